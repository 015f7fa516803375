//! Segmented scans as messages of ROS 2.

use std::ops::Range;

use scanseg_formats::Axes;

use crate::export::outline::{Outline, outlines_of};
use crate::export::points::{RECORD_BYTES, record};
use crate::export::ros::{
    ColorRgba, CompressedImage, Header, Marker, MarkerArray, MeshFile, Point, PointCloud2, PointField, Pose,
    Quaternion, Time,
};
use crate::export::segmented::Segmented;
use crate::picture::label_colour;

/// Returns some rows of a scan as a cloud: x, y, z, rgb and label. `axes` are those of its frame.
pub fn cloud(scan: &Segmented<'_>, rows: Range<usize>, header: Header, axes: Axes) -> PointCloud2 {
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
        data: (rows.start * columns..rows.end * columns).flat_map(|pixel| record(scan, pixel, axes)).collect(),
        is_dense: false,
    }
}

/// Returns the segments of a scan as markers, each filled with its colour, its label as the id. The
/// first marker removes those of the scan before.
pub fn planes(scan: &Segmented<'_>, header: &Header, axes: Axes) -> MarkerArray {
    let outlines = outlines_of(scan);
    let found = (0..).zip(&outlines);
    let planes = found.filter_map(|(i, outline)| Some(marker(i, outline.as_ref()?, header.clone(), axes)));
    let of_before = Marker { action: DELETE_ALL, ..empty(header.clone()) };
    MarkerArray { markers: [of_before].into_iter().chain(planes).collect() }
}

/// Returns triangles from the first corner of an outline to each of its other sides.
pub(super) fn marker(segment: usize, outline: &Outline, header: Header, axes: Axes) -> Marker {
    let label = segment as u32 + 1;
    let [r, g, b] = label_colour(label).map(|value| f32::from(value) / 255.0);
    let corners = outline.corners_m.iter().map(|&corner| axes.back(corner));
    let corners: Vec<Point> = corners.map(|[x, y, z]| Point { x, y, z }).collect();
    Marker {
        id: label as i32,
        color: ColorRgba { r, g, b, a: 0.5 },
        points: corners[1..].windows(2).flat_map(|side| [corners[0], side[0], side[1]]).collect(),
        ..empty(header)
    }
}

const TRIANGLE_LIST: i32 = 11;
const DELETE_ALL: i32 = 3;

fn empty(header: Header) -> Marker {
    Marker {
        header,
        ns: "planes",
        id: 0,
        r#type: TRIANGLE_LIST,
        action: 0,
        pose: Pose {
            position: Point { x: 0.0, y: 0.0, z: 0.0 },
            orientation: Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 },
        },
        scale: Point { x: 1.0, y: 1.0, z: 1.0 },
        color: ColorRgba { r: 0.0, g: 0.0, b: 0.0, a: 0.0 },
        lifetime: Time::default(),
        frame_locked: false,
        points: vec![],
        colors: vec![],
        texture_resource: "",
        texture: CompressedImage { header: Header::new(0, ""), format: "", data: vec![] },
        uv_coordinates: vec![],
        text: String::new(),
        mesh_resource: "",
        mesh_file: MeshFile { filename: "", data: vec![] },
        mesh_use_embedded_materials: false,
    }
}
