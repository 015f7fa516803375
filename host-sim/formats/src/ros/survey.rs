//! What a recording holds, and which of its topics is taken.

use std::sync::Arc;

use crate::file::Cause;
use crate::ros::cdr::decode;
use crate::ros::cloud as clouds;
use crate::ros::depth;
use crate::ros::messages::{CameraInfo, Image, JointState, LaserScan, PointCloud2, TfMessage};
use crate::ros::recording::{Open, Topic};
use crate::ros::turned::Turning;
use crate::scan_error::ScanError;

const FORMAT: &str = "a recording";

/// The scans of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Content {
    /// Organised clouds.
    Clouds,
    /// Depth images.
    Depths,
    /// The rows of a 2D scanner.
    Lasers {
        /// Its frame.
        frame: String,
    },
    /// Packets of a Velodyne.
    Velodyne,
}

/// What a recording holds.
#[derive(Default)]
pub struct Survey {
    /// Each topic with its number of messages, and what it holds or why nothing of use.
    topics: Vec<(Arc<Topic>, usize, Result<Content, String>)>,
    /// The cameras of which something is said, in the order of their topics.
    pub cameras: Vec<(String, CameraInfo)>,
    /// All that turns.
    pub turning: Turning,
}

impl Survey {
    /// Reads all of a recording.
    pub fn of(open: &Open) -> Result<Survey, Cause> {
        let mut survey = Survey::default();
        let mut recording = open()?;
        while let Some(message) = recording.next_message()? {
            let topic = &message.topic;
            let known = survey.topics.iter_mut().find(|(known, ..)| known == topic);
            if let Some((_, count, _)) = known {
                *count += 1;
            } else {
                survey.topics.push((Arc::clone(topic), 1, content(&topic.kind, &message.data)));
                if topic.kind == CAMERA_INFO {
                    survey.cameras.push((topic.name.clone(), decode(CAMERA_INFO, &message.data)?));
                }
            }
            match topic.kind.as_str() {
                TF => survey.turning.add_transforms(&topic.name, decode::<TfMessage>(TF, &message.data)?),
                JOINT_STATE => survey.turning.add_joints(&decode::<JointState>(JOINT_STATE, &message.data)?),
                _ => {}
            }
        }
        Ok(survey)
    }

    /// Returns the topic that was asked for, or the only one with scans.
    pub fn choose(&self, wanted: Option<&str>) -> Result<(Arc<Topic>, Content), ScanError> {
        let fitting = self.topics.iter().filter_map(|(topic, _, content)| Some((topic, content.as_ref().ok()?)));
        if let Some(wanted) = wanted {
            let found = self.topics.iter().find(|(topic, ..)| topic.name == wanted);
            return match found {
                Some((topic, _, Ok(content))) => Ok((Arc::clone(topic), content.clone())),
                Some((_, _, Err(why))) => Err(ScanError::lacks(FORMAT, format!("scans on {wanted}: {why}"))),
                None => Err(ScanError::lacks(FORMAT, format!("the topic {wanted}; it has {}", self.list()))),
            };
        }
        let mut fitting = fitting;
        match (fitting.next(), fitting.next()) {
            (Some((topic, content)), None) => Ok((Arc::clone(topic), content.clone())),
            (None, _) => Err(ScanError::lacks(FORMAT, format!("a topic of scans; it has {}", self.list()))),
            _ => Err(ScanError::lacks(
                FORMAT,
                format!("one topic of scans alone: choose by --topic among {}", self.list()),
            )),
        }
    }

    /// Returns all topics in words.
    fn list(&self) -> String {
        let word = |(topic, count, content): &(Arc<Topic>, usize, Result<Content, String>)| {
            let why = content.as_ref().err().map_or_else(String::new, |why| format!(": {why}"));
            format!("{} ({count} of {}{why})", topic.name, topic.kind)
        };
        let words: Vec<String> = self.topics.iter().map(word).collect();
        if words.is_empty() { "no message".into() } else { words.join(", ") }
    }
}

const CAMERA_INFO: &str = "sensor_msgs/msg/CameraInfo";
const TF: &str = "tf2_msgs/msg/TFMessage";
const JOINT_STATE: &str = "sensor_msgs/msg/JointState";

/// Returns what a topic holds, by its first message.
fn content(kind: &str, data: &[u8]) -> Result<Content, String> {
    match kind {
        "sensor_msgs/msg/PointCloud2" => {
            let cloud: PointCloud2<'_> = decode("PointCloud2", data).map_err(|e| e.to_string())?;
            if clouds::has_rows(&cloud) { Ok(Content::Clouds) } else { Err("points without rows".into()) }
        }
        "sensor_msgs/msg/Image" => {
            let image: Image<'_> = decode("Image", data).map_err(|e| e.to_string())?;
            depth::sample(&image.encoding).map(|_| Content::Depths).ok_or("no depths".into())
        }
        "sensor_msgs/msg/LaserScan" => {
            let scan: LaserScan = decode("LaserScan", data).map_err(|e| e.to_string())?;
            Ok(Content::Lasers { frame: scan.header.frame_id })
        }
        "velodyne_msgs/msg/VelodyneScan" => Ok(Content::Velodyne),
        _ => Err("no scans".into()),
    }
}
