//! Where in a picture the numbers of segments stand.

use std::collections::BTreeMap;

/// A place well within a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub x: usize,
    pub y: usize,
    /// How far away what is not of the segment is, pixels.
    pub room: f32,
}

/// Returns for each label other than 0 the place farthest from all that is not of the label, the
/// border of the picture included; `labels` row by row, `width` a row.
pub fn places(labels: &[u32], width: usize) -> BTreeMap<u32, Place> {
    let most = labels.iter().copied().max().unwrap_or(0);
    // of each label the greatest distance, and where it is
    let mut farthest = vec![(0, 0); most as usize + 1];
    for (i, (&label, &distance)) in labels.iter().zip(&distances(labels, width)).enumerate() {
        let known = &mut farthest[label as usize];
        if distance > known.0 {
            *known = (distance, i);
        }
    }
    let place = |(distance, i): (u32, usize)| Place { x: i % width, y: i / width, room: distance as f32 / 3.0 };
    let found = (0..).zip(farthest).skip(1).filter(|(_, (distance, _))| *distance > 0);
    found.map(|(label, farthest)| (label, place(farthest))).collect()
}

/// Returns for each pixel its distance to the nearest pixel of another label or beyond the border,
/// in thirds of a pixel: 3 for a step to the side, 4 for one across a corner.
fn distances(labels: &[u32], width: usize) -> Vec<u32> {
    let mut distances = vec![u32::MAX; labels.len()];
    lessen(labels, &mut distances, width);
    // the same from the last pixel to the first
    let turned: Vec<u32> = labels.iter().rev().copied().collect();
    distances.reverse();
    lessen(&turned, &mut distances, width);
    distances.reverse();
    distances
}

/// Lessens distances to those by way of the pixels before each: to the left, and above.
fn lessen(labels: &[u32], distances: &mut [u32], width: usize) {
    let by = |label: u32, other: Option<&u32>, distance: Option<&u32>, step: u32| match (other, distance) {
        (Some(&other), Some(&distance)) if other == label => distance + step,
        _ => step,
    };
    // beyond the border there is nothing
    let (mut labels_above, mut above): (&[u32], &[u32]) = (&[], &[]);
    let rows = labels.chunks_exact(width.max(1));
    for (labels, row) in rows.zip(distances.chunks_exact_mut(width.max(1))) {
        let mut left: (Option<u32>, u32) = (None, 0);
        for (x, (&label, distance)) in labels.iter().zip(&mut *row).enumerate() {
            let near = |at: usize, step: u32| by(label, labels_above.get(at), above.get(at), step);
            let aside = by(label, left.0.as_ref(), Some(&left.1), 3);
            let straight = near(x, 3).min(near(x.wrapping_sub(1), 4)).min(near(x + 1, 4));
            *distance = (*distance).min(aside).min(straight);
            left = (Some(label), *distance);
        }
        (labels_above, above) = (labels, row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_in_the_middle_of_its_segment() {
        let labels = [
            [1, 1, 1, 1, 1, 2, 2],
            [1, 1, 1, 1, 1, 2, 2],
            [1, 1, 1, 1, 1, 2, 2],
            [1, 1, 1, 1, 1, 2, 0],
            [1, 1, 1, 1, 1, 3, 3],
        ];
        let places = places(labels.as_flattened(), 7);
        assert_eq!(places.keys().copied().collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(places[&1], Place { x: 2, y: 2, room: 3.0 });
        assert_eq!((places[&2].room, places[&3].room), (1.0, 1.0));
        assert!(places[&2].x >= 5 && places[&3].y == 4);
        assert!(super::places(&[], 0).is_empty());
    }

    /// A ring's place is on the ring, not in its hole.
    #[test]
    fn a_place_is_on_its_segment() {
        let ring = |x: usize, y: usize| u32::from((1..=7).contains(&x) && (1..=7).contains(&y) && !(x == 4 && y == 4));
        let labels: Vec<u32> = (0..81).map(|i| ring(i % 9, i / 9)).collect();
        let place = places(&labels, 9)[&1];
        assert_eq!(labels[9 * place.y + place.x], 1);
    }
}
