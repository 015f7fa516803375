//! Segments as lists: CSV, JSON, and a table for the terminal.

use std::fmt::Write;

use scanseg_core::{Approach, Plane, Segment};
use scanseg_sim::export::{Planarity, Verdict};
use scanseg_sim::overview::Line;
use serde::Serialize;

use crate::command::options::Configuration;
use crate::command::output::Failure;

/// Segments that the table and the legend show.
const LINES: usize = 12;

/// What `segments.json` holds.
#[derive(Serialize)]
pub struct Listing {
    #[serde(skip)]
    pub approach: Approach,
    pub header: Header,
    pub segments: Vec<Entry>,
}

/// About the scan as a whole.
#[derive(Serialize)]
pub struct Header {
    pub rows: usize,
    pub columns: usize,
    /// Pixels with a return, within the limits of the range.
    pub returns: usize,
    /// Counts that are ranges outside of those limits: no returns.
    pub outside_limits: usize,
    /// Pixels of edges after the closing.
    pub edge_pixels: usize,
    /// Pixels in segments of whatever size.
    pub segment_pixels: usize,
    /// Pixels that got no label because the table of live labels was full.
    pub unlabelled_pixels: u32,
    /// Segments of whatever size.
    pub segments_found: usize,
    /// Segments listed.
    pub segments_listed: usize,
    /// Smaller segments are not listed.
    pub min_pixels: u32,
    pub configuration: Configuration,
}

/// A segment; without a plane (`null`) where its points do not make one.
#[derive(Serialize)]
pub struct Entry {
    /// Its value in `labels.png`.
    pub label: u32,
    pub pixels: u32,
    pub first_row: u16,
    pub last_row: u16,
    pub first_column: u16,
    pub last_column: u16,
    /// Mean of its points, each of which counts the same.
    pub centroid_m: [f32; 3],
    pub normal: Option<[f32; 3]>,
    pub distance_m: Option<f32>,
    pub rms_m: Option<f32>,
    /// `rms_m` over what the noise alone makes it; about 1 of a plane.
    pub residual_per_noise: Option<f32>,
    /// What that means: `planar`, `rough` or `uncertain`.
    pub planarity: &'static str,
    /// Of normal x, y, z and distance.
    pub covariance: Option<[[f32; 4]; 4]>,
}

impl Entry {
    pub fn new(label: u32, segment: &Segment, centroid_m: [f32; 3]) -> Entry {
        let plane: Option<Plane> = segment.plane();
        Entry {
            label,
            pixels: segment.pixels(),
            first_row: segment.first_row,
            last_row: segment.last_row,
            first_column: segment.first_column,
            last_column: segment.last_column,
            centroid_m,
            normal: plane.map(|p| p.normal),
            distance_m: plane.map(|p| p.distance_m),
            rms_m: plane.map(|p| p.rms_m),
            residual_per_noise: None,
            planarity: Verdict::Uncertain.name(),
            covariance: plane.map(|p| p.covariance),
        }
    }
}

impl Listing {
    /// States how planar each segment is.
    pub fn set_planarities(&mut self, planarities: &[Planarity]) {
        for (entry, planarity) in self.segments.iter_mut().zip(planarities) {
            entry.residual_per_noise = planarity.residual_per_noise;
            entry.planarity = planarity.verdict.name();
        }
    }

    pub fn json(&self) -> Result<Vec<u8>, Failure> {
        let mut bytes = serde_json::to_vec_pretty(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }

    /// One line per segment; fields of a plane are empty where there is none.
    pub fn csv(&self) -> Vec<u8> {
        let mut text = "label,pixels,first_row,last_row,first_column,last_column,centroid_x_m,centroid_y_m,\
             centroid_z_m,normal_x,normal_y,normal_z,distance_m,rms_m"
            .to_string();
        (0..16).for_each(|i| text += &format!(",covariance_{}{}", i / 4, i % 4));
        text += ",residual_per_noise,planarity";
        text.push('\n');
        for e in &self.segments {
            let whole = [e.label, e.pixels];
            let box_ = [e.first_row, e.last_row, e.first_column, e.last_column].map(u32::from);
            let mut fields: Vec<String> = whole.iter().chain(&box_).map(u32::to_string).collect();
            fields.extend(e.centroid_m.map(|x| x.to_string()));
            let plane = e.normal.into_iter().flatten().chain(e.distance_m).chain(e.rms_m);
            let plane = plane.chain(e.covariance.into_iter().flatten().flatten());
            fields.extend(plane.map(|x| x.to_string()));
            fields.resize(9 + 5 + 16, String::new());
            fields.push(e.residual_per_noise.map(|x| x.to_string()).unwrap_or_default());
            fields.push(e.planarity.to_string());
            text += &fields.join(",");
            text.push('\n');
        }
        text.into_bytes()
    }

    /// Returns a line for each segment of the table, for the legend of a picture.
    pub fn legend(&self) -> Vec<Line> {
        let line = |e: &Entry| {
            let plane = e.distance_m.zip(e.rms_m);
            let plane = plane.map(|(d, rms_m)| format!(", plane {d:.2} m away, rms {:.1} mm", 1e3 * rms_m));
            Line { label: e.label, text: format!("{} pixels{}", e.pixels, plane.unwrap_or_default()) }
        };
        self.segments.iter().take(LINES).map(line).collect()
    }

    /// Returns how many pixels are in no segment for the sake of edges, in the words of the approach.
    fn on_edges(&self) -> String {
        match self.approach {
            Approach::Plane => String::new(),
            Approach::Edge => format!(", {} on edges", self.header.edge_pixels),
            Approach::Region => format!(", {} on no line", self.header.edge_pixels),
        }
    }

    /// Returns the largest segments and the totals.
    pub fn table(&self) -> String {
        let mut text =
            String::from("  label   pixels  distance m            normal          rms mm       rows     columns\n");
        for e in self.segments.iter().take(LINES) {
            let plane = match (e.distance_m, e.normal, e.rms_m) {
                (Some(d), Some([x, y, z]), Some(rms_m)) => {
                    format!("{d:11.3}  ({x:6.3}, {y:6.3}, {z:6.3})  {:7.1}", 1e3 * rms_m)
                }
                _ => format!("{:>11}  {:^24}  {:>7}", "-", "-", "-"),
            };
            let rows = format!("{}-{}", e.first_row, e.last_row);
            let columns = format!("{}-{}", e.first_column, e.last_column);
            let _ = writeln!(text, "{:7}  {:7} {plane}  {rows:>9}  {columns:>10}", e.label, e.pixels);
        }
        let h = &self.header;
        let more = self.segments.len().saturating_sub(LINES);
        if more > 0 {
            let _ = writeln!(text, "    and {more} more");
        }
        let _ = writeln!(
            text,
            "{} x {} pixels, {} with a return{}; {} segments, {} of them with {} pixels or more",
            h.rows,
            h.columns,
            h.returns,
            self.on_edges(),
            h.segments_found,
            h.segments_listed,
            h.min_pixels
        );
        text
    }
}
