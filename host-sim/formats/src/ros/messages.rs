//! The messages that are read, field by field in their order, up to the last one of use.

use std::fmt;

use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// `builtin_interfaces/msg/Time`.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl Time {
    pub fn ns(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// `sensor_msgs/msg/PointField`.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct PointField {
    pub name: String,
    pub offset: u32,
    /// 7 is `f32`, 8 `f64`.
    pub datatype: u8,
    pub count: u32,
}

/// `sensor_msgs/msg/PointCloud2`.
#[derive(Deserialize, Serialize)]
pub struct PointCloud2<'a> {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub fields: Vec<PointField>,
    pub is_bigendian: bool,
    pub point_step: u32,
    pub row_step: u32,
    pub data: &'a [u8],
}

/// `sensor_msgs/msg/Image`.
#[derive(Deserialize, Serialize)]
pub struct Image<'a> {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub encoding: String,
    pub is_bigendian: u8,
    pub step: u32,
    pub data: &'a [u8],
}

/// `sensor_msgs/msg/CameraInfo`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct CameraInfo {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub distortion_model: String,
    pub d: Vec<f64>,
    pub k: [f64; 9],
    pub r: [f64; 9],
    pub p: [f64; 12],
    pub binning_x: u32,
    pub binning_y: u32,
    pub roi: RegionOfInterest,
}

/// `sensor_msgs/msg/RegionOfInterest`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct RegionOfInterest {
    pub x_offset: u32,
    pub y_offset: u32,
}

/// `sensor_msgs/msg/LaserScan`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct LaserScan {
    pub header: Header,
    pub angle_min: f32,
    pub angle_max: f32,
    pub angle_increment: f32,
    pub time_increment: f32,
    pub scan_time: f32,
    pub range_min: f32,
    pub range_max: f32,
    pub ranges: Vec<f32>,
}

/// `sensor_msgs/msg/JointState`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct JointState {
    pub header: Header,
    pub name: Vec<String>,
    pub position: Vec<f64>,
}

/// `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct TfMessage {
    pub transforms: Vec<TransformStamped>,
}

/// `geometry_msgs/msg/TransformStamped`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    /// x, y, z, metres.
    pub translation: [f64; 3],
    /// x, y, z, w.
    pub rotation: [f64; 4],
}

/// `velodyne_msgs/msg/VelodyneScan`.
#[derive(Deserialize)]
pub struct VelodyneScan {
    #[serde(rename = "header")]
    _header: Header,
    pub packets: Vec<VelodynePacket>,
}

/// `velodyne_msgs/msg/VelodynePacket`.
#[derive(Deserialize)]
pub struct VelodynePacket {
    #[serde(rename = "stamp")]
    _stamp: Time,
    #[serde(deserialize_with = "packet")]
    pub data: Vec<u8>,
}

const PACKET_BYTES: usize = 1206;

fn packet<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<u8>, D::Error> {
    struct Bytes;

    impl<'de> Visitor<'de> for Bytes {
        type Value = Vec<u8>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "{PACKET_BYTES} bytes")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Vec<u8>, A::Error> {
            let mut bytes = Vec::with_capacity(PACKET_BYTES);
            for i in 0..PACKET_BYTES {
                bytes.push(sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?);
            }
            Ok(bytes)
        }
    }

    deserializer.deserialize_tuple(PACKET_BYTES, Bytes)
}
