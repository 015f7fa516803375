//! The session against a virtual scanner: recovered from every fault.

use proptest::prelude::*;
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Action, Baud, Phase, Session, SessionEvent, Settings, Trouble, Variant};
use scanseg_virtual_rig::{Mishap, VirtualLms, WireFaults};

use crate::lms2xx_bench::{Bench, RESTARTS, SETTINGS, ramp};

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

/// A scanner that starts over between scans.
#[test]
fn restart_while_running() {
    for message in RESTARTS {
        let mut bench = Bench::new(VirtualLms::new(ramp), Settings { baud: Baud::B9600, ..SETTINGS });
        bench.run_up();
        // The scan under way is lost to it.
        for _ in 0..100 {
            bench.receive(message);
        }
        bench.step();
        assert_eq!(bench.troubles, [Trouble::Restarted]);
        bench.run_scans(3, 30_000);
    }
}

/// A scanner that starts over while the session waits for one of its answers: the session begins
/// again. (At the first one scans still come, and the message could be taken for values of one.)
#[test]
fn restart_during_every_command() {
    for message in RESTARTS {
        for at in 1..9 {
            let lms = VirtualLms::new(ramp).running(Baud::B9600, Variant::Deg180Step1);
            let mut bench = Bench::new(lms, SETTINGS);
            while bench.lms.commands.len() <= at {
                bench.step();
            }
            bench.receive(message);
            bench.step();
            assert_eq!(bench.troubles, [Trouble::Restarted], "at {at}");
            assert_eq!(bench.session.phase(), Phase::Finding);
            bench.run_scans(3, 60_000);
            assert!(bench.lms.eeprom_writes <= 1);
        }
    }
}

/// An answer that breaks off: the command is sent again.
#[test]
fn answer_that_breaks_off() {
    let mut session = Session::new(SETTINGS);
    let mut now_ms = 0;
    let mut tries = 0;
    loop {
        match session.poll(now_ms) {
            Action::Send { bytes, .. } => {
                assert_eq!(bytes.as_slice()[4..6], [0x20, 0x25]);
                tries += 1;
                if tries == 2 {
                    break;
                }
                let half_an_answer = [0x06, 0x02, 0x80, 0x03, 0x00, 0xA0];
                assert_eq!(session.feed(now_ms, &half_an_answer[..1]), (1, SessionEvent::NeedMore));
                assert_eq!(session.feed(now_ms, &half_an_answer[1..]), (5, SessionEvent::NeedMore));
            }
            Action::Wait { ms } => now_ms += ms,
            Action::SetBaud(_) => {}
            Action::Tell(trouble) => panic!("{trouble}"),
        }
    }
    assert!((1_000..2_500).contains(&now_ms), "{now_ms}: it was acknowledged, so the answer had its time");
}

/// A scanner that never takes the variant, as an LMS 2xx-S14: told again and again, and good if
/// another one is put in.
#[test]
fn variant_refused_for_good() {
    let lms = VirtualLms::new(ramp).running(Baud::B38400, Variant::Deg180Step1);
    let mut bench = Bench::new(lms, SETTINGS);
    while bench.troubles.len() < 5 {
        let refuse = bench.lms.commands.last() == Some(&0x20);
        bench.lms.mishaps =
            [if refuse || bench.lms.commands.ends_with(&[0x3B]) { Mishap::Refuse } else { Mishap::None }].into();
        if bench.session.phase() == Phase::Finding {
            bench.lms.mishaps.clear();
        }
        bench.step();
        assert!(bench.now_us < 60_000_000 && bench.scans == 0);
    }
    assert_eq!(bench.troubles, [Trouble::Refused { command: 0x3B, reason: 0 }; 5]);
    bench.lms.mishaps.clear();
    bench.run_scans(3, 10_000);
    assert_eq!(bench.lms.eeprom_writes, 1);
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
            // A write is not tried twice, and a rate that was changed unheard has to be searched
            // for.
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
            let first = bench.troubles.first().copied();
            let expected = match mishap {
                // They are tried again; but a write of the EEPROM is not.
                NoAcknowledge => (4..=6).contains(&at).then_some(Trouble::NoAnswer { command: 0x77 }),
                // A failure while searching only leads to the next rate.
                _ if at == 0 || at == 2 => {
                    assert!(bench.troubles.iter().all(|trouble| *trouble == Trouble::NotFound), "{mishap:?} at {at}");
                    first
                }
                // Scans that come although the start was not answered are good enough.
                NoAnswer if at == 8 => None,
                Nack => Some(Trouble::NotAcknowledged { command: code }),
                Ignore | NoAnswer | WrongAnswer => Some(Trouble::NoAnswer { command: code }),
                Refuse if code == 0x74 => Some(Trouble::Configuration { length: 1 }),
                Refuse => Some(Trouble::Refused { command: code, reason: u8::from(code == 0x20) }),
                _ => Some(Trouble::Refused { command: code, reason: 0x92 }),
            };
            assert_eq!(first, expected, "{mishap:?} at {at}");
        }
    }
}

#[test]
fn bad_wires() {
    for faults in [
        WireFaults { flip_one_in: 5_000, ..WireFaults::default() },
        WireFaults { drop_one_in: 5_000, ..WireFaults::default() },
        WireFaults { insert_one_in: 5_000, ..WireFaults::default() },
        WireFaults { flip_one_in: 9_000, drop_one_in: 9_000, insert_one_in: 9_000, ..WireFaults::default() },
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
        variant in prop::sample::select(Variant::ALL.to_vec()),
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
        bench.lms.wires.faults = WireFaults::default();
        bench.run_scans(3, 200_000);
    }
}

/// On wires that let no scan through whole, a good head now and then is enough: the scanner is left
/// alone.
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
