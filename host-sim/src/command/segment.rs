//! `scanseg segment`: a range image in; labels, edges, bearing angles, lists and an overview out.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use scanseg_core::{Config, Trace};
use scanseg_sim::format::GreyImage;
use scanseg_sim::overview::{Images, overview};
use scanseg_sim::segmentation::{Approach, Segmentation, SegmentationError, bearing_image};

use super::lists::{Entry, Header, Listing};
use super::options::{Configuration, Options, in_terms_of_options};
use super::{Failure, Files, Scan, print, write};

/// From so many points on a bar shows the progress.
const LONG_SCAN: usize = 1_000_000;

/// Segment a range image
#[derive(Args)]
pub struct Arguments {
    /// Range image: grey PGM (P5) or PNG
    scan: PathBuf,
    /// Its geometry file (TOML)
    #[arg(long, value_name = "FILE")]
    geometry: PathBuf,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    options: Options,
}

/// What is written of a segmentation.
#[derive(Args)]
pub struct Output {
    /// Smaller segments are left out of labels.png and of the lists
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    min_pixels: u32,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scan = Scan::read(&arguments.scan, &arguments.geometry)?;
    arguments.options.check()?;
    let config = arguments.options.config(&scan.geometry);
    let (files, summary) =
        segment(&scan, arguments.options.approach(), &config, arguments.options.max_labels(), &arguments.output)?;
    write(&arguments.out, &files)?;
    print(&summary)
}

/// Segments a scan: the files to write, and what to print.
pub fn segment(
    scan: &Scan,
    approach: Approach,
    config: &Config<'_>,
    max_labels: Option<usize>,
    output: &Output,
) -> Result<(Files, String), Failure> {
    let (rows, columns) = (scan.ranges.rows, scan.ranges.columns);
    let runs = if approach == Approach::Edge { 3 } else { 1 };
    let bar = if rows * columns > LONG_SCAN { bar(runs * rows) } else { ProgressBar::hidden() };
    let run = |config: &Config<'_>| {
        Segmentation::of(&scan.ranges, &scan.geometry, approach, config, max_labels, || bar.inc(1))
            .map_err(|e| in_terms_of_options(&scan.name, e))
    };
    let started = Instant::now();
    let segmentation = run(config)?;
    let seconds = started.elapsed().as_secs_f64();
    // the traces of the configuration along rows and along columns, those between neighbours if it has none
    let traces = |usual: Trace, along: fn(&Trace) -> bool| {
        let some: Vec<Trace> = config.traces.iter().copied().filter(along).collect();
        if some.is_empty() { vec![usual] } else { some }
    };
    let edges_along = |usual, along| Ok::<_, Failure>(run(&Config { traces: &traces(usual, along), ..*config })?.edges);
    let (edges_rows, edges_columns);
    let edges: &[(&str, &[bool])] = match approach {
        Approach::Edge => {
            edges_rows = edges_along(Trace::ROW, |t| t.rows == 0)?;
            edges_columns = edges_along(Trace::COLUMN, |t| t.columns == 0)?;
            &[
                ("Edges along rows", &edges_rows),
                ("Edges along columns", &edges_columns),
                ("Edges of all traces", &segmentation.edges),
                ("Edges after closing", &segmentation.closed_edges),
            ]
        }
        Approach::Plane => &[("Pixels on no plane", &segmentation.closed_edges)],
        Approach::Region => {
            &[("Where lines begin", &segmentation.edges), ("Pixels on no line", &segmentation.closed_edges)]
        }
    };
    bar.finish_and_clear();

    let listed = segmentation.of_pixels(output.min_pixels);
    let grey = |max_value, values| GreyImage { rows, columns, max_value, values }.to_png();
    let numbers = segmentation.numbers(output.min_pixels);
    if listed.len() > usize::from(u16::MAX) {
        let (found, min_pixels) = (listed.len(), output.min_pixels);
        let what = format!("{found} segments of {min_pixels} pixels or more are too many for labels.png (65535)");
        return Err(format!("{}: {what}: use a larger --min-pixels", scan.name).into());
    }
    let labels_png = grey(65535, numbers.iter().map(|&n| n as u16).collect());
    let edges_png = grey(255, segmentation.closed_edges.iter().map(|&edge| if edge { 255 } else { 0 }).collect());

    let bearing =
        |trace| -> Result<Vec<u16>, SegmentationError> { bearing_image(&scan.ranges, &scan.geometry, config, trace) };
    let [horizontal, vertical] = [bearing(Trace::ROW)?, bearing(Trace::COLUMN)?];
    let listing = Listing {
        header: Header {
            rows,
            columns,
            returns: scan
                .ranges
                .range_m
                .iter()
                .filter(|m| (config.min_range_m..=config.max_range_m).contains(m))
                .count(),
            edge_pixels: segmentation.closed_edges.iter().filter(|&&edge| edge).count(),
            segment_pixels: segmentation.segments.iter().map(|s| s.pixels() as usize).sum(),
            unlabelled_pixels: segmentation.unlabelled,
            segments_found: segmentation.segments.len(),
            segments_listed: listed.len(),
            min_pixels: output.min_pixels,
            configuration: Configuration::new(approach, config),
        },
        segments: (1..).zip(listed).map(|(number, segment)| Entry::new(number, segment)).collect(),
    };
    let images = Images {
        bearing_rows: &horizontal,
        bearing_columns: &vertical,
        edges,
        closed_edges: &segmentation.closed_edges,
        numbers: &numbers,
    };
    let files = [
        ("overview.png", overview(&scan.ranges, &scan.geometry, &images).to_png()),
        ("labels.png", labels_png),
        ("edges.png", edges_png),
        ("bearing-horizontal.png", grey(65535, horizontal)),
        ("bearing-vertical.png", grey(65535, vertical)),
        ("bearing-diagonal.png", grey(65535, bearing(Trace::DIAGONAL)?)),
        ("bearing-antidiagonal.png", grey(65535, bearing(Trace::ANTIDIAGONAL)?)),
        ("segments.csv", listing.csv()),
        ("segments.json", listing.json()?),
    ];
    let per_point_ns = 1e9 * seconds / (rows * columns) as f64;
    let summary = format!("{}segmented in {:.1} ms, {per_point_ns:.0} ns per point\n", listing.table(), 1e3 * seconds);
    Ok((files.map(|(name, bytes)| (name.to_string(), bytes)).into(), summary))
}

/// A bar on stderr; nothing is drawn where that is no terminal.
pub fn bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("segmenting {wide_bar} {percent} %, {eta} left");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
