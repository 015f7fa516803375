//! The session against a virtual scanner: found at every rate, set up, and recovered from every
//! fault.

use proptest::prelude::*;
use scanseg_hal::lms2xx::command::{Answer, Command, Configuration};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{
    Action, Baud, Event, MeasuringMode, Phase, SUB_RANGE, Session, SessionEvent, Settings, TelegramDecoder, Trouble,
    Unit, Variant,
};
use scanseg_virtual_rig::{Beam, Mishap, VirtualLms, WireFaults};

const SETTINGS: Settings = Settings {
    baud: Baud::B38400,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};

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
                SessionEvent::ScanLine => {
                    let settings = *self.session.settings();
                    let scan = self.session.scan_line().expect("scan");
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

/// What the scanner says when it has been switched on, and when it has been reset.
const RESTARTS: [&[u8]; 2] =
    [b"\x02\x80\x17\x00\x90LMS200;301063;V02.10 \x10\x63\x5E", &[0x02, 0x80, 0x02, 0x00, 0x91, 0x10, 0x79, 0x30]];

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

/// Sends a command to a scanner and waits for what it says to it; code, data and answer.
fn ask(lms: &mut VirtualLms, now_us: &mut u64, baud: Baud, command: &Command) -> (u8, Vec<u8>, Option<Answer>) {
    let mut decoder = TelegramDecoder::new();
    *now_us = lms.write(*now_us, command.encode().as_slice(), baud);
    let mut acknowledged = false;
    for _ in 0..10_000 {
        *now_us += 1_000;
        let bytes = lms.read(*now_us, baud);
        let mut rest = &bytes[..];
        loop {
            let fed = decoder.feed(rest);
            rest = &rest[fed.used..];
            match fed.event {
                Event::NeedMore => break,
                Event::Ack => acknowledged = true,
                Event::Start { .. } => {}
                Event::Telegram { code } => {
                    assert!(acknowledged, "an answer is acknowledged first");
                    let telegram = decoder.telegram().expect("telegram");
                    return (code, telegram.data().to_vec(), command.answer(&telegram));
                }
                event => panic!("{event:?}"),
            }
        }
    }
    panic!("{command:?} is not answered");
}

/// Every command, as a driver without a session would send it.
#[test]
fn every_command_is_answered() {
    let (mut lms, mut now_us) = (VirtualLms::new(ramp).running(Baud::B9600, Variant::Deg100Step05), 0);
    let mut ask = |command: Command| self::ask(&mut lms, &mut now_us, Baud::B9600, &command);
    let done = Some(Answer::Done);
    assert_eq!(ask(Command::Stop), (0xA0, vec![0], done));
    let (code, data, answer) = ask(Command::Type);
    assert_eq!((code, &data[..], answer), (0xBA, &b"LMS200;301063;V02.10 "[..], done));
    let (code, data, answer) = ask(Command::Status);
    assert_eq!((code, &data[..8], data.len(), answer), (0xB1, &b"V02.10 \x25"[..], 151, done));
    assert_eq!(ask(Command::Errors), (0xB2, vec![0, 0], done));
    for variant in Variant::ALL {
        assert_eq!(ask(Command::SetVariant(variant)).2, done);
        let (code, data, answer) = ask(Command::Poll);
        assert_eq!((code, data.len(), answer), (0xB0, 2 + 2 * usize::from(variant.columns()), done));
        // One scan only: the next telegram is the answer to the next command.
        assert_eq!(ask(Command::Type).0, 0xBA);
    }
    let (code, data, answer) = ask(Command::ReadConfiguration);
    assert_eq!((code, answer), (0xF4, done));
    let wanted = Configuration::new(&data).expect("configuration").with(MeasuringMode::Range16Fields, Unit::Millimetre);
    assert_eq!(ask(Command::WriteConfiguration(wanted)).2, Some(Answer::Refused(0)), "not in installation mode");
    assert_eq!(ask(Command::Install), (0xA0, vec![0], done));
    assert_eq!(ask(Command::WriteConfiguration(wanted)).2, done);
    assert_eq!(ask(Command::ReadConfiguration).1, wanted.as_slice());
    for (first, last) in [(0, 10), (11, 10), (10, 362)] {
        assert_eq!(ask(Command::StartSubRange { first, last }).2, Some(Answer::Refused(1)));
    }
    assert_eq!(ask(Command::StartSubRange { first: 90, last: 270 }).2, done);
    assert_eq!(ask(Command::Stop).2, done);
    assert_eq!(ask(Command::Start).2, done);
    assert_eq!(ask(Command::StartInterlaced).2, done);
    assert_eq!(ask(Command::Stop).2, done);
    assert_eq!(ask(Command::SetBaud(Baud::B38400)).2, done);
    // It does not hear while it changes its rate.
    now_us += 300_000;
    let mut ask = |command: Command| self::ask(&mut lms, &mut now_us, Baud::B38400, &command);
    assert_eq!(ask(Command::Reset), (0x91, vec![], done));
    now_us += 5_000_000;
    let message = lms.read(now_us, Baud::B9600);
    assert_eq!(message, RESTARTS[0]);
}

/// The values of a part of the scan, with the columns that they are of.
#[test]
fn sub_range_values() {
    let (mut lms, mut now_us) = (VirtualLms::new(ramp).running(Baud::B38400, Variant::Deg180Step05), 0);
    assert_eq!(ask(&mut lms, &mut now_us, Baud::B38400, &Command::StartSubRange { first: 90, last: 270 }).0, 0xA0);
    let mut decoder = TelegramDecoder::new();
    decoder.expect_scan_lines(Some(Settings { unit: Unit::Centimetre, ..SETTINGS }.format()));
    let mut scans = 0;
    while scans < 3 {
        now_us += 300;
        let bytes = lms.read(now_us, Baud::B38400);
        let mut rest = &bytes[..];
        loop {
            let fed = decoder.feed(rest);
            rest = &rest[fed.used..];
            match fed.event {
                Event::NeedMore => break,
                Event::Start { .. } => {}
                event => {
                    assert_eq!(event, Event::Telegram { code: SUB_RANGE });
                    let scan = decoder.telegram().and_then(|telegram| telegram.scan_line()).expect("scan");
                    assert_eq!((scan.first_column(), scan.columns(), scan.partial_quarter()), (89, 181, None));
                    assert!(scan.words().eq((89..270).map(|column| 1000 + column * 20)));
                    scans += 1;
                }
            }
        }
    }
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
