//! A page with the points of a segmented scan in 3D, that needs no other file and no network.
//!
//! `view.min.js` is three.js with what is in `host-sim/web/view`, which makes it: `npm ci && npm run
//! build` there.

mod told;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

use crate::export::Segmented;
use crate::picture::label_colour;
pub use told::{ToldPlane, ToldSegment};

/// Labels have so many colours, with that of none; then they begin anew at that of 1.
const COLOURS: u32 = 21;

/// Returns the colours of labels: of none, of 1, 2, ...; label n from the last on has that of
/// 1 + (n - 1) modulo their number less 1.
pub fn palette() -> Vec<[u8; 3]> {
    (0..COLOURS).map(label_colour).collect()
}

/// What the page is given, as JSON.
#[derive(Serialize)]
struct Data<'a> {
    name: &'a str,
    palette: Vec<[u8; 3]>,
    segments: Vec<ToldSegment>,
    /// x, y, z of each return as `f32`, little end first, in base64; metres.
    points: String,
    /// Its label as `u32`.
    labels: String,
}

/// Returns the page. It takes some 560 KB, and 22 bytes for each return.
///
/// # Errors
/// None that is known: numbers always have a form in JSON.
pub fn html(name: &str, scan: &Segmented<'_>) -> serde_json::Result<String> {
    let (mut points, mut labels) = (vec![], vec![]);
    for pixel in 0..scan.labels.len() {
        let Some(point) = scan.point_m(pixel) else { continue };
        point.iter().for_each(|x| points.extend((*x as f32).to_le_bytes()));
        labels.extend(scan.labels[pixel].to_le_bytes());
    }
    let data = Data {
        name,
        palette: palette(),
        segments: scan.segments.iter().map(ToldSegment::of).collect(),
        points: BASE64_STANDARD.encode(points),
        labels: BASE64_STANDARD.encode(labels),
    };
    // nothing in it ends the element in which it stands
    let data = serde_json::to_string(&data)?.replace('<', "\\u003c");
    let [style, viewer] = [include_str!("../style.css"), include_str!("view.min.js")];
    let page = include_str!("view.html").replace("{{style}}", style);
    Ok(page.replace("{{viewer}}", viewer).replace("{{data}}", &data))
}
