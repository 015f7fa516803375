//! A small RGB canvas.

use zeno::{Command, Join, Mask, PathBuilder, Stroke};

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Black: no range; an edge.
pub const BLACK: Rgb = [0, 0, 0];
/// White: paper.
pub const WHITE: Rgb = [255, 255, 255];

/// A picture of 8 bits per colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<Rgb>,
}

impl Picture {
    /// Returns a picture of one colour. A side of 0 is made 1, as no file holds an empty picture.
    pub fn new(width: usize, height: usize, colour: Rgb) -> Picture {
        let (width, height) = (width.max(1), height.max(1));
        Picture { width, height, rgb: vec![colour; width * height] }
    }

    /// Returns the picture of these pixels, row by row; `width` and the number of rows are 1 or more.
    pub(crate) fn of_pixels(width: usize, rgb: Vec<Rgb>) -> Picture {
        Picture { width, height: rgb.len() / width, rgb }
    }

    /// Returns a picture of `colour(x, y)` for each pixel; sides as in [`Picture::new`].
    pub fn from_fn(width: usize, height: usize, mut colour: impl FnMut(usize, usize) -> Rgb) -> Picture {
        let mut picture = Picture::new(width, height, BLACK);
        for (y, row) in picture.rgb.chunks_exact_mut(picture.width).enumerate() {
            row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = colour(x, y));
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
        self.index(x, y).map(|at| self.rgb[at])
    }

    /// Colours a pixel.
    pub fn put(&mut self, x: usize, y: usize, colour: Rgb) {
        if let Some(at) = self.index(x, y) {
            self.rgb[at] = colour;
        }
    }

    fn index(&self, x: usize, y: usize) -> Option<usize> {
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }

    /// Fills the rectangle from (`x`, `y`), `width` x `height` pixels.
    pub fn rect(&mut self, x: usize, y: usize, width: usize, height: usize, colour: Rgb) {
        let (left, right) = (x.min(self.width), x.saturating_add(width).min(self.width));
        for y in y..y.saturating_add(height).min(self.height) {
            self.rgb[y * self.width + left..y * self.width + right].fill(colour);
        }
    }

    /// Copies `other` with its upper left corner at (`x`, `y`).
    pub fn blit(&mut self, x: usize, y: usize, other: &Picture) {
        let width = other.width.min(self.width.saturating_sub(x));
        for dy in 0..other.height.min(self.height.saturating_sub(y)) {
            let (from, to) = (dy * other.width, (y + dy) * self.width + x);
            self.rgb[to..to + width].copy_from_slice(&other.rgb[from..from + width]);
        }
    }

    /// Draws a line through `points`, `width` pixels wide. Dashes and the gaps between them are as
    /// long as `dashes` says, by turns, pixels; without any the line is whole.
    pub fn line(&mut self, points: &[(f32, f32)], width: f32, dashes: &[f32], colour: Rgb) {
        let mut path = vec![];
        for (i, &point) in points.iter().enumerate() {
            path.push(if i == 0 { Command::MoveTo(point.into()) } else { Command::LineTo(point.into()) });
        }
        let mut stroke = Stroke::new(width);
        stroke.join(Join::Round).dash(dashes, 0.0);
        self.ink(Mask::new(&path).style(stroke), colour);
    }

    /// Draws a disc around (`x`, `y`).
    pub fn dot(&mut self, (x, y): (f32, f32), radius: f32, colour: Rgb) {
        let mut path: Vec<Command> = vec![];
        path.add_circle((x, y), radius);
        self.ink(&mut Mask::new(&path), colour);
    }

    /// Colours what a mask covers; pixels that it covers in part are mixed.
    pub(super) fn ink(&mut self, mask: &mut Mask<'_, '_, &Vec<Command>>, colour: Rgb) {
        let (cover, place) = mask.render();
        let (left, top) = (place.left as isize, place.top as isize);
        for (y, cover) in (top..).zip(cover.chunks_exact((place.width as usize).max(1))) {
            let Some(y) = usize::try_from(y).ok().filter(|y| *y < self.height) else { continue };
            let row = &mut self.rgb[y * self.width..][..self.width];
            // what lies to the left of the picture is left out
            let pixels = row.iter_mut().skip(left.max(0) as usize);
            for (pixel, &part) in pixels.zip(cover.iter().skip((-left).max(0) as usize)) {
                match part {
                    0 => {}
                    u8::MAX => *pixel = colour,
                    _ => *pixel = mixed(*pixel, colour, f32::from(part) / 255.0),
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
            self.rgb[from(y, height, self.height) * self.width + from(x, width, self.width)]
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
        // all others would take as long as all else that `segment` does, or longer
        encoder.set_compression(png::Compression::Fastest);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("a PNG header in memory");
        writer.write_image_data(self.rgb.as_flattened()).expect("PNG data in memory");
        writer.finish().expect("a PNG end in memory");
        bytes
    }
}

/// Returns the mixture of two colours, from `a` where `part` is 0 to `b` where it is 1.
pub fn mixed(a: Rgb, b: Rgb, part: f32) -> Rgb {
    [0, 1, 2].map(|c| (f32::from(a[c]) * (1.0 - part) + f32::from(b[c]) * part).round() as u8)
}
