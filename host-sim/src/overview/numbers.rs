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
    let mut places = BTreeMap::<u32, Place>::new();
    for (i, &distance) in distances(labels, width).iter().enumerate() {
        let place = Place { x: i % width, y: i / width, room: distance as f32 / 3.0 };
        if labels[i] != 0 && places.get(&labels[i]).is_none_or(|known| known.room < place.room) {
            places.insert(labels[i], place);
        }
    }
    places
}

/// Returns for each pixel its distance to the nearest pixel of another label or beyond the border,
/// in thirds of a pixel: 3 for a step to the side, 4 for one across a corner.
fn distances(labels: &[u32], width: usize) -> Vec<u32> {
    let height = labels.len() / width.max(1);
    let mut distances = vec![u32::MAX; labels.len()];
    let near = |distances: &[u32], x: usize, y: usize, (dx, dy): (isize, isize)| {
        let other = x.checked_add_signed(dx).zip(y.checked_add_signed(dy));
        let other = other.filter(|&(x, y)| x < width && y < height).map(|(x, y)| y * width + x);
        let step = if dx == 0 || dy == 0 { 3 } else { 4 };
        match other {
            Some(j) if labels[j] == labels[y * width + x] => distances[j].saturating_add(step),
            _ => step,
        }
    };
    let before = [(-1, 0), (-1, -1), (0, -1), (1, -1)];
    let after = before.map(|(dx, dy)| (-dx, -dy));
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    for (x, y) in pixels.clone() {
        for step in before {
            distances[y * width + x] = near(&distances, x, y, step).min(distances[y * width + x]);
        }
    }
    for (x, y) in pixels.rev() {
        for step in after {
            distances[y * width + x] = near(&distances, x, y, step).min(distances[y * width + x]);
        }
    }
    distances
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
