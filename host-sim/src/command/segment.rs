//! `scanseg segment`: a range image in; labels, pictures, points, bearing angles and lists out.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::ProgressBar;
use scanseg_core::{AnyConfig, Approach, EdgeConfig, Trace};
use scanseg_formats::{Geometry, GreyImage, RangeImage};
use scanseg_sim::export::{Segmented, planarities_of, point_m, points};
use scanseg_sim::parallel::in_parallel;
use scanseg_sim::segmentation::{Segmentation, SegmentationError, bearing_image};
use scanseg_sim::view;

use crate::command::exports::ExportOptions;
use crate::command::input::{Input, ScanArguments};
use crate::command::lists::{Entry, Header, Listing};
use crate::command::noise;
use crate::command::opened::open;
use crate::command::options::{Configuration, Options, in_terms_of_options};
use crate::command::output::{Failure, Files, bar, print, warn, write};
use crate::command::shown::Shown;
use crate::command::{planes, warnings};

/// From so many points on a bar shows the progress.
const LONG_SCAN: usize = 1_000_000;

/// The page with the segments in 3D.
const VIEW: &str = "view.html";

/// Segment a range image
///
/// Writes, into one folder: segments.csv and segments.json, a segment a line, `label` its value in
/// labels.png; labels.png, edges.png (not by planes) and bearing-*.png, pixel by pixel as the scan;
/// segments.png, overlay.png (segments over the ranges) and overview.png, up being up and left
/// being left as the scanner sees them; points.ply, the returns as points with colour and label.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    scan: ScanArguments,
    /// Of a file with several scans all of them, each into a folder of its own: DIR/frame-0, DIR/frame-1, ...
    #[arg(long, conflicts_with_all = ["frame", "open"])]
    all_frames: bool,
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
    /// Also write view.html, a page with the segments in 3D that needs no other file, and open it
    #[arg(long)]
    open: bool,
}

impl ListOptions {
    /// Returns what is written where nothing more was asked for.
    pub fn usual(min_pixels: u32) -> ListOptions {
        ListOptions { exports: ExportOptions::default(), min_pixels, open: false }
    }

    /// Opens the page in a folder of results, if that was asked for.
    pub fn open(&self, folder: &Path) -> Result<(), Failure> {
        if self.open { open(&folder.join(VIEW)) } else { Ok(()) }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begun = Instant::now();
    if !arguments.all_frames {
        let input = arguments.scan.read()?;
        return segment_into(&arguments.out, &input, begun.elapsed(), arguments);
    }
    let mut inputs = arguments.scan.all()?;
    let bar = bar(inputs.len());
    loop {
        let begun = Instant::now();
        let Some(input) = inputs.next() else { break };
        let ((n, input), reading) = (input?, begun.elapsed());
        bar.suspend(|| segment_into(&arguments.out.join(format!("frame-{n}")), &input, reading, arguments))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

/// Segments a scan, writes the results, and prints what was found and what each part took; `reading` is
/// what it took to read the scan.
fn segment_into(out: &Path, input: &Input, reading: Duration, arguments: &Arguments) -> Result<(), Failure> {
    let config = arguments.options.config(&input.geometry)?;
    let begun = Instant::now();
    let (files, mut summary) = segment(input, config, &arguments.options, &arguments.lists)?;
    let (segmenting, begun) = (begun.elapsed(), Instant::now());
    write(out, &files)?;
    let [reading, segmenting, writing] = [reading, segmenting, begun.elapsed()].map(|time| 1e3 * time.as_secs_f64());
    let _ = writeln!(
        summary,
        "read in {reading:.1} ms, segmented and drawn in {segmenting:.1} ms, written to the disk in {writing:.1} ms"
    );
    if arguments.all_frames {
        return print(&format!("{}\n{summary}", out.display()));
    }
    print(&summary)?;
    arguments.lists.open(out)
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
    // bearing angles do not wait for the segments
    let (segmentation, bearings) = thread::scope(|threads| {
        let bearings = threads.spawn(|| bearing_images(input, &config));
        (run(config), bearings.join())
    });
    let (segmentation, bearings) = (segmentation?, bearings.expect("bearing angles of any scan")?);
    let seconds = segmentation.core_time.as_secs_f64();
    let edges = match config {
        AnyConfig::Edge(config) => edges_along_rows_and_columns(config, run)?,
        _ => vec![],
    };
    bar.finish_and_clear();

    let labels = segmentation.numbers(lists.min_pixels);
    let stated = options.states_noise(&input.geometry);
    let returns = input.returns(&config.ranging());
    let segmented = Segmented {
        image: &returns,
        geometry: &input.geometry,
        ranging: &config.ranging(),
        range_noise_m: if stated { &[] } else { &segmentation.range_noise_m },
        labels: &labels,
        segments: segmentation.of_pixels(lists.min_pixels),
    };
    let mut listing = listing(input, &config, &segmentation, &labels, lists.min_pixels);
    listing.set_planarities(&planarities_of(&segmented));
    check_labels(input, &listing)?;
    let shown =
        Shown { input, scan: &returns, config: &config, segmentation: &segmentation, labels: &labels, along: &edges };
    let legend = listing.legend();
    let made: [(&str, &(dyn Fn() -> Vec<u8> + Sync)); 6] = [
        ("overview.png", &|| shown.overview([&bearings[0].counts, &bearings[1].counts]).to_png()),
        ("segments.png", &|| shown.segments(&legend).to_png()),
        ("overlay.png", &|| shown.overlay(&legend).to_png()),
        ("points.ply", &|| points::ply(&segmented)),
        ("labels.png", &|| labels_png(rows, columns, &labels)),
        ("segments.csv", &|| listing.csv()),
    ];
    let bytes = in_parallel(made.len(), |i| made[i].1());
    let mut files: Vec<_> = made.iter().map(|(name, _)| *name).zip(bytes).collect();
    if config.approach() != Approach::Plane {
        let edges = segmentation.closed_edges.iter().map(|&edge| if edge { 255 } else { 0 });
        files.push(("edges.png", GreyImage { rows, columns, max_value: 255, values: edges.collect() }.to_png()));
    }
    files.extend(bearings.into_iter().map(|image| (image.name, image.png)));
    files.push(("segments.json", listing.json()?));
    let per_point_ns = 1e9 * seconds / (rows * columns) as f64;
    let mut all = warnings::of_scan(input, &config, stated);
    all.extend(warnings::of_result(&input.name, &config, stated, options.max_labels(), &segmentation));
    all.iter().for_each(|warning| warn(warning));
    let (table, noise, ms) = (listing.table(), noise::used(&config, stated, segmentation.noise), 1e3 * seconds);
    let weak = planes::weak(segmentation.of_pixels(lists.min_pixels)).unwrap_or_default();
    let remarks = input.remarks();
    let summary = format!("{remarks}{table}{weak}{noise}\nthe core took {ms:.1} ms, {per_point_ns:.0} ns per point\n");
    let mut files: Files = files.into_iter().map(|(name, bytes)| (name.to_string(), bytes)).collect();
    files.extend(lists.exports.files(&segmented)?);
    if lists.open {
        files.push((VIEW.to_string(), view::html(&input.name, &segmented)?.into_bytes()));
    }
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

/// Bearing angles along a trace, as a file as well.
struct Bearings {
    name: &'static str,
    counts: Vec<u16>,
    png: Vec<u8>,
}

/// Returns the bearing angles along the usual traces, those along rows and along columns first.
fn bearing_images(input: &Input, config: &AnyConfig<'_>) -> Result<Vec<Bearings>, SegmentationError> {
    let (rows, columns, max_value) = (input.ranges.rows, input.ranges.columns, 65535);
    let along = |(name, trace)| -> Result<Bearings, SegmentationError> {
        let counts = bearing_image(&input.ranges, &input.geometry, &config.ranging(), trace)?;
        let image = GreyImage { rows, columns, max_value, values: counts };
        Ok(Bearings { name, png: image.to_png(), counts: image.values })
    };
    let traces = [
        ("bearing-horizontal.png", Trace::ROW),
        ("bearing-vertical.png", Trace::COLUMN),
        ("bearing-diagonal.png", Trace::DIAGONAL),
        ("bearing-antidiagonal.png", Trace::ANTIDIAGONAL),
    ];
    traces.into_iter().map(along).collect()
}

fn listing(
    input: &Input,
    config: &AnyConfig<'_>,
    segmentation: &Segmentation,
    labels: &[u32],
    min_pixels: u32,
) -> Listing {
    let ranging = config.ranging();
    let listed = segmentation.of_pixels(min_pixels);
    let is_return = |range_m: &&f32| (ranging.min_range_m..=ranging.max_range_m).contains(*range_m);
    let returns = input.ranges.range_m.iter().filter(is_return).count();
    let centroids_m = centroids_m(&input.ranges, &input.geometry, labels, listed.len());
    let entries = (1..).zip(listed).zip(centroids_m);
    Listing {
        approach: config.approach(),
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
        segments: entries.map(|((label, segment), centroid_m)| Entry::new(label, segment, centroid_m)).collect(),
    }
}

/// Returns the mean of the points of each label from 1 to `count`.
fn centroids_m(ranges: &RangeImage, geometry: &Geometry, labels: &[u32], count: usize) -> Vec<[f32; 3]> {
    let mut sums = vec![([0.0; 3], 0.0); count + 1];
    for (i, (&label, &range_m)) in labels.iter().zip(&ranges.range_m).enumerate().filter(|(_, (label, _))| **label > 0)
    {
        let (sum, points) = &mut sums[label as usize];
        let point_m = point_m(geometry, i / ranges.columns, i % ranges.columns, range_m);
        sum.iter_mut().zip(point_m).for_each(|(sum, metres)| *sum += metres);
        *points += 1.0;
    }
    sums[1..].iter().map(|(sum, points)| sum.map(|sum| (sum / points) as f32)).collect()
}

/// Checks that the 16 bits of labels.png do for the segments.
fn check_labels(input: &Input, listing: &Listing) -> Result<(), Failure> {
    let Header { segments_listed: found, min_pixels, .. } = listing.header;
    if found > usize::from(u16::MAX) {
        let what = format!("{found} segments of {min_pixels} pixels or more are too many for labels.png (65535)");
        return Err(format!("{}: {what}: use a larger --min-pixels", input.name).into());
    }
    Ok(())
}

/// Returns the image of the segments' labels.
fn labels_png(rows: usize, columns: usize, labels: &[u32]) -> Vec<u8> {
    let values = labels.iter().map(|&label| label as u16).collect();
    GreyImage { rows, columns, max_value: 65535, values }.to_png()
}
