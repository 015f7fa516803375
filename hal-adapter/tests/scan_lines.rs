//! Partial scan lines, sub-ranges and means: which columns of a row their values are.

use scanseg_hal::lms2xx::{
    Baud, Event, MEANS, MeasuringMode, SCAN_LINE, SUB_RANGE, Session, SessionEvent, Settings, TelegramDecoder, Unit,
    Variant,
};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

/// The row of a telegram whose values are 1, 2, 3 and so on, and what the scan line says of itself.
fn row(head: &[u8], count_word: u16, variant: Variant) -> (Vec<usize>, u8, bool) {
    let values: Vec<u16> = (1..=count_word & 0x3FF).collect();
    let bytes = frame(&scan_payload(head, count_word | 1 << 14, &values, &[], 0x10));
    let mut decoder = TelegramDecoder::new();
    let begun = decoder.feed(&bytes);
    let done = decoder.feed(&bytes[begun.used..]);
    assert_eq!(done.event, Event::Telegram { code: head[0] });
    let line = decoder.telegram().and_then(|telegram| telegram.scan_line()).expect("a scan line");
    let mut row_m = vec![9.0; variant.columns().into()];
    line.row_m(MeasuringMode::Range8Fields, variant, &mut row_m);
    let counts = row_m.iter().map(|range_m| (range_m * 1000.0).round() as usize).collect();
    (counts, line.scans(), line.fits(variant))
}

#[test]
fn values_are_in_their_own_columns() {
    let partial = |quarter: u16| 0x2000 | quarter << 11;
    for (variant, head, count_word, first, step) in [
        (Variant::Deg180Step1, vec![SCAN_LINE], 181, 0, 1),
        (Variant::Deg180Step1, vec![SCAN_LINE], 181 | partial(0), 0, 1),
        (Variant::Deg180Step05, vec![SCAN_LINE], 181 | partial(0), 0, 2),
        (Variant::Deg180Step05, vec![SCAN_LINE], 180 | partial(2), 1, 2),
        (Variant::Deg100Step025, vec![SCAN_LINE], 101 | partial(0), 0, 4),
        (Variant::Deg100Step025, vec![SCAN_LINE], 100 | partial(1), 1, 4),
        (Variant::Deg100Step025, vec![SCAN_LINE], 100 | partial(2), 2, 4),
        (Variant::Deg100Step025, vec![SCAN_LINE], 100 | partial(3), 3, 4),
        (Variant::Deg180Step05, vec![SUB_RANGE, 46, 0, 60, 1], 271, 45, 1),
        (Variant::Deg180Step05, vec![MEANS, 4], 361, 0, 1),
    ]
    .into_iter()
    .step_by(if cfg!(miri) { 4 } else { 1 })
    {
        let (counts, scans, fits) = row(&head, count_word, variant);
        let values = usize::from(count_word & 0x3FF);
        let expected: Vec<usize> = (0..counts.len())
            .map(|column| match (column >= first).then(|| (column - first) / step) {
                Some(value) if value < values && first + value * step == column => value + 1,
                _ => 0,
            })
            .collect();
        assert_eq!(counts, expected, "{head:?} {count_word:#06x}");
        assert_eq!((scans, fits), (if head[0] == MEANS { 4 } else { 1 }, true));
    }
    // of another variant
    assert!(!row(&[SCAN_LINE], 181, Variant::Deg180Step05).2);
    assert!(!row(&[SCAN_LINE], 180 | partial(2), Variant::Deg180Step1).2);
    assert!(!row(&[SUB_RANGE, 46, 0, 60, 1], 271, Variant::Deg180Step1).2);
}

/// A session that listens takes them as scan lines.
#[test]
fn a_session_takes_them() {
    let (variant, unit, mode) = (Variant::Deg180Step05, Unit::Millimetre, MeasuringMode::Range8Fields);
    let settings = Settings { baud: Baud::B38400, variant, unit, mode, interlaced: false };
    for (head, count) in [(vec![SCAN_LINE], 361), (vec![SUB_RANGE, 46, 0, 60, 1], 271), (vec![MEANS, 4], 361)] {
        let mut session = Session::listening(settings);
        let bytes = frame(&scan_payload(&head, count | 1 << 14, &vec![1000; count.into()], &[], 0x10));
        let (start, _) = session.feed(0, &bytes);
        assert_eq!(session.feed(0, &bytes[start..]), (bytes.len() - start, SessionEvent::ScanLine), "{head:?}");
        assert_eq!(session.scan_line().map(|line| line.columns()), Some(count));
    }
}
