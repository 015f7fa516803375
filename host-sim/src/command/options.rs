//! The options that every segmenting subcommand takes: the configuration, value by value.

use clap::{Args, ValueEnum};
use scanseg_core::{AnyConfig, Approach, ConfigError, EdgeConfig, Element, PlaneConfig, Ranging, RegionConfig, Trace};
use scanseg_formats::{Geometry, SENSORS, Sensor};
use scanseg_sim::segmentation::{self, SegmentationError};
use serde::Serialize;

use crate::command::input::with_page;
use crate::command::output::Failure;

#[derive(Args)]
pub struct Options {
    /// Settings to start from
    #[arg(long, value_enum, default_value = "default")]
    preset: Preset,
    /// How the scan is segmented [default: as the other options need it, or that of the preset]
    #[arg(long, value_enum)]
    approach: Option<ApproachOption>,
    /// Standard deviation of one range, metres [default: that of the geometry file; else measured
    /// in the scan, or, by edges and by regions, 0.01]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub range_noise_m: Option<f64>,
    /// Take the errors of this sensor in place of those of the geometry file
    #[arg(long, value_name = "NAME", value_parser = parse_sensor)]
    sensor: Option<Sensor>,
    /// Nearer ranges count as no return [default: that of the geometry file, or of the preset]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    min_range_m: Option<f64>,
    /// Farther ranges count as no return [default: that of the geometry file, or of the preset]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    max_range_m: Option<f64>,
    /// Edge-based: a roof edge is where the bearing angle turns by this much or more [default: of
    /// the preset]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    roof_angle_deg: Option<f32>,
    /// Edge-based: a step edge needs a bearing angle within this of 0 or 180 degrees [default: of
    /// the preset]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    step_angle_deg: Option<f32>,
    /// Edge-based: comma list of row, column, diagonal, antidiagonal or ROWSxCOLUMNS back to the
    /// previous pixel, such as 0x3 or 2x-2; each may be made longer by a factor, as in row*3
    /// [default: of the preset]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_trace)]
    traces: Vec<Trace>,
    /// Edge-based: structuring element of the closing [default: of the preset]
    #[arg(long, value_enum)]
    closing: Option<Closing>,
    /// Region-based: a line of a row ends where the bearing angle turns by this much or more
    /// [default: of the preset]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    line_angle_deg: Option<f32>,
    /// Region-based: surfaces may be this far from a plane, besides the noise [default: of the
    /// preset]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    plane_distance_m: Option<f32>,
    /// Size of the table of live labels [default: enough for any image; by planes twice the columns]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_labels: Option<u32>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Preset {
    /// Planes that go on from row to row: right at the noise of real scanners, nothing to set but
    /// the noise
    Default,
    /// The paper's edge-based method, see EdgeConfig::paper
    Paper,
}

#[derive(Clone, Copy, ValueEnum)]
enum ApproachOption {
    /// By planes that go on from row to row
    Plane,
    /// By edges in bearing-angle images
    Edge,
    /// By growing regions from the lines of each row
    Region,
}

#[derive(Clone, Copy, ValueEnum)]
enum Closing {
    /// A pixel and its four neighbours
    Plus,
    /// 3 x 3 pixels
    Square,
}

impl Options {
    /// Returns the configuration for a scan of this geometry. Refuses a value that the approach
    /// does not use.
    pub fn config(&self, geometry: &Geometry) -> Result<AnyConfig<'_>, Failure> {
        let approach = self.approach();
        if let Some((option, needed)) = self.given().find(|&(_, needed)| needed != approach) {
            return Err(format!("{option} needs --approach {}", name(needed)).into());
        }
        let ranging = self.ranging(geometry, approach);
        Ok(match approach {
            Approach::Plane => PlaneConfig::new(ranging).into(),
            Approach::Edge => self.edge_config(ranging).into(),
            Approach::Region => self.region_config(ranging).into(),
        })
    }

    /// Returns the geometry with the errors that the options state in place of its own.
    fn stated(&self, geometry: &Geometry) -> Geometry {
        let mut stated = geometry.clone();
        if let Some(sensor) = &self.sensor {
            (stated.range_noise_m, stated.noise) = (Some(sensor.range_noise_m()), sensor.noise());
        }
        stated.range_noise_m = self.range_noise_m.or(stated.range_noise_m);
        stated
    }

    /// Returns whether anything is stated of the noise of the ranges.
    pub fn states_noise(&self, geometry: &Geometry) -> bool {
        segmentation::states_noise(&self.stated(geometry))
    }

    fn ranging(&self, geometry: &Geometry, approach: Approach) -> Ranging {
        let ranging = segmentation::ranging_of(&self.stated(geometry), approach);
        segmentation::limited(ranging, self.min_range_m, self.max_range_m)
    }

    fn edge_config(&self, ranging: Ranging) -> EdgeConfig<'_> {
        let paper = EdgeConfig::paper();
        let traces = if self.traces.is_empty() { paper.traces } else { &self.traces };
        let closing = match self.closing {
            Some(Closing::Plus) => Element::Plus,
            Some(Closing::Square) => Element::Square,
            None => paper.closing,
        };
        paper
            .with_ranging(ranging)
            .with_traces(traces)
            .with_roof_angle_rad(self.roof_angle_deg.map_or(paper.roof_angle_rad, f32::to_radians))
            .with_step_angle_rad(self.step_angle_deg.map_or(paper.step_angle_rad, f32::to_radians))
            .with_closing(closing)
    }

    fn region_config(&self, ranging: Ranging) -> RegionConfig {
        let paper = RegionConfig::paper();
        paper
            .with_ranging(ranging)
            .with_line_angle_rad(self.line_angle_deg.map_or(paper.line_angle_rad, f32::to_radians))
            .with_plane_distance_m(self.plane_distance_m.unwrap_or(paper.plane_distance_m))
    }

    /// Returns the approach that is named, or else the one that the given values belong to, or else
    /// that of the preset.
    fn approach(&self) -> Approach {
        match (self.approach, self.preset) {
            (Some(ApproachOption::Plane), _) => Approach::Plane,
            (Some(ApproachOption::Edge), _) => Approach::Edge,
            (Some(ApproachOption::Region), _) => Approach::Region,
            (None, preset) => match (self.given().next(), preset) {
                (Some((_, approach)), _) => approach,
                (None, Preset::Default) => Approach::Plane,
                (None, Preset::Paper) => Approach::Edge,
            },
        }
    }

    /// Returns the options given that belong to one approach.
    fn given(&self) -> impl Iterator<Item = (&'static str, Approach)> {
        [
            ("--roof-angle-deg", Approach::Edge, self.roof_angle_deg.is_some()),
            ("--step-angle-deg", Approach::Edge, self.step_angle_deg.is_some()),
            ("--traces", Approach::Edge, !self.traces.is_empty()),
            ("--closing", Approach::Edge, self.closing.is_some()),
            ("--line-angle-deg", Approach::Region, self.line_angle_deg.is_some()),
            ("--plane-distance-m", Approach::Region, self.plane_distance_m.is_some()),
        ]
        .into_iter()
        .filter_map(|(option, approach, given)| given.then_some((option, approach)))
    }

    pub fn max_labels(&self) -> Option<usize> {
        self.max_labels.map(|n| n as usize)
    }
}

fn parse_sensor(name: &str) -> Result<Sensor, String> {
    Sensor::named(name).ok_or_else(|| format!("not one of {}", SENSORS.map(|sensor| sensor.name).join(", ")))
}

/// `row`, `2x-2`, `column*3`.
fn parse_trace(text: &str) -> Result<Trace, String> {
    let (name, factor) = text.split_once('*').unwrap_or((text, "1"));
    let factor: u8 = factor.parse().map_err(|_| format!("`{factor}` is not a whole number from 1 to 255"))?;
    let trace = match name {
        "row" => Trace::ROW,
        "column" => Trace::COLUMN,
        "diagonal" => Trace::DIAGONAL,
        "antidiagonal" => Trace::ANTIDIAGONAL,
        _ => {
            let offsets = name.split_once('x').and_then(|(r, c)| Some((r.parse().ok()?, c.parse().ok()?)));
            let (rows, columns) =
                offsets.ok_or("not row, column, diagonal, antidiagonal or ROWSxCOLUMNS (0 to 16 x -128 to 127)")?;
            Trace { rows, columns }
        }
    };
    let long = trace.times(factor);
    let exact = i32::from(long.rows) == i32::from(trace.rows) * i32::from(factor)
        && i32::from(long.columns) == i32::from(trace.columns) * i32::from(factor);
    if factor > 0 && exact { Ok(long) } else { Err(format!("a factor of {factor} is 0 or too long")) }
}

fn name(approach: Approach) -> &'static str {
    match approach {
        Approach::Plane => "plane",
        Approach::Edge => "edge",
        Approach::Region => "region",
    }
}

/// Names the option that a refused configuration value came from, or else the scan.
pub fn in_terms_of_options(scan: &str, e: SegmentationError) -> Failure {
    let config_error = match &e {
        SegmentationError::Config(config_error) => config_error,
        SegmentationError::Geometry(e) => return with_page(&format!("{scan}: {e}")),
        _ => return format!("{scan}: {e}").into(),
    };
    match *config_error {
        ConfigError::Value { field: "roof_angle_rad", value } => {
            format!("--roof-angle-deg cannot be {}", value.to_degrees()).into()
        }
        ConfigError::Value { field: "step_angle_rad", value } => {
            format!("--step-angle-deg cannot be {}", value.to_degrees()).into()
        }
        ConfigError::Value { field: "line_angle_rad", value } => {
            format!("--line-angle-deg cannot be {}", value.to_degrees()).into()
        }
        ConfigError::Value {
            field: field @ ("plane_distance_m" | "range_noise_m" | "min_range_m" | "max_range_m"),
            value,
        } => format!("--{} cannot be {value}", field.replace('_', "-")).into(),
        ConfigError::Count { field: "traces", value } => format!("--traces: {value} are too many").into(),
        ConfigError::Count { field: field @ ("traces.rows" | "traces.columns"), value } => {
            format!("--traces cannot go back {value} {}", field.trim_start_matches("traces.")).into()
        }
        _ => with_page(&format!("{scan}: its geometry: {config_error}")),
    }
}

/// A configuration as the lists of segments state it. The settings of other approaches are those of
/// the paper.
#[derive(Serialize)]
pub struct Configuration {
    approach: &'static str,
    range_noise_m: f32,
    pub min_range_m: f32,
    pub max_range_m: f32,
    roof_angle_deg: f32,
    step_angle_deg: f32,
    traces: Vec<String>,
    closing: &'static str,
    line_angle_deg: f32,
    plane_distance_m: f32,
}

impl Configuration {
    pub fn new(config: &AnyConfig<'_>) -> Self {
        let ranging = config.ranging();
        let edge = if let AnyConfig::Edge(config) = config { *config } else { EdgeConfig::paper() };
        let region = if let AnyConfig::Region(config) = config { *config } else { RegionConfig::paper() };
        Configuration {
            approach: name(config.approach()),
            range_noise_m: ranging.range_noise_m,
            min_range_m: ranging.min_range_m,
            max_range_m: ranging.max_range_m,
            roof_angle_deg: edge.roof_angle_rad.to_degrees(),
            step_angle_deg: edge.step_angle_rad.to_degrees(),
            traces: edge.traces.iter().map(|t| format!("{}x{}", t.rows, t.columns)).collect(),
            closing: match edge.closing {
                Element::Plus => "plus",
                Element::Square => "square",
            },
            line_angle_deg: region.line_angle_rad.to_degrees(),
            plane_distance_m: region.plane_distance_m,
        }
    }
}
