//! A scan that is being segmented, row by row.

use scanseg_core::{AnyConfig, AnySegmenter, Segment, Segmenter};
use scanseg_formats::Scan;
use scanseg_sim::segmentation::{Collected, OwnedMemory, ScanBeams, SegmentationError, check_size};
use self_cell::{MutBorrow, self_cell};

/// What a segmenter works in.
struct Place {
    memory: MutBorrow<OwnedMemory>,
    beams: ScanBeams,
}

#[allow(unsafe_code)]
mod cell {
    use super::{AnySegmenter, Place, self_cell};

    self_cell!(
        /// A segmenter with the place in which it works: a page calls it row by row, so that both
        /// must outlive a call.
        pub(super) struct Placed {
            owner: Place,
            #[not_covariant]
            dependent: AnySegmenter,
        }
    );
}

/// A scan that is being segmented.
pub struct Live {
    placed: cell::Placed,
    collected: Collected,
    rows: usize,
    /// Rows pushed.
    pub row: usize,
}

impl Live {
    /// Begins a scan.
    pub fn new(scan: &Scan, config: AnyConfig<'static>) -> Result<Live, SegmentationError> {
        check_size(&scan.image)?;
        let (rows, columns) = (scan.image.rows, scan.image.columns);
        let place = Place {
            beams: ScanBeams::new(&scan.geometry, rows, columns)?,
            memory: MutBorrow::new(OwnedMemory::new(config, columns, None)),
        };
        let placed = cell::Placed::try_new(place, |place| {
            AnySegmenter::new(config, place.beams.beams(), columns, place.memory.borrow_mut().memory())
        })?;
        Ok(Live { placed, collected: Collected::new(rows, columns), rows, row: 0 })
    }

    /// Pushes up to `count` rows of the scan that it began with. The last one ends it.
    pub fn push(&mut self, scan: &Scan, count: usize) -> Result<(), SegmentationError> {
        let columns = scan.image.columns;
        for _ in 0..count.min(self.rows - self.row) {
            let (row, collected) = (self.row, &mut self.collected);
            let ranges_m = &scan.image.range_m[row * columns..(row + 1) * columns];
            self.placed.with_dependent_mut(|place, segmenter| {
                segmenter.push_row(ranges_m, place.beams.row(row), collected).map(|_| ())
            })?;
            self.row += 1;
            if self.is_complete() {
                let collected = &mut self.collected;
                self.placed.with_dependent_mut(|_, segmenter| segmenter.finish(collected));
            }
        }
        Ok(())
    }

    /// Returns whether all rows have been pushed.
    pub fn is_complete(&self) -> bool {
        self.row == self.rows
    }

    /// Returns the noise that counts at a range now, metres; none by edges and by regions.
    pub fn noise_m(&self, range_m: f32) -> Option<f32> {
        self.placed.with_dependent(|_, segmenter| match segmenter {
            AnySegmenter::Plane(planes) => Some(planes.range_noise_m(range_m)),
            AnySegmenter::Edge(_) | AnySegmenter::Region(_) => None,
        })
    }

    /// Returns the label of each pixel so far; 0 for none.
    pub fn labels(&self) -> Vec<u32> {
        self.collected.labels()
    }

    /// Returns the segments that are complete, the largest first.
    pub fn segments(&self) -> Vec<Segment> {
        self.collected.segments()
    }
}
