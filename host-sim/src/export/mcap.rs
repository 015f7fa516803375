//! A run as an MCAP recording of ROS 2 messages, for Foxglove, Rerun and `ros2 bag`.

use std::collections::BTreeMap;
use std::io::Cursor;

use byteorder::LittleEndian;
use cdr_encoding::to_vec;
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use serde::Serialize;

use crate::export::outline::{Outline, outlines_of};
use crate::export::points::{RECORD_BYTES, record};
use crate::export::ros::{
    ColorRgba, CompressedImage, Header, MARKER_ARRAY, Marker, MarkerArray, MeshFile, POINT_CLOUD2, Point, PointCloud2,
    PointField, Pose, Quaternion, Time,
};
use crate::export::segmented::Segmented;
use crate::picture::label_colour;

/// From a row to the next. The scan does not say how fast its scanner was.
const ROW_NS: u64 = 20_000_000;
/// Time of the first row: a viewer takes 0 for none.
const START_NS: u64 = 1_000_000_000;

const FRAME: &str = "scanner";

type Failure = Box<dyn std::error::Error>;

/// Returns a recording, rows 20 ms apart: on `/rows` each row as a cloud; on `/planes` each segment as
/// a marker when the row after its last one has come, its outline filled with its colour, its label
/// as the id; on `/points` at the end the whole organised cloud. All clouds are
/// `sensor_msgs/msg/PointCloud2` with x, y, z, rgb and label.
///
/// # Errors
/// What the writers of messages and recordings say; none that is known.
pub fn mcap(scan: &Segmented<'_>) -> Result<Vec<u8>, Failure> {
    let rows = scan.image.rows;
    let writer = WriteOptions::new().compression(None).profile("ros2").library("scanseg");
    let mut recording = Recording { writer: writer.create(Cursor::new(vec![]))?, sequence: 0 };
    let clouds = recording.writer.add_schema("sensor_msgs/msg/PointCloud2", "ros2msg", POINT_CLOUD2.as_bytes())?;
    let markers =
        recording.writer.add_schema("visualization_msgs/msg/MarkerArray", "ros2msg", MARKER_ARRAY.as_bytes())?;
    let mut topic = |schema, name| recording.writer.add_channel(schema, name, "cdr", &BTreeMap::new());
    let [rows_topic, planes, points] = [topic(clouds, "/rows")?, topic(markers, "/planes")?, topic(clouds, "/points")?];

    let outlines = outlines_of(scan);
    let mut ended: Vec<Vec<usize>> = vec![vec![]; rows + 1];
    (0..outlines.len()).for_each(|i| ended[(usize::from(scan.segments[i].last_row) + 1).min(rows)].push(i));
    for (row, ended) in ended.iter().enumerate() {
        if !ended.is_empty() {
            let marker = |&i: &usize| Some(marker(i, outlines[i].as_ref()?, header(row)));
            let markers = ended.iter().filter_map(marker).collect();
            recording.write(planes, row, &MarkerArray { markers })?;
        }
        if row < rows {
            recording.write(rows_topic, row, &cloud(scan, row..row + 1, header(row)))?;
        }
    }
    recording.write(points, rows, &cloud(scan, 0..rows, header(rows)))?;
    recording.writer.finish()?;
    Ok(recording.writer.into_inner().into_inner())
}

struct Recording {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

impl Recording {
    fn write(&mut self, channel_id: u16, row: usize, message: &impl Serialize) -> Result<(), Failure> {
        // CDR of version 1, little end first
        let mut bytes = vec![0, 1, 0, 0];
        bytes.extend(to_vec::<_, LittleEndian>(message)?);
        let (log_time, sequence) = (time_ns(row), self.sequence);
        self.sequence += 1;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, &bytes)?)
    }
}

fn time_ns(row: usize) -> u64 {
    START_NS + ROW_NS * row as u64
}

fn header(row: usize) -> Header {
    let ns = time_ns(row);
    let stamp = Time { sec: (ns / 1_000_000_000) as i32, nanosec: (ns % 1_000_000_000) as u32 };
    Header { stamp, frame_id: FRAME }
}

fn cloud(scan: &Segmented<'_>, rows: std::ops::Range<usize>, header: Header) -> PointCloud2 {
    const FLOAT32: u8 = 7;
    const UINT32: u8 = 6;
    let columns = scan.image.columns;
    let kinds = [("x", FLOAT32), ("y", FLOAT32), ("z", FLOAT32), ("rgb", FLOAT32), ("label", UINT32)];
    let field = |(offset, (name, datatype))| PointField { name, offset, datatype, count: 1 };
    PointCloud2 {
        header,
        height: rows.len() as u32,
        width: columns as u32,
        fields: (0..).step_by(4).zip(kinds).map(field).collect(),
        is_bigendian: false,
        point_step: RECORD_BYTES as u32,
        row_step: (RECORD_BYTES * columns) as u32,
        data: (rows.start * columns..rows.end * columns).flat_map(|pixel| record(scan, pixel)).collect(),
        is_dense: false,
    }
}

/// Returns triangles from the first corner of an outline to each of its other sides.
fn marker(segment: usize, outline: &Outline, header: Header) -> Marker {
    const TRIANGLE_LIST: i32 = 11;
    let label = segment as u32 + 1;
    let [r, g, b] = label_colour(label).map(|value| f32::from(value) / 255.0);
    let corners: Vec<Point> = outline.corners_m.iter().map(|&[x, y, z]| Point { x, y, z }).collect();
    let none = Time { sec: 0, nanosec: 0 };
    Marker {
        header,
        ns: "planes",
        id: label as i32,
        r#type: TRIANGLE_LIST,
        action: 0,
        pose: Pose {
            position: Point { x: 0.0, y: 0.0, z: 0.0 },
            orientation: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 },
        },
        scale: Point { x: 1.0, y: 1.0, z: 1.0 },
        color: ColorRgba { r, g, b, a: 0.5 },
        lifetime: none,
        frame_locked: false,
        points: corners[1..].windows(2).flat_map(|side| [corners[0], side[0], side[1]]).collect(),
        colors: vec![],
        texture_resource: "",
        texture: CompressedImage { header: Header { stamp: none, frame_id: "" }, format: "", data: vec![] },
        uv_coordinates: vec![],
        text: String::new(),
        mesh_resource: "",
        mesh_file: MeshFile { filename: "", data: vec![] },
        mesh_use_embedded_materials: false,
    }
}
