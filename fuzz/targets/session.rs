//! A session that is told anything at any time; and with a scanner that does some things wrong and
//! then none: it runs.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_fuzz::scanner::{Piece, settings};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Action, Baud, Phase, Session, SessionEvent, Settings};
use scanseg_virtual_rig::telegrams::frame;
use scanseg_virtual_rig::{Beam, Mishap, VirtualLms, WireFaults};

#[derive(Debug, Arbitrary)]
enum Step {
    /// Do what it says; time goes on as long as it waits.
    Poll,
    /// Time goes on so many milliseconds; then poll.
    Later(u32),
    /// What a scanner may send.
    Came(Piece),
    /// What a scanner answers to the command sent last.
    Answer { code: u8, data: Vec<u8> },
    /// The same, good.
    Good,
}

#[derive(Debug)]
enum Input {
    Steps { settings: Settings, listening: bool, now_ms: u32, steps: Vec<Step> },
    Scanner { settings: Settings, running: bool, mishaps: Vec<Mishap>, faults: [u8; 3], cycle: bool },
}

const MISHAPS: [Mishap; 8] = [
    Mishap::None,
    Mishap::Ignore,
    Mishap::Nack,
    Mishap::NoAcknowledge,
    Mishap::NoAnswer,
    Mishap::Refuse,
    Mishap::Misunderstand,
    Mishap::WrongAnswer,
];

impl Arbitrary<'_> for Input {
    fn arbitrary(u: &mut Unstructured) -> Result<Input> {
        let with_scanner = u.arbitrary::<u8>()? % 16 == 15;
        let settings = settings(u)?;
        Ok(if with_scanner {
            let mishaps = u.arbitrary_iter::<u8>()?.take(12);
            let mishaps = mishaps.map(|mishap| Ok(MISHAPS[usize::from(mishap? % 8)])).collect::<Result<_>>()?;
            Input::Scanner { settings, running: u.arbitrary()?, mishaps, faults: u.arbitrary()?, cycle: u.arbitrary()? }
        } else {
            Input::Steps { settings, listening: u.arbitrary()?, now_ms: u.arbitrary()?, steps: u.arbitrary()? }
        })
    }
}

fuzz_target!(|input: Input| match input {
    Input::Steps { settings, listening, now_ms, steps } => anything(settings, listening, now_ms, &steps),
    Input::Scanner { settings, running, mishaps, faults, cycle } => scanner(settings, running, mishaps, faults, cycle),
});

fn anything(settings: Settings, listening: bool, mut now_ms: u32, steps: &[Step]) {
    let mut session = if listening { Session::listening(settings) } else { Session::new(settings) };
    let mut command = Vec::new();
    for step in steps {
        match step {
            Step::Poll => poll(&mut session, &mut now_ms, &mut command),
            Step::Later(ms) => {
                now_ms = now_ms.wrapping_add(*ms);
                poll(&mut session, &mut now_ms, &mut command);
            }
            Step::Came(piece) => feed(&mut session, now_ms, &piece.bytes(&settings)),
            Step::Answer { code, data } => {
                let piece = [&[*code][..], &data[..data.len().min(100)], &[0x10]].concat();
                feed(&mut session, now_ms, &[&[0x06], &frame(&piece)[..]].concat());
            }
            Step::Good => {
                feed(&mut session, now_ms, &good_answer(&command, &settings));
            }
        }
        assert!(!listening || session.phase() == Phase::Running);
    }
}

/// What a scanner answers that does as it is told.
fn good_answer(command: &[u8], settings: &Settings) -> Vec<u8> {
    let Some(&code) = command.get(4) else { return vec![] };
    let data = match code {
        0x20 => vec![0],
        0x3B => [&[1], &command[5..9]].concat(),
        // as wanted, or to be written
        0x74 => {
            let mut configuration = vec![0; 32];
            configuration[5] = if settings.interlaced { settings.mode.code() } else { 0 };
            configuration[6] = settings.unit.code();
            configuration
        }
        0x77 => vec![1],
        _ => vec![],
    };
    [&[0x06], &frame(&[&[code + 0x80][..], &data, &[0x10]].concat())[..]].concat()
}

fn poll(session: &mut Session, now_ms: &mut u32, command: &mut Vec<u8>) {
    match session.poll(*now_ms) {
        Action::SetBaud(baud) => assert_eq!(baud, session.baud()),
        Action::Send { bytes, gap_us } => {
            *command = bytes.as_slice().to_vec();
            let (covered, check) = command.split_at(command.len() - 2);
            assert_eq!((covered[0], covered[1], check), (0x02, 0x00, &check_word(covered).to_le_bytes()[..]));
            assert_eq!(gap_us, if session.baud() == Baud::B500000 { 60 } else { 0 });
        }
        Action::Wait { ms } => {
            assert!((1..=20_000).contains(&ms), "waits {ms} ms");
            *now_ms = now_ms.wrapping_add(ms);
        }
        Action::Tell(_) => {}
    }
}

fn feed(session: &mut Session, now_ms: u32, mut bytes: &[u8]) {
    loop {
        let (used, event) = session.feed(now_ms, bytes);
        bytes = &bytes[used..];
        match event {
            SessionEvent::NeedMore => return assert!(bytes.is_empty()),
            SessionEvent::Start { .. } | SessionEvent::Rejected(_) => assert_eq!(session.phase(), Phase::Running),
            SessionEvent::ScanLine => check_scan(session),
        }
    }
}

fn check_scan(session: &Session) {
    let (settings, scan) = (session.settings(), session.scan_line().expect("a scan"));
    let columns = match scan.partial_quarter() {
        None => Some(settings.variant.columns()),
        Some(quarter) => settings.variant.partial_columns(quarter),
    };
    // a sub-range is a part of it
    let end = scan.first_column() + scan.columns();
    assert!(columns.is_some_and(|columns| end <= columns) && scan.fits(settings.variant), "{scan:?}");
    assert_eq!(scan.unit(), settings.unit);
    assert_eq!((scan.partial_quarter().is_some(), session.phase()), (settings.interlaced, Phase::Running));
}

/// Whatever went wrong for 5 s, when nothing does any more the session runs within two minutes.
fn scanner(settings: Settings, running: bool, mishaps: Vec<Mishap>, faults: [u8; 3], cycle: bool) {
    let mut lms = VirtualLms::new(|_: Beam| 1500);
    if running {
        lms = lms.running(Baud::B38400, settings.variant);
    }
    lms.mishaps = mishaps.into();
    let [drop_one_in, flip_one_in, insert_one_in] = faults.map(|one_in| 8 * u32::from(one_in));
    lms.wires.faults = WireFaults { drop_one_in, flip_one_in, insert_one_in, ..WireFaults::default() };
    let mut session = Session::new(settings);
    let (mut port, mut now_us, mut scans) = (Baud::B9600, 0, 0);
    let good_from_us = 5_000_000;
    let mut is_good = false;
    while scans < 3 {
        if !is_good && now_us >= good_from_us {
            is_good = true;
            lms.wires.faults = WireFaults::default();
            lms.mishaps.clear();
            if cycle {
                lms.power_cycle(now_us);
            }
        }
        match session.poll((now_us / 1000) as u32) {
            Action::SetBaud(baud) => {
                lms.read(now_us, port);
                port = baud;
            }
            Action::Send { bytes, gap_us } => {
                for byte in bytes.as_slice() {
                    now_us = lms.write(now_us, &[*byte], port) + u64::from(gap_us);
                }
            }
            Action::Wait { ms } => {
                now_us += 1000 * u64::from(ms.min(20));
                let bytes = lms.read(now_us, port);
                let mut rest = &bytes[..];
                loop {
                    let (used, event) = session.feed((now_us / 1000) as u32, rest);
                    rest = &rest[used..];
                    match event {
                        SessionEvent::NeedMore => break,
                        SessionEvent::ScanLine => {
                            check_scan(&session);
                            scans += u32::from(is_good);
                        }
                        _ => {}
                    }
                }
            }
            Action::Tell(_) => {}
        }
        assert!(now_us < good_from_us + 120_000_000, "{:?}", session.phase());
    }
}
