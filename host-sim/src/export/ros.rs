//! Messages of ROS 2 as their definitions have them, field by field: `sensor_msgs`,
//! `visualization_msgs` and what they consist of.

use serde::Serialize;

#[derive(Clone, Copy, Default, Serialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

/// `std_msgs/msg/Header`.
#[derive(Clone, Serialize)]
pub struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: String,
}

impl Header {
    /// Returns the header of a time, nanoseconds, and a frame.
    pub fn new(stamp_ns: i64, frame: &str) -> Header {
        let (sec, nanosec) = (stamp_ns.div_euclid(1_000_000_000), stamp_ns.rem_euclid(1_000_000_000));
        Header { stamp: Time { sec: sec as i32, nanosec: nanosec as u32 }, frame_id: frame.into() }
    }
}

#[derive(Serialize)]
pub struct PointField {
    pub name: &'static str,
    pub offset: u32,
    pub datatype: u8,
    pub count: u32,
}

/// `sensor_msgs/msg/PointCloud2`.
#[derive(Serialize)]
pub struct PointCloud2 {
    pub(super) header: Header,
    pub(super) height: u32,
    pub(super) width: u32,
    pub(super) fields: Vec<PointField>,
    pub(super) is_bigendian: bool,
    pub(super) point_step: u32,
    pub(super) row_step: u32,
    pub(super) data: Vec<u8>,
    pub(super) is_dense: bool,
}

/// `geometry_msgs/msg/Point`, and `Vector3`, which has the same fields.
#[derive(Clone, Copy, Serialize)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

#[derive(Serialize)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

#[derive(Serialize)]
pub struct Pose {
    pub position: Point,
    pub orientation: Quaternion,
}

#[derive(Clone, Copy, Serialize)]
pub struct ColorRgba {
    pub r: f32,
    pub g: f32,
    pub b: f32,
    pub a: f32,
}

#[derive(Serialize)]
pub struct CompressedImage {
    pub header: Header,
    pub format: &'static str,
    pub data: Vec<u8>,
}

#[derive(Serialize)]
pub struct UvCoordinate {
    pub u: f32,
    pub v: f32,
}

#[derive(Serialize)]
pub struct MeshFile {
    pub filename: &'static str,
    pub data: Vec<u8>,
}

/// `visualization_msgs/msg/Marker`.
#[derive(Serialize)]
pub struct Marker {
    pub header: Header,
    pub ns: &'static str,
    pub id: i32,
    pub r#type: i32,
    pub action: i32,
    pub pose: Pose,
    pub scale: Point,
    pub color: ColorRgba,
    pub lifetime: Time,
    pub frame_locked: bool,
    pub points: Vec<Point>,
    pub colors: Vec<ColorRgba>,
    pub texture_resource: &'static str,
    pub texture: CompressedImage,
    pub uv_coordinates: Vec<UvCoordinate>,
    pub text: String,
    pub mesh_resource: &'static str,
    pub mesh_file: MeshFile,
    pub mesh_use_embedded_materials: bool,
}

/// `visualization_msgs/msg/MarkerArray`.
#[derive(Serialize)]
pub struct MarkerArray {
    pub(super) markers: Vec<Marker>,
}

/// The definition of [`PointCloud2`], with those that it needs.
pub const POINT_CLOUD2: &str = concat!(
    "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\n\
     uint32 row_step\nuint8[] data\nbool is_dense\n",
    include_str!("ros_header.txt"),
    "================================================================================\nMSG: sensor_msgs/PointField\n\
     uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
     uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"
);

/// The definition of [`MarkerArray`], with those that it needs.
pub const MARKER_ARRAY: &str =
    concat!("visualization_msgs/Marker[] markers\n", include_str!("ros_marker.txt"), include_str!("ros_header.txt"));
