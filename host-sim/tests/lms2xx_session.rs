//! The session against a virtual scanner: found at every rate, set up, and recovered from every fault.

use proptest::prelude::*;
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{
    Action, Baud, MeasuringMode, Phase, Session, SessionEvent, Settings, Trouble, Unit, Variant,
};
use scanseg_sim::virtual_rig::{Beam, Faults, Mishap, VirtualLms};

const SETTINGS: Settings = Settings {
    baud: Baud::B38400,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
const VARIANTS: [Variant; 5] =
    [Variant::Deg100Step1, Variant::Deg100Step05, Variant::Deg100Step025, Variant::Deg180Step1, Variant::Deg180Step05];

/// Ranges that tell the bearing: 1000 and 40 a degree.
fn ramp(beam: Beam) -> u16 {
    1000 + (beam.bearing_deg * 40.0) as u16
}

/// A session and a scanner on one simulated line.
struct Bench {
    session: Session,
    lms: VirtualLms,
    port: Baud,
    now_us: u64,
    troubles: Vec<Trouble>,
    scans: u32,
    rejected: u32,
}

impl Bench {
    fn new(lms: VirtualLms, settings: Settings) -> Self {
        let session = Session::new(settings);
        Self { session, lms, port: Baud::B9600, now_us: 0, troubles: vec![], scans: 0, rejected: 0 }
    }

    fn now_ms(&self) -> u32 {
        // The clock wraps soon after the start.
        (u32::MAX - 5_000).wrapping_add((self.now_us / 1000) as u32)
    }

    /// Does what the session says once; waits are taken in steps of a millisecond.
    fn step(&mut self) {
        match self.session.poll(self.now_ms()) {
            Action::SetBaud(baud) => {
                self.lms.read(self.now_us, self.port);
                self.port = baud;
                assert_eq!(self.session.baud(), baud);
            }
            Action::Send { bytes, gap_us } => {
                for byte in bytes.as_slice() {
                    self.now_us = self.lms.write(self.now_us, &[*byte], self.port) + u64::from(gap_us);
                }
            }
            Action::Wait { ms } => {
                assert!(ms > 0);
                self.now_us += 1000;
                let bytes = self.lms.read(self.now_us, self.port);
                self.receive(&bytes);
            }
            Action::Tell(trouble) => self.troubles.push(trouble),
        }
    }

    fn receive(&mut self, mut bytes: &[u8]) {
        loop {
            let (used, event) = self.session.feed(self.now_ms(), bytes);
            bytes = &bytes[used..];
            match event {
                SessionEvent::NeedMore => return assert!(bytes.is_empty()),
                SessionEvent::Start { .. } => {}
                SessionEvent::Rejected(_) => self.rejected += 1,
                SessionEvent::Scan => {
                    let settings = *self.session.settings();
                    let scan = self.session.scan().expect("scan");
                    assert_eq!(scan.unit(), settings.unit);
                    match scan.partial_quarter() {
                        None => assert_eq!(scan.columns(), settings.variant.columns()),
                        Some(quarter) => assert_eq!(Some(scan.columns()), settings.variant.partial_columns(quarter)),
                    }
                    assert_eq!(scan.partial_quarter().is_some(), settings.interlaced);
                    self.scans += 1;
                }
            }
        }
    }

    /// Past the scanner's own start, during which it is looked for in vain.
    fn run_up(&mut self) {
        self.run_scans(1, 30_000);
        assert!(self.troubles.iter().all(|trouble| matches!(trouble, Trouble::NotFound | Trouble::Restarted)));
        self.troubles.clear();
    }

    /// Until as many more scans have come; how many milliseconds that took.
    fn run_scans(&mut self, scans: u32, at_most_ms: u64) -> u64 {
        let (goal, begin) = (self.scans + scans, self.now_us);
        while self.scans < goal {
            self.step();
            let took_ms = (self.now_us - begin) / 1000;
            assert!(took_ms < at_most_ms, "{:?} after {took_ms} ms, {:?}", self.session.phase(), self.troubles);
        }
        (self.now_us - begin) / 1000
    }

    fn run_ms(&mut self, ms: u64) {
        let end = self.now_us + ms * 1000;
        while self.now_us < end {
            self.step();
        }
    }
}

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
    for variant in VARIANTS {
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
        if bytes.iter().any(|byte| bench.session.feed(bench.now_ms(), &[*byte]).1 == SessionEvent::Scan) {
            break;
        }
    }
    let scan = bench.session.scan().expect("scan");
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
fn power_cycle_and_silence_and_reset() {
    let mut bench = Bench::new(VirtualLms::new(ramp), SETTINGS);
    bench.run_up();
    let writes = bench.lms.eeprom_writes;

    bench.lms.fall_silent(bench.now_us);
    println!("running again {} ms after falling silent", bench.run_scans(3, 15_000));
    assert_eq!(bench.troubles, [Trouble::Silent]);

    bench.lms.power_cycle(bench.now_us);
    println!("running again {} ms after a power cycle", bench.run_scans(3, 30_000));
    assert_eq!(bench.troubles[..2], [Trouble::Silent, Trouble::Silent]);

    // At the permanent rate its power-on message can be heard.
    let mut bench = Bench::new(VirtualLms::new(ramp), Settings { baud: Baud::B9600, ..SETTINGS });
    bench.run_scans(3, 30_000);
    bench.lms.power_cycle(bench.now_us);
    bench.run_scans(3, 30_000);
    assert!(
        bench
            .troubles
            .iter()
            .all(|trouble| matches!(trouble, Trouble::Silent | Trouble::NotFound | Trouble::Restarted))
    );
    assert_eq!(bench.lms.eeprom_writes, writes, "what is there already is not written again");
}

/// A scanner that starts over while the session waits for an answer, or between scans.
#[test]
fn power_on_message_restarts_the_session() {
    let mut bench = Bench::new(VirtualLms::new(ramp), Settings { baud: Baud::B9600, ..SETTINGS });
    bench.run_up();
    let message = [
        0x02, 0x80, 0x17, 0x00, 0x90, 0x4C, 0x4D, 0x53, 0x32, 0x30, 0x30, 0x3B, 0x33, 0x30, 0x31, 0x30, 0x36, 0x33,
        0x3B, 0x56, 0x30, 0x32, 0x2E, 0x31, 0x30, 0x20, 0x10, 0x63, 0x5E,
    ];
    // The scan under way is lost to it.
    while bench.session.phase() == Phase::Running {
        bench.receive(&message);
    }
    bench.step();
    assert_eq!(bench.troubles, [Trouble::Restarted]);
    bench.run_scans(3, 30_000);
}

/// Scans that are good in themselves but not as set up do not count.
#[test]
fn scans_of_another_format() {
    let mut bench = Bench::new(VirtualLms::new(ramp), SETTINGS);
    bench.run_up();
    bench.lms.fall_silent(bench.now_us);
    bench.run_ms(400);
    assert_eq!((bench.session.phase(), bench.rejected), (Phase::Running, 0));
    let mut bytes = vec![0x02, 0x80, 0x6E, 0x01, 0xB0, 0xB5, 0x00];
    bytes.resize(7 + 2 * 181, 0);
    bytes.push(0x10);
    bytes.extend(check_word(&bytes).to_le_bytes());
    let before = bench.scans;
    for count in 1.. {
        bench.receive(&bytes);
        bench.run_ms(50);
        if bench.session.phase() != Phase::Running {
            assert!(count > 10);
            break;
        }
        assert_eq!((bench.rejected, bench.scans), (count, before));
    }
    bench.run_scans(3, 30_000);
    assert_eq!(bench.troubles, [Trouble::Silent]);
}

/// A false start byte claims the answer, and no further byte comes to show that it was false.
#[test]
fn answer_behind_a_false_start() {
    let mut session = Session::new(SETTINGS);
    let mut now_ms = 0;
    let mut next_command = |session: &mut Session| loop {
        match session.poll(now_ms) {
            Action::Send { bytes, .. } => return bytes.as_slice()[4],
            Action::Wait { ms } => now_ms += ms,
            Action::SetBaud(_) => {}
            Action::Tell(trouble) => panic!("{trouble}"),
        }
    };
    assert_eq!(next_command(&mut session), 0x20);
    let answer = [0x06, 0x02, 0x80, 0x03, 0x00, 0xA0, 0x00, 0x10, 0x16, 0x0A];
    let mut bytes = &[&[0x02, 0x80, 0x40, 0x00, 0xA0], &answer[..]].concat()[..];
    while !bytes.is_empty() {
        let (used, event) = session.feed(60, bytes);
        bytes = &bytes[used..];
        assert_eq!(event, SessionEvent::NeedMore);
    }
    assert_eq!(session.phase(), Phase::Finding);
    assert_eq!(next_command(&mut session), 0x3B, "found without a second try");
}

/// Each thing that can go wrong, with each command of the set-up, once and then over and over.
#[test]
fn every_mishap_with_every_command() {
    use Mishap::{Ignore, Misunderstand, Nack, NoAcknowledge, NoAnswer, Refuse, WrongAnswer};
    // Stop, rate, stop, variant, read, install, write, leave, start.
    const CODES: [u8; 9] = [0x20, 0x20, 0x20, 0x3B, 0x74, 0x20, 0x77, 0x20, 0x20];
    let clean = {
        let mut bench = Bench::new(VirtualLms::new(ramp).running(Baud::B9600, Variant::Deg180Step1), SETTINGS);
        bench.run_scans(1, 30_000);
        bench.lms.commands.clone()
    };
    assert_eq!(clean, CODES);
    for mishap in [Ignore, Nack, NoAcknowledge, NoAnswer, Refuse, Misunderstand, WrongAnswer] {
        for (at, code) in CODES.into_iter().enumerate() {
            let lms = VirtualLms::new(ramp).running(Baud::B9600, Variant::Deg180Step1);
            let mut bench = Bench::new(lms, SETTINGS);
            bench.lms.mishaps = core::iter::repeat_n(Mishap::None, at).chain([mishap]).collect();
            bench.run_scans(3, 60_000);
            assert!(bench.lms.eeprom_writes == 1 || mishap == NoAnswer, "{mishap:?} at {at}");
            assert!(bench.lms.eeprom_writes <= 1, "{mishap:?} at {at}: an answer lost, and written again");
            // A write is not tried twice, and a rate that was changed unheard has to be searched for.
            let told = !bench.troubles.is_empty();
            let may_tell = code == 0x77 || (at == 1 && mishap == NoAnswer) || (code == 0x74 && mishap == Refuse);
            assert!(!told || may_tell, "{mishap:?} at {at}: {:?}", bench.troubles);

            if code == 0x20 && at == 8 && mishap == NoAnswer {
                assert_eq!(bench.lms.commands, CODES, "the scans are answer enough");
            }

            // Again, but now so often that the session has to start over.
            let lms = VirtualLms::new(ramp).running(Baud::B9600, Variant::Deg180Step1);
            let mut bench = Bench::new(lms, SETTINGS);
            bench.lms.mishaps = core::iter::repeat_n(Mishap::None, at).chain([mishap; 4]).collect();
            bench.run_scans(3, 120_000);
            let expected = match mishap {
                NoAcknowledge => None,
                Nack => Some(Trouble::NotAcknowledged { command: code }),
                Ignore | NoAnswer | WrongAnswer => Some(Trouble::NoAnswer { command: code }),
                Refuse if code == 0x74 => Some(Trouble::Configuration { length: 1 }),
                Refuse => Some(Trouble::Refused { command: code, reason: u8::from(code == 0x20) }),
                _ => Some(Trouble::Refused { command: code, reason: 0x92 }),
            };
            // While searching, failures only lead to the next rate; a rate that was changed unheard is searched for; and scans that come
            // although the start was not answered are good enough.
            let searching = at == 0 || at == 2;
            let unheard = (code == 0x74 && mishap == Refuse)
                || (at == 8 && mishap == NoAnswer)
                || (at == 1 && mishap == NoAnswer);
            match expected {
                Some(expected) if !searching && !unheard => {
                    assert_eq!(bench.troubles.first(), Some(&expected), "{mishap:?} at {at}");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn bad_wires() {
    for faults in [
        Faults { flip_one_in: 5_000, ..Faults::default() },
        Faults { drop_one_in: 5_000, ..Faults::default() },
        Faults { insert_one_in: 5_000, ..Faults::default() },
        Faults { flip_one_in: 9_000, drop_one_in: 9_000, insert_one_in: 9_000, ..Faults::default() },
    ] {
        let mut bench = Bench::new(VirtualLms::new(ramp), Settings { baud: Baud::B500000, ..SETTINGS });
        bench.run_up();
        bench.lms.wires.faults = faults;
        let before = bench.scans;
        bench.run_ms(20_000);
        let scans = bench.scans - before;
        // 750 were sent; of 732 bytes all must arrive whole: about one telegram in seven is hit.
        println!("{faults:?}: {scans} of 750 scans, {} telegrams rejected, {:?}", bench.rejected, bench.troubles);
        assert!((560..720).contains(&scans), "{scans} scans");
        assert!(bench.rejected >= 30);
        assert_eq!(bench.troubles, []);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever happens to the scanner, in the end it scans.
    #[test]
    fn comes_back_from_anything(
        mishaps in prop::collection::vec(
            prop::sample::select(vec![
                Mishap::None, Mishap::Ignore, Mishap::Nack, Mishap::NoAcknowledge,
                Mishap::NoAnswer, Mishap::Refuse, Mishap::Misunderstand, Mishap::WrongAnswer,
            ]), 0..12),
        blows in prop::collection::vec((0u64..9_000, 0u8..4), 0..4),
        to in prop::sample::select(Baud::ALL.to_vec()),
        variant in prop::sample::select(VARIANTS.to_vec()),
        interlaced in any::<bool>(),
    ) {
        let settings = Settings { baud: to, variant, interlaced, ..SETTINGS };
        let mut bench = Bench::new(VirtualLms::new(ramp), settings);
        bench.lms.mishaps = mishaps.into();
        for (after_ms, blow) in blows {
            bench.run_ms(after_ms);
            match blow {
                0 => bench.lms.power_cycle(bench.now_us),
                1 => bench.lms.fall_silent(bench.now_us),
                2 => bench.lms.wires.faults.flip_one_in = 300,
                _ => bench.lms.wires.faults.drop_one_in = 300,
            }
        }
        bench.lms.wires.faults = Faults::default();
        bench.run_scans(3, 200_000);
    }
}

/// On wires that let no scan through whole, a good head now and then is enough: the scanner is left alone.
#[test]
fn damaged_scans_are_signs_of_life() {
    let mut bench = Bench::new(VirtualLms::new(ramp).running(Baud::B38400, Variant::Deg180Step05), SETTINGS);
    bench.run_scans(3, 40_000);
    let (commands, scans) = (bench.lms.commands.len(), bench.scans);
    bench.lms.wires.faults.flip_one_in = 50;
    bench.run_ms(20_000);
    assert!(bench.scans <= scans + 1 && bench.rejected > 50);
    assert_eq!((bench.troubles.len(), bench.lms.commands.len()), (0, commands));
    bench.lms.fall_silent(bench.now_us);
    bench.run_ms(3_000);
    assert_eq!(bench.troubles, [Trouble::Silent]);
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
