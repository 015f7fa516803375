//! The commands of a virtual scanner, as a driver without a session would send them.

use scanseg_hal::lms2xx::command::{Answer, Command, Configuration};
use scanseg_hal::lms2xx::{Baud, Event, MeasuringMode, SUB_RANGE, Settings, TelegramDecoder, Unit, Variant};
use scanseg_virtual_rig::VirtualLms;

use crate::lms2xx_bench::{RESTARTS, SETTINGS, ramp};

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
