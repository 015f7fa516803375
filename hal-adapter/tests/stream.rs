//! Streams of telegrams with junk between them, in pieces of any size.

use proptest::prelude::*;
use scanseg_hal::lms2xx::{Event, ScanLineFormat, TelegramDecoder, Unit, Variant};
use scanseg_virtual_rig::telegrams::{Seen, decode, frame, scan_payload, telegrams, telegrams_by_themselves};

fn any_variant() -> impl Strategy<Value = Variant> {
    use Variant::{Deg100Step1, Deg100Step05, Deg100Step025, Deg180Step1, Deg180Step05};
    prop::sample::select(vec![Deg100Step1, Deg100Step05, Deg100Step025, Deg180Step1, Deg180Step05])
}

fn status() -> impl Strategy<Value = u8> {
    (0u8..=4, 0u8..32).prop_map(|(severity, rest)| severity | rest << 3)
}

/// Values that often look like the beginning of a telegram.
fn values(count: usize) -> impl Strategy<Value = Vec<u16>> {
    prop::collection::vec(
        prop_oneof![4 => any::<u16>(), 1 => Just(0x8002), 1 => Just(0x0015), 1 => Just(0xB000)],
        count,
    )
}

/// Valid telegrams of every kind.
fn telegram() -> impl Strategy<Value = Vec<u8>> {
    let scan = (any_variant(), 0u16..3, any::<prop::sample::Index>(), any::<bool>(), status()).prop_flat_map(
        |(variant, unit, quarter, partial, status)| {
            let quarters: Vec<u8> = (0..4).filter(|&quarter| variant.partial_columns(quarter).is_some()).collect();
            let quarter = *quarter.get(&quarters);
            let count = if partial { variant.partial_columns(quarter).expect("one") } else { variant.columns() };
            let bits = if partial { 0x2000 | u16::from(quarter) << 11 } else { 0 };
            let room = if count == 401 { 0 } else { 2 };
            (values(count.into()), prop::collection::vec(any::<u8>(), 0..=room)).prop_map(
                move |(values, index_bytes)| {
                    frame(&scan_payload(&[0xB0], count | bits | unit << 14, &values, &index_bytes, status))
                },
            )
        },
    );
    let sub_range = (1u16..=361, 0u16..40, status()).prop_flat_map(|(first, more, status)| {
        let last = (first + more).min(361);
        let mut head = vec![0xB7];
        head.extend(first.to_le_bytes());
        head.extend(last.to_le_bytes());
        let count = last - first + 1;
        values(count.into()).prop_map(move |values| frame(&scan_payload(&head, count | 1 << 14, &values, &[], status)))
    });
    let other =
        (0x80u8..=0xFF, prop::collection::vec(any::<u8>(), 0..160), status()).prop_map(|(code, data, status)| {
            let code = if matches!(code, 0xB0 | 0xB6 | 0xB7) { 0xA0 } else { code };
            frame(&[&[code][..], &data, &[status]].concat())
        });
    prop_oneof![3 => scan, 1 => sub_range, 2 => other]
}

/// Bytes between telegrams: anything, and often what looks like a telegram.
fn junk() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        2 => Just(vec![]),
        2 => prop::collection::vec(any::<u8>(), 0..40),
        2 => prop::collection::vec(prop::sample::select(vec![0x02u8, 0x80, 0x06, 0x15, 0xB0, 0x03]), 0..40),
        // A header that claims more than follows, so that it swallows what comes after it.
        2 => (2u16..=806, 0x80u8..).prop_map(|(length, code)| {
            let [low, high] = length.to_le_bytes();
            vec![0x02, 0x80, low, high, code]
        }),
        // A telegram cut off.
        1 => (telegram(), any::<prop::sample::Index>()).prop_map(|(mut telegram, end)| {
            telegram.truncate(end.index(telegram.len()));
            telegram
        }),
        // A telegram with one bit flipped.
        1 => (telegram(), any::<prop::sample::Index>(), 0..8).prop_map(|(mut telegram, at, bit)| {
            let at = at.index(telegram.len());
            telegram[at] ^= 1u8 << bit;
            telegram
        }),
    ]
}

/// `Start` tells its distance from the last byte used: where it is in the stream must not depend on
/// the pieces.
fn stream() -> impl Strategy<Value = (Vec<Vec<u8>>, Vec<u8>)> {
    prop::collection::vec((junk(), telegram()), 1..5).prop_map(|parts| {
        let bytes = parts.iter().flat_map(|(junk, telegram)| junk.iter().chain(telegram)).copied().collect();
        (parts.into_iter().map(|(_, telegram)| telegram).collect(), bytes)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    #[cfg_attr(miri, ignore = "slow")]
    fn pieces_do_not_matter((_, bytes) in stream(), pieces in prop::collection::vec(1usize..900, 1..6)) {
        let whole = decode(&bytes, &[bytes.len()], None);
        prop_assert_eq!(&decode(&bytes, &pieces, None), &whole);
        prop_assert_eq!(&decode(&bytes, &[1], None), &whole);
        prop_assert_eq!(telegrams(&whole), telegrams_by_themselves(&bytes, None));
    }

    /// Junk can hide a telegram only by being, with the telegram's first bytes, a good telegram
    /// itself.
    #[test]
    #[cfg_attr(miri, ignore = "slow")]
    fn no_good_telegram_is_lost((sent, bytes) in stream(), pieces in prop::collection::vec(1usize..900, 1..6)) {
        let found = telegrams(&decode(&bytes, &pieces, None));
        let mut after = found.iter();
        for telegram in &sent {
            prop_assert!(after.any(|(_, found)| found == telegram), "lost one of {} bytes", telegram.len());
        }
    }

    #[test]
    fn anything_at_all(bytes in prop::collection::vec(any::<u8>(), 0..if cfg!(miri) { 100 } else { 3000 })) {
        let _ = decode(&bytes, &[7, 64, 1], None);
    }

    #[test]
    #[cfg_attr(miri, ignore = "slow")]
    fn scans_read_back(variant in any_variant(), unit in 0u16..3, words in values(401), status in status()) {
        let words = &words[..variant.columns().into()];
        let bytes = frame(&scan_payload(&[0xB0], variant.columns() | unit << 14, words, &[], status));
        let unit = [Unit::Centimetre, Unit::Millimetre, Unit::Decimetre][usize::from(unit)];
        let mut decoder = TelegramDecoder::new();
        decoder.expect_scan_lines(Some(ScanLineFormat { variant, unit, interlaced: false }));
        let first = decoder.feed(&bytes);
        prop_assert_eq!((first.used, first.event), (1, Event::Start { bytes_ago: 0 }));
        let second = decoder.feed(&bytes[1..]);
        prop_assert_eq!((second.used, second.event), (bytes.len() - 1, Event::Telegram { code: 0xB0 }));
        let scan = decoder.telegram().expect("telegram").scan_line().expect("scan");
        prop_assert_eq!((scan.unit(), scan.status().0), (unit, status));
        prop_assert_eq!(scan.words().collect::<Vec<_>>(), words);
    }
}

/// One telegram of every kind after one kind of junk each, in one piece, byte by byte, and in
/// pieces of two sizes.
#[test]
fn every_kind_among_junk() {
    let values = |count| (0..count).map(|i| [0x8002, 0x0015, 0xB000, 1234][i % 4]).collect::<Vec<u16>>();
    let scan = frame(&scan_payload(&[0xB0], 101 | 1 << 14, &values(101), &[7, 8], 0x10));
    let partial = frame(&scan_payload(&[0xB0], 100 | 0x3000, &values(100), &[], 0x31));
    let sub_range = frame(&scan_payload(&[0xB7, 5, 0, 24, 0], 20 | 1 << 14, &values(20), &[], 0x10));
    let answer = frame(&[0xA0, 0x00, 0x10]);
    let mut flipped = sub_range.clone();
    flipped[20] ^= 1;
    let claims_more = [0x02, 0x80, 0xFF, 0x02, 0xB0];
    let (mut bytes, mut sent) = (vec![], vec![]);
    for (junk, telegram) in
        [(&[0x06, 0x02, 0x80][..], scan.clone()), (&scan[..50], sub_range), (&flipped, answer), (&claims_more, partial)]
    {
        bytes.extend(junk);
        sent.push((bytes.len(), telegram.clone()));
        bytes.extend(telegram);
    }
    let whole = decode(&bytes, &[bytes.len()], None);
    assert_eq!(telegrams(&whole), sent);
    assert_eq!(decode(&bytes, &[1], None), whole);
    assert_eq!(decode(&bytes, &[300, 7], None), whole);
}

/// Two whole telegrams within the claimed length of a false one both come out, and the starts are
/// told with their distance.
#[test]
fn telegrams_inside_a_false_one() {
    let inner = [frame(&[0xA0, 0x00, 0x10]), frame(&[0xBB, 0x01, 0x10])].concat();
    let mut bytes = vec![0x02, 0x80, inner.len() as u8 + 1, 0x00, 0xA5];
    bytes.extend(&inner);
    bytes.extend([0, 0]);
    let seen = decode(&bytes, &[bytes.len()], None);
    let events: Vec<_> = seen
        .iter()
        .map(|seen| match seen {
            Seen::Event(Event::Start { bytes_ago }) => format!("start {bytes_ago} ago"),
            Seen::Event(Event::Rejected(_)) => "rejected".into(),
            Seen::Event(event) => format!("{event:?}"),
            Seen::Telegram { bytes, .. } => format!("{:02X}", bytes[4]),
        })
        .collect();
    assert_eq!(events, ["start 0 ago", "rejected", "start 19 ago", "A0", "start 10 ago", "BB"]);
}
