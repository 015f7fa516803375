//! Charts: a grid of panels. Those of a row share its y axis, all share the x axis.

use crate::experiment::drawing::Drawing;
use crate::picture::{Anchor, text_width};

/// Between panels.
const GAP: (f64, f64) = (30.0, 26.0);
/// For labels to the left, for half a label above, to the right, below.
const MARGINS: (f64, f64, f64, f64) = (62.0, 8.0, 18.0, 46.0);
/// For the legend, and for titles.
const LEGEND: f64 = 24.0;
const TITLES: f64 = 24.0;
/// A panel of [`Chart::parts`].
const PART: (f64, f64) = (260.0, 190.0);

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
    /// Returns the whole chart.
    pub fn drawing(&self) -> Drawing {
        let (left, _, right, below) = MARGINS;
        let above = self.above();
        let column_x = |column: usize| left + column as f64 * (self.panel.0 + GAP.0);
        let row_y = |row: usize| above + row as f64 * (self.panel.1 + GAP.1);
        let legend = left + self.legend.iter().map(|name| legend_width(name)).sum::<f64>();
        let width = (column_x(self.columns.len()) - GAP.0 + right).max(legend);
        let height = row_y(self.rows.len()) - GAP.1 + below;
        let mut drawing = Drawing::new(width, height, &self.title);
        self.draw_legend(&mut drawing, left);
        for (column, title) in self.columns.iter().enumerate() {
            drawing.text((column_x(column) + self.panel.0 / 2.0, above - 10.0), Anchor::Middle, title);
        }
        for (number, row) in self.rows.iter().enumerate() {
            let (top, last) = (row_y(number), number + 1 == self.rows.len());
            drawing.upright((16.0, top + self.panel.1 / 2.0), &row.y.label);
            for (tick, name) in &row.y.ticks {
                let y = top + self.panel.1 * (1.0 - row.y.place(*tick)) + 4.0;
                drawing.text((left - 6.0, y), Anchor::End, name);
            }
            for (column, curves) in row.panels.iter().enumerate() {
                self.panel(&mut drawing, (column_x(column), top), &row.y, curves, last);
            }
        }
        let middle = (left + column_x(self.columns.len()) - GAP.0) / 2.0;
        drawing.text((middle, height - 8.0), Anchor::Middle, &self.x.label);
        drawing
    }

    /// Returns each panel as a chart of its own, row by row, for narrow pages. They have no legend.
    pub fn parts(&self) -> Vec<Vec<Chart>> {
        let part = |y: &Axis, column: &String, curves: &Vec<Curve>| Chart {
            columns: vec![column.clone()],
            rows: vec![Row { y: y.clone(), panels: vec![curves.clone()] }],
            panel: PART,
            legend: vec![],
            ..self.clone()
        };
        let named = |row: &Row| {
            let panels = self.columns.iter().zip(&row.panels);
            panels.map(|(name, curves)| part(&row.y, name, curves)).collect()
        };
        self.rows.iter().map(named).collect()
    }

    /// Returns the legend alone.
    pub fn legend(&self) -> Drawing {
        let width = self.legend.iter().map(|name| legend_width(name)).sum::<f64>();
        let mut drawing = Drawing::new(width.ceil(), 28.0, &self.legend.join(", "));
        self.draw_legend(&mut drawing, 0.0);
        drawing
    }

    fn draw_legend(&self, drawing: &mut Drawing, mut x: f64) {
        for (style, name) in self.legend.iter().enumerate() {
            drawing.curve(style, &[(x, 16.0), (x + 30.0, 16.0)]);
            drawing.text((x + 36.0, 20.0), Anchor::Start, name);
            x += legend_width(name);
        }
    }

    /// What stands above the panels: a legend, titles.
    fn above(&self) -> f64 {
        let legend = if self.legend.is_empty() { 0.0 } else { LEGEND };
        let titles = if self.columns.iter().all(String::is_empty) { 0.0 } else { TITLES };
        MARGINS.1 + legend + titles
    }

    /// A panel with its upper left corner at `corner`; `last` in the column has the ticks of x
    /// below.
    fn panel(&self, drawing: &mut Drawing, corner: (f64, f64), y: &Axis, curves: &[Curve], last: bool) {
        let at_x = |value| corner.0 + self.panel.0 * self.x.place(value);
        let at_y = |value| corner.1 + self.panel.1 * (1.0 - y.place(value));
        let (right, bottom) = (corner.0 + self.panel.0, corner.1 + self.panel.1);
        for (tick, _) in &y.ticks {
            drawing.grid((corner.0, at_y(*tick)), (right, at_y(*tick)));
        }
        for (tick, name) in &self.x.ticks {
            drawing.grid((at_x(*tick), corner.1), (at_x(*tick), bottom));
            if last {
                drawing.text((at_x(*tick), bottom + 16.0), Anchor::Middle, name);
            }
        }
        for curve in curves {
            let points: Vec<_> = curve.points.iter().map(|&(x, y)| (at_x(x), at_y(y))).collect();
            drawing.curve(curve.style, &points);
            if self.dots {
                drawing.dots(curve.style, &points);
            }
        }
    }
}

fn legend_width(name: &str) -> f64 {
    62.0 + f64::from(text_width(12.0, name).ceil())
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
        insta::assert_snapshot!(chart().drawing().svg());
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
        let pixels = chart().drawing().pixels(2.0);
        let pixel = |x: f64, y: f64| pixels.get((2.0 * x) as usize, (2.0 * y) as usize).unwrap();
        let (left, above) = (MARGINS.0, chart().above());
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
