//! The evaluation against a second one written straight from the definitions.

use proptest::prelude::*;
use scanseg_sim::hoover::{Class, Overlaps};
use scanseg_tests::hoover::classify;

/// Columns of the test images: 6 rows make 60 pixels.
const COLUMNS: usize = 10;

/// A rectangle of one label: top, left, bottom, right (inclusive), label.
fn rectangle() -> impl Strategy<Value = [usize; 5]> {
    (0..6usize, 0..COLUMNS, 0..6usize, 0..COLUMNS, 0..6usize).prop_map(|(t, l, b, r, id)| [t, l, b, r, id])
}

fn paint(image: &mut [u16], rectangles: &[[usize; 5]]) {
    for &[r0, c0, r1, c1, label] in rectangles {
        for row in r0.min(r1)..=r0.max(r1) {
            for column in c0.min(c1)..=c0.max(c1) {
                image[row * COLUMNS + column] = label as u16;
            }
        }
    }
}

/// Truth and segmentation: rectangles over the whole; the segmentation starts from the truth,
/// renamed, so that matches, splits and merges are common, and is then painted over.
fn images() -> impl Strategy<Value = (Vec<u16>, Vec<u16>)> {
    let rectangles = || proptest::collection::vec(rectangle(), 0..6);
    (rectangles(), rectangles(), proptest::collection::vec(0..7u16, 6)).prop_map(|(first, second, names)| {
        let mut truth = vec![1; 6 * COLUMNS];
        paint(&mut truth, &first);
        let mut labels = truth.iter().map(|&n| names[n as usize]).collect::<Vec<_>>();
        paint(&mut labels, &second);
        (truth, labels)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4000) })]

    #[test]
    fn agrees_with_the_definitions((truth, labels) in images(), percent in 51..=100usize, min_pixels in 0..6usize) {
        let (instances, missed, noise, _) = classify(&truth, &labels, percent, min_pixels);
        let found = Overlaps::new(&truth, &labels, min_pixels).unwrap().at(percent as f64 / 100.0).unwrap();
        let class = |c| match c {
            Class::Correct => 0,
            Class::OverSegmented => 1,
            Class::UnderSegmented => 2,
        };
        let standing: Vec<_> =
            found.instances.iter().map(|i| (class(i.class), i.truth.clone(), i.segments.clone())).collect();
        let count = |class| instances.iter().filter(|i| i.0 == class).count();
        prop_assert_eq!(
            [found.correct, found.over_segmented, found.under_segmented, found.missed, found.noise],
            [count(0), count(1), count(2), missed.len(), noise.len()]
        );
        prop_assert_eq!(standing, instances);
    }
}

/// The random images above would prove little if conflicts were rare in them.
#[test]
fn random_images_hold_every_class_and_conflict() {
    use proptest::{strategy::ValueTree, test_runner::TestRunner};
    let mut runner = TestRunner::deterministic();
    let (mut seen, mut conflicts) = ([0; 3], 0);
    for _ in 0..1000 {
        let (truth, labels) = images().new_tree(&mut runner).unwrap().current();
        let (instances, _, _, dropped) = classify(&truth, &labels, 60, 0);
        instances.iter().for_each(|i| seen[i.0 as usize] += 1);
        conflicts += dropped;
    }
    assert!(seen.iter().all(|&n| n > 50), "{seen:?}");
    assert!(conflicts > 100, "{conflicts} {seen:?}");
}
