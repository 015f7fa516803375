//! The scans of a topic, message by message as they come.

use std::collections::VecDeque;

use crate::cloud::axes::Axes;
use crate::file::Cause;
use crate::ros::cdr::decode;
use crate::ros::laser::{Row, Sweep};
use crate::ros::messages::{CameraInfo, Header, Image, JointState, LaserScan, PointCloud2, TfMessage};
use crate::ros::turned::Turning;
use crate::ros::{cloud, depth};
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;

/// So long the turn of a scanner is remembered, and a row waits for it.
const REMEMBERED_NS: i64 = 60_000_000_000;
/// So many rows may wait for their turn.
const MOST_WAITING: usize = 1000;

/// A topic that must be subscribed to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Needed {
    /// Its name.
    pub topic: String,
    /// The package of its type.
    pub package: &'static str,
    /// Its type, without the package.
    pub kind: &'static str,
    /// Whether its last message is kept for those that come later (transient local).
    pub latched: bool,
}

/// What has come.
#[derive(Clone, Debug)]
pub enum Came {
    /// A row of a sweep that goes on, as a scan of one row.
    Row {
        /// The row.
        row: LiveScan,
        /// Whether a sweep begins with it.
        begins: bool,
    },
    /// A whole scan; of a sweep all rows that came.
    Scan(LiveScan),
}

/// A scan that has come.
#[derive(Clone, Debug)]
pub struct LiveScan {
    /// The scan.
    pub scan: Scan,
    /// The time of its message, of the last of several, nanoseconds.
    pub stamp_ns: i64,
    /// The frame in which its points are.
    pub frame: String,
    /// The axes of that frame.
    pub axes: Axes,
}

/// The scans of a topic of `PointCloud2`, of depths as `Image`, or of a turned `LaserScan`.
pub struct LiveScans {
    topic: String,
    options: ReadOptions,
    source: Source,
    /// What has come and was not taken.
    ready: VecDeque<Came>,
}

enum Source {
    Clouds,
    Depths { camera: Option<Box<CameraInfo>> },
    Lasers(Box<Lasers>),
}

#[derive(Default)]
struct Lasers {
    turning: Turning,
    /// Rows whose turn is not known yet.
    waiting: VecDeque<LaserScan>,
    sweep: Sweep,
    last: Header,
}

impl LiveScans {
    /// Returns the scans of a topic. `kind` is its type, as `sensor_msgs/msg/PointCloud2`; none of a
    /// type that has no scans.
    pub fn new(topic: &str, kind: &str, options: ReadOptions) -> Option<LiveScans> {
        let source = match kind.strip_prefix("sensor_msgs/msg/")? {
            "PointCloud2" => Source::Clouds,
            "Image" => Source::Depths { camera: None },
            "LaserScan" => Source::Lasers(Box::default()),
            _ => return None,
        };
        Some(LiveScans { topic: topic.into(), options, source, ready: VecDeque::new() })
    }

    /// Returns the topics that it takes, its own first.
    pub fn needed(&self) -> Vec<Needed> {
        let needed = |topic: &str, package, kind| Needed { topic: topic.into(), package, kind, latched: false };
        let sensor = |topic: &str, kind| needed(topic, "sensor_msgs", kind);
        match &self.source {
            Source::Clouds => vec![sensor(&self.topic, "PointCloud2")],
            Source::Depths { .. } => {
                vec![sensor(&self.topic, "Image"), sensor(&depth::camera_topic(&self.topic), "CameraInfo")]
            }
            Source::Lasers(_) => vec![
                sensor(&self.topic, "LaserScan"),
                needed("/tf", "tf2_msgs", "TFMessage"),
                Needed { latched: true, ..needed("/tf_static", "tf2_msgs", "TFMessage") },
                sensor("/joint_states", "JointState"),
            ],
        }
    }

    /// Adds a message. `topic` is its place in what is needed, `data` its CDR with the four bytes before
    /// it. [`LiveScans::take`] gives what it completes.
    ///
    /// # Errors
    /// A message that is damaged, or has no scan.
    pub fn push(&mut self, topic: usize, data: &[u8]) -> Result<(), Cause> {
        let name = self.topic.clone();
        match (&mut self.source, topic) {
            (Source::Clouds, _) => {
                let message: PointCloud2<'_> = decode("PointCloud2", data)?;
                let (scan, axes) = cloud::points(&message)?.into_scan_with_axes(name, &self.options)?;
                self.ready.push_back(Came::Scan(LiveScan::of(scan, message.header, axes)));
            }
            (Source::Depths { camera }, 0) => {
                let Some(camera) = camera else {
                    let lacking = depth::camera_topic(&self.topic);
                    return Err(ScanError::lacks("a depth image", format!("a message on {lacking} before it")).into());
                };
                let scan = depth::scan(name, data, camera, &self.options)?;
                let header = decode::<Image<'_>>("Image", data)?.header;
                self.ready.push_back(Came::Scan(LiveScan::of(scan, header, Axes::Optical)));
            }
            (Source::Depths { camera }, _) => *camera = Some(Box::new(decode("CameraInfo", data)?)),
            (Source::Lasers(lasers), topic) => lasers.push(topic, data)?,
        }
        Ok(())
    }

    /// Returns the next of what has come, in the order of time; none until there is more.
    ///
    /// # Errors
    /// A sweep that is no scan.
    pub fn take(&mut self) -> Result<Option<Came>, Cause> {
        if let (Source::Lasers(lasers), true) = (&mut self.source, self.ready.is_empty()) {
            lasers.advance(&self.topic, &self.options, &mut self.ready)?;
        }
        Ok(self.ready.pop_front())
    }
}

impl LiveScan {
    fn of(scan: Scan, header: Header, axes: Axes) -> LiveScan {
        LiveScan { scan, stamp_ns: header.stamp.ns(), frame: header.frame_id, axes }
    }
}

impl Lasers {
    fn push(&mut self, topic: usize, data: &[u8]) -> Result<(), Cause> {
        match topic {
            0 => {
                self.waiting.push_back(decode("LaserScan", data)?);
                if self.waiting.len() > MOST_WAITING {
                    self.waiting.pop_front();
                    return Err(ScanError::lacks("LaserScan", "a transform or a joint at its time").into());
                }
            }
            1 => self.turning.add_transforms("/tf", decode::<TfMessage>("TFMessage", data)?),
            2 => self.turning.add_transforms("/tf_static", decode::<TfMessage>("TFMessage", data)?),
            _ => self.turning.add_joints(&decode::<JointState>("JointState", data)?),
        }
        Ok(())
    }

    /// Takes the next row, if its turn is known by now, and with it the sweep that ends before it.
    fn advance(&mut self, name: &str, options: &ReadOptions, ready: &mut VecDeque<Came>) -> Result<(), Cause> {
        while let Some(row) = self.waiting.front() {
            // until something has turned, nothing is known
            let Ok(turned) = self.turning.of(&row.header.frame_id) else { return Ok(()) };
            let begun_ns = row.header.stamp.ns();
            let lasts_ns = f64::from(row.time_increment) * 1e9 * row.ranges.len() as f64;
            if turned.last_ns().is_none_or(|last_ns| last_ns < begun_ns.saturating_add(lasts_ns as i64)) {
                return Ok(());
            }
            let points = Row::of(row, &turned);
            let header = Header { frame_id: turned.frame.clone(), ..row.header.clone() };
            self.waiting.pop_front();
            self.turning.forget_before(begun_ns.saturating_sub(REMEMBERED_NS));
            let Some(points) = points else { continue };
            let before = std::mem::replace(&mut self.last, header.clone());
            let row = LiveScan::of(points.scan(name.into(), options)?, header, Axes::Forward);
            let ended = self.sweep.push(points);
            let sweep = ended.filter(Sweep::is_scan).map(|sweep| sweep.scan(name.into(), &turned, options));
            let sweep = sweep.transpose().map(|scan| scan.map(|scan| LiveScan::of(scan, before, Axes::Forward)));
            let row = Came::Row { row, begins: self.sweep.begins() };
            let (sweep, failed) = sweep.map_or_else(|e| (None, Err(e)), |sweep| (sweep, Ok(())));
            ready.extend(sweep.map(Came::Scan).into_iter().chain([row]));
            return failed;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::made_up::cdr;
    use crate::ros::messages::Time;

    fn joints(s: f64, turn_rad: f64) -> Vec<u8> {
        let header = Header { stamp: stamp(s), frame_id: String::new() };
        cdr(&JointState { header, name: vec!["tilt".into()], position: vec![turn_rad] })
    }

    fn stamp(s: f64) -> Time {
        Time { sec: s as i32, nanosec: (s.fract() * 1e9).round() as u32 }
    }

    #[test]
    fn a_sweep_ends_where_the_turn_goes_back_and_rows_wait_for_their_turn() {
        let mut scans = LiveScans::new("/scan", "sensor_msgs/msg/LaserScan", ReadOptions::default()).unwrap();
        assert_eq!(scans.needed().len(), 4);
        let laser = LaserScan {
            header: Header { stamp: Time::default(), frame_id: "laser".into() },
            angle_min: -0.2,
            angle_max: 0.2,
            angle_increment: 0.02,
            range_min: 0.1,
            range_max: 30.0,
            ranges: vec![2.0; 21],
            ..LaserScan::default()
        };
        let (mut found, mut rows, mut begun) = (vec![], 0, vec![]);
        // up for 1 s, down for 1 s, in steps of 0.05 s
        for i in 0..45 {
            let s = f64::from(i) * 0.05;
            let mut row = laser.clone();
            row.header.stamp = stamp(s);
            // the turn comes after the row
            scans.push(0, &cdr(&row)).unwrap();
            assert!(scans.take().unwrap().is_none());
            scans.push(3, &joints(s, (1.0 - (s % 2.0 - 1.0).abs()) / 2.0)).unwrap();
            while let Some(came) = scans.take().unwrap() {
                match came {
                    Came::Row { row, begins } => {
                        assert_eq!((row.scan.image.rows, row.scan.image.columns, row.scan.measured), (1, 21, 21));
                        assert_eq!((row.stamp_ns, &*row.frame), (stamp(0.05 * rows as f64).ns(), "laser"));
                        if begins {
                            begun.push(rows);
                        }
                        rows += 1;
                    }
                    Came::Scan(scan) => found.push(scan),
                }
            }
        }
        assert_eq!(found.len(), 2);
        // rows come at once, whole sweeps with the row that begins the next one
        let of_first = found[0].scan.image.rows;
        assert_eq!((begun[0], begun[1], begun[2]), (0, of_first, of_first + found[1].scan.image.rows));
        assert!(rows >= 43, "{rows}");
        assert!((20..=23).contains(&found[0].scan.image.rows), "{}", found[0].scan.image.rows);
        assert_eq!(found[0].frame, "laser");
        assert!((1_000_000_000..=1_100_000_000).contains(&found[0].stamp_ns), "{}", found[0].stamp_ns);
    }

    #[test]
    fn a_depth_image_waits_for_its_camera() {
        let mut scans = LiveScans::new("/cam/depth", "sensor_msgs/msg/Image", ReadOptions::default()).unwrap();
        assert_eq!(scans.needed()[1].topic, "/cam/camera_info");
        let data = [1000u16; 6].map(u16::to_le_bytes).concat();
        let header = Header { stamp: stamp(2.5), frame_id: "optical".into() };
        let image = cdr(&Image {
            header,
            height: 2,
            width: 3,
            encoding: "16UC1".into(),
            is_bigendian: 0,
            step: 6,
            data: &data,
        });
        assert!(scans.push(0, &image).unwrap_err().to_string().contains("/cam/camera_info"));
        let k = [50.0, 0.0, 1.0, 0.0, 50.0, 0.5, 0.0, 0.0, 1.0];
        scans.push(1, &cdr(&CameraInfo { k, ..CameraInfo::default() })).unwrap();
        assert!(scans.take().unwrap().is_none());
        scans.push(0, &image).unwrap();
        let Some(Came::Scan(found)) = scans.take().unwrap() else { panic!("no scan") };
        assert_eq!((found.stamp_ns, &*found.frame, found.axes), (2_500_000_000, "optical", Axes::Optical));
        assert!(LiveScans::new("/x", "sensor_msgs/msg/Imu", ReadOptions::default()).is_none());
    }
}
