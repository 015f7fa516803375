//! Charts as SVG, and any SVG as PNG. A chart is a grid of panels: those of a row share its y axis,
//! all share the x axis.
//!
//! The SVG is also fit to stand in a web page: text and axes have the page's colour, and its style
//! sheet can give others to the classes `paper` (background) and `s0`, `s1`, ... (curves).

use std::fmt::Write;
use std::sync::Arc;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Between panels.
const GAP: (f64, f64) = (30.0, 26.0);
/// For labels to the left, above (legend and titles), to the right, below.
const MARGINS: (f64, f64, f64, f64) = (62.0, 56.0, 18.0, 46.0);

/// Colours and dashes of curves, by style; from the palette of Okabe and Ito, which the
/// colour-blind can tell apart.
const STYLES: [(&str, &str); 4] = [("#0072b2", ""), ("#d55e00", "7 3"), ("#008763", "2 2"), ("#b35a90", "9 2 2 2")];

/// How values become places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; values are above 0.
    Logarithmic,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// How.
    pub scale: Scale,
    /// From its first value to its last; values beyond are drawn at its end.
    pub span: (f64, f64),
    /// Values with a grid line, and what stands there.
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// Returns a linear axis from 0 to `max` or a little more, with ticks at round numbers. A `max`
    /// of 0 or less is 1.
    pub fn up_to(label: &str, max: f64) -> Axis {
        let max = if max > 0.0 { max } else { 1.0 };
        let decade = 10f64.powf((max / 5.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|x| x * decade).into_iter().find(|step| max / step <= 6.0);
        let step = step.unwrap_or(10.0 * decade);
        let ticks = (0..=(max / step - 1e-9).ceil() as usize).map(|i| i as f64 * step);
        Axis::linear(label, &ticks.collect::<Vec<_>>())
    }

    /// Returns a linear axis with these ticks, rising, two or more.
    pub fn linear(label: &str, ticks: &[f64]) -> Axis {
        let named: Vec<_> = ticks.iter().map(|tick| (*tick, ((tick * 1e6).round() / 1e6).to_string())).collect();
        Axis { label: label.to_string(), scale: Scale::Linear, span: (ticks[0], ticks[ticks.len() - 1]), ticks: named }
    }

    /// Returns where on the axis a value is, 0 at its start, 1 at its end.
    fn place(&self, value: f64) -> f64 {
        let by = |x: f64| if self.scale == Scale::Logarithmic { x.log10() } else { x };
        let (from, to) = (by(self.span.0), by(self.span.1));
        ((by(value) - from) / (to - from)).clamp(0.0, 1.0)
    }
}

/// Points joined by a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Which of the legend's entries.
    pub style: usize,
    /// x and y, along the curve.
    pub points: Vec<(f64, f64)>,
}

/// Panels that share a y axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The axis.
    pub y: Axis,
    /// The curves of each panel.
    pub panels: Vec<Vec<Curve>>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// For readers who cannot see it.
    pub title: String,
    /// The x axis.
    pub x: Axis,
    /// Above the panels of the first row, one each.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
    /// Width and height of a panel, units of the SVG.
    pub panel: (f64, f64),
    /// Names of the styles 0, 1, ...
    pub legend: Vec<String>,
    /// Whether points are marked by dots.
    pub dots: bool,
}

impl Chart {
    /// Returns the chart as an SVG file.
    pub fn svg(&self) -> String {
        let (left, above, right, below) = MARGINS;
        let column_x = |column: usize| left + column as f64 * (self.panel.0 + GAP.0);
        let row_y = |row: usize| above + row as f64 * (self.panel.1 + GAP.1);
        let legend_width = |name: &String| 62.0 + 7.0 * name.chars().count() as f64;
        let legend = left + self.legend.iter().map(legend_width).sum::<f64>();
        let width = (column_x(self.columns.len()) - GAP.0 + right).max(legend);
        let height = row_y(self.rows.len()) - GAP.1 + below;
        let mut svg = Svg::new(width, height, &self.title);
        let mut x = left;
        for (style, name) in self.legend.iter().enumerate() {
            svg.curve(style, &[(x, 16.0), (x + 30.0, 16.0)]);
            svg.text(x + 36.0, 20.0, "start", name);
            x += legend_width(name);
        }
        for (column, title) in self.columns.iter().enumerate() {
            svg.text(column_x(column) + self.panel.0 / 2.0, above - 10.0, "middle", title);
        }
        for (number, row) in self.rows.iter().enumerate() {
            let (top, last) = (row_y(number), number + 1 == self.rows.len());
            svg.upright(16.0, top + self.panel.1 / 2.0, &row.y.label);
            for (tick, name) in &row.y.ticks {
                svg.text(left - 6.0, top + self.panel.1 * (1.0 - row.y.place(*tick)) + 4.0, "end", name);
            }
            for (column, curves) in row.panels.iter().enumerate() {
                self.panel(&mut svg, (column_x(column), top), &row.y, curves, last);
            }
        }
        svg.text((left + column_x(self.columns.len()) - GAP.0) / 2.0, height - 8.0, "middle", &self.x.label);
        svg.finish()
    }

    /// A panel with its upper left corner at `corner`; `last` in the column has the ticks of x
    /// below.
    fn panel(&self, svg: &mut Svg, corner: (f64, f64), y: &Axis, curves: &[Curve], last: bool) {
        let at_x = |value| corner.0 + self.panel.0 * self.x.place(value);
        let at_y = |value| corner.1 + self.panel.1 * (1.0 - y.place(value));
        let (right, bottom) = (corner.0 + self.panel.0, corner.1 + self.panel.1);
        for (tick, _) in &y.ticks {
            svg.grid((corner.0, at_y(*tick)), (right, at_y(*tick)));
        }
        for (tick, name) in &self.x.ticks {
            svg.grid((at_x(*tick), corner.1), (at_x(*tick), bottom));
            if last {
                svg.text(at_x(*tick), bottom + 16.0, "middle", name);
            }
        }
        for curve in curves {
            let points: Vec<_> = curve.points.iter().map(|&(x, y)| (at_x(x), at_y(y))).collect();
            svg.curve(curve.style, &points);
            if self.dots {
                svg.dots(curve.style, &points);
            }
        }
    }
}

/// An SVG file in the making. Units are pixels at a scale of 1; text is 12 of them high.
pub struct Svg(String);

impl Svg {
    /// Returns an empty sheet, white; `title` is for readers who cannot see it.
    pub fn new(width: f64, height: f64, title: &str) -> Svg {
        Svg(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" color=\"#222\" fill=\"none\" font-family=\"'DejaVu Sans', Verdana, sans-serif\" font-size=\"12\">\n\
             <title>{}</title>\n<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
            escaped(title)
        ))
    }

    /// A line of text; `anchor` is `start`, `middle` or `end`.
    pub fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"currentColor\">{text}</text>"
        );
    }

    /// A line of text that reads from below upwards, its middle at (x, y).
    fn upright(&mut self, x: f64, y: f64, text: &str) {
        let text = escaped(text);
        let turn = format!("translate({x:.1} {y:.1}) rotate(-90)");
        let _ =
            writeln!(self.0, "<text transform=\"{turn}\" text-anchor=\"middle\" fill=\"currentColor\">{text}</text>");
    }

    fn grid(&mut self, from: (f64, f64), to: (f64, f64)) {
        let line = format!("M{:.1} {:.1}L{:.1} {:.1}", from.0, from.1, to.0, to.1);
        let _ = writeln!(self.0, "<path d=\"{line}\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/>");
    }

    fn curve(&mut self, style: usize, points: &[(f64, f64)]) {
        let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        let (colour, dashes) = STYLES[style % STYLES.len()];
        let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dashes}\"") };
        let path = path.join("L");
        let _ = writeln!(
            self.0,
            "<path class=\"s{style}\" d=\"M{path}\" stroke=\"{colour}\" stroke-width=\"2\" stroke-linejoin=\"round\"{dashes}/>"
        );
    }

    fn dots(&mut self, style: usize, points: &[(f64, f64)]) {
        let colour = STYLES[style % STYLES.len()].0;
        for (x, y) in points {
            // a line without length and with round ends
            let _ = writeln!(
                self.0,
                "<path class=\"s{style}\" d=\"M{x:.1} {y:.1}h0\" stroke=\"{colour}\" stroke-width=\"6\" stroke-linecap=\"round\"/>"
            );
        }
    }

    /// A PNG file as a picture, `width` x `height` units, upper left corner at (x, y).
    pub fn picture(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), png: &[u8]) {
        use base64::prelude::{BASE64_STANDARD, Engine};
        let data = BASE64_STANDARD.encode(png);
        let _ = writeln!(
            self.0,
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" image-rendering=\"optimizeSpeed\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>"
        );
    }

    /// Returns the file.
    pub fn finish(mut self) -> String {
        self.0 += "</svg>\n";
        self.0
    }
}

/// Text as it may stand in SVG and HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns a PNG file of an SVG of this module, `scale` pixels per unit, above 0.
///
/// # Panics
/// If it is no SVG, or too large to be drawn.
pub fn png(svg: &str, scale: f32) -> Vec<u8> {
    // The font comes with the program: none needs to be installed.
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options).expect("an SVG of our own");
    let size = tree.size().to_int_size().scale_by(scale).expect("a scale above 0");
    let mut pixels = Pixmap::new(size.width(), size.height()).expect("a size that can be drawn");
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().expect("a PNG in memory")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let curve = |style, points: &[(f64, f64)]| Curve { style, points: points.to_vec() };
        Chart {
            title: "small & known".to_string(),
            x: Axis::linear("tolerance", &[0.5, 1.0]),
            columns: vec!["5 mm".to_string()],
            rows: vec![Row {
                y: Axis::up_to("correct, %", 40.0),
                panels: vec![vec![curve(0, &[(0.5, 40.0), (1.0, 0.0)]), curve(1, &[(0.75, 20.0), (1.0, 90.0)])]],
            }],
            panel: (100.0, 80.0),
            legend: vec!["edge".to_string(), "region".to_string()],
            dots: false,
        }
    }

    #[test]
    fn a_small_chart_to_the_letter() {
        insta::assert_snapshot!(chart().svg());
    }

    #[test]
    fn ticks_are_round_and_few() {
        let ticks = |max| Axis::up_to("", max).ticks.into_iter().map(|(_, name)| name).collect::<Vec<_>>().join(" ");
        assert_eq!(ticks(43.0), "0 10 20 30 40 50");
        assert_eq!(ticks(100.0), "0 20 40 60 80 100");
        assert_eq!(ticks(0.3), "0 0.05 0.1 0.15 0.2 0.25 0.3");
        assert_eq!(ticks(900.0), "0 200 400 600 800 1000");
        assert_eq!(ticks(0.0), "0 0.2 0.4 0.6 0.8 1");
    }

    #[test]
    fn a_logarithmic_axis_spaces_decades_evenly() {
        let axis = Axis { label: String::new(), scale: Scale::Logarithmic, span: (1e4, 1e6), ticks: vec![] };
        assert_eq!([1e4, 1e5, 1e6, 1e7].map(|x| (1e3 * axis.place(x)).round()), [0.0, 500.0, 1000.0, 1000.0]);
    }

    #[test]
    fn the_picture_has_text_and_curves_where_the_chart_has() {
        let bytes = png(&chart().svg(), 2.0);
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut rgba = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgba).unwrap();
        let pixel = |x: f64, y: f64| {
            let i = 4 * ((2.0 * y) as usize * info.width as usize + (2.0 * x) as usize);
            [rgba[i], rgba[i + 1], rgba[i + 2]]
        };
        let (left, above, ..) = MARGINS;
        let (width, height) = chart().panel;
        // a quarter along the first curve; shortly before the end of the second, which lies beyond
        // the axis
        assert_eq!(pixel(left + width / 4.0, above + height / 4.0), [0x00, 0x72, 0xb2]);
        assert_eq!(pixel(left + width - 2.0, above + 1.6), [0xd5, 0x5e, 0x00]);
        assert_eq!(pixel(1.0, 1.0), [255; 3]);
        // the legend's words are there: dark pixels right of the first line of the legend
        let dark = (100..126)
            .flat_map(|x| (8..24).map(move |y| (x, y)))
            .filter(|&(x, y)| pixel(f64::from(x), f64::from(y))[0] < 128);
        assert!(dark.count() > 20);
    }
}
