//! Roof and step edges of bearing-angle images (paper, section 4).

use super::{Image, Settings, Size, Trace};

/// Roof edges of one count image: Sobel, with the L1 norm, where |gx| + |gy| is at least
/// `roof_eighths`. It works on eighths of the counts, rounded up: 1 to 8192, so that only "none" is
/// 0. (4 is the sum of the weights of one side of the operator.)
///
/// A pixel without a bearing angle is no edge. A neighbour outside of the image or without a
/// bearing angle counts as the pixel itself, so that a border or hole is no edge by itself.
pub fn roof_edges(size: Size, counts: &[u16], roof_eighths: u32) -> Vec<bool> {
    let eighth = |(row, column)| counts[size.index(row, column)].div_ceil(8);
    let is_edge = |pixel: (usize, usize)| {
        let own = eighth(pixel);
        if own == 0 {
            return false;
        }
        let at = |down, right| {
            let neighbour = size.neighbour(pixel, down, right).map(eighth);
            i64::from(neighbour.filter(|&eighth| eighth != 0).unwrap_or(own))
        };
        let gx = (at(-1, 1) + 2 * at(0, 1) + at(1, 1)) - (at(-1, -1) + 2 * at(0, -1) + at(1, -1));
        let gy = (at(1, -1) + 2 * at(1, 0) + at(1, 1)) - (at(-1, -1) + 2 * at(-1, 0) + at(-1, 1));
        gx.abs() + gy.abs() >= i64::from(roof_eighths)
    };
    size.pixels().map(is_edge).collect()
}

/// Step edges of one count image, which is that of `trace`: where the bearing angle is at most
/// `step_counts` from 0 or from pi, and the range differs by more than `step_range_m` from that of
/// the previous pixel on the trace.
///
/// The difference is that of the f32 ranges, rounded to f32. A pixel without a bearing angle, or
/// with a missing range on either side, is no edge.
pub fn step_edges(image: &Image, trace: Trace, counts: &[u16], step_counts: u32, step_range_m: f32) -> Vec<bool> {
    let is_edge = |pixel: (usize, usize)| {
        let count = i64::from(counts[image.size.index(pixel.0, pixel.1)]);
        let nearly_parallel = count <= i64::from(step_counts) || count >= 65535 - i64::from(step_counts);
        let previous = trace.previous(image.size, pixel).and_then(|previous| image.range(previous));
        match (image.range(pixel), previous) {
            (Some(range_m), Some(previous_m)) => {
                count != 0 && nearly_parallel && (range_m - previous_m).abs() > step_range_m
            }
            _ => false,
        }
    };
    image.size.pixels().map(is_edge).collect()
}

/// The edge image: roof and step edges of all traces. Panics if there is not one count per pixel
/// for every trace of the settings.
pub fn edges(image: &Image, settings: &Settings, counts: &[Vec<u16>]) -> Vec<bool> {
    assert_eq!(counts.len(), settings.traces.len(), "one count image per trace");
    let mut edges = vec![false; image.range_m.len()];
    for (&trace, counts) in settings.traces.iter().zip(counts) {
        assert_eq!(counts.len(), edges.len(), "one count per pixel");
        let roof = roof_edges(image.size, counts, settings.roof_eighths);
        let step = step_edges(image, trace, counts, settings.step_counts, settings.step_range_m);
        for (edge, found) in edges.iter_mut().zip(roof.iter().zip(step)) {
            *edge |= found.0 | found.1;
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::art::Picture;
    use crate::reference::beams::{Beams, TurnAxis};
    use crate::reference::bearing::bearing_counts;
    use crate::reference::closing::Element;

    /// Digits are bearing angles in eighths, a blank has none; `roof_angle` is a fourth of the
    /// threshold.
    fn roof(art: &str, roof_angle: u32, wraps: bool) -> Picture {
        let picture = Picture::parse(art);
        let counts = picture.map(|pixel| 8 * pixel.to_digit(10).unwrap_or(0) as u16);
        Picture::bits(picture.columns, &roof_edges(picture.size(wraps), &counts, 4 * roof_angle))
    }

    /// A jump of 4 between two columns: gx is 4 * 4 on either side of it, whether inside or on the
    /// border.
    #[test]
    fn both_sides_of_a_jump() {
        let art = "
            |111555|
            |111555|
            |111555|";
        let expected = Picture::parse(
            "
            |..##..|
            |..##..|
            |..##..|",
        );
        assert_eq!(roof(art, 4, false), expected);
        assert_eq!(roof(art, 5, false), Picture::parse("|......|\n|......|\n|......|"));
        // Cyclic: the first column is beside the last one.
        assert_eq!(roof(art, 4, true), Picture::parse("|#.##.#|\n|#.##.#|\n|#.##.#|"));
    }

    /// In the middle row the border pixel's missing neighbours count as itself.
    #[test]
    fn border_pixels() {
        // (1, 0): E side 1 + 2*1 + 1 = 4, W side 4 * 1; S 1 * 4; N (NW = own 1) + 2*9 + 9 = 28: gy
        // = 4 - 28 = -24, gx = (9 + 2 + 1) - (1 + 2 + 1) = 8: 32 = 4 * 8. (0, 0), own 9: N and W
        // count 9: S side 9 + 2*1 + 1 = 12: gy = 12 - 36 = -24; gx = (9 + 18 + 1) - 36 = -8: 32
        // again. Below: nothing differs.
        let art = "
            |99|
            |11|
            |11|";
        assert_eq!(roof(art, 8, false), Picture::parse("|##|\n|##|\n|..|"));
        assert_eq!(roof(art, 9, false), Picture::parse("|..|\n|..|\n|..|"));
    }

    /// A diagonal has |gx| = |gy| = 12: the sum is 4 * 6, where the bigger alone and the Euclidean
    /// norm, 17, are less.
    #[test]
    fn the_sum_of_both_gradients() {
        // At the centre, own 5: E side 5 + 2*5 + 5, W side 1 + 2*1 + 5: gx = 20 - 8 = 12; gy alike.
        let art = "
            |115|
            |155|
            |555|";
        assert!(roof(art, 6, false).to_bits()[4]);
        assert!(!roof(art, 7, false).to_bits()[4]);
    }

    /// A pixel without a count is no edge and makes none: the others are all equal.
    #[test]
    fn holes() {
        assert_eq!(roof("|777|\n|7 7|\n|777|", 1, false), Picture::parse("|...|\n|...|\n|...|"));
        // Threshold 0 makes every pixel an edge that has a count.
        assert_eq!(roof("|777|\n|7 7|\n|777|", 0, false), Picture::parse("|###|\n|#.#|\n|###|"));
        // A gap between 1 and 9 hides the jump across it.
        assert_eq!(roof("|11 99|\n|11 99|\n|11 99|", 1, false), Picture::parse("|.....|\n|.....|\n|.....|"));
    }

    #[test]
    fn a_single_pixel() {
        assert_eq!(roof("|5|", 1, false), Picture::parse("|.|"));
        assert_eq!(roof("|5|", 1, true), Picture::parse("|.|"));
        // Two cyclic columns: each is both neighbours of the other, gx = 0.
        assert_eq!(roof("|19|", 1, true), Picture::parse("|..|"));
        // Not cyclic, own 1: gx = (1 + 2*9 + 1) - 4 = 16; own 9: 36 - (9 + 2*1 + 9) = 16.
        assert_eq!(roof("|19|", 4, false), Picture::parse("|##|"));
        assert_eq!(roof("|19|", 5, false), Picture::parse("|..|"));
    }

    /// 1 to 8 are one eighth, 9 is the next one; the largest count is 8192 eighths. Beside one
    /// neighbour the gradient is twice the difference.
    #[test]
    fn eighths_are_rounded_up() {
        let size = Size { rows: 1, columns: 2, wraps: false };
        for (counts, eighths) in [([1, 8], 0), ([8, 9], 1), ([9, 16], 0), ([1, 65535], 8191), ([1, 65528], 8190)] {
            assert_eq!(roof_edges(size, &counts, 2 * eighths + 1), [false; 2], "{counts:?}");
            assert_eq!(roof_edges(size, &counts, 2 * eighths), [true; 2], "{counts:?}");
        }
    }

    fn steps(ranges: &[f32], counts: &[u16], step_counts: u32, step_range_m: f32, wraps: bool) -> Vec<bool> {
        let image = Image::new(Size { rows: 1, columns: ranges.len(), wraps }, ranges.to_vec());
        step_edges(&image, Trace::HORIZONTAL, counts, step_counts, step_range_m)
    }

    #[test]
    fn step_thresholds() {
        let (f, t) = (false, true);
        // The angle: at the threshold is an edge, beyond it not; 0 is no angle. The first has no
        // previous pixel.
        let ranges = [2.0, 4.0, 2.0, 4.0, 2.0, 4.0, 2.0];
        let counts = [1, 100, 101, 65435, 65434, 0, 65535];
        assert_eq!(steps(&ranges, &counts, 100, 0.5, false), [f, t, f, t, f, f, t]);
        assert_eq!(steps(&ranges, &counts, 100_000, 0.5, false), [f, t, t, t, t, f, t]);
        // The range: more than the threshold, away or nearer.
        assert_eq!(steps(&[2.0, 2.5, 2.0, 2.75, 2.0], &[1; 5], 100, 0.5, false), [f, f, f, t, t]);
        // A missing range on either side.
        assert_eq!(steps(&[2.0, 0.0, 4.0, 2.0], &[1; 4], 100, 0.5, false), [f, f, f, t]);
        // Across the seam.
        assert_eq!(steps(&[2.0, 2.0, 4.0], &[1; 3], 100, 0.5, true), [t, f, t]);
    }

    /// 4 + 4.8e-7 less 3e-7 is above 4, but 4 in f32.
    #[test]
    fn the_difference_is_f32() {
        let ranges = [3e-7, 4f32.next_up()];
        assert!(f64::from(ranges[1]) - f64::from(ranges[0]) > 4.0);
        assert_eq!(steps(&ranges, &[0, 1], 100, 4.0, false), [false, false]);
        assert_eq!(steps(&ranges, &[0, 1], 100, 4f32.next_down(), false), [false, true]);
    }

    /// One degree between beams: 2 m to 4 m is a bearing angle of 1.0 degree, 4 m to 2 m one of
    /// 178.0 degrees.
    #[test]
    fn a_box_in_front_of_a_wall() {
        let beam_rad = (0..8).map(|i| f64::from(i).to_radians()).collect();
        let beams = Beams::Nodding { beam_rad, turn_rad: vec![0.0], axis: TurnAxis::Y };
        let size = Size { rows: 1, columns: 8, wraps: false };
        let image = Image::new(size, vec![4.0, 4.0, 4.0, 2.0, 2.0, 2.0, 4.0, 4.0]);
        let counts = bearing_counts(&image, &beams, Trace::HORIZONTAL);
        let step_counts = |degrees: u32| degrees * 65535 / 180;
        let found = |degrees| step_edges(&image, Trace::HORIZONTAL, &counts, step_counts(degrees), 0.5);
        assert_eq!(Picture::bits(8, &found(3)), Picture::parse("|...#..#.|"));
    }

    /// The union over traces, of roofs and steps.
    #[test]
    fn union_of_traces() {
        let size = Size { rows: 3, columns: 3, wraps: false };
        let image = Image::new(size, vec![2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 8.0]);
        let settings = Settings {
            traces: vec![Trace::HORIZONTAL, Trace::VERTICAL],
            roof_eighths: 500,
            step_counts: 100,
            step_range_m: 1.0,
            element: Element::Plus,
        };
        let mut horizontal = vec![30000; 9];
        horizontal[8] = 50;
        horizontal[6] = 0;
        let vertical = vec![30000, 30000, 30000, 30000, 30000, 30000, 0, 0, 0];
        // The 50 is a step, and a roof to its three neighbours: gx, gy of (1, 1) and the sides see
        // it.
        let expected = Picture::parse("|...|\n|.##|\n|.##|");
        assert_eq!(Picture::bits(3, &edges(&image, &settings, &[horizontal, vertical.clone()])), expected);
        // Only the vertical step: no roof edges at all.
        let mut only_step = vertical;
        only_step[8] = 65500;
        only_step[4] = 0;
        only_step[5] = 0;
        let expected = Picture::parse("|...|\n|...|\n|..#|");
        assert_eq!(Picture::bits(3, &edges(&image, &settings, &[vec![0; 9], only_step])), expected);
    }
}
