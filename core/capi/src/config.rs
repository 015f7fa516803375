//! The configuration as C has it.

use scanseg_core::{EdgeConfig, RegionConfig};

/// `approach`: planes that go on from row to row. The default, and right at the noise of real
/// scanners.
pub const SCANSEG_PLANE: u32 = 0;
/// `approach`: areas between edges of bearing-angle images, as in the paper. Labels come three rows
/// late.
pub const SCANSEG_EDGE: u32 = 1;
/// `approach`: regions grown from the lines of each row, the paper's other one.
pub const SCANSEG_REGION: u32 = 2;

/// `beams`: a 2D scanner whose scan plane tilts about the axis y (to the left).
/// Direction = (cos b cos t, sin b, cos b sin t) for the column angle b and the row angle t.
pub const SCANSEG_NODDING_Y: u32 = 1;
/// `beams`: a 2D scanner whose scan plane pans about the axis z (upright). Direction = (cos b cos
/// t, cos b sin t, sin b).
pub const SCANSEG_NODDING_Z: u32 = 2;
/// `beams`: a spinning scanner. Direction = (cos e cos a, cos e sin a, sin e) for the column angle
/// a (azimuth) and the row angle e (elevation).
pub const SCANSEG_SPINNING: u32 = 3;
/// `beams`: a camera. Direction = (1, -(u - cx) / fx, -(v - cy) / fy), normalised, for column u and
/// row v. Ranges are along the beam, not depths.
pub const SCANSEG_PINHOLE: u32 = 4;

/// `beams`: any; each row brings the directions of its beams, see `scanseg_row_beams`. Takes some
/// two times as long as the other kinds.
pub const SCANSEG_FREE: u32 = 5;

/// `closing`: a pixel and its four neighbours, as in the paper.
pub const SCANSEG_PLUS: u32 = 0;
/// `closing`: 3 x 3 pixels.
pub const SCANSEG_SQUARE: u32 = 1;

/// Elements of `traces`.
pub const SCANSEG_MAX_TRACES: usize = 8;

/// A direction through the image: from a pixel back to the previous one on the trace.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Trace {
    /// The previous pixel is so many rows earlier, 0 to 16.
    pub rows: u8,
    /// And so many columns to the left; negative, only with `rows` above 0, is to the right.
    pub columns: i8,
}

/// The configuration of a segmenter. `scanseg_config_init` sets it to the defaults; then at least
/// `columns` and `beams` are to be set, and what the beams need. It is copied: nothing of it need
/// stay after `scanseg_init`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Config {
    /// `sizeof(scanseg_config)`.
    pub struct_size: u32,
    /// `SCANSEG_ABI_VERSION`.
    pub abi_version: u32,
    /// `SCANSEG_PLANE` (default), `SCANSEG_EDGE` or `SCANSEG_REGION`.
    pub approach: u32,
    /// Columns of the image, 1 to 16384. No default.
    pub columns: u32,
    /// Most live labels; 0 (default): as many as any indoor scan needs, and by the paper's two
    /// approaches any image. Fewer save 88 bytes each.
    pub max_labels: u32,

    /// `SCANSEG_NODDING_Y`, `SCANSEG_NODDING_Z`, `SCANSEG_SPINNING` or `SCANSEG_PINHOLE`. No
    /// default.
    pub beams: u32,
    /// Spinning and free: 1 if the last column neighbours the first, else 0. Even columns must then go round
    /// exactly once.
    pub wraps: u32,
    /// Nodding and spinning, even columns: angle of column 0, radians, within +-2 pi. Nodding:
    /// measured from the middle of the scan plane, so that the axis is at +-pi / 2.
    pub column_start_rad: f32,
    /// From a column to the next, radians; not 0, within +-pi / 2.
    pub column_step_rad: f32,
    /// Nodding and spinning, columns that are not even: one angle per column, radians. NULL: they
    /// are even.
    pub column_angles_rad: *const f32,
    /// Elements of `column_angles_rad`: `columns`, or 0 for even columns.
    pub column_angle_count: u32,
    /// Nodding, with `column_angles_rad`: how much more than its row each column is turned, radians,
    /// within +-pi / 2, as of the lasers of one firing that look beside it. NULL: not at all.
    pub column_turns_rad: *const f32,
    /// Elements of `column_turns_rad`: `columns`, or 0.
    pub column_turn_count: u32,
    /// Plane: 1 if a scan is a full turn, whose last row neighbours its first one, as the firings of a
    /// spinning lidar; else 0 (default).
    pub full_turns: u32,
    /// Pinhole: focal length along a row, pixels; not 0.
    pub fx_px: f32,
    /// Pinhole: focal length along a column, pixels; not 0.
    pub fy_px: f32,
    /// Pinhole: column of the optical axis.
    pub cx_px: f32,
    /// Pinhole: row of the optical axis.
    pub cy_px: f32,

    /// Standard deviation of one range, metres, 0 to 10; default 0.01. `SCANSEG_PLANE` measures the
    /// noise in the scan too, and the larger of both counts; with 0 that measured.
    pub range_noise_m: f32,
    /// Plane: the standard deviation grows by so much with each metre of the range; 0 to 1, default
    /// 0. Only `SCANSEG_PLANE` uses this and what follows up to `flatness_m`.
    pub range_noise_per_m: f32,
    /// Plane: and by so much with the square of the range, 1 / m; 0 to 1, default 0. Cameras with a
    /// disparity noise of d pixels at baseline B and focal length f have d / (f B).
    pub range_noise_per_m2: f32,
    /// Plane: step between neighbouring counts of a range, metres; 0 to 10, default 0.
    pub range_step_m: f32,
    /// Plane: the same, growing with the square of the range, 1 / m; 0 to 1, default 0.
    pub range_step_per_m2: f32,
    /// Plane: pixels over which errors of ranges are alike, along rows and columns; 1 to 100,
    /// default 1. Depth cameras: 4.
    pub noise_correlation_px: f32,
    /// Plane: standard deviation of the direction of a beam within its row, radians; 0 to 0.1,
    /// default 0.
    pub beam_noise_rad: f32,
    /// Plane: standard deviation of the turn angle of a row, radians; 0 to 0.1, default 0. Of nodding
    /// scanners only.
    pub turn_noise_rad: f32,
    /// Plane: surfaces are flat to this, one standard deviation across the plane, metres; 0 to 10,
    /// default 0.
    pub flatness_m: f32,
    /// Nearer ranges are no return, metres, above 0; default 0.05.
    pub min_range_m: f32,
    /// Farther ranges are no return, metres, up to 500; default 100.
    pub max_range_m: f32,
    /// Edge: a roof edge is where the bearing angle turns by this much, radians, above 0, up to pi;
    /// default 20 deg.
    pub roof_angle_rad: f32,
    /// Edge: a step edge needs a bearing angle within this of 0 or pi, radians, 0 to pi / 2;
    /// default 6 deg.
    pub step_angle_rad: f32,
    /// Edge: `SCANSEG_PLUS` (default) or `SCANSEG_SQUARE`.
    pub closing: u32,
    /// Region: a line ends where the bearing angle turns by this much, radians, above 0, up to pi /
    /// 2; default 3 deg.
    pub line_angle_rad: f32,
    /// Region: how far a surface may be from a plane beside the noise, metres, 0 to 1; default
    /// 0.005.
    pub plane_distance_m: f32,
    /// Edge: how many of `traces` are used, 1 to 8; default 2.
    pub trace_count: u32,
    /// Edge: the traces whose edges are combined; default: along rows and along columns, between
    /// neighbours.
    pub traces: [Trace; SCANSEG_MAX_TRACES],
}

impl Config {
    pub(crate) fn defaults(struct_size: u32, abi_version: u32) -> Config {
        let (edge, region) = (EdgeConfig::paper(), RegionConfig::paper());
        let ranging = edge.ranging;
        let mut traces = [Trace { rows: 0, columns: 0 }; SCANSEG_MAX_TRACES];
        for (trace, of) in traces.iter_mut().zip(edge.traces) {
            *trace = Trace { rows: of.rows, columns: of.columns };
        }
        Config {
            struct_size,
            abi_version,
            approach: SCANSEG_PLANE,
            columns: 0,
            max_labels: 0,
            beams: 0,
            wraps: 0,
            column_start_rad: 0.0,
            column_step_rad: 0.0,
            column_angles_rad: core::ptr::null(),
            column_angle_count: 0,
            column_turns_rad: core::ptr::null(),
            column_turn_count: 0,
            full_turns: 0,
            fx_px: 0.0,
            fy_px: 0.0,
            cx_px: 0.0,
            cy_px: 0.0,
            range_noise_m: ranging.range_noise_m,
            range_noise_per_m: ranging.range_noise_per_m,
            range_noise_per_m2: ranging.range_noise_per_m2,
            range_step_m: ranging.range_step_m,
            range_step_per_m2: ranging.range_step_per_m2,
            noise_correlation_px: ranging.noise_correlation_px,
            beam_noise_rad: ranging.beam_noise_rad,
            turn_noise_rad: ranging.turn_noise_rad,
            flatness_m: ranging.flatness_m,
            min_range_m: ranging.min_range_m,
            max_range_m: ranging.max_range_m,
            roof_angle_rad: edge.roof_angle_rad,
            step_angle_rad: edge.step_angle_rad,
            closing: SCANSEG_PLUS,
            line_angle_rad: region.line_angle_rad,
            plane_distance_m: region.plane_distance_m,
            trace_count: edge.traces.len() as u32,
            traces,
        }
    }
}
