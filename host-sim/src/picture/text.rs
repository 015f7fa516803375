//! Text in pictures, in DejaVu Sans, which comes with the program: no font needs to be installed.

use std::sync::LazyLock;

use ttf_parser::{Face, OutlineBuilder};
use zeno::{Angle, Command, Join, Mask, Stroke, Transform};

use crate::picture::canvas::{Picture, Rgb};

static FACE: LazyLock<Face<'static>> =
    LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).expect("the font that comes along"));

/// What of a line of text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a line of text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Size of the font, pixels; capitals are 0.73 of it high.
    pub size: f32,
    /// What stands at the place of the text.
    pub anchor: Anchor,
    /// Colour of the letters.
    pub colour: Rgb,
    /// Colour of a seam around the letters, to read them on any ground.
    pub halo: Option<Rgb>,
    /// Whether it reads from below upwards.
    pub upright: bool,
}

impl TextStyle {
    /// Returns text from left to right that starts at its place, without a seam.
    pub const fn new(size: f32, colour: Rgb) -> TextStyle {
        TextStyle { size, anchor: Anchor::Start, colour, halo: None, upright: false }
    }
}

/// Returns the width of a line of text in a font of this size, pixels.
pub fn text_width(size: f32, text: &str) -> f32 {
    text.chars().map(|character| advance(size, character)).sum()
}

fn advance(size: f32, character: char) -> f32 {
    let glyph = FACE.glyph_index(character).unwrap_or_default();
    f32::from(FACE.glyph_hor_advance(glyph).unwrap_or(0)) * size / f32::from(FACE.units_per_em())
}

impl Picture {
    /// Writes one line of text with its base line at (`x`, `y`). Characters that the font does not
    /// have are boxes.
    pub fn text(&mut self, (x, y): (f32, f32), style: TextStyle, text: &str) {
        let before = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => text_width(style.size, text) / 2.0,
            Anchor::End => text_width(style.size, text),
        };
        let scale = style.size / f32::from(FACE.units_per_em());
        let mut outline = Outline { path: vec![], left: -before, scale };
        for character in text.chars() {
            // a blank has no outline
            let _ = FACE.outline_glyph(FACE.glyph_index(character).unwrap_or_default(), &mut outline);
            outline.left += advance(style.size, character);
        }
        let turn = Transform::rotation(Angle::from_degrees(if style.upright { -90.0 } else { 0.0 }));
        let place = Some(turn.then_translate(x, y));
        if let Some(halo) = style.halo {
            let mut seam = Stroke::new(style.size / 4.0);
            seam.join(Join::Round);
            self.ink(Mask::new(&outline.path).transform(place).style(seam), halo);
        }
        self.ink(Mask::new(&outline.path).transform(place), style.colour);
    }
}

/// Outlines of letters, one after another on a base line at y = 0.
struct Outline {
    path: Vec<Command>,
    left: f32,
    scale: f32,
}

impl Outline {
    fn at(&self, x: f32, y: f32) -> zeno::Point {
        (self.left + self.scale * x, -self.scale * y).into()
    }
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.push(Command::MoveTo(self.at(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.push(Command::LineTo(self.at(x, y)));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.push(Command::QuadTo(self.at(x1, y1), self.at(x, y)));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.push(Command::CurveTo(self.at(x1, y1), self.at(x2, y2), self.at(x, y)));
    }

    fn close(&mut self) {
        self.path.push(Command::Close);
    }
}
