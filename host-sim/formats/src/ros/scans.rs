//! The scans of a recording.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Arc;

use crate::file::Cause;
use crate::ros::laser::{Sweep, Sweeps};
use crate::ros::mcap::McapRecording;
use crate::ros::per_message::{PerMessage, Read};
use crate::ros::recording::{Open, Recording};
use crate::ros::survey::{Content, Survey};
use crate::ros::velodyne::VelodynePackets;
use crate::ros::{cloud, depth};
use crate::scan::ReadOptions;
use crate::streamed::{Stream, Streamed};

/// Returns the scans of an MCAP file.
pub(crate) fn frames_of_mcap(path: &Path, options: &ReadOptions) -> Result<Streamed, Cause> {
    let file = path.to_path_buf();
    frames(path, options, Arc::new(move || Ok(Box::new(McapRecording::open(&file)?) as Box<dyn Recording>)))
}

/// Returns the scans of an SQLite file.
#[cfg(feature = "db3")]
pub(crate) fn frames_of_db3(path: &Path, options: &ReadOptions) -> Result<Streamed, Cause> {
    let file = path.to_path_buf();
    let open = move || Ok(Box::new(crate::ros::db3::Db3Recording::open(&file)?) as Box<dyn Recording>);
    frames(path, options, Arc::new(open))
}

/// Says that this build cannot.
#[cfg(not(feature = "db3"))]
pub(crate) fn frames_of_db3(_: &Path, _: &ReadOptions) -> Result<Streamed, Cause> {
    let what = "the feature db3 of this build; `rosbags-convert` makes an MCAP file of it";
    Err(crate::scan_error::ScanError::lacks("an SQLite recording", what).into())
}

fn frames(path: &Path, options: &ReadOptions, open: Open) -> Result<Streamed, Cause> {
    let survey = Survey::of(&open)?;
    let (topic, content) = survey.choose(options.topic.as_deref())?;
    let name = format!("{} {}", path.display(), topic.name);
    let options = options.clone();
    let each = |read: Read| -> Box<dyn Fn() -> Result<Box<dyn Stream>, Cause> + Send> {
        let (open, topic) = (Arc::clone(&open), Arc::clone(&topic));
        Box::new(move || {
            let (recording, topic, read) = (open()?, Arc::clone(&topic), Arc::clone(&read));
            Ok(Box::new(PerMessage { recording, topic, read, data: vec![] }))
        })
    };
    let streams: Box<dyn Fn() -> Result<Box<dyn Stream>, Cause> + Send> = match content {
        Content::Clouds => each(Arc::new(move |data| cloud::scan(name.clone(), data, &options))),
        Content::Depths => {
            let camera = depth::camera(&topic.name, &survey.cameras)?.clone();
            each(Arc::new(move |data| depth::scan(name.clone(), data, &camera, &options)))
        }
        Content::Lasers { frame } => {
            let turned = Arc::new(survey.turning.of(&frame)?);
            Box::new(move || {
                let (recording, topic, turned) = (open()?, Arc::clone(&topic), Arc::clone(&turned));
                let (name, options) = (name.clone(), options.clone());
                let (begun, sweep) = (Sweep::default(), Sweep::default());
                Ok(Box::new(Sweeps { name, options, recording, topic, turned, begun, sweep }))
            })
        }
        Content::Velodyne => Box::new(move || {
            let (recording, topic, packets) = (open()?, Arc::clone(&topic), VecDeque::new());
            let (name, options) = (name.clone(), options.clone());
            Ok(Box::new(VelodynePackets { name, options, recording, topic, packets, turns: None, turn: None }))
        }),
    };
    Streamed::new("a recording", streams)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    use crate::ros::made_up::{Temporary, cdr, mcap};
    use crate::ros::messages::{
        CameraInfo, Header, Image, JointState, LaserScan, PointCloud2, PointField, TfMessage, Time, TransformStamped,
    };
    use crate::scan::{Frames, Scan};

    const CLOUD: &str = "sensor_msgs/msg/PointCloud2";
    const IMAGE: &str = "sensor_msgs/msg/Image";
    const CAMERA: &str = "sensor_msgs/msg/CameraInfo";
    const LASER: &str = "sensor_msgs/msg/LaserScan";
    const TF: &str = "tf2_msgs/msg/TFMessage";
    const JOINTS: &str = "sensor_msgs/msg/JointState";

    fn read(file: &Temporary, topic: Option<&str>) -> Result<Vec<Scan>, Cause> {
        let options = ReadOptions { topic: topic.map(Into::into), ..ReadOptions::default() };
        let mut frames = frames_of_mcap(file.path(), &options)?;
        (0..frames.count()).map(|n| frames.read(n)).collect()
    }

    fn refused(file: &Temporary, topic: Option<&str>) -> String {
        read(file, topic).map(|scans| scans.len()).unwrap_err().to_string()
    }

    /// A cloud whose points all are at a distance, in so many rows of 4.
    fn cloud(rows: u32, distance_m: f32) -> Vec<u8> {
        let field = |name: &str, offset| PointField { name: name.into(), offset, datatype: 7, count: 1 };
        let data: Vec<u8> = (0..4 * rows).flat_map(|_| [distance_m, 0.0, 0.0]).flat_map(f32::to_le_bytes).collect();
        cdr(&PointCloud2 {
            header: Header::default(),
            height: rows,
            width: 4,
            fields: vec![field("x", 0), field("y", 4), field("z", 8)],
            is_bigendian: false,
            point_step: 12,
            row_step: 48,
            data: &data,
        })
    }

    fn image(encoding: &str) -> Vec<u8> {
        let (header, data) = (Header::default(), [1000u16; 6].map(u16::to_le_bytes).concat());
        cdr(&Image { header, height: 2, width: 3, encoding: encoding.into(), is_bigendian: 0, step: 6, data: &data })
    }

    #[test]
    fn the_only_topic_with_scans_is_taken() {
        let camera = CameraInfo { k: [50.0, 0.0, 1.0, 0.0, 50.0, 0.5, 0.0, 0.0, 1.0], ..CameraInfo::default() };
        let file = mcap(
            "only",
            &[
                ("/cam/camera_info", CAMERA, cdr(&camera)),
                ("/cam/depth", IMAGE, image("16UC1")),
                ("/cam/rgb", IMAGE, image("rgb8")),
                ("/cam/depth", IMAGE, image("16UC1")),
            ],
        );
        let scans = read(&file, None).unwrap();
        assert_eq!(scans.len(), 2);
        assert!(scans[1].name.ends_with("/cam/depth, frame 1"), "{}", scans[1].name);
        assert!((scans[1].image.range_m[1] - (1.0f32 + 0.01 * 0.01).sqrt()).abs() < 1e-4);
        assert!(refused(&file, Some("/cam/rgb")).contains("no depths"));
        assert!(refused(&file, Some("/cam/none")).contains("/cam/depth (2 of sensor_msgs/msg/Image)"));
    }

    #[test]
    fn of_several_topics_one_must_be_chosen() {
        let messages = [
            ("/a", CLOUD, cloud(2, 1.0)),
            ("/b", CLOUD, cloud(3, 2.0)),
            ("/flat", CLOUD, cloud(1, 3.0)),
            ("/a", CLOUD, cloud(2, 4.0)),
        ];
        let file = mcap("several", &messages);
        let said = refused(&file, None);
        assert!(said.contains("--topic") && said.contains("/a (2 of") && said.contains("/flat (1 of"), "{said}");
        assert!(said.contains("points without rows"), "{said}");
        let ranges: Vec<f32> = read(&file, Some("/a")).unwrap().iter().map(|scan| scan.image.range_m[0]).collect();
        assert_eq!(ranges, [1.0, 4.0]);
        // what is cut off has what came before
        let bytes = fs::read(file.path()).unwrap();
        let short = mcap("short", &[]);
        let at = bytes.windows(4).rposition(|window| window == 4.0f32.to_le_bytes()).unwrap();
        fs::write(short.path(), &bytes[..at]).unwrap();
        let kept = read(&short, Some("/a"));
        assert!(kept.is_err() || kept.is_ok_and(|scans| scans.len() == 1));
        assert!(refused(&mcap("none", &[]), None).contains("no message"));
    }

    /// The turn of a tilting scanner at a time: down and up again within 4 s, radians upwards.
    fn tilt_rad(s: f64) -> f64 {
        0.5 - (s % 4.0 - 2.0).abs() / 2.0
    }

    fn header(frame: &str, s: f64) -> Header {
        let stamp = Time { sec: s as i32, nanosec: (s.fract() * 1e9).round() as u32 };
        Header { stamp, frame_id: frame.into() }
    }

    /// What a scanner sees of a wall 2 m ahead, 0.1 m in front of the axis of its tilt.
    fn wall_row(s: f64) -> Vec<u8> {
        let ranges = (0..41).map(|i| {
            let beam_rad = 0.02 * f64::from(i - 20);
            let turn_rad = tilt_rad(s + 0.001 * f64::from(i));
            ((2.0 - 0.1 * turn_rad.cos()) / (beam_rad.cos() * turn_rad.cos())) as f32
        });
        cdr(&LaserScan {
            header: header("laser", s),
            angle_min: -0.4,
            angle_max: 0.4,
            angle_increment: 0.02,
            time_increment: 0.001,
            scan_time: 0.05,
            range_min: 0.1,
            range_max: 30.0,
            ranges: ranges.collect(),
        })
    }

    /// Where a pixel's point lies ahead.
    fn ahead_m(scan: &Scan, row: usize, column: usize) -> f64 {
        f64::from(scan.image.range_m[row * scan.image.columns + column]) * scan.geometry.direction(row, column)[0]
            + scan.geometry.origin(row, column)[0]
    }

    #[test]
    fn a_tilted_laser_sees_a_flat_wall_by_its_transforms() {
        let mut messages = vec![];
        let transform = |parent: &str, child: &str, s, translation, rotation| {
            let header = header(parent, s);
            let transforms = vec![TransformStamped { header, child_frame_id: child.into(), translation, rotation }];
            cdr(&TfMessage { transforms })
        };
        messages.push(("/tf_static", TF, transform("tilt", "laser", 0.0, [0.1, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])));
        for i in 0..900 {
            let s = f64::from(i) * 0.01;
            let half = -tilt_rad(s) / 2.0;
            messages.push(("/tf", TF, transform("base", "tilt", s, [0.0; 3], [0.0, half.sin(), 0.0, half.cos()])));
            if i % 5 == 0 {
                messages.push(("/scan", LASER, wall_row(s)));
            }
        }
        let scans = read(&mcap("tilted", &messages), None).unwrap();
        // four sweeps of 2 s and the beginning of a fifth, each of 40 rows, or one that it needs to see the turn
        let rows: Vec<usize> = scans.iter().map(|scan| scan.image.rows).collect();
        assert!(rows.len() == 5 && rows[..4].iter().all(|rows| (38..=43).contains(rows)), "{rows:?}");
        for scan in &scans {
            for row in 0..scan.image.rows {
                for column in 0..41 {
                    let off_m = ahead_m(scan, row, column) - 2.0;
                    // the turn goes back where a sweep ends
                    assert!(off_m.abs() < 2e-3, "row {row}, column {column}: {off_m}");
                }
            }
        }
    }

    #[test]
    fn a_joint_turns_the_laser_where_no_transform_does() {
        let mut messages = vec![];
        for i in 0..400 {
            let s = f64::from(i) * 0.01;
            let joints = JointState {
                header: header("", s),
                name: vec!["wheel".into(), "tilt_joint".into()],
                position: vec![0.0, -tilt_rad(s)],
            };
            messages.push(("/joint_states", JOINTS, cdr(&joints)));
            if i % 5 == 0 {
                messages.push(("/scan", LASER, wall_row(s)));
            }
        }
        let scans = read(&mcap("joint", &messages), None).unwrap();
        assert!(scans[0].remarks.iter().any(|remark| remark.contains("tilt_joint")), "{:?}", scans[0].remarks);
        // it is not known that the scanner lies 0.1 m before its axis
        assert!((ahead_m(&scans[0], 10, 20) - 1.9).abs() < 0.02);

        messages.retain(|(topic, ..)| *topic == "/scan");
        assert!(refused(&mcap("still", &messages), None).contains("a transform that turns laser"));
    }
}
