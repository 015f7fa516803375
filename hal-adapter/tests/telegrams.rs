//! Telegrams that scanners and their drivers really sent, byte for byte.

use scanseg_hal::lms2xx::command::{Answer, Command, Configuration, MODE_ANSWER, POWER_ON};
use scanseg_hal::lms2xx::{
    Baud, Beam, Event, MeasuringMode, Reading, ScanLineError, ScanLineFormat, Severity, TelegramDecoder, TelegramError,
    Unit, Variant,
};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

/// All events of these bytes but `NeedMore`.
fn events(decoder: &mut TelegramDecoder, mut bytes: &[u8]) -> Vec<Event> {
    let mut events = Vec::new();
    loop {
        let fed = decoder.feed(bytes);
        bytes = &bytes[fed.used..];
        match fed.event {
            Event::NeedMore => return events,
            event => events.push(event),
        }
    }
}

/// Feeds up to the first telegram.
fn telegram(decoder: &mut TelegramDecoder, mut bytes: &[u8]) {
    loop {
        let fed = decoder.feed(bytes);
        bytes = &bytes[fed.used..];
        match fed.event {
            Event::Telegram { .. } => return,
            Event::NeedMore => panic!("no telegram"),
            _ => {}
        }
    }
}

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("hex")).collect()
}

#[test]
fn commands() {
    use Variant::{Deg100Step1, Deg100Step05, Deg100Step025, Deg180Step1, Deg180Step05};
    for (command, bytes) in [
        (Command::Start, "02 00 02 00 20 24 34 08"),
        (Command::Stop, "02 00 02 00 20 25 35 08"),
        (Command::StartInterlaced, "02 00 02 00 20 2A 3A 08"),
        (Command::SetBaud(Baud::B500000), "02 00 02 00 20 48 58 08"),
        (Command::SetBaud(Baud::B38400), "02 00 02 00 20 40 50 08"),
        (Command::SetBaud(Baud::B19200), "02 00 02 00 20 41 51 08"),
        (Command::SetBaud(Baud::B9600), "02 00 02 00 20 42 52 08"),
        (Command::Status, "02 00 01 00 31 15 12"),
        (Command::Reset, "02 00 01 00 10 34 12"),
        (Command::Poll, "02 00 02 00 30 01 31 18"),
        (Command::Install, "02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5"),
        (Command::SetVariant(Deg100Step1), "02 00 05 00 3B 64 00 64 00 1D 0F"),
        (Command::SetVariant(Deg100Step05), "02 00 05 00 3B 64 00 32 00 B1 59"),
        (Command::SetVariant(Deg100Step025), "02 00 05 00 3B 64 00 19 00 E7 72"),
        (Command::SetVariant(Deg180Step1), "02 00 05 00 3B B4 00 64 00 97 49"),
        (Command::SetVariant(Deg180Step05), "02 00 05 00 3B B4 00 32 00 3B 1F"),
    ] {
        assert_eq!(command.encode().as_slice(), hex(bytes), "{command:?}");
    }
    let sub_range = Command::StartSubRange { first: 90, last: 270 }.encode();
    assert_eq!(&sub_range.as_slice()[4..10], [0x20, 0x27, 90, 0, 14, 1]);
}

#[test]
fn configuration_commands() {
    let tail = "00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00";
    for (block, check) in [
        ("00 00 00 00 00 0D 00", "20 CB"),
        ("00 00 00 00 00 0D 01", "34 C7"),
        ("00 00 00 00 00 00 01", "FC 7E"),
        ("00 00 00 00 00 00 00", "E8 72"),
        ("00 00 46 00 00 00 00", "C7 25"),
        ("00 00 46 00 00 00 01", "D3 29"),
    ] {
        let block = hex(&format!("{block} {tail}"));
        let configuration = Configuration::new(&block).expect("32 bytes");
        let sent = Command::WriteConfiguration(configuration).encode();
        let mut expected = hex("02 00 21 00 77");
        expected.extend(&block);
        expected.extend(hex(check));
        assert_eq!(sent.as_slice(), expected);
    }
    // The scanner of the first telegram in centimetres, changed to that of the second: only one
    // byte differs.
    let cm = Configuration::new(&hex(&format!("00 00 46 00 00 00 00 {tail}"))).expect("32 bytes");
    let mm = Configuration::new(&hex(&format!("00 00 46 00 00 00 01 {tail}"))).expect("32 bytes");
    assert_eq!(cm.with(MeasuringMode::Range8Fields, Unit::Millimetre), mm);
    assert_eq!(mm.with(MeasuringMode::Range8Fields, Unit::Millimetre), mm);
    assert_eq!(mm.with(MeasuringMode::Range32Field, Unit::Millimetre).as_slice()[5..7], [6, 1]);
    assert_eq!(Configuration::new(&[0; 6]), None);
    assert_eq!(Configuration::new(&[0; 49]), None);
}

#[test]
fn mode_answers() {
    for (bytes, device, restarting) in [
        ("06 02 80 03 00 A0 00 10 16 0A", 2, false),
        ("06 02 80 03 00 A0 00 30 36 0A", 2, true),
        ("06 02 80 03 00 A0 00 18 1E 0A", 3, false),
    ] {
        let mut decoder = TelegramDecoder::new();
        let bytes = hex(bytes);
        let expected = [Event::Ack, Event::Start { bytes_ago: 0 }, Event::Telegram { code: MODE_ANSWER }];
        assert_eq!(events(&mut decoder, &bytes), expected);
        assert!(decoder.telegram().is_none(), "only until the next feed");
        telegram(&mut decoder, &bytes);
        let found = decoder.telegram().expect("telegram");
        assert_eq!(found.data(), [0]);
        assert_eq!(found.status().severity(), Some(Severity::Ok));
        assert_eq!((found.status().device(), found.status().restarting()), (device, restarting));
        assert!(!found.status().implausible() && !found.status().polluted());
        assert!(found.scan_line().is_none());
        assert_eq!(Command::Start.answer(&found), Some(Answer::Done));
        assert_eq!(Command::Type.answer(&found), None);
    }
}

#[test]
fn variant_answers() {
    use Variant::{Deg100Step1, Deg100Step05, Deg100Step025, Deg180Step1, Deg180Step05};
    for (variant, rest) in [
        (Deg100Step1, "64 00 64 00 10 4F BD"),
        (Deg100Step05, "64 00 32 00 10 17 10"),
        (Deg100Step025, "64 00 19 00 10 BB 46"),
        (Deg180Step1, "B4 00 64 00 10 5B 30"),
        (Deg180Step05, "B4 00 32 00 10 03 9D"),
    ] {
        let mut decoder = TelegramDecoder::new();
        telegram(&mut decoder, &hex(&format!("06 02 80 07 00 BB 01 {rest}")));
        let found = decoder.telegram().expect("telegram");
        assert_eq!(Command::SetVariant(variant).answer(&found), Some(Answer::Done));
        let other = if variant == Deg180Step1 { Deg180Step05 } else { Deg180Step1 };
        assert_eq!(Command::SetVariant(other).answer(&found), Some(Answer::Refused(1)), "not the variant asked for");
    }
}

#[test]
fn power_on() {
    let bytes = hex("02 80 17 00 90 4C 4D 53 32 30 30 3B 33 30 31 30 36 33 3B 56 30 32 2E 31 30 20 10 63 5E");
    let mut decoder = TelegramDecoder::new();
    telegram(&mut decoder, &bytes);
    let found = decoder.telegram().expect("telegram");
    assert_eq!(found.code(), POWER_ON);
    assert_eq!(found.data(), b"LMS200;301063;V02.10 ");
}

/// This answer is quoted in a driver with a length that does not fit and a wrong check word: it
/// must not pass.
#[test]
fn damaged_quotation() {
    let bytes = hex("06 02 80 25 00 F7 00 00 00 46 00 00 0D 00 00 00 02 02 00 00 00 00 00 00 00 00 00 00 00 00 00 00 \
                     00 00 00 00 00 00 00 00 02 CB 10 00 00");
    let mut decoder = TelegramDecoder::new();
    let events = events(&mut decoder, &bytes);
    assert!(matches!(events[2], Event::Rejected(TelegramError::CheckWord { .. })));
    assert!(!events.iter().any(|event| matches!(event, Event::Telegram { .. })));
}

fn recorded_scan() -> Option<(Vec<u8>, Vec<u16>)> {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/sick-lms200-telegram/");
    let Ok(bytes) = std::fs::read(format!("{data}lms200_b0_361.bin")) else {
        println!("skipped: no recorded telegram at {data}");
        return None;
    };
    let expected = std::fs::read_to_string(format!("{data}lms200_b0_361.expected_mm.txt")).expect("expected ranges");
    Some((bytes, expected.split_whitespace().map(|mm| mm.parse().expect("number")).collect()))
}

const RECORDED: ScanLineFormat =
    ScanLineFormat { variant: Variant::Deg180Step05, unit: Unit::Millimetre, interlaced: false };

#[test]
#[cfg_attr(miri, ignore = "reads a file")]
fn recorded_scan_decodes_exactly() {
    let Some((bytes, expected)) = recorded_scan() else { return };
    assert_eq!((bytes.len(), expected.len()), (732, 361));
    let mut decoder = TelegramDecoder::new();
    decoder.expect_scan_lines(Some(RECORDED));
    telegram(&mut decoder, &bytes);
    let scan = decoder.telegram().expect("telegram").scan_line().expect("scan");
    assert_eq!((scan.columns(), scan.first_column(), scan.unit()), (361, 0, Unit::Millimetre));
    assert_eq!((scan.partial_quarter(), scan.index_bytes()), (None, &[][..]));
    assert_eq!(scan.status().0, 0x10);
    assert!(scan.words().eq(expected.iter().copied()));
    for mode in [MeasuringMode::Range16Fields, MeasuringMode::Range32Field, MeasuringMode::Range32Immediate] {
        let ranges: Vec<_> = scan.beams(mode).map(|beam| beam.range_mm(scan.unit())).collect();
        assert!(ranges.iter().zip(&expected).all(|(range, &mm)| *range == Some(u32::from(mm))));
    }
    // The mask must fit the measuring mode: 89 ranges here need more than 13 bits.
    let wrong = scan.beams(MeasuringMode::Range8Fields).zip(&expected);
    assert_eq!(wrong.filter(|(beam, mm)| beam.reading != Reading::Range(**mm)).count(), 89);
}

#[test]
#[cfg_attr(miri, ignore = "reads a file")]
fn recorded_scan_against_other_formats() {
    let Some((bytes, _)) = recorded_scan() else { return };
    for (format, error) in [
        (ScanLineFormat { variant: Variant::Deg180Step1, ..RECORDED }, ScanLineError::Count(361)),
        (ScanLineFormat { unit: Unit::Centimetre, ..RECORDED }, ScanLineError::Unit(1)),
        (ScanLineFormat { interlaced: true, ..RECORDED }, ScanLineError::Partial { partial: false, quarter: 0 }),
    ] {
        let mut decoder = TelegramDecoder::new();
        decoder.expect_scan_lines(Some(format));
        let events = events(&mut decoder, &bytes);
        assert_eq!(events[1], Event::Rejected(TelegramError::ScanLine(error)));
        assert!(!events.iter().any(|event| matches!(event, Event::Telegram { .. })));
    }
}

/// Errors that the check word cannot see, all of them: of a scan that passes none but the values
/// can have suffered.
#[test]
#[cfg_attr(miri, ignore = "reads a file")]
fn blind_spots_of_the_check_word() {
    let Some((bytes, expected)) = recorded_scan() else { return };
    let mut passed = 0;
    for byte in 0..bytes.len() - 4 {
        for bit in 0..7 {
            let mut bad = bytes.clone();
            bad[byte] ^= 1 << bit;
            bad[byte + 1] ^= 2 << bit;
            let mut decoder = TelegramDecoder::new();
            decoder.expect_scan_lines(Some(RECORDED));
            if events(&mut decoder, &bad).iter().any(|event| matches!(event, Event::Telegram { .. })) {
                passed += 1;
                telegram(&mut decoder, &bad);
                let Some(scan) = decoder.telegram().expect("telegram").scan_line() else {
                    assert!(byte == 4 || byte == 3, "it is the code that suffered: the telegram is no scan any more");
                    continue;
                };
                assert!(scan.columns() == 361 && scan.unit() == Unit::Millimetre && scan.partial_quarter().is_none());
                let differing = scan.words().zip(&expected).filter(|(word, mm)| word != *mm).count();
                assert!(differing <= 2 && byte >= 6, "byte {byte}: the damage is confined to values");
            }
        }
    }
    assert!(passed > 0, "no decoder can see these");
}

fn scan_of(count_word: u16, values: usize, status: u8) -> Vec<u8> {
    frame(&scan_payload(&[0xB0], count_word, &vec![0; values], &[], status))
}

fn rejection(bytes: &[u8]) -> Option<TelegramError> {
    events(&mut TelegramDecoder::new(), bytes).into_iter().find_map(|event| match event {
        Event::Rejected(error) => Some(error),
        _ => None,
    })
}

/// Answers that say less than they should, or something else.
#[test]
fn poor_answers() {
    let answer = |command: Command, payload: &[u8]| {
        let mut decoder = TelegramDecoder::new();
        telegram(&mut decoder, &frame(payload));
        command.answer(&decoder.telegram().expect("telegram"))
    };
    assert_eq!(answer(Command::Start, &[0xA0, 0x10]), Some(Answer::Refused(0xFF)), "not a word of how it went");
    assert_eq!(answer(Command::Install, &[0xA0, 0x01, 0x10]), Some(Answer::Refused(1)), "wrong password");
    assert_eq!(answer(Command::Type, &[0x92, 0x10]), Some(Answer::Refused(0x92)));
    assert_eq!(answer(Command::Type, &[0xB1, 0x00, 0x10]), None);
    assert_eq!(answer(Command::SetVariant(Variant::Deg180Step1), &[0xBB, 0x01, 0x10]), Some(Answer::Refused(1)));
    assert_eq!(answer(Command::Reset, &[0x91, 0x10]), Some(Answer::Done));
}

/// All with a right check word.
#[test]
fn contradictions_are_rejected() {
    use ScanLineError::{Count, Length, Partial, SubRange, TooShort};
    let scan = |error| Some(TelegramError::ScanLine(error));
    let unit_mm = 1 << 14;
    assert_eq!(rejection(&scan_of(181 | unit_mm, 181, 0x10)), None);
    assert_eq!(rejection(&scan_of(181 | unit_mm, 180, 0x10)), scan(Length { length: 364, count: 181 }));
    // Two index bytes are as long as a value.
    assert_eq!(rejection(&scan_of(181 | unit_mm, 182, 0x10)), None);
    assert_eq!(rejection(&scan_of(181 | unit_mm, 183, 0x10)), scan(Length { length: 370, count: 181 }));
    assert_eq!(rejection(&scan_of(180 | unit_mm, 180, 0x10)), scan(Count(180)), "only partial scans have so many");
    assert_eq!(rejection(&scan_of(180 | 0x3000 | unit_mm, 180, 0x10)), None);
    assert_eq!(rejection(&scan_of(181 | 0x3000 | unit_mm, 181, 0x10)), scan(Count(181)));
    assert_eq!(rejection(&scan_of(361 | 0x2000 | unit_mm, 361, 0x10)), scan(Count(361)));
    assert_eq!(rejection(&scan_of(181 | 0x0800, 181, 0x10)), scan(Partial { partial: false, quarter: 1 }));
    assert_eq!(rejection(&scan_of(181 | 3 << 14, 181, 0x10)), scan(ScanLineError::Unit(3)));
    for status in (0..=u8::MAX).step_by(if cfg!(miri) { 85 } else { 1 }) {
        let expected = (status & 7 > 4).then_some(TelegramError::Status(status));
        assert_eq!(rejection(&scan_of(181, 181, status)), expected);
    }
    assert_eq!(rejection(&frame(&[0xB0, 0x01, 0x10])), scan(TooShort { length: 3 }));
    let sub_range = |first: u8, last: u8, count: u8| {
        let mut payload = vec![0xB7, first, 0, last, 0, count, 0x40];
        payload.resize(7 + 2 * usize::from(count), 0);
        payload.push(0x10);
        rejection(&frame(&payload))
    };
    assert_eq!(sub_range(1, 10, 10), None);
    assert_eq!(sub_range(0, 9, 10), scan(SubRange { first: 0, last: 9 }));
    assert_eq!(sub_range(1, 10, 9), scan(SubRange { first: 1, last: 10 }));
    assert_eq!(sub_range(10, 1, 8), scan(SubRange { first: 10, last: 1 }));
}

#[test]
fn special_values_are_kept_apart() {
    use MeasuringMode::*;
    for (mode, max) in [
        (Range8Fields, 0x1FFF),
        (Range8Reflector, 0x1FFF),
        (Range8FieldsAbc, 0x1FFF),
        (Range16Reflector, 0x3FFF),
        (Range16Fields, 0x3FFF),
        (Range32Reflector, 0x7FFF),
        (Range32Field, 0x7FFF),
        (Range32Immediate, 0xFFFF),
    ] {
        let special = [
            (max, Reading::Invalid),
            (max - 1, Reading::Dazzled),
            (max - 2, Reading::Overflow),
            (max - 3, Reading::Unassigned(max - 3)),
            (max - 4, Reading::WeakSignal),
            (max - 5, Reading::ChannelError),
            (max - 6, Reading::Unassigned(max - 6)),
            (max - 7, Reading::Unassigned(max - 7)),
            (max - 8, Reading::AboveMaximum),
        ];
        for word in (0..=u16::MAX).step_by(if cfg!(miri) { 1021 } else { 1 }) {
            let beam = Beam::new(word, mode);
            let counts = word & max;
            let listed = special.iter().find(|(code, _)| *code == counts).map(|(_, reading)| *reading);
            assert_eq!(beam.reading, listed.unwrap_or(Reading::Range(counts)));
            assert_eq!(u32::from(beam.flags), u32::from(word) / (u32::from(max) + 1));
            let range = listed.is_none().then_some(u32::from(counts));
            assert_eq!(beam.range_mm(Unit::Millimetre), range);
            assert_eq!(beam.range_mm(Unit::Centimetre), range.map(|counts| counts * 10));
            assert_eq!(beam.range_mm(Unit::Decimetre), range.map(|counts| counts * 100));
        }
    }
    // The table in SICK's telegram list, 13 bits.
    for (code, reading) in [
        (8191, Reading::Invalid),
        (8190, Reading::Dazzled),
        (8189, Reading::Overflow),
        (8187, Reading::WeakSignal),
        (8186, Reading::ChannelError),
        (8183, Reading::AboveMaximum),
    ] {
        assert_eq!(Beam::new(code, Range8Fields), Beam { reading, flags: 0 });
        assert_eq!(Beam::new(code | 0xA000, Range8Fields), Beam { reading, flags: 5 });
    }
}

#[test]
fn status_bits() {
    use scanseg_hal::lms2xx::ScannerStatus;
    let severities = [Severity::Ok, Severity::Info, Severity::Warning, Severity::Error, Severity::Fatal];
    for (bits, severity) in (0u8..).zip(severities) {
        assert_eq!(ScannerStatus(bits | 0x10).severity(), Some(severity));
    }
    assert_eq!(ScannerStatus(0x15).severity(), None);
    assert!(ScannerStatus(0xC0).implausible() && ScannerStatus(0xC0).polluted() && !ScannerStatus(0xC0).restarting());
    assert!(!ScannerStatus(0x10).implausible(), "the device bits say nothing of plausibility");
}
