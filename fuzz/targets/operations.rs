//! Lists of what can be done with a segmenter, in memory that is used again and again: after
//! whatever was done before, a scan gives what it gives to a fresh segmenter.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_core::{AnyConfig, AnySegmenter, Finished, PushError, Segmenter, Sizes, Status};
use scanseg_fuzz::case::{APPROACHES, Case, Settings};
use scanseg_tests::stream::{Record, Room, Scan};

#[derive(Clone, Copy, Debug, Arbitrary)]
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
    if !case.is_taken() {
        return;
    }
    let columns = case.scan.columns;
    let configs = [&case.settings, &other].map(|settings| APPROACHES.map(|approach| settings.config(approach)));
    let sizes = configs.as_flattened().iter().map(|config| config.sizes(columns)).reduce(Sizes::max);
    let mut room = Room::of(Sizes { areas: case.areas, ..sizes.expect("some") });
    let (mut config, mut areas) = (case.settings.config(case.approach), case.areas);
    let mut list = list.iter();
    while let Some((approach, with_other, few)) = run(&case.scan, config, areas, &mut room, &mut list) {
        config = configs[usize::from(with_other)][usize::from(approach % 3)];
        areas = 1 + usize::from(few) % case.areas;
    }
});

/// Runs operations up to [`Operation::Again`], and returns what it asks for.
fn run(
    scan: &Scan,
    config: AnyConfig<'_>,
    areas: usize,
    room: &mut Room,
    list: &mut std::slice::Iter<Operation>,
) -> Option<(u8, bool, u8)> {
    let mut memory = room.memory();
    memory.areas = &mut memory.areas[..areas];
    let Ok(segmenter) = AnySegmenter::new(config, scan.beams(), scan.columns, memory) else {
        return list.find_map(Operation::again);
    };
    let mut trial = Trial { scan, config, areas, segmenter, pushed: no_rows(scan), record: Record::default() };
    for operation in list {
        let again = operation.again();
        if again.is_some() {
            return again;
        }
        trial.perform(operation);
    }
    None
}

impl Operation {
    fn again(&self) -> Option<(u8, bool, u8)> {
        match *self {
            Operation::Again { approach, other, areas } => Some((approach, other, areas)),
            _ => None,
        }
    }
}

fn no_rows(scan: &Scan) -> Scan {
    Scan { range_m: vec![], turn_rad: vec![], ..scan.clone() }
}

/// A segmenter, the rows that it has taken of its scan, and what it said.
struct Trial<'a> {
    scan: &'a Scan,
    config: AnyConfig<'a>,
    areas: usize,
    segmenter: AnySegmenter<'a>,
    pushed: Scan,
    record: Record,
}

impl Trial<'_> {
    fn perform(&mut self, operation: &Operation) {
        let columns = self.scan.columns;
        match *operation {
            Operation::Push(row) if !self.scan.turn_rad.is_empty() => {
                self.push_row_of_scan(usize::from(row) % self.scan.turn_rad.len());
            }
            Operation::Push(_) => self.push(&vec![2.0; columns], 0.0),
            Operation::PushAll => (0..self.scan.turn_rad.len()).for_each(|row| self.push_row_of_scan(row)),
            Operation::Length(length) => self.push(&vec![2.0; length.into()], 0.0),
            Operation::Turn(turn_rad) => self.push(&vec![2.0; columns], turn_rad),
            Operation::Finish | Operation::FinishToo => self.finish(),
            Operation::Reset => {
                self.segmenter.reset();
                self.begin();
            }
            Operation::Break(after) => self.record.break_at = Some(self.record.events.len() + usize::from(after % 64)),
            Operation::Again { .. } => {}
        }
    }

    /// The next row is the first of a new scan.
    fn begin(&mut self) {
        (self.pushed, self.record) = (no_rows(self.scan), Record::default());
    }

    fn push_row_of_scan(&mut self, row: usize) {
        self.push(self.scan.row_m(row), self.scan.turn_rad[row]);
    }

    fn push(&mut self, ranges_m: &[f32], turn_rad: f32) {
        let (before, columns) = (self.record.events.len(), self.scan.columns);
        match self.segmenter.push_row(ranges_m, turn_rad, &mut self.record) {
            Ok(status) => {
                assert_eq!(ranges_m.len(), columns);
                self.pushed.range_m.extend(ranges_m);
                self.pushed.turn_rad.push(turn_rad);
                self.record.statuses.push(status);
                if status == Status::Stopped {
                    self.check_broken_off();
                    self.begin();
                }
            }
            Err(error) => {
                assert_eq!(self.record.events.len(), before, "a row that is not taken changes nothing");
                match error {
                    PushError::RowLength { expected, got } => {
                        assert!((expected, got) == (columns, ranges_m.len()) && expected != got);
                    }
                    PushError::TurnAngle { .. } => assert!(!(-6300.0..=6300.0).contains(&turn_rad)),
                    _ => panic!("{error}"),
                }
            }
        }
    }

    fn finish(&mut self) {
        let finished = self.segmenter.finish(&mut self.record);
        if finished == Finished::Stopped {
            self.check_broken_off();
        } else {
            (self.record.finished, self.record.break_at) = (Some(finished), None);
            assert_eq!(self.record, self.fresh());
        }
        self.begin();
    }

    /// What a fresh segmenter says of the rows.
    fn fresh(&self) -> Record {
        self.pushed.record(self.config, self.areas)
    }

    /// Up to where the sink broke off, all is as in the whole scan.
    fn check_broken_off(&self) {
        let count = self.record.events.len();
        assert_eq!(self.record.break_at, Some(count - 1));
        assert_eq!(self.record.events, self.fresh().events[..count]);
    }
}
