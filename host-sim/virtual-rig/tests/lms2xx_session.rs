//! The session against a virtual scanner: found at every rate, set up, and read.

use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{
    Action, Baud, MeasuringMode, Phase, Session, SessionEvent, Settings, Trouble, Unit, Variant,
};
use scanseg_virtual_rig::VirtualLms;

use crate::lms2xx_bench::{Bench, SETTINGS, ramp};

#[test]
fn from_every_rate_to_every_rate() {
    for from in Baud::ALL {
        for to in Baud::ALL {
            let lms = VirtualLms::new(ramp).running(from, Variant::Deg100Step05);
            let mut bench = Bench::new(lms, Settings { baud: to, ..SETTINGS });
            let took_ms = bench.run_scans(3, 40_000);
            println!("{from:?} to {to:?}: third scan after {took_ms} ms");
            assert_eq!(bench.troubles, []);
            assert_eq!((bench.port, bench.session.phase()), (to, Phase::Running));
            assert_eq!(bench.lms.mode_and_unit(), (6, 1));
            assert_eq!(bench.lms.eeprom_writes, 1);
        }
    }
}

#[test]
fn every_variant_and_interlacing() {
    for variant in Variant::ALL {
        for interlaced in [false, true] {
            for (unit, mode) in [
                (Unit::Centimetre, MeasuringMode::Range8Fields),
                (Unit::Millimetre, MeasuringMode::Range16Fields),
                (Unit::Decimetre, MeasuringMode::Range32Immediate),
            ] {
                let settings = Settings { baud: Baud::B500000, variant, unit, mode, interlaced };
                let mut bench = Bench::new(VirtualLms::new(ramp), settings);
                bench.run_scans(8, 30_000);
                let untouched = unit == Unit::Centimetre;
                assert_eq!(bench.lms.eeprom_writes, u32::from(!untouched), "written only where it differs");
                assert_eq!(bench.lms.mode_and_unit(), (mode.code(), unit.code()));
            }
        }
    }
}

/// As many scans a second as the mirror or the line allow.
#[test]
fn scan_rates() {
    for (baud, variant, interlaced, per_10_s) in [
        (Baud::B500000, Variant::Deg180Step1, false, 750),
        (Baud::B500000, Variant::Deg180Step05, false, 375),
        (Baud::B500000, Variant::Deg180Step05, true, 750),
        (Baud::B500000, Variant::Deg100Step025, false, 187),
        (Baud::B38400, Variant::Deg180Step05, false, 46),
        (Baud::B9600, Variant::Deg180Step05, false, 12),
    ] {
        let mut bench = Bench::new(VirtualLms::new(ramp), Settings { baud, variant, interlaced, ..SETTINGS });
        bench.run_scans(1, 30_000);
        let before = bench.scans;
        bench.run_ms(10_000);
        let scans = bench.scans - before;
        assert!(scans.abs_diff(per_10_s) <= 1, "{baud:?} {variant:?}: {scans} scans in 10 s");
        assert_eq!(bench.rejected, 0);
    }
}

#[test]
fn values_arrive_in_order() {
    let mut bench = Bench::new(VirtualLms::new(ramp), SETTINGS);
    bench.run_scans(1, 30_000);
    // Byte by byte up to the next scan.
    loop {
        let Action::Wait { .. } = bench.session.poll(bench.now_ms()) else { panic!("running") };
        bench.now_us += 100;
        let bytes = bench.lms.read(bench.now_us, bench.port);
        if bytes.iter().any(|byte| bench.session.feed(bench.now_ms(), &[*byte]).1 == SessionEvent::ScanLine) {
            break;
        }
    }
    let scan = bench.session.scan_line().expect("scan");
    assert!(scan.words().eq((0..361).map(|column| 1000 + column * 20)));
}

#[test]
fn nobody_there() {
    let mut bench = Bench::new(VirtualLms::new(ramp), SETTINGS);
    bench.lms.wires.faults.drop_one_in = 1;
    bench.run_ms(20_000);
    assert!(bench.troubles.len() >= 2, "{:?}", bench.troubles);
    assert!(bench.troubles.iter().all(|trouble| *trouble == Trouble::NotFound));
    assert_eq!(bench.session.phase(), Phase::Finding);
    bench.lms.wires.faults.drop_one_in = 0;
    bench.run_scans(3, 30_000);
}

#[test]
fn listening_sends_nothing() {
    let mut session = Session::listening(SETTINGS);
    assert_eq!(session.phase(), Phase::Running);
    assert!(matches!(session.poll(0), Action::Wait { .. }));
    let mut message = b"\x02\x80\x17\x00\x90LMS200;301063;V02.10 \x10".to_vec();
    message.extend(check_word(&message).to_le_bytes());
    while let (used, event) = session.feed(100_000, &message)
        && event != SessionEvent::NeedMore
    {
        message.drain(..used);
    }
    assert!(matches!(session.poll(100_000), Action::Tell(Trouble::Restarted)));
    assert!(matches!(session.poll(1_000_000), Action::Wait { .. }));
    assert_eq!(session.phase(), Phase::Running);
}
