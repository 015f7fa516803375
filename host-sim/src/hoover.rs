//! How well a segmentation matches the ground truth: the five classes of Hoover et al. 1996, "An
//! experimental comparison of range image segmentation algorithms" (IEEE PAMI 18(7)).
//!
//! A truth region N has P_n pixels, a segment M has P_m, and they share O. With a tolerance 0.5 < T
//! <= 1:
//!
//! - correct detection: O >= T P_m and O >= T P_n;
//! - over-segmentation of N: the segments with O >= T P_m number two or more, and together cover T
//!   P_n;
//! - under-segmentation by M: the truth regions with O >= T P_n number two or more, and together
//!   cover T P_m;
//! - missed: truth regions in no instance of these three;
//! - noise: segments in no instance of these three.
//!
//! A region may stand in one instance only. Instances are taken in the order of falling average of
//! their two ratios (see [`Instance::average`]); one that needs a region already taken is dropped
//! whole. Averages that agree to 1e-9 are ties: correct detection goes before over-segmentation
//! before under-segmentation, then the lower truth id, then the lower segment id.
//!
//! `>=` holds at exact equality even where T P is not exact in binary: the comparison allows 1e-9
//! P.

use std::{
    collections::{BTreeMap, BTreeSet},
    error, fmt,
};

/// What an [`Instance`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// One segment is one truth region.
    Correct,
    /// One truth region is several segments.
    OverSegmented,
    /// Several truth regions are one segment.
    UnderSegmented,
}

/// A match that stands between truth regions and segments.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Its class.
    pub class: Class,
    /// Ids of its truth regions, rising: several for under-segmentation, otherwise one.
    pub truth: Vec<u16>,
    /// Ids of its segments, rising: several for over-segmentation, otherwise one.
    pub segments: Vec<u16>,
    /// (mean of the single ratios + ratio of the sum) / 2, in (0.5, 1]. Correct: (O / P_m + O /
    /// P_n) / 2. Over-segmentation: (mean of O / P_m + sum of O / P_n) / 2. Under-segmentation: the
    /// same with m and n exchanged.
    pub average: f64,
}

/// The classes at one tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Hoover {
    /// The tolerance T.
    pub tolerance: f64,
    /// Truth regions considered: those with at least the chosen number of pixels.
    pub truth_regions: usize,
    /// Segments considered: those with at least the chosen number of pixels.
    pub segments: usize,
    /// Correct detections: as many truth regions as segments.
    pub correct: usize,
    /// Instances of over-segmentation, which is the number of truth regions over-segmented.
    pub over_segmented: usize,
    /// Instances of under-segmentation, which is the number of segments that under-segment. The
    /// truth regions that they swallow are twice as many or more.
    pub under_segmented: usize,
    /// Truth regions in no instance.
    pub missed: usize,
    /// Segments in no instance.
    pub noise: usize,
    /// The instances that stand, best average first.
    pub instances: Vec<Instance>,
}

/// Why a segmentation cannot be evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HooverError {
    /// The two images differ in size.
    Size {
        /// Pixels of the truth.
        truth: usize,
        /// Pixels of the segmentation.
        labels: usize,
    },
    /// The tolerance does not lie in (0.5, 1].
    Tolerance(f64),
}

impl fmt::Display for HooverError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HooverError::Size { truth, labels } => {
                write!(f, "ground truth has {truth} pixels, segmentation has {labels}")
            }
            HooverError::Tolerance(t) => write!(f, "tolerance {t} is not in (0.5, 1]"),
        }
    }
}

impl error::Error for HooverError {}

/// Truth ids paired with segment ids and the pixels they share: all that the classes need, at any
/// tolerance.
#[derive(Clone, Debug)]
pub struct Overlaps {
    /// Pixels of each truth region considered.
    truth: BTreeMap<u16, u32>,
    /// Pixels of each segment considered.
    segments: BTreeMap<u16, u32>,
    /// (truth id, segment id, shared pixels), rising by ids; both are considered, and the pixels are
    /// more than half of one of them. So there are no more than there are regions on both sides.
    shared: Vec<(u16, u16, u32)>,
}

/// Regions that are in no instance yet.
struct Left {
    ids: BTreeSet<u16>,
    /// Ids looked up, for tests.
    #[cfg(test)]
    looked_up: usize,
}

impl Left {
    fn of(areas: &BTreeMap<u16, u32>) -> Left {
        Left {
            ids: areas.keys().copied().collect(),
            #[cfg(test)]
            looked_up: 0,
        }
    }

    fn has_all(&mut self, ids: &[u16]) -> bool {
        self.look_up(ids.len());
        ids.iter().all(|id| self.ids.contains(id))
    }

    fn take(&mut self, ids: &[u16]) {
        self.look_up(ids.len());
        ids.iter().for_each(|id| _ = self.ids.remove(id));
    }

    fn look_up(&mut self, _ids: usize) {
        #[cfg(test)]
        {
            self.looked_up += _ids;
        }
    }
}

impl Overlaps {
    /// Counts the pixels of two label images of one shape, row by row.
    ///
    /// 0 is no region in either image, yet its pixels count in the area of the region on the other
    /// side. Truth regions and segments of fewer than `min_pixels` pixels are treated like 0; 0 and
    /// 1 keep all of them. A region is its id: its pixels need not touch. Images that differ in
    /// length are an error, empty images are not. Costs n log n for n pixels.
    pub fn new(truth: &[u16], labels: &[u16], min_pixels: usize) -> Result<Self, HooverError> {
        if truth.len() != labels.len() {
            return Err(HooverError::Size { truth: truth.len(), labels: labels.len() });
        }
        let areas = |image: &[u16]| {
            let mut areas = BTreeMap::new();
            image.iter().filter(|&&id| id != 0).for_each(|&id| *areas.entry(id).or_insert(0u32) += 1);
            areas.retain(|_, &mut area| area as usize >= min_pixels);
            areas
        };
        let (truth_areas, segment_areas) = (areas(truth), areas(labels));
        let mut shared = BTreeMap::new();
        for (&n, &m) in truth.iter().zip(labels) {
            if truth_areas.contains_key(&n) && segment_areas.contains_key(&m) {
                *shared.entry((n, m)).or_insert(0u32) += 1;
            }
        }
        // No tolerance asks for half or less.
        let is_most = |o: u32, area: u32| 2 * u64::from(o) > u64::from(area);
        let shared = shared.into_iter().map(|((n, m), o)| (n, m, o));
        let shared = shared.filter(|(n, m, o)| is_most(*o, truth_areas[n]) || is_most(*o, segment_areas[m])).collect();
        Ok(Self { truth: truth_areas, segments: segment_areas, shared })
    }

    /// Classifies at one tolerance, which must lie in (0.5, 1]. Costs n log n for n regions on both
    /// sides.
    pub fn at(&self, tolerance: f64) -> Result<Hoover, HooverError> {
        if !(tolerance > 0.5 && tolerance <= 1.0) {
            return Err(HooverError::Tolerance(tolerance));
        }
        let (mut truth_left, mut segments_left) = (Left::of(&self.truth), Left::of(&self.segments));
        let instances = self.standing(tolerance, &mut truth_left, &mut segments_left);
        let count = |class| instances.iter().filter(|i| i.class == class).count();
        Ok(Hoover {
            tolerance,
            truth_regions: self.truth.len(),
            segments: self.segments.len(),
            correct: count(Class::Correct),
            over_segmented: count(Class::OverSegmented),
            under_segmented: count(Class::UnderSegmented),
            missed: truth_left.ids.len(),
            noise: segments_left.ids.len(),
            instances,
        })
    }

    /// Returns the instances that stand, best average first, and takes their regions.
    fn standing(&self, tolerance: f64, truth_left: &mut Left, segments_left: &mut Left) -> Vec<Instance> {
        let mut candidates = self.candidates(tolerance);
        candidates.sort_by_key(|i| (-((i.average * 1e9).round() as i64), i.class, i.truth[0], i.segments[0]));
        candidates.retain(|i| {
            let free = truth_left.has_all(&i.truth) && segments_left.has_all(&i.segments);
            if free {
                truth_left.take(&i.truth);
                segments_left.take(&i.segments);
            }
            free
        });
        candidates
    }

    /// Every instance that the definitions allow, conflicts not yet resolved.
    fn candidates(&self, tolerance: f64) -> Vec<Instance> {
        let covers = |shared: u32, area: u32| f64::from(shared) >= (tolerance - 1e-9) * f64::from(area);
        let ratio = |shared: u32, area: u32| f64::from(shared) / f64::from(area);
        let mut instances = Vec::new();
        // Per truth region the segments that lie in it; per segment the truth regions that lie in
        // it.
        let (mut inside_truth, mut inside_segment) = (BTreeMap::new(), BTreeMap::new());
        for &(n, m, shared) in &self.shared {
            let (n_area, m_area) = (self.truth[&n], self.segments[&m]);
            if covers(shared, m_area) {
                inside_truth.entry(n).or_insert_with(Vec::new).push((m, shared, m_area));
            }
            if covers(shared, n_area) {
                inside_segment.entry(m).or_insert_with(Vec::new).push((n, shared, n_area));
            }
            if covers(shared, m_area) && covers(shared, n_area) {
                let average = (ratio(shared, m_area) + ratio(shared, n_area)) / 2.0;
                instances.push(Instance { class: Class::Correct, truth: vec![n], segments: vec![m], average });
            }
        }
        let split = |whole_area: u32, parts: &[(u16, u32, u32)]| {
            let sum = parts.iter().map(|&(_, shared, _)| shared).sum();
            let mean = parts.iter().map(|&(_, shared, area)| ratio(shared, area)).sum::<f64>() / parts.len() as f64;
            let ids = parts.iter().map(|&(id, ..)| id).collect::<Vec<_>>();
            (parts.len() >= 2 && covers(sum, whole_area)).then(|| (ids, (mean + ratio(sum, whole_area)) / 2.0))
        };
        for (n, parts) in inside_truth {
            if let Some((segments, average)) = split(self.truth[&n], &parts) {
                instances.push(Instance { class: Class::OverSegmented, truth: vec![n], segments, average });
            }
        }
        for (m, parts) in inside_segment {
            if let Some((truth, average)) = split(self.segments[&m], &parts) {
                instances.push(Instance { class: Class::UnderSegmented, truth, segments: vec![m], average });
            }
        }
        instances
    }
}

/// [`Overlaps::new`] and [`Overlaps::at`] in one, for a single tolerance.
pub fn evaluate(truth: &[u16], labels: &[u16], tolerance: f64, min_pixels: usize) -> Result<Hoover, HooverError> {
    Overlaps::new(truth, labels, min_pixels)?.at(tolerance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Label image from a drawing: `.` is 0, a letter or digit is its character code; blanks are
    /// left out.
    fn drawn(art: &str) -> Vec<u16> {
        art.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '.' { 0 } else { c as u16 }).collect()
    }

    /// Instances as text: class, truth ids, segment ids; and the counts, which must agree with
    /// them.
    fn classes(truth: &str, labels: &str, tolerance: f64, min_pixels: usize) -> (String, [usize; 5]) {
        let h = evaluate(&drawn(truth), &drawn(labels), tolerance, min_pixels).unwrap();
        let ids = |ids: &[u16]| ids.iter().map(|&id| char::from(id as u8)).collect::<String>();
        let line = |i: &Instance| format!("{:?} {} {}", i.class, ids(&i.truth), ids(&i.segments));
        let text = h.instances.iter().map(line).collect::<Vec<_>>().join("; ");
        (text, [h.correct, h.over_segmented, h.under_segmented, h.missed, h.noise])
    }

    #[test]
    fn every_class_once() {
        // A = a but for one pixel of 10. B (12 px) is b (6) and c (6). C and D (4 each) are d (8).
        // E has nothing on it; e (3 px) lies where the truth has nothing.
        let truth = "AAAAA BBBBBB CC DD E ...
                     AAAAA BBBBBB CC DD E ...";
        let labels = "aaaaa bbbccc dd dd . eee
                      aaaa. bbbccc dd dd . ...";
        let expected = "OverSegmented B bc; UnderSegmented CD d; Correct A a";
        assert_eq!(classes(truth, labels, 0.8, 0), (expected.into(), [1, 1, 1, 1, 1]));
        // At T = 1 the one pixel costs A (9 of 10): missed beside E, and a is noise beside e.
        let expected = "OverSegmented B bc; UnderSegmented CD d";
        assert_eq!(classes(truth, labels, 1.0, 0), (expected.into(), [0, 1, 1, 2, 2]));
    }

    #[test]
    fn pixels_without_a_region_count_in_areas() {
        // A has 10 px of which a covers 8; a has 10 px of which 2 have no truth. 8/10 both ways:
        // just correct at 0.8.
        let (truth, labels) = ("AAAAA AAAAA ..", "..aaa aaaaa aa");
        assert_eq!(classes(truth, labels, 0.8, 0), ("Correct A a".into(), [1, 0, 0, 0, 0]));
        assert_eq!(classes(truth, labels, 0.81, 0), (String::new(), [0, 0, 0, 1, 1]));
    }

    #[test]
    fn equality_holds_where_binary_does_not() {
        // 0.55 * 100 = 55.00000000000001 in f64; 55 of 100 pixels must do.
        let truth = vec![1; 100];
        let labels = (0..100).map(|i| u16::from(i < 55)).collect::<Vec<_>>();
        assert_eq!(evaluate(&truth, &labels, 0.55, 0).unwrap().correct, 1);
        assert_eq!(evaluate(&truth, &labels, 0.5500001, 0).unwrap().correct, 0);
    }

    #[test]
    fn better_over_segmentation_beats_correct() {
        // A has 10 px, a 6 and b 4, all inside A. At T = 0.6 Correct A a: (6/6 + 6/10) / 2 = 0.8.
        // Over A ab: ((1 + 1) / 2 + 10/10) / 2 = 1. So b is not noise.
        assert_eq!(classes("AAAAA AAAAA", "aaaaa abbbb", 0.6, 0), ("OverSegmented A ab".into(), [0, 1, 0, 0, 0]));
    }

    #[test]
    fn better_correct_beats_over_segmentation() {
        // A has 16 px. a: 13 of 13. b: 3 of its 5 lie in A. Correct A a: (1 + 13/16) / 2 = 0.906.
        // Over A ab: ((1 + 3/5) / 2 + 16/16) / 2 = 0.9. Correct stands, b is noise.
        assert_eq!(
            classes("AAAA AAAA AAAA AAAA ..", "aaaa aaaa aaaa abbb bb", 0.6, 0),
            ("Correct A a".into(), [1, 0, 0, 0, 1])
        );
        // Now b lies in A with 3 of 4. Over A ab: ((1 + 3/4) / 2 + 1) / 2 = 0.9375, not the mean of
        // all three ratios, (1 + 3/4 + 1) / 3.
        let h = evaluate(&drawn("AAAA AAAA AAAA AAAA ."), &drawn("aaaa aaaa aaaa abbb b"), 0.6, 0).unwrap();
        assert_eq!((h.instances.len(), h.instances[0].class), (1, Class::OverSegmented));
        assert_eq!(h.instances[0].average, 0.9375);
    }

    #[test]
    fn better_under_segmentation_beats_both_others() {
        // A has 10 px: 8 in a, 2 in b. B has 2 px, both in a. a has 10 px. b has 3 px, one of them
        // outside. Correct A a: (8/10 + 8/10) / 2 = 0.8. Over A ab: ((8/10 + 2/3) / 2 + 10/10) / 2
        // = 0.867. Under AB a: ((8/10 + 2/2) / 2 + 10/10) / 2 = 0.95. So A and a are taken, b is
        // noise.
        assert_eq!(
            classes("AAAAAAAA AA BB .", "aaaaaaaa bb aa b", 0.6, 0),
            ("UnderSegmented AB a".into(), [0, 0, 1, 0, 1])
        );
        // At T = 0.9 none of them qualifies: two missed, two noise.
        assert_eq!(classes("AAAAAAAA AA BB .", "aaaaaaaa bb aa b", 0.9, 0), (String::new(), [0, 0, 0, 2, 2]));
    }

    #[test]
    fn ties_go_to_correct_then_over_then_under() {
        // A has 15 px. a: 12 of 12. b: 3 of its 5 lie in A. Correct A a: (1 + 12/15) / 2 = 0.9.
        // Over A ab: ((1 + 3/5) / 2 + 15/15) / 2 = 0.9. And with the images exchanged the same for
        // under.
        let (one, three) = ("AAAAA AAAAA AAAAA ..", "aaaaa aaaaa aabbb bb");
        assert_eq!(classes(one, three, 0.6, 0), ("Correct A a".into(), [1, 0, 0, 0, 1]));
        assert_eq!(classes(three, one, 0.6, 0), ("Correct a A".into(), [1, 0, 0, 1, 0]));
        // A has 10 px: 8 in a, 2 in b (2 px). a has 10 px: 8 in A, 2 in B (2 px).
        // Over A ab and under AB a: ((8/10 + 2/2) / 2 + 10/10) / 2 = 0.95 both. B is missed.
        assert_eq!(classes("AAAAAAAA AA BB", "aaaaaaaa bb aa", 0.6, 0), ("OverSegmented A ab".into(), [0, 1, 0, 1, 0]));
        // Equal averages of one class never share a region; the lower truth id is listed first.
        assert_eq!(classes("BBAA", "aabb", 0.6, 0).0, "Correct A b; Correct B a");
    }

    #[test]
    fn too_few_parts_or_too_little_cover_is_missed_and_noise() {
        // A has 10 px; only a (5 of 5) and b (2 of 2) lie in it: 7/10 < 0.8.
        assert_eq!(classes("AAAAA AAAAA", "aaaaa bb...", 0.8, 0), (String::new(), [0, 0, 0, 1, 2]));
        assert_eq!(classes("AAAAA AAAAA", "aaaaa bb...", 0.7, 0).0, "OverSegmented A ab");
    }

    #[test]
    fn small_regions_are_ignored_but_still_fill_areas() {
        // B (2 px) and b (2 px) are below 3 px: neither missed nor noise. a has 10 px, 8 of them in
        // A (8 px).
        let (truth, labels) = ("AAAA AAAA BB ..", "aaaa aaaa aa bb");
        assert_eq!(classes(truth, labels, 0.8, 3), ("Correct A a".into(), [1, 0, 0, 0, 0]));
        assert_eq!(classes(truth, labels, 0.9, 3), (String::new(), [0, 0, 0, 1, 1]));
        // Kept (2 px suffice), B joins A under a, and b is noise.
        assert_eq!(classes(truth, labels, 0.8, 2), ("UnderSegmented AB a".into(), [0, 0, 1, 0, 1]));
        let h = evaluate(&drawn(truth), &drawn(labels), 0.8, 3).unwrap();
        assert_eq!((h.truth_regions, h.segments), (1, 1));
    }

    /// Each pixel its own region, against itself and against stripes; overlaps that no tolerance
    /// asks for are not kept. Walks over all regions for each instance would look 10^9 times.
    #[test]
    fn regions_are_looked_up_and_not_walked_over() {
        const REGIONS: u16 = 40_000;
        let truth: Vec<u16> = (1..=REGIONS).collect();
        let stripes: Vec<u16> = (0..REGIONS).map(|i| 1 + i / 200).collect();
        for (labels, correct, over) in [(&truth, usize::from(REGIONS), 0), (&stripes, 0, 200)] {
            let overlaps = Overlaps::new(labels, &truth, 1).unwrap();
            assert_eq!(overlaps.shared.len(), truth.len());
            let (mut truth_left, mut segments_left) = (Left::of(&overlaps.truth), Left::of(&overlaps.segments));
            let instances = overlaps.standing(0.8, &mut truth_left, &mut segments_left);
            assert_eq!(instances.len(), correct + over);
            assert!(truth_left.looked_up + segments_left.looked_up <= 5 * truth.len());
        }
        // 200 x 200 pieces that are no half of anything
        let crossed: Vec<u16> = (0..REGIONS).map(|i| 1 + i % 200).collect();
        assert_eq!(Overlaps::new(&stripes, &crossed, 1).unwrap().shared, []);
    }

    #[test]
    fn bad_input_is_an_error() {
        assert_eq!(evaluate(&[1, 1], &[1], 0.8, 0), Err(HooverError::Size { truth: 2, labels: 1 }));
        for t in [0.5, 1.0000001, -1.0, f64::INFINITY] {
            assert_eq!(evaluate(&[1], &[1], t, 0), Err(HooverError::Tolerance(t)));
        }
        assert!(evaluate(&[1], &[1], f64::NAN, 0).is_err());
        assert_eq!(evaluate(&[], &[], 1.0, 0).unwrap().instances, []);
    }
}
