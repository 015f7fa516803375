//! A segmenter that keeps the rows which it is given, for what is to be done with whole scans.

use std::cell::RefCell;
use std::rc::Rc;

use scanseg_core::{Finished, PushError, RowBeams, Segmenter, Sink, Status};
use scanseg_formats::RangeImage;

/// A scan as it was pushed; of what lies beside the turn of a row nothing is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedScan {
    /// Ranges in metres, row by row; 0 without a return.
    pub range_m: Vec<f32>,
    /// Turn angle of each row, radians.
    pub turns_rad: Vec<f32>,
}

impl RecordedScan {
    /// Returns the scan as an image.
    pub fn image(self) -> RangeImage {
        let rows = self.turns_rad.len();
        RangeImage { rows, columns: self.range_m.len() / rows.max(1), range_m: self.range_m }
    }
}

/// Gives everything to another segmenter, and keeps the rows of each scan that is finished.
pub struct Recorder<S> {
    segmenter: S,
    scan: RecordedScan,
    scans: Rc<RefCell<Vec<RecordedScan>>>,
}

impl<S> Recorder<S> {
    /// Returns a recorder whose scans go to `scans`.
    pub fn new(segmenter: S, scans: &Rc<RefCell<Vec<RecordedScan>>>) -> Recorder<S> {
        Recorder { segmenter, scan: RecordedScan::default(), scans: Rc::clone(scans) }
    }
}

impl<S: Segmenter> Segmenter for Recorder<S> {
    fn push_row<'r, T: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut T,
    ) -> Result<Status, PushError> {
        let beams = beams.into();
        let status = self.segmenter.push_row(ranges_m, beams, sink)?;
        if status == Status::Stopped {
            self.scan = RecordedScan::default();
        } else {
            let is_return = |range_m: f32| range_m > 0.0 && range_m.is_finite();
            self.scan.range_m.extend(ranges_m.iter().map(|&range_m| if is_return(range_m) { range_m } else { 0.0 }));
            self.scan.turns_rad.push(beams.turn_rad);
        }
        Ok(status)
    }

    fn finish<T: Sink + ?Sized>(&mut self, sink: &mut T) -> Finished {
        let scan = std::mem::take(&mut self.scan);
        if !scan.turns_rad.is_empty() {
            self.scans.borrow_mut().push(scan);
        }
        self.segmenter.finish(sink)
    }

    fn reset(&mut self) {
        self.scan = RecordedScan::default();
        self.segmenter.reset();
    }

    fn latency_rows(&self) -> usize {
        self.segmenter.latency_rows()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segmentation::OwnedMemory;
    use scanseg_core::{Beams, EdgeConfig, EdgeSegmenter, LabelRow};
    use std::ops::ControlFlow;

    /// Breaks off at the rows of a scan after so many.
    struct Rows(usize);

    impl Sink for Rows {
        fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
            if row.row() < self.0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        }
    }

    #[test]
    fn finished_scans_are_kept_row_by_row() {
        let config = EdgeConfig::paper();
        let mut memory = OwnedMemory::new(config, 3, None);
        let beams = Beams::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 1.0, cy_px: 1.0 };
        let segmenter = EdgeSegmenter::new(config, beams, 3, memory.memory()).unwrap();
        let scans = Rc::default();
        let mut recorder = Recorder::new(segmenter, &scans);
        let mut sink = Rows(100);
        let row = [1.0, f32::NAN, -2.0];
        recorder.push_row(&row, 0.5, &mut sink).unwrap();
        assert!(recorder.push_row(&[1.0], 0.5, &mut sink).is_err());
        recorder.push_row(&[0.0, 3.0, f32::INFINITY], 0.6, &mut sink).unwrap();
        recorder.finish(&mut sink);
        recorder.finish(&mut sink);
        // dropped, broken off
        recorder.push_row(&row, 0.7, &mut sink).unwrap();
        recorder.reset();
        while recorder.push_row(&row, 0.8, &mut Rows(0)).unwrap() != Status::Stopped {}
        recorder.push_row(&row, 0.9, &mut sink).unwrap();
        recorder.finish(&mut sink);
        let scan =
            |range_m: &[f32], turns_rad: &[f32]| RecordedScan { range_m: range_m.into(), turns_rad: turns_rad.into() };
        let expected = [scan(&[1.0, 0.0, 0.0, 0.0, 3.0, 0.0], &[0.5, 0.6]), scan(&[1.0, 0.0, 0.0], &[0.9])];
        assert_eq!(*scans.borrow(), expected);
        let image = expected[0].clone().image();
        assert_eq!((image.rows, image.columns, image.range_m.len()), (2, 3, 6));
        assert_eq!(recorder.latency_rows(), recorder.segmenter.latency_rows());
    }
}
