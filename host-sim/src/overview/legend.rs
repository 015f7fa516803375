//! What the colours and numbers of a picture of segments mean.

use crate::picture::{BLACK, Picture, TextStyle, WHITE, label_colour, text_width};

/// A line of a legend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Label of the segment, from 1.
    pub label: u32,
    /// What is said of it, in a few words.
    pub text: String,
}

const SIZE: f32 = 16.0;
const LINE: usize = 24;
const SWATCH: usize = 18;
const GAP: usize = 12;

/// Returns a legend `width` pixels wide or a little more: a box of each line's colour, its label,
/// its text; in as many columns as there is room for.
pub(super) fn legend(width: usize, lines: &[Line]) -> Picture {
    let texts: Vec<String> = lines.iter().map(|line| format!("{}  {}", line.label, line.text)).collect();
    let longest = texts.iter().map(|text| text_width(SIZE, text).ceil() as usize).max().unwrap_or(0);
    let column = SWATCH + GAP / 2 + longest + 2 * GAP;
    let columns = (width.saturating_sub(GAP) / column).clamp(1, lines.len().max(1));
    let rows = lines.len().div_ceil(columns);
    let mut picture = Picture::new(width.max(GAP + columns * column), rows * LINE + GAP, WHITE);
    for (i, (line, text)) in lines.iter().zip(&texts).enumerate() {
        let (x, y) = (GAP + i / rows * column, GAP + i % rows * LINE);
        picture.rect(x, y, SWATCH, SWATCH, label_colour(line.label));
        picture.text(((x + SWATCH + GAP / 2) as f32, y as f32 + 0.85 * SIZE), TextStyle::new(SIZE, BLACK), text);
    }
    picture
}
