//! Lists of what can be done with a segmenter, in memory that is used again and again: after whatever was done before, a
//! scan gives what it gives to a fresh segmenter.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_core::{Finished, PushError, Status};
use scanseg_fuzz::case::{Case, Settings};
use scanseg_tests::stream::{Approach, Record, Room, Scan};

#[derive(Arbitrary, Clone, Copy, Debug)]
enum Operation {
    /// A row of the scan.
    Push(u8),
    /// All of them.
    PushAll,
    /// A row of so many ranges.
    Length(u8),
    /// A row at this angle, if it is one.
    Turn(f32),
    Finish,
    /// The same: without it most lists would not end a scan.
    FinishToo,
    Reset,
    /// The sink breaks off at the event after so many.
    Break(u8),
    /// Another segmenter in the same memory.
    Again {
        approach: u8,
        other: bool,
        areas: u8,
    },
}

#[derive(Debug)]
struct Operations {
    case: Case,
    other: Settings,
    list: Vec<Operation>,
}

impl Arbitrary<'_> for Operations {
    fn arbitrary(u: &mut Unstructured) -> Result<Operations> {
        let list = u.arbitrary_iter()?.take(40).collect::<Result<_>>()?;
        Ok(Operations { other: Settings::arbitrary(u)?, case: Case::arbitrary(u)?, list })
    }
}

fuzz_target!(|operations: Operations| {
    let Operations { case, other, list } = operations;
    if case.is_taken() {
        let mut room = Room::new(case.scan.columns, &case.settings.config(), case.areas);
        let more = Room::new(case.scan.columns, &other.config(), case.areas);
        room.ranges.resize(room.ranges.len().max(more.ranges.len()), 0.0);
        room.bearings.resize(room.bearings.len().max(more.bearings.len()), 0);
        let (mut approach, mut settings, mut areas) = (case.approach, &case.settings, case.areas);
        let mut list = list.iter();
        while let Some((next, with_other, few)) = run(&case.scan, approach, settings, areas, &mut room, &mut list) {
            approach = [Approach::Plane, Approach::Edge, Approach::Region][usize::from(next % 3)];
            settings = if with_other { &other } else { &case.settings };
            areas = 1 + usize::from(few) % case.areas;
        }
    }
});

/// Runs operations up to [`Operation::Again`].
fn run(
    scan: &Scan,
    approach: Approach,
    settings: &Settings,
    areas: usize,
    room: &mut Room,
    list: &mut std::slice::Iter<Operation>,
) -> Option<(u8, bool, u8)> {
    let (columns, config) = (scan.columns, settings.config());
    let mut memory = room.memory();
    memory.areas = &mut memory.areas[..areas];
    let mut segmenter = match approach.segmenter(config, scan.beams(), columns, memory) {
        Ok(segmenter) => segmenter,
        Err(_) => {
            return list.find_map(|operation| match *operation {
                Operation::Again { approach, other, areas } => Some((approach, other, areas)),
                _ => None,
            });
        }
    };
    let empty = || (Scan { range_m: vec![], turn_rad: vec![], ..scan.clone() }, Record::default());
    let (mut pushed, mut record) = empty();
    for operation in list {
        let mut push = |ranges_m: &[f32], turn_rad: f32| {
            let before = record.events.len();
            match segmenter.push(ranges_m, turn_rad, &mut record) {
                Ok(status) => {
                    assert_eq!(ranges_m.len(), columns);
                    pushed.range_m.extend(ranges_m);
                    pushed.turn_rad.push(turn_rad);
                    record.statuses.push(status);
                    if status == Status::Stopped {
                        assert_eq!(record.break_at, Some(record.events.len() - 1));
                        let whole = pushed.record_by(approach, &config, areas);
                        assert_eq!(record.events, whole.events[..record.events.len()]);
                        (pushed, record) = empty();
                    }
                }
                Err(error) => {
                    assert_eq!(record.events.len(), before, "a row that is not taken changes nothing");
                    match error {
                        PushError::RowLength { expected, got } => {
                            assert!((expected, got) == (columns, ranges_m.len()) && expected != got);
                        }
                        PushError::TurnAngle { .. } => assert!(!(-6300.0..=6300.0).contains(&turn_rad)),
                        _ => panic!("{error}"),
                    }
                }
            }
        };
        match *operation {
            Operation::Push(row) if !scan.turn_rad.is_empty() => {
                let row = usize::from(row) % scan.turn_rad.len();
                push(scan.row_m(row), scan.turn_rad[row]);
            }
            Operation::Push(_) => push(&vec![2.0; columns], 0.0),
            Operation::PushAll => (0..scan.turn_rad.len()).for_each(|row| push(scan.row_m(row), scan.turn_rad[row])),
            Operation::Length(length) => push(&vec![2.0; length.into()], 0.0),
            Operation::Turn(turn_rad) => push(&vec![2.0; columns], turn_rad),
            Operation::Finish | Operation::FinishToo => {
                let finished = segmenter.end(&mut record);
                let whole = pushed.record_by(approach, &config, areas);
                if finished == Finished::Stopped {
                    assert_eq!(record.break_at, Some(record.events.len() - 1));
                    assert_eq!(record.events, whole.events[..record.events.len()]);
                } else {
                    (record.finished, record.break_at) = (Some(finished), None);
                    assert_eq!(record, whole);
                }
                (pushed, record) = empty();
            }
            Operation::Reset => {
                segmenter.clear();
                (pushed, record) = empty();
            }
            Operation::Break(after) => record.break_at = Some(record.events.len() + usize::from(after % 64)),
            Operation::Again { approach, other, areas } => return Some((approach, other, areas)),
        }
    }
    None
}
