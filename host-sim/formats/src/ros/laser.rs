//! The rows of a turned 2D scanner: LaserScan, and what turns it.
//!
//! A sweep is a scan: it ends where the turn goes back, or after a whole turn. Each beam has the pose
//! of its own time.

use std::sync::Arc;

use crate::cloud::Cloud;
use crate::file::Cause;
use crate::grey_image::MAX_PIXELS;
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

/// The sweeps of a topic.
pub struct Sweeps {
    pub name: String,
    pub options: ReadOptions,
    pub recording: Box<dyn Recording>,
    pub topic: Arc<Topic>,
    pub turned: Arc<Turned>,
    /// Rows that are read, of which the first belongs to the next sweep.
    pub rows: Vec<Row>,
    pub sweep: Vec<Row>,
}

/// A row with the points of its beams.
pub struct Row {
    pose: Pose,
    points: Vec<[f32; 3]>,
}

impl Sweeps {
    /// Returns the next row whose pose is known.
    fn next_row(&mut self) -> Result<Option<Row>, Cause> {
        while let Some(message) = self.recording.next_message()? {
            if message.topic == self.topic {
                let row = self.row(&decode("LaserScan", &message.data)?);
                if row.is_some() {
                    return Ok(row);
                }
            }
        }
        Ok(None)
    }

    fn row(&self, scan: &LaserScan) -> Option<Row> {
        let begun_ns = scan.header.stamp.ns();
        let step_ns = f64::from(scan.time_increment) * 1e9;
        let pose = self.turned.at(begun_ns)?;
        let point = |(i, range_m): (usize, &f32)| {
            let good = range_m.is_finite() && *range_m >= scan.range_min && *range_m <= scan.range_max;
            let at = if good { self.turned.at(begun_ns.saturating_add((step_ns * i as f64) as i64)) } else { None };
            let Some(at) = at.or(good.then_some(pose)) else { return [f32::NAN; 3] };
            let beam_rad = f64::from(scan.angle_min) + i as f64 * f64::from(scan.angle_increment);
            let range_m = f64::from(*range_m);
            at.of_point([range_m * beam_rad.cos(), range_m * beam_rad.sin(), 0.0]).map(|m| m as f32)
        };
        Some(Row { pose, points: scan.ranges.iter().enumerate().map(point).collect() })
    }

    /// Reads the rows of a sweep; fewer than [`LEAST_ROWS`] are none.
    fn read_sweep(&mut self) -> Result<(), Cause> {
        self.sweep = std::mem::take(&mut self.rows);
        // the farthest turn so far, and the direction once it is clear
        let (mut farthest_rad, mut direction) = (0.0f64, None::<[f64; 3]>);
        while let Some(row) = self.next_row()? {
            let Some(first) = self.sweep.first() else {
                self.sweep.push(row);
                continue;
            };
            let pixels = (self.sweep.len() + 1).saturating_mul(row.points.len());
            let last = self.sweep.last().map_or(first.pose, |last| last.pose);
            let turn = last.turn_to(&row.pose);
            let along_rad = match direction {
                Some(axis) => dot(axis, turn),
                None => {
                    let length = dot(turn, turn).sqrt();
                    if length > 1e-4 {
                        direction = Some(turn.map(|x| x / length));
                    }
                    length
                }
            };
            let turned_rad = self.turned_rad(direction) + along_rad;
            farthest_rad = farthest_rad.max(turned_rad);
            let over = turned_rad < farthest_rad - BACK_RAD || turned_rad >= std::f64::consts::TAU;
            if over || pixels > MAX_PIXELS || row.points.len() != first.points.len() {
                self.rows.push(row);
                return Ok(());
            }
            self.sweep.push(row);
        }
        Ok(())
    }

    /// How far the sweep has turned, radians.
    fn turned_rad(&self, direction: Option<[f64; 3]>) -> f64 {
        let Some(axis) = direction else { return 0.0 };
        self.sweep.windows(2).map(|pair| dot(axis, pair[0].pose.turn_to(&pair[1].pose))).sum()
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Stream for Sweeps {
    fn advance(&mut self) -> Result<bool, Cause> {
        loop {
            self.read_sweep()?;
            if self.sweep.len() >= LEAST_ROWS {
                return Ok(true);
            }
            if self.rows.is_empty() {
                return Ok(false);
            }
        }
    }

    fn scan(&self) -> Result<Scan, Cause> {
        let (rows, columns) = (self.sweep.len(), self.sweep.first().map_or(0, |row| row.points.len()));
        ScanError::check_pixels(rows, columns)?;
        let points = self.sweep.iter().flat_map(|row| row.points.iter().copied()).collect();
        let mut scan = Cloud { rows, columns, points }.into_scan(self.name.clone(), &self.options)?;
        scan.remarks.extend(self.turned.remark.clone());
        Ok(scan)
    }
}
