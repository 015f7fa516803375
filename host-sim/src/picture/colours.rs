//! The colours of ranges, labels, bearing angles and edges.

use crate::picture::canvas::{BLACK, Rgb, WHITE, mixed};

/// Colour of a range: from bright yellow at `near_m` and nearer over red and violet to dark blue at
/// `far_m` and farther, in steps that look alike. Black where there is no range (not above 0,
/// infinite, or not a number). Limits that are equal or not numbers give some colour other than
/// black.
///
/// The colours are those of matplotlib's "plasma" map at every eighth of its length, interpolated.
pub fn range_colour(range_m: f32, near_m: f32, far_m: f32) -> Rgb {
    const NEAR_TO_FAR: [Rgb; 9] = [
        [0xf0, 0xf9, 0x21],
        [0xfd, 0xc3, 0x28],
        [0xf8, 0x94, 0x41],
        [0xe5, 0x6b, 0x5d],
        [0xcc, 0x46, 0x78],
        [0xa9, 0x23, 0x95],
        [0x7e, 0x03, 0xa8],
        [0x4c, 0x02, 0xa1],
        [0x0d, 0x08, 0x87],
    ];
    if !(range_m > 0.0 && range_m.is_finite()) {
        return BLACK;
    }
    let t = ((range_m - near_m) / (far_m - near_m)).clamp(0.0, 1.0) * 8.0;
    // Limits that span nothing, or that are not numbers: the near colour.
    let t = if t.is_nan() { 0.0 } else { t };
    let i = (t as usize).min(7);
    let fraction = t - i as f32;
    let (a, b) = (NEAR_TO_FAR[i], NEAR_TO_FAR[i + 1]);
    mixed(a, b, fraction)
}

/// Colours that stay as far apart as they can for normal sight and for the three kinds of colour
/// blindness (Machado et al. 2009; distances in CIE Lab), each the farthest from black, white,
/// greys and all before it. The first two are blue and orange of Okabe and Ito.
const LABELS: [Rgb; 20] = [
    [0x00, 0x72, 0xb2],
    [0xe6, 0x9f, 0x00],
    [0x77, 0x00, 0xff],
    [0x99, 0x44, 0x11],
    [0xaa, 0xff, 0x99],
    [0xbb, 0x88, 0x77],
    [0x88, 0x66, 0xff],
    [0x99, 0xaa, 0xff],
    [0x99, 0x77, 0x99],
    [0xff, 0xee, 0x00],
    [0xaa, 0xaa, 0x55],
    [0xcc, 0xee, 0x66],
    [0x55, 0xee, 0xaa],
    [0x22, 0x77, 0x44],
    [0xbb, 0x77, 0x11],
    [0xdd, 0x00, 0xbb],
    [0x33, 0xcc, 0xaa],
    [0x99, 0x11, 0xcc],
    [0xaa, 0x00, 0x88],
    [0xcc, 0x22, 0x77],
];

/// Colour of a label, such that labels with numbers close to each other look different, to the
/// colour-blind too as far as possible; 0 (no label) is dark grey. Label 21 has the colour of label
/// 1 again.
pub fn label_colour(label: u32) -> Rgb {
    match label.checked_sub(1) {
        None => [64, 64, 64],
        Some(i) => LABELS[i as usize % LABELS.len()],
    }
}

/// Grey of a bearing angle: black at 0, white at pi radians (and beyond); dark blue where it is not
/// a number, which here means that one of its two ranges is missing.
pub fn bearing_colour(bearing_rad: f32) -> Rgb {
    if bearing_rad.is_nan() {
        return [0, 0, 96];
    }
    [(bearing_rad / std::f32::consts::PI * 255.0).round() as u8; 3]
}

/// Black for an edge, white for none.
pub fn edge_colour(edge: bool) -> Rgb {
    if edge { BLACK } else { WHITE }
}
