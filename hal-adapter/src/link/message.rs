//! The messages of the link.

use scanseg_core::Segment;
use serde::{Deserialize, Serialize};

use crate::lms2xx::Trouble;
use crate::rig::{Counters, ScanFinished, ScanStarted};

/// Version of the messages, in [`Message::Hello`].
pub const VERSION: u8 = 1;

/// A message of a board to its host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// The first message of a sender after its start. The sequence begins with it.
    Hello {
        /// [`VERSION`].
        version: u8,
    },
    /// A scan has begun. Labels begin again.
    ScanStarted(ScanStarted),
    /// A segment is complete.
    Segment(SegmentReport),
    /// Two areas of this scan are one. Pixels labelled `from` in earlier rows belong to `into`. An
    /// earlier report of a segment `from` is void. The last report of a label is valid. See
    /// [`scanseg_core::Join`].
    Join {
        /// The label that ends here.
        from: u32,
        /// The label that goes on.
        into: u32,
    },
    /// A scan is over.
    ScanFinished(ScanFinished),
    /// Sent from time to time, during scans or not.
    Status(Counters),
    /// A trouble with the scanner.
    Trouble(Trouble),
}

/// A segment, see [`Segment`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SegmentReport {
    /// Its label.
    pub label: u32,
    /// Number of pixels.
    pub pixels: u32,
    /// First row with a pixel of it.
    pub first_row: u16,
    /// Last row with a pixel of it.
    pub last_row: u16,
    /// Leftmost column with a pixel of it.
    pub first_column: u16,
    /// Rightmost column with a pixel of it.
    pub last_column: u16,
    /// Mean of its points, metres.
    pub centroid_m: [f32; 3],
    /// Its plane, if its points define one.
    pub plane: Option<PlaneReport>,
}

/// A plane, see [`scanseg_core::Plane`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlaneReport {
    /// Unit normal towards the scanner.
    pub normal: [f32; 3],
    /// Distance from the scanner, metres.
    pub distance_m: f32,
    /// Root of the mean squared distance of the points, metres.
    pub rms_m: f32,
    /// Covariance of (normal x, y, z, distance): xx, xy, xz, xd, yy, yz, yd, zz, zd, dd.
    pub covariance: [f32; 10],
}

impl From<&Segment> for SegmentReport {
    /// Computes the plane.
    fn from(segment: &Segment) -> Self {
        let plane = segment.plane().map(|plane| {
            let [[xx, xy, xz, xd], [_, yy, yz, yd], [_, _, zz, zd], [_, _, _, dd]] = plane.covariance;
            PlaneReport {
                normal: plane.normal,
                distance_m: plane.distance_m,
                rms_m: plane.rms_m,
                covariance: [xx, xy, xz, xd, yy, yz, yd, zz, zd, dd],
            }
        });
        Self {
            label: segment.label.0,
            pixels: segment.pixels(),
            first_row: segment.first_row,
            last_row: segment.last_row,
            first_column: segment.first_column,
            last_column: segment.last_column,
            centroid_m: segment.centroid_m(),
            plane,
        }
    }
}
