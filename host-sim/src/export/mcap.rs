//! A run as an MCAP recording of ROS 2 messages, for Foxglove, Rerun and `ros2 bag`.

use std::collections::BTreeMap;
use std::io::Cursor;

use byteorder::LittleEndian;
use cdr_encoding::to_vec;
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use serde::Serialize;

use scanseg_formats::Axes;

use crate::export::messages::{cloud, marker};
use crate::export::outline::outlines_of;
use crate::export::ros::{Header, MARKER_ARRAY, MarkerArray, POINT_CLOUD2};
use crate::export::segmented::Segmented;

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
            let marker = |&i: &usize| Some(marker(i, outlines[i].as_ref()?, header(row), Axes::Forward));
            let markers = ended.iter().filter_map(marker).collect();
            recording.write(planes, row, &MarkerArray { markers })?;
        }
        if row < rows {
            recording.write(rows_topic, row, &cloud(scan, row..row + 1, header(row), Axes::Forward))?;
        }
    }
    recording.write(points, rows, &cloud(scan, 0..rows, header(rows), Axes::Forward))?;
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
    Header::new(time_ns(row) as i64, FRAME)
}
