//! `scanseg segment`: a range image in; labels, edges, bearing angles, lists and an overview out.

use std::path::PathBuf;

use clap::Args;
use indicatif::ProgressBar;
use scanseg_core::{AnyConfig, Approach, EdgeConfig, Trace};
use scanseg_formats::GreyImage;
use scanseg_sim::export::Segmented;
use scanseg_sim::overview::{Images, overview};
use scanseg_sim::segmentation::{Segmentation, SegmentationError, bearing_image};

use crate::command::exports::ExportOptions;
use crate::command::input::{Input, ScanArguments};
use crate::command::lists::{Entry, Header, Listing};
use crate::command::noise;
use crate::command::options::{Configuration, Options, in_terms_of_options};
use crate::command::output::{Failure, Files, bar, print, warn, write};
use crate::command::{planes, warnings};

/// From so many points on a bar shows the progress.
const LONG_SCAN: usize = 1_000_000;

/// Segment a range image
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    scan: ScanArguments,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    lists: ListOptions,
    #[command(flatten)]
    options: Options,
}

/// What is written of a segmentation.
#[derive(Args)]
pub struct ListOptions {
    #[command(flatten)]
    exports: ExportOptions,
    /// Smaller segments are left out of labels.png and of the lists
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    min_pixels: u32,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let input = arguments.scan.read()?;
    let config = arguments.options.config(&input.geometry)?;
    let (files, summary) = segment(&input, config, &arguments.options, &arguments.lists)?;
    write(&arguments.out, &files)?;
    print(&summary)
}

/// Segments a range image. Returns the files to write, and what to print. Warns of what looks
/// wrong.
pub fn segment(
    input: &Input,
    config: AnyConfig<'_>,
    options: &Options,
    lists: &ListOptions,
) -> Result<(Files, String), Failure> {
    let (rows, columns) = (input.ranges.rows, input.ranges.columns);
    let runs = if config.approach() == Approach::Edge { 3 } else { 1 };
    let bar = if rows * columns > LONG_SCAN { bar(runs * rows) } else { ProgressBar::hidden() };
    let run = |config: AnyConfig<'_>| {
        Segmentation::of(&input.ranges, &input.geometry, config, options.max_labels(), || bar.inc(1))
            .map_err(|e| in_terms_of_options(&input.name, e))
    };
    let segmentation = run(config)?;
    let seconds = segmentation.core_time.as_secs_f64();
    let edges = match config {
        AnyConfig::Edge(config) => edges_along_rows_and_columns(config, run)?,
        _ => vec![],
    };
    bar.finish_and_clear();

    let numbers = segmentation.numbers(lists.min_pixels);
    let stated = options.states_noise(&input.geometry);
    let segmented = Segmented {
        image: &input.ranges,
        geometry: &input.geometry,
        ranging: &config.ranging(),
        range_noise_m: if stated { &[] } else { &segmentation.range_noise_m },
        numbers: &numbers,
        segments: segmentation.of_pixels(lists.min_pixels),
    };
    let mut listing = listing(input, &config, &segmentation, lists.min_pixels);
    listing.set_planarities(&segmented.planarities());
    let labels_png = labels_png(input, &numbers, &listing)?;
    let [horizontal, vertical, diagonal, antidiagonal] =
        bearing_images(input, &config, [Trace::ROW, Trace::COLUMN, Trace::DIAGONAL, Trace::ANTIDIAGONAL])?;
    let images = Images {
        bearing_rows: &horizontal,
        bearing_columns: &vertical,
        edges: &titled(config.approach(), &edges, &segmentation),
        closed_edges: &segmentation.closed_edges,
        numbers: &numbers,
    };
    let grey = |max_value, values| GreyImage { rows, columns, max_value, values }.to_png();
    let edges_png = grey(255, segmentation.closed_edges.iter().map(|&edge| if edge { 255 } else { 0 }).collect());
    let files = [
        ("overview.png", overview(&input.ranges, &input.geometry, &images).to_png()),
        ("labels.png", labels_png),
        ("edges.png", edges_png),
        ("bearing-horizontal.png", grey(65535, horizontal)),
        ("bearing-vertical.png", grey(65535, vertical)),
        ("bearing-diagonal.png", grey(65535, diagonal)),
        ("bearing-antidiagonal.png", grey(65535, antidiagonal)),
        ("segments.csv", listing.csv()),
        ("segments.json", listing.json()?),
    ];
    let per_point_ns = 1e9 * seconds / (rows * columns) as f64;
    let mut all = warnings::of_scan(input, &config, stated);
    all.extend(warnings::of_result(&input.name, &config, stated, options.max_labels(), &segmentation));
    all.iter().for_each(|warning| warn(warning));
    let (table, noise, ms) = (listing.table(), noise::used(&config, stated, segmentation.noise), 1e3 * seconds);
    let weak = planes::weak(segmentation.of_pixels(lists.min_pixels)).unwrap_or_default();
    let remarks = input.remarks();
    let summary = format!("{remarks}{table}{weak}{noise}\nthe core took {ms:.1} ms, {per_point_ns:.0} ns per point\n");
    let mut files: Files = files.map(|(name, bytes)| (name.to_string(), bytes)).into();
    files.extend(lists.exports.files(&segmented)?);
    Ok((files, summary))
}

/// Returns the edges of the traces along rows alone, and of those along columns alone: of the
/// traces of the configuration, or of those between neighbours if it has none that way.
fn edges_along_rows_and_columns(
    config: EdgeConfig<'_>,
    run: impl Fn(AnyConfig<'_>) -> Result<Segmentation, Failure>,
) -> Result<Vec<Vec<bool>>, Failure> {
    let edges_of = |usual: Trace, is_along: fn(&Trace) -> bool| -> Result<Vec<bool>, Failure> {
        let mut traces: Vec<Trace> = config.traces.iter().copied().filter(is_along).collect();
        if traces.is_empty() {
            traces.push(usual);
        }
        Ok(run(config.with_traces(&traces).into())?.edges)
    };
    let along_rows = edges_of(Trace::ROW, |trace| trace.rows == 0)?;
    let along_columns = edges_of(Trace::COLUMN, |trace| trace.columns == 0)?;
    Ok(vec![along_rows, along_columns])
}

/// Returns the images of edges with their titles.
fn titled<'a>(
    approach: Approach,
    along: &'a [Vec<bool>],
    segmentation: &'a Segmentation,
) -> Vec<(&'static str, &'a [bool])> {
    let (edges, closed_edges) = (&segmentation.edges[..], &segmentation.closed_edges[..]);
    match approach {
        Approach::Edge => {
            let titles = ["Edges along rows", "Edges along columns", "Edges of all traces", "Edges after closing"];
            titles.into_iter().zip(along.iter().map(Vec::as_slice).chain([edges, closed_edges])).collect()
        }
        Approach::Plane => vec![("Pixels on no plane", closed_edges)],
        Approach::Region => vec![("Where lines begin", edges), ("Pixels on no line", closed_edges)],
    }
}

fn bearing_images<const N: usize>(
    input: &Input,
    config: &AnyConfig<'_>,
    traces: [Trace; N],
) -> Result<[Vec<u16>; N], SegmentationError> {
    let mut images = [const { vec![] }; N];
    for (image, trace) in images.iter_mut().zip(traces) {
        *image = bearing_image(&input.ranges, &input.geometry, &config.ranging(), trace)?;
    }
    Ok(images)
}

fn listing(input: &Input, config: &AnyConfig<'_>, segmentation: &Segmentation, min_pixels: u32) -> Listing {
    let ranging = config.ranging();
    let listed = segmentation.of_pixels(min_pixels);
    let is_return = |range_m: &&f32| (ranging.min_range_m..=ranging.max_range_m).contains(*range_m);
    let returns = input.ranges.range_m.iter().filter(is_return).count();
    Listing {
        header: Header {
            rows: segmentation.rows,
            columns: segmentation.columns,
            returns,
            outside_limits: input.ranges.range_m.iter().filter(|&&range_m| range_m > 0.0).count() - returns,
            edge_pixels: segmentation.closed_edges.iter().filter(|&&edge| edge).count(),
            segment_pixels: segmentation.segments.iter().map(|s| s.pixels() as usize).sum(),
            unlabelled_pixels: segmentation.unlabelled,
            segments_found: segmentation.segments.len(),
            segments_listed: listed.len(),
            min_pixels,
            configuration: Configuration::new(config),
        },
        segments: (1..).zip(listed).map(|(number, segment)| Entry::new(number, segment)).collect(),
    }
}

/// Returns the image of the segments' numbers. Its 16 bits must do for them.
fn labels_png(input: &Input, numbers: &[u32], listing: &Listing) -> Result<Vec<u8>, Failure> {
    let Header { rows, columns, segments_listed: found, min_pixels, .. } = listing.header;
    if found > usize::from(u16::MAX) {
        let what = format!("{found} segments of {min_pixels} pixels or more are too many for labels.png (65535)");
        return Err(format!("{}: {what}: use a larger --min-pixels", input.name).into());
    }
    let values = numbers.iter().map(|&number| number as u16).collect();
    Ok(GreyImage { rows, columns, max_value: 65535, values }.to_png())
}
