//! The segments found so far, by their labels.

use scanseg_core::{Label, Segment};

/// No segment has this label.
const NONE: u32 = u32::MAX;

/// Segments, each at hand by its label: an event costs the same however many there are.
#[derive(Default)]
pub(super) struct Found {
    segments: Vec<Segment>,
    /// Where the segment of each label is, or [`NONE`].
    places: Vec<u32>,
    /// Segments looked at, for tests.
    #[cfg(test)]
    looked_at: usize,
}

impl Found {
    /// Adds a segment. It replaces the one with the same label.
    pub fn insert(&mut self, segment: &Segment) {
        let label = segment.label.0 as usize;
        if self.places.len() <= label {
            self.places.resize(label + 1, NONE);
        }
        self.look();
        match self.segments.get_mut(self.places[label] as usize) {
            Some(known) => *known = *segment,
            None => {
                self.places[label] = self.segments.len() as u32;
                self.segments.push(*segment);
            }
        }
    }

    /// Removes the segment of a label, if there is one.
    pub fn remove(&mut self, label: Label) {
        let Some(place) = self.places.get_mut(label.0 as usize) else { return };
        let place = std::mem::replace(place, NONE);
        self.look();
        if place == NONE {
            return;
        }
        self.segments.swap_remove(place as usize);
        if let Some(moved) = self.segments.get(place as usize) {
            self.places[moved.label.0 as usize] = place;
        }
    }

    /// Returns the segments, the one with the most pixels first; where pixels are equal the lower
    /// label first.
    pub fn sorted(&self) -> Vec<Segment> {
        let mut segments = self.segments.clone();
        segments.sort_unstable_by_key(|s| (u32::MAX - s.pixels(), s.label));
        segments
    }

    fn look(&mut self) {
        #[cfg(test)]
        {
            self.looked_at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::segmentation::Segmentation;
    use scanseg_core::EdgeConfig;
    use scanseg_formats::{Depth, Geometry, Kind, RangeImage};

    fn segment() -> Segment {
        let kind = Kind::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 1.0, cy_px: 1.0, depth: Depth::Range };
        let geometry = Geometry::of(kind);
        let scan = RangeImage { rows: 1, columns: 1, range_m: vec![2.0] };
        Segmentation::of(&scan, &geometry, EdgeConfig::paper(), None, || ()).unwrap().segments[0]
    }

    /// Walks over all segments for each event would look at 10^10 of them.
    #[test]
    fn an_event_looks_at_one_segment() {
        const SEGMENTS: u32 = 200_000;
        let (segment, mut found) = (segment(), Found::default());
        for label in 1..=SEGMENTS {
            found.insert(&Segment { label: Label(label), ..segment });
        }
        for label in (1..=SEGMENTS).filter(|label| label % 3 == 0) {
            found.remove(Label(label));
            found.remove(Label(label));
            found.insert(&Segment { label: Label(label - 1), last_row: 7, ..segment });
        }
        assert!(found.looked_at <= 2 * SEGMENTS as usize, "{}", found.looked_at);
        let left = found.sorted();
        assert!(left.iter().map(|s| s.label.0).eq((1..=SEGMENTS).filter(|label| label % 3 != 0)));
        assert!(left.iter().all(|s| (s.last_row == 7) == (s.label.0 % 3 == 2 && s.label.0 < SEGMENTS)));
    }

    #[test]
    fn labels_that_are_not_known_are_none() {
        let mut found = Found::default();
        found.remove(Label(9));
        found.insert(&Segment { label: Label(4), ..segment() });
        found.remove(Label(3));
        found.remove(Label(5));
        assert_eq!(found.sorted().len(), 1);
    }
}
