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
        Some(LiveScans { topic: topic.into(), options, source })
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

    /// Takes a message. `topic` is its place in what is needed, `data` its CDR with the four bytes
    /// before it. Returns the scan that it completes.
    ///
    /// # Errors
    /// A message that is damaged, or has no scan.
    pub fn push(&mut self, topic: usize, data: &[u8]) -> Result<Option<LiveScan>, Cause> {
        let name = self.topic.clone();
        match (&mut self.source, topic) {
            (Source::Clouds, _) => {
                let message: PointCloud2<'_> = decode("PointCloud2", data)?;
                let (scan, axes) = cloud::points(&message)?.into_scan_with_axes(name, &self.options)?;
                Ok(Some(LiveScan::of(scan, message.header, axes)))
            }
            (Source::Depths { camera }, 0) => {
                let Some(camera) = camera else {
                    let lacking = depth::camera_topic(&self.topic);
                    return Err(ScanError::lacks("a depth image", format!("a message on {lacking} before it")).into());
                };
                let scan = depth::scan(name, data, camera, &self.options)?;
                Ok(Some(LiveScan::of(scan, decode::<Image<'_>>("Image", data)?.header, Axes::Optical)))
            }
            (Source::Depths { camera }, _) => {
                *camera = Some(Box::new(decode("CameraInfo", data)?));
                Ok(None)
            }
            (Source::Lasers(lasers), topic) => {
                lasers.push(topic, data)?;
                lasers.advance(&name, &self.options)
            }
        }
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

    /// Takes the rows whose turn is known by now, up to the end of a sweep.
    fn advance(&mut self, name: &str, options: &ReadOptions) -> Result<Option<LiveScan>, Cause> {
        while let Some(row) = self.waiting.front() {
            // until something has turned, nothing is known
            let Ok(turned) = self.turning.of(&row.header.frame_id) else { return Ok(None) };
            let begun_ns = row.header.stamp.ns();
            let lasts_ns = f64::from(row.time_increment) * 1e9 * row.ranges.len() as f64;
            if turned.last_ns().is_none_or(|last_ns| last_ns < begun_ns.saturating_add(lasts_ns as i64)) {
                return Ok(None);
            }
            let points = Row::of(row, &turned);
            let header = row.header.clone();
            self.waiting.pop_front();
            self.turning.forget_before(begun_ns.saturating_sub(REMEMBERED_NS));
            let Some(points) = points else { continue };
            let before = std::mem::replace(&mut self.last, header);
            if let Some(sweep) = self.sweep.push(points).filter(Sweep::is_scan) {
                let scan = sweep.scan(name.into(), &turned, options)?;
                let header = Header { frame_id: turned.frame.clone(), ..before };
                return Ok(Some(LiveScan::of(scan, header, Axes::Forward)));
            }
        }
        Ok(None)
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
        let mut found = vec![];
        // up for 1 s, down for 1 s, in steps of 0.05 s
        for i in 0..45 {
            let s = f64::from(i) * 0.05;
            let mut row = laser.clone();
            row.header.stamp = stamp(s);
            // the turn comes after the row
            found.extend(scans.push(0, &cdr(&row)).unwrap());
            found.extend(scans.push(3, &joints(s, (1.0 - (s % 2.0 - 1.0).abs()) / 2.0)).unwrap());
        }
        assert_eq!(found.len(), 2);
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
        assert!(scans.push(1, &cdr(&CameraInfo { k, ..CameraInfo::default() })).unwrap().is_none());
        let found = scans.push(0, &image).unwrap().unwrap();
        assert_eq!((found.stamp_ns, &*found.frame, found.axes), (2_500_000_000, "optical", Axes::Optical));
        assert!(LiveScans::new("/x", "sensor_msgs/msg/Imu", ReadOptions::default()).is_none());
    }
}
