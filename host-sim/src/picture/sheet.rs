//! Sheets of titled panels, like the figures of a paper.

use crate::picture::canvas::{BLACK, Picture, WHITE};
use crate::picture::text::{TextStyle, text_width};

/// Between panels, and around them.
const MARGIN: usize = 12;

/// Panels with their titles above them, black on white, in a grid of `columns` columns (0 is made
/// 1), row by row. Cells are as wide and as high as the largest panel, and wide enough for the
/// longest title.
pub fn sheet(panels: &[(String, Picture)], columns: usize) -> Picture {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let widest = panels.iter().map(|(_, panel)| panel.width()).max().unwrap_or(0);
    let highest = panels.iter().map(|(_, panel)| panel.height()).max().unwrap_or(0);
    // large enough to read when the sheet is shown at the width of a page
    let size = (widest as f32 / 34.0).clamp(13.0, 30.0);
    let longest = panels.iter().map(|(title, _)| text_width(size, title).ceil() as usize).max().unwrap_or(0);
    let title_height = (1.4 * size) as usize;
    let (cell_width, cell_height) = (widest.max(longest) + MARGIN, title_height + highest + MARGIN);

    let mut picture = Picture::new(MARGIN + columns * cell_width, MARGIN + rows * cell_height, WHITE);
    for (i, (title, panel)) in panels.iter().enumerate() {
        let (x, y) = (MARGIN + i % columns * cell_width, MARGIN + i / columns * cell_height);
        picture.text((x as f32, y as f32 + size), TextStyle::new(size, BLACK), title);
        picture.blit(x, y + title_height, panel);
    }
    picture
}
