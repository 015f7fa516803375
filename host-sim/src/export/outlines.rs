//! The outlines of segments as lists and as polygons for viewers.

use std::fmt::Write;

use serde::Serialize;

use crate::export::outline::{Outline, outlines_of};
use crate::export::planarity::planarities_of;
use crate::export::segmented::Segmented;
use crate::picture::label_colour;

/// What is written of a segment that has an outline.
#[derive(Serialize)]
struct Entry {
    label: u32,
    pixels: u32,
    area_m2: f64,
    normal: [f32; 3],
    distance_m: f32,
    rms_m: f32,
    residual_per_noise: Option<f32>,
    planarity: &'static str,
}

/// Outlines with what they are of.
pub struct Outlines {
    list: Vec<(Entry, Outline)>,
}

#[derive(Serialize)]
struct Polygon<'a> {
    #[serde(flatten)]
    entry: &'a Entry,
    corners_m: &'a [[f64; 3]],
}

/// Of a GeoJSON file.
#[derive(Serialize)]
struct Feature<'a> {
    r#type: &'static str,
    id: u32,
    properties: &'a Entry,
    geometry: Geometry,
}

#[derive(Serialize)]
struct Geometry {
    r#type: &'static str,
    coordinates: [Vec<[f64; 3]>; 1],
}

#[derive(Serialize)]
struct FeatureCollection<'a> {
    r#type: &'static str,
    /// What its coordinates are, since they are not those of GeoJSON.
    coordinates: &'static str,
    features: Vec<Feature<'a>>,
}

impl Outlines {
    /// Returns the outlines of a scan. Segments without one are left out.
    pub fn of(scan: &Segmented<'_>) -> Outlines {
        let (outlines, planarities) = (outlines_of(scan), planarities_of(scan));
        let mut list = vec![];
        for (i, (segment, outline)) in scan.segments.iter().zip(outlines).enumerate() {
            let Some((plane, outline)) = segment.plane().zip(outline) else { continue };
            let entry = Entry {
                label: i as u32 + 1,
                pixels: segment.pixels(),
                area_m2: outline.area_m2,
                normal: plane.normal,
                distance_m: plane.distance_m,
                rms_m: plane.rms_m,
                residual_per_noise: planarities[i].residual_per_noise,
                planarity: planarities[i].verdict.name(),
            };
            list.push((entry, outline));
        }
        Outlines { list }
    }

    /// Returns a JSON list: a segment each, with its corners.
    ///
    /// # Errors
    /// None that is known.
    pub fn json(&self) -> serde_json::Result<Vec<u8>> {
        let polygons: Vec<_> =
            self.list.iter().map(|(entry, outline)| Polygon { entry, corners_m: &outline.corners_m }).collect();
        serde_json::to_vec_pretty(&polygons)
    }

    /// Returns a CSV file: a corner each.
    pub fn csv(&self) -> Vec<u8> {
        let mut text = "label,corner,x_m,y_m,z_m\n".to_string();
        for (entry, outline) in &self.list {
            for (i, [x, y, z]) in outline.corners_m.iter().enumerate() {
                let _ = writeln!(text, "{},{i},{x:.6},{y:.6},{z:.6}", entry.label);
            }
        }
        text.into_bytes()
    }

    /// Returns an ASCII PLY file: a coloured face each, with the label of its segment.
    pub fn ply(&self) -> Vec<u8> {
        let corners = || self.list.iter().flat_map(|(_, outline)| &outline.corners_m);
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty list int int vertex_indices\nproperty uchar red\nproperty uchar green\n\
             property uchar blue\nproperty int label\nend_header\n",
            corners().count(),
            self.list.len()
        );
        corners().for_each(|[x, y, z]| _ = writeln!(text, "{x:.6} {y:.6} {z:.6}"));
        let mut first = 0;
        for (entry, outline) in &self.list {
            let count = outline.corners_m.len();
            let _ = write!(text, "{count}");
            (first..first + count).for_each(|corner| _ = write!(text, " {corner}"));
            let [red, green, blue] = label_colour(entry.label);
            let _ = writeln!(text, " {red} {green} {blue} {}", entry.label);
            first += count;
        }
        text.into_bytes()
    }

    /// Returns a file as GeoJSON has it (RFC 7946), but for its coordinates: they are not longitude and
    /// latitude, but metres in the scanner's frame.
    ///
    /// # Errors
    /// None that is known.
    pub fn geojson(&self) -> serde_json::Result<Vec<u8>> {
        let features = self.list.iter().map(|(entry, outline)| {
            let mut ring = outline.corners_m.clone();
            ring.push(ring[0]);
            let geometry = Geometry { r#type: "Polygon", coordinates: [ring] };
            Feature { r#type: "Feature", id: entry.label, properties: entry, geometry }
        });
        serde_json::to_vec(&FeatureCollection {
            r#type: "FeatureCollection",
            coordinates: "metres, scanner's frame: x forward, y left, z up",
            features: features.collect(),
        })
    }
}
