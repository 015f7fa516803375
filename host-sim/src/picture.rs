//! Pictures of scans: a small RGB canvas with text, the colours of ranges, labels, bearing angles
//! and edges, and sheets of titled panels like the figures of a paper.
//!
//! x is the column, to the right, and y the row, downwards, in pixels. What lies outside of a
//! picture is not drawn.
use font8x8::legacy::BASIC_LEGACY;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Black: no range; an edge.
pub const BLACK: Rgb = [0, 0, 0];
/// White: paper.
pub const WHITE: Rgb = [255, 255, 255];

/// Width and height of a character of [`Picture::text`] at scale 1, pixels.
pub const CHARACTER: usize = 8;

/// A picture of 8 bits per colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    /// Returns a picture of one colour. A side of 0 is made 1, as no file holds an empty picture.
    pub fn new(width: usize, height: usize, colour: Rgb) -> Picture {
        let (width, height) = (width.max(1), height.max(1));
        Picture { width, height, rgb: colour.repeat(width * height) }
    }

    /// Returns a picture of `colour(x, y)` for each pixel; sides as in [`Picture::new`].
    pub fn from_fn(width: usize, height: usize, mut colour: impl FnMut(usize, usize) -> Rgb) -> Picture {
        let mut picture = Picture::new(width, height, BLACK);
        for (i, pixel) in picture.rgb.chunks_exact_mut(3).enumerate() {
            pixel.copy_from_slice(&colour(i % picture.width, i / picture.width));
        }
        picture
    }

    /// Width in pixels, 1 or more.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels, 1 or more.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Colour of a pixel; none outside.
    pub fn get(&self, x: usize, y: usize) -> Option<Rgb> {
        let at = self.index(x, y)?;
        Some([self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]])
    }

    /// Colours a pixel.
    pub fn put(&mut self, x: usize, y: usize, colour: Rgb) {
        if let Some(at) = self.index(x, y) {
            self.rgb[at..at + 3].copy_from_slice(&colour);
        }
    }

    fn index(&self, x: usize, y: usize) -> Option<usize> {
        (x < self.width && y < self.height).then_some(3 * (y * self.width + x))
    }

    /// Fills the rectangle from (`x`, `y`), `width` x `height` pixels.
    pub fn rect(&mut self, x: usize, y: usize, width: usize, height: usize, colour: Rgb) {
        for y in y..y.saturating_add(height).min(self.height) {
            for x in x..x.saturating_add(width).min(self.width) {
                self.put(x, y, colour);
            }
        }
    }

    /// Copies `other` with its upper left corner at (`x`, `y`).
    pub fn blit(&mut self, x: usize, y: usize, other: &Picture) {
        for dy in 0..other.height.min(self.height.saturating_sub(y)) {
            for dx in 0..other.width.min(self.width.saturating_sub(x)) {
                let from = 3 * (dy * other.width + dx);
                let to = 3 * ((y + dy) * self.width + x + dx);
                self.rgb[to..to + 3].copy_from_slice(&other.rgb[from..from + 3]);
            }
        }
    }

    /// Writes one line of ASCII text, its upper left corner at (`x`, `y`), each character
    /// [`CHARACTER`] * `scale` pixels wide and high. Other characters are written as `?`.
    pub fn text(&mut self, x: usize, y: usize, scale: usize, colour: Rgb, text: &str) {
        for (i, character) in text.chars().enumerate() {
            let glyph = BASIC_LEGACY.get(character as usize).unwrap_or(&BASIC_LEGACY['?' as usize]);
            for (row, bits) in glyph.iter().enumerate() {
                // The lowest bit is the leftmost pixel.
                for column in (0..CHARACTER).filter(|column| bits >> column & 1 == 1) {
                    let left = x.saturating_add((i * CHARACTER + column) * scale);
                    self.rect(left, y.saturating_add(row * scale), scale, scale, colour);
                }
            }
        }
    }

    /// Returns the picture in another size, each pixel that of the nearest one; sides as in
    /// [`Picture::new`].
    pub fn scaled(&self, width: usize, height: usize) -> Picture {
        let (width, height) = (width.max(1), height.max(1));
        // The middle of the new pixel lies in the pixel taken.
        let from = |to: usize, new: usize, old: usize| (2 * to + 1) * old / (2 * new);
        Picture::from_fn(width, height, |x, y| {
            let at = 3 * (from(y, height, self.height) * self.width + from(x, width, self.width));
            [self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]]
        })
    }

    /// Returns a PNG file of the picture.
    ///
    /// # Panics
    /// If a side is above 2^31 - 1.
    pub fn to_png(&self) -> Vec<u8> {
        let [width, height] = [self.width, self.height].map(|n| u32::try_from(n).expect("a side is too long"));
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("a PNG header in memory");
        writer.write_image_data(&self.rgb).expect("PNG data in memory");
        writer.finish().expect("a PNG end in memory");
        bytes
    }
}

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
    [0, 1, 2].map(|c| (f32::from(a[c]) * (1.0 - fraction) + f32::from(b[c]) * fraction).round() as u8)
}

/// Colour of a label, such that labels with numbers close to each other look different; 0 (no
/// label) is dark grey.
///
/// Hue goes on by the golden angle from label to label, lightness takes turns among three.
pub fn label_colour(label: u32) -> Rgb {
    if label == 0 {
        return [64, 64, 64];
    }
    const GOLDEN_TURN: f64 = 0.381_966_011_250_105;
    let hue = (f64::from(label) * GOLDEN_TURN).fract();
    let lightness = [0.45, 0.62, 0.78][label as usize % 3];
    let chroma = 0.85 * (1.0 - (2.0 * lightness - 1.0f64).abs());
    // Each colour is a trapezoid over the hue, a third of a turn from the next.
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|middle| {
        let distance = (hue - middle + 0.5).rem_euclid(1.0) - 0.5;
        let height = (2.0 - 6.0 * distance.abs()).clamp(0.0, 1.0);
        (255.0 * (lightness + chroma * (height - 0.5))).round() as u8
    })
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

/// Panels with their titles above them, black on white, in a grid of `columns` columns (0 is made
/// 1), row by row. Cells are as wide and as high as the largest panel, and wide enough for the
/// longest title.
pub fn sheet(panels: &[(&str, Picture)], columns: usize) -> Picture {
    const MARGIN: usize = 8;
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns);
    let longest = panels.iter().map(|(title, _)| title.chars().count() * CHARACTER).max().unwrap_or(0);
    let widest = panels.iter().map(|(_, panel)| panel.width).max().unwrap_or(0);
    let highest = panels.iter().map(|(_, panel)| panel.height).max().unwrap_or(0);
    // Titles in double size where they have the room.
    let scale = if 2 * longest <= widest { 2 } else { 1 };
    let title_height = CHARACTER * scale + MARGIN / 2;
    let (cell_width, cell_height) = (widest.max(longest) + MARGIN, title_height + highest + MARGIN);

    let mut picture = Picture::new(MARGIN + columns * cell_width, MARGIN + rows * cell_height, WHITE);
    for (i, (title, panel)) in panels.iter().enumerate() {
        let (x, y) = (MARGIN + i % columns * cell_width, MARGIN + i / columns * cell_height);
        picture.text(x, y, scale, BLACK, title);
        picture.blit(x, y + title_height, panel);
    }
    picture
}
