//! The figures of the paper from the results, numbered as there; and one of the cost.

use crate::experiment::chart::{Axis, Chart, Curve, Row, Scale};
use crate::experiment::counts::Counts;
use crate::experiment::drawing::Drawing;
use crate::experiment::method::TOLERANCES;
use crate::experiment::results::Results;
use crate::overview::{Frame, NO_RETURN, View, range_title, usual_ranges_m};
use crate::picture::{Anchor, Picture, label_colour, range_colour};

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Of its files, without the ending.
    pub name: &'static str,
    /// What it shows.
    pub caption: String,
    /// The figure in one piece.
    pub whole: Drawing,
    /// The same in rows of pieces that a page may put below each other where it is narrow.
    pub parts: Vec<Vec<Drawing>>,
    /// What the curves of all pieces mean.
    pub legend: Option<Drawing>,
    /// Pixels of the PNG per unit of the drawing.
    pub scale: f64,
}

/// All figures in order.
pub fn figures(results: &Results) -> Vec<Figure> {
    vec![scene(results), correct(results), missed(results), split(results), cost(results)]
}

/// Fig. 6. Without a mark for edges: what is in no segment is dark.
fn scene(results: &Results) -> Figure {
    const GAP: f64 = 8.0;
    let sample = &results.sample;
    let scan = &sample.scan;
    let frame = Frame::of(View::of(&sample.geometry, scan.rows, scan.columns), scan.rows, scan.columns);
    let (near_m, far_m) = usual_ranges_m(scan);
    let labels = |label: &dyn Fn(usize) -> u32| {
        frame.picture(|i| if scan.range_m[i] > 0.0 { label_colour(label(i)) } else { NO_RETURN })
    };
    let truth = labels(&|i| u32::from(sample.truth[i]));
    let depth = frame.picture(|i| match scan.range_m[i] {
        0.0 => NO_RETURN,
        range_m => range_colour(range_m, near_m, far_m),
    });
    let mut rows = vec![vec![("ground truth".to_string(), truth), (range_title(near_m, far_m).to_lowercase(), depth)]];
    for (method, by_noise) in results.methods.iter().zip(&sample.numbers) {
        let titled = by_noise.iter().zip(&results.noises_mm);
        rows.push(titled.map(|(n, mm)| (format!("{method}, {}", noise_name(*mm)), labels(&|i| n[i]))).collect());
    }

    let (wide, high) = (frame.width as f64 + GAP, TITLE + frame.height as f64 + GAP);
    let across = rows.iter().map(Vec::len).max().unwrap_or(1) as f64;
    let title = "A simulated office, its depth, and the segments of each method";
    let mut whole = Drawing::new(GAP + across * wide, GAP + rows.len() as f64 * high, title);
    let mut parts = vec![];
    for (j, row) in rows.into_iter().enumerate() {
        let mut drawings = vec![];
        for (i, (title, picture)) in row.into_iter().enumerate() {
            let mut part = Drawing::new(frame.width as f64, TITLE + frame.height as f64, &title);
            titled(&mut part, (0.0, 0.0), &title, picture.clone());
            drawings.push(part);
            titled(&mut whole, (GAP + i as f64 * wide, GAP + j as f64 * high), &title, picture);
        }
        parts.push(drawings);
    }
    let caption = format!(
        "A sample scene (number {}): ground truth, range, and the output of each method at each level of noise. Grey is \
         in no segment, pale blue returned nothing.",
        sample.scene
    );
    Figure { name: "scene", caption, whole, parts, legend: None, scale: 1.0 }
}

/// For the title above a picture.
const TITLE: f64 = 20.0;

fn titled(drawing: &mut Drawing, (x, y): (f64, f64), title: &str, picture: Picture) {
    drawing.text((x, y + TITLE - 7.0), Anchor::Start, title);
    drawing.picture((x, y + TITLE), picture);
}

/// Returns the figure of a chart.
fn of_chart(name: &'static str, chart: &Chart) -> Figure {
    let parts = chart.parts().iter().map(|row| row.iter().map(Chart::drawing).collect()).collect();
    let legend = Some(chart.legend());
    Figure { name, caption: chart.title.clone(), whole: chart.drawing(), parts, legend, scale: 2.0 }
}

/// Fig. 7.
fn correct(results: &Results) -> Figure {
    let caption = "Correctly segmented regions over the tolerance T: the part that a segment and a truth region must \
         share of both.";
    over_tolerance(results, "correct", caption, &[("correct, % of truth regions", |c| c.correct)])
}

/// Fig. 8.
fn missed(results: &Results) -> Figure {
    let caption = "Truth regions that no segment matches (above), and segments that match no truth region (below; they \
         can be more than there are truth regions).";
    let classes: [Class; 2] =
        [("missed, % of truth regions", |c| c.missed), ("noise, % of truth regions", |c| c.noise)];
    over_tolerance(results, "missed", caption, &classes)
}

/// Fig. 9.
fn split(results: &Results) -> Figure {
    let caption =
        "Truth regions found as several segments (above), and segments that hold several truth regions (below).";
    let classes: [Class; 2] = [
        ("over-segm., % of truth regions", |c| c.over_segmented),
        ("under-segm., % of truth regions", |c| c.under_segmented),
    ];
    over_tolerance(results, "split", caption, &classes)
}

/// Label of the axis, and what is counted.
type Class = (&'static str, fn(&Counts) -> usize);

/// Returns a row of panels for each class, a panel for each level of noise, a curve for each
/// method.
fn over_tolerance(results: &Results, name: &'static str, caption: &str, classes: &[Class]) -> Figure {
    let row = |&(label, class): &Class| {
        let curve = |method, noise_mm| {
            let points = TOLERANCES.map(|percent| {
                let counts = results.counts(method, noise_mm, percent);
                (f64::from(percent) / 100.0, counts.percent(class(&counts)))
            });
            Curve { style: method, points: points.collect() }
        };
        let curves = |&mm: &u32| (0..results.methods.len()).map(|method| curve(method, mm)).collect::<Vec<_>>();
        let panels: Vec<_> = results.noises_mm.iter().map(curves).collect();
        let values = panels.iter().flatten().flat_map(|curve| &curve.points).map(|point| point.1);
        Row { y: Axis::up_to(label, values.fold(0.0, f64::max)), panels }
    };
    let chart = Chart {
        title: caption.to_string(),
        x: Axis::linear("tolerance T", &[0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        columns: results.noises_mm.iter().map(|&mm| noise_name(mm)).collect(),
        rows: classes.iter().map(row).collect(),
        panel: (230.0, 190.0),
        legend: results.methods.iter().map(|name| name.to_string()).collect(),
        dots: false,
    };
    of_chart(name, &chart)
}

/// Ours: the paper says O(n) and shows nothing.
fn cost(results: &Results) -> Figure {
    let curve = |style| {
        let costs = results.costs.iter().filter(|cost| cost.method == style);
        Curve { style, points: costs.map(|cost| (cost.points() as f64, cost.instructions_per_point)).collect() }
    };
    let curves: Vec<_> = (0..results.methods.len()).map(curve).collect();
    let most = results.costs.iter().map(|cost| cost.instructions_per_point).fold(0.0, f64::max);
    let caption = "Processor instructions per point over the number of points, one scene in several resolutions. Where \
         a curve is level, the cost is linear in the number of points; where it falls, less.";
    let chart = Chart {
        title: caption.to_string(),
        x: Axis {
            label: "points".to_string(),
            scale: Scale::Logarithmic,
            span: (8e3, 1.2e6),
            ticks: [(1e4, "10 000"), (1e5, "100 000"), (1e6, "1 million")]
                .map(|(x, name)| (x, name.to_string()))
                .into(),
        },
        columns: vec![String::new()],
        rows: vec![Row { y: Axis::up_to("instructions per point", most), panels: vec![curves] }],
        panel: (480.0, 240.0),
        legend: results.methods.iter().map(|name| name.to_string()).collect(),
        dots: true,
    };
    of_chart("cost", &chart)
}

fn noise_name(noise_mm: u32) -> String {
    if noise_mm == 0 { "no noise".to_string() } else { format!("{noise_mm} mm noise") }
}
