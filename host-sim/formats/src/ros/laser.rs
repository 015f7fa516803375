//! The rows of a turned 2D scanner: LaserScan, and what turns it.
//!
//! A sweep is a scan: it ends where the turn goes back, or after a whole turn. Each beam has the pose
//! of its own time.

use std::sync::Arc;

use crate::beside::Beside;
use crate::cloud::Cloud;
use crate::cloud::fit::length;
use crate::cloud::recognise::NOWHERE;
use crate::file::Cause;
use crate::geometry::{Geometry, Kind};
use crate::grey_image::MAX_PIXELS;
use crate::range_image::RangeImage;
use crate::ros::cdr::decode;
use crate::ros::messages::LaserScan;
use crate::ros::pose::Pose;
use crate::ros::recording::{Recording, Topic};
use crate::ros::turned::Turned;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::streamed::Stream;

/// So far a turn may go back without that a sweep ends, radians: 1 degree.
const BACK_RAD: f64 = 0.017;
/// Fewer rows are no sweep.
const LEAST_ROWS: usize = 8;

/// A row with the points of its beams.
pub struct Row {
    pose: Pose,
    points: Vec<[f32; 3]>,
}

impl Row {
    /// Returns the row of a message, whose pose must be known where it begins.
    pub fn of(scan: &LaserScan, turned: &Turned) -> Option<Row> {
        let begun_ns = scan.header.stamp.ns();
        let step_ns = f64::from(scan.time_increment) * 1e9;
        let pose = turned.at(begun_ns)?;
        let point = |(i, range_m): (usize, &f32)| {
            let good = range_m.is_finite() && *range_m >= scan.range_min && *range_m <= scan.range_max;
            let at = if good { turned.at(begun_ns.saturating_add((step_ns * i as f64) as i64)) } else { None };
            let Some(at) = at.or(good.then_some(pose)) else { return [f32::NAN; 3] };
            let beam_rad = f64::from(scan.angle_min) + i as f64 * f64::from(scan.angle_increment);
            let range_m = f64::from(*range_m);
            at.of_point([range_m * beam_rad.cos(), range_m * beam_rad.sin(), 0.0]).map(|m| m as f32)
        };
        Some(Row { pose, points: scan.ranges.iter().enumerate().map(point).collect() })
    }

    /// Returns the row as a scan of one row, each beam at its own direction.
    pub fn scan(&self, name: String, options: &ReadOptions) -> Result<Scan, Cause> {
        let unit_m = options.unit_m.unwrap_or(1.0);
        let pixel = |point: &[f32; 3]| {
            let range_m = length(point);
            let good = range_m.is_finite() && range_m > 0.0;
            if good {
                ((range_m * unit_m) as f32, point.map(|x| (f64::from(x) / range_m) as f32))
            } else {
                (0.0, NOWHERE)
            }
        };
        let (range_m, directions): (Vec<f32>, Vec<[f32; 3]>) = self.points.iter().map(pixel).unzip();
        let columns = range_m.len();
        let measured = range_m.iter().filter(|range_m| **range_m > 0.0).count();
        let kind = Kind::Free { directions, columns, wraps: false };
        let geometry = match options.geometry()? {
            Some(given) => Geometry { kind, beside: Beside::NONE, unit_m, no_return: vec![], ..given },
            None => Geometry::of(kind),
        };
        let mut image = RangeImage { rows: 1, columns, range_m };
        image.keep_within(&geometry);
        Ok(Scan { name, image, geometry, measured, remarks: vec![] })
    }
}

/// Rows that turn one way.
#[derive(Default)]
pub struct Sweep {
    rows: Vec<Row>,
    /// The way in which it turns, once it is clear.
    direction: Option<[f64; 3]>,
    turned_rad: f64,
    farthest_rad: f64,
}

impl Sweep {
    /// Adds a row. Returns the sweep that ends before it.
    pub fn push(&mut self, row: Row) -> Option<Sweep> {
        let Some(last) = self.rows.last() else {
            self.rows.push(row);
            return None;
        };
        let turn = last.pose.turn_to(&row.pose);
        let along_rad = match self.direction {
            Some(axis) => dot(axis, turn),
            None => {
                let length = dot(turn, turn).sqrt();
                if length > 1e-4 {
                    self.direction = Some(turn.map(|x| x / length));
                }
                length
            }
        };
        self.turned_rad += along_rad;
        self.farthest_rad = self.farthest_rad.max(self.turned_rad);
        let pixels = (self.rows.len() + 1).saturating_mul(row.points.len());
        let over = self.turned_rad < self.farthest_rad - BACK_RAD || self.turned_rad >= std::f64::consts::TAU;
        if over || pixels > MAX_PIXELS || row.points.len() != last.points.len() {
            return Some(std::mem::replace(self, Sweep { rows: vec![row], ..Sweep::default() }));
        }
        self.rows.push(row);
        None
    }

    /// Whether it has one row.
    pub fn begins(&self) -> bool {
        self.rows.len() == 1
    }

    /// Whether it has enough rows for a scan.
    pub fn is_scan(&self) -> bool {
        self.rows.len() >= LEAST_ROWS
    }

    pub fn scan(&self, name: String, turned: &Turned, options: &ReadOptions) -> Result<Scan, Cause> {
        let (rows, columns) = (self.rows.len(), self.rows.first().map_or(0, |row| row.points.len()));
        ScanError::check_pixels(rows, columns)?;
        let points = self.rows.iter().flat_map(|row| row.points.iter().copied()).collect();
        let mut scan = Cloud { rows, columns, points }.into_scan(name, options)?;
        scan.remarks.extend(turned.remark.clone());
        Ok(scan)
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The sweeps of a topic.
pub struct Sweeps {
    pub name: String,
    pub options: ReadOptions,
    pub recording: Box<dyn Recording>,
    pub topic: Arc<Topic>,
    pub turned: Arc<Turned>,
    /// The rows of the sweep that has begun.
    pub begun: Sweep,
    /// The sweep to which it has come.
    pub sweep: Sweep,
}

impl Sweeps {
    /// Returns the next row whose pose is known.
    fn next_row(&mut self) -> Result<Option<Row>, Cause> {
        while let Some(message) = self.recording.next_message()? {
            if message.topic == self.topic {
                let row = Row::of(&decode("LaserScan", &message.data)?, &self.turned);
                if row.is_some() {
                    return Ok(row);
                }
            }
        }
        Ok(None)
    }
}

impl Stream for Sweeps {
    fn advance(&mut self) -> Result<bool, Cause> {
        loop {
            let ended = match self.next_row()? {
                Some(row) => self.begun.push(row),
                None => Some(std::mem::take(&mut self.begun)),
            };
            let Some(sweep) = ended else { continue };
            if sweep.is_scan() {
                self.sweep = sweep;
                return Ok(true);
            }
            if sweep.rows.is_empty() {
                return Ok(false);
            }
        }
    }

    fn scan(&self) -> Result<Scan, Cause> {
        self.sweep.scan(self.name.clone(), &self.turned, &self.options)
    }
}
