//! Drawings of lines, text and pictures, as SVG and as pixels.
//!
//! The SVG is also fit to stand in a web page: text and axes have the page's colour, and its style
//! sheet can give others to the classes `paper` (background) and `s0`, `s1`, ... (curves).

use std::fmt::Write;

use crate::picture::{Anchor, Picture, Rgb, TextStyle, WHITE, mixed};

/// Size of text, units.
const TEXT: f64 = 12.0;

/// Of text and axes, where a page has no other.
const INK: Rgb = [0x22; 3];

/// How much of a grid line is ink.
const GRID: f32 = 0.15;

/// Colours and dashes of curves, by style; from the palette of Okabe and Ito, which the
/// colour-blind can tell apart.
const STYLES: [(Rgb, &[f32]); 4] = [
    ([0x00, 0x72, 0xb2], &[]),
    ([0xd5, 0x5e, 0x00], &[7.0, 3.0]),
    ([0x00, 0x87, 0x63], &[2.0, 2.0]),
    ([0xb3, 0x5a, 0x90], &[9.0, 2.0, 2.0, 2.0]),
];

fn style(number: usize) -> (Rgb, &'static [f32]) {
    STYLES[number % STYLES.len()]
}

/// A drawing on white. Units are pixels at a scale of 1; text is 12 of them high.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Units.
    pub width: f64,
    /// Units.
    pub height: f64,
    /// For readers who cannot see it.
    title: String,
    shapes: Vec<Shape>,
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Text { at: (f64, f64), anchor: Anchor, upright: bool, text: String },
    Grid { from: (f64, f64), to: (f64, f64) },
    Curve { style: usize, points: Vec<(f64, f64)> },
    Dot { style: usize, at: (f64, f64) },
    Picture { at: (f64, f64), picture: Picture },
}

impl Drawing {
    /// Returns an empty sheet; `title` is for readers who cannot see it.
    pub fn new(width: f64, height: f64, title: &str) -> Drawing {
        Drawing { width, height, title: title.to_string(), shapes: vec![] }
    }

    /// A line of text with its base line at `at`.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        self.shapes.push(Shape::Text { at, anchor, upright: false, text: text.to_string() });
    }

    /// A line of text that reads from below upwards, its middle at `at`.
    pub fn upright(&mut self, at: (f64, f64), text: &str) {
        self.shapes.push(Shape::Text { at, anchor: Anchor::Middle, upright: true, text: text.to_string() });
    }

    /// A thin pale line.
    pub fn grid(&mut self, from: (f64, f64), to: (f64, f64)) {
        self.shapes.push(Shape::Grid { from, to });
    }

    /// A curve in one of the styles.
    pub fn curve(&mut self, style: usize, points: &[(f64, f64)]) {
        self.shapes.push(Shape::Curve { style, points: points.to_vec() });
    }

    /// Dots in one of the styles.
    pub fn dots(&mut self, style: usize, points: &[(f64, f64)]) {
        self.shapes.extend(points.iter().map(|&at| Shape::Dot { style, at }));
    }

    /// A picture with its upper left corner at `at`; its pixels are units.
    pub fn picture(&mut self, at: (f64, f64), picture: Picture) {
        self.shapes.push(Shape::Picture { at, picture });
    }

    /// Returns the drawing as an SVG file.
    pub fn svg(&self) -> String {
        let Drawing { width, height, title, shapes } = self;
        let shapes: String = shapes.iter().map(Shape::svg).collect();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" color=\"{}\" fill=\"none\" font-family=\"'DejaVu Sans', Verdana, sans-serif\" font-size=\"{TEXT}\">\n\
             <title>{}</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{shapes}</svg>\n",
            name(INK),
            escaped(title)
        )
    }

    /// Returns the drawing as pixels, `scale` of them per unit, above 0.
    pub fn pixels(&self, scale: f64) -> Picture {
        let side = |units: f64| (units * scale).round() as usize;
        let mut pixels = Picture::new(side(self.width), side(self.height), WHITE);
        self.shapes.iter().for_each(|shape| shape.draw(&mut pixels, scale));
        pixels
    }
}

impl Shape {
    fn svg(&self) -> String {
        let mut svg = String::new();
        // writing to a string does not fail
        let _ = match self {
            Shape::Text { at: (x, y), anchor, upright, text } => {
                let place = match upright {
                    true => format!("transform=\"translate({x:.1} {y:.1}) rotate(-90)\""),
                    false => format!("x=\"{x:.1}\" y=\"{y:.1}\""),
                };
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let text = escaped(text);
                writeln!(svg, "<text {place} text-anchor=\"{anchor}\" fill=\"currentColor\">{text}</text>")
            }
            Shape::Grid { from, to } => {
                let line = format!("M{:.1} {:.1}L{:.1} {:.1}", from.0, from.1, to.0, to.1);
                writeln!(svg, "<path d=\"{line}\" stroke=\"currentColor\" stroke-opacity=\"{GRID}\"/>")
            }
            Shape::Curve { style: number, points } => {
                let path = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect::<Vec<_>>().join("L");
                let (colour, dashes) = style(*number);
                let dashes = dashes.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
                let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
                writeln!(
                    svg,
                    "<path class=\"s{number}\" d=\"M{path}\" stroke=\"{}\" stroke-width=\"2\" stroke-linejoin=\"round\"{dashes}/>",
                    name(colour)
                )
            }
            // a line without length and with round ends
            Shape::Dot { style: number, at: (x, y) } => writeln!(
                svg,
                "<path class=\"s{number}\" d=\"M{x:.1} {y:.1}h0\" stroke=\"{}\" stroke-width=\"6\" stroke-linecap=\"round\"/>",
                name(style(*number).0)
            ),
            Shape::Picture { at: (x, y), picture } => {
                use base64::prelude::{BASE64_STANDARD, Engine};
                let (width, height, data) =
                    (picture.width(), picture.height(), BASE64_STANDARD.encode(picture.to_png()));
                writeln!(
                    svg,
                    "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" image-rendering=\"optimizeSpeed\" \
                     style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>"
                )
            }
        };
        svg
    }

    fn draw(&self, pixels: &mut Picture, scale: f64) {
        let at = |(x, y): (f64, f64)| ((scale * x) as f32, (scale * y) as f32);
        match self {
            Shape::Text { at: place, anchor, upright, text } => {
                let style = TextStyle::new((scale * TEXT) as f32, INK);
                pixels.text(at(*place), TextStyle { anchor: *anchor, upright: *upright, ..style }, text);
            }
            Shape::Grid { from, to } => {
                pixels.line(&[at(*from), at(*to)], scale as f32, &[], mixed(WHITE, INK, GRID));
            }
            Shape::Curve { style: number, points } => {
                let (colour, dashes) = style(*number);
                let points: Vec<_> = points.iter().map(|point| at(*point)).collect();
                let dashes: Vec<_> = dashes.iter().map(|length| length * scale as f32).collect();
                pixels.line(&points, 2.0 * scale as f32, &dashes, colour);
            }
            Shape::Dot { style: number, at: place } => pixels.dot(at(*place), 3.0 * scale as f32, style(*number).0),
            Shape::Picture { at: (x, y), picture } => {
                let [x, y, width, height] = [*x, *y, picture.width() as f64, picture.height() as f64]
                    .map(|units| (scale * units).round() as usize);
                pixels.blit(x, y, &picture.scaled(width, height));
            }
        }
    }
}

/// Returns a colour as SVG and HTML have it.
fn name([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as it may stand in SVG and HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
