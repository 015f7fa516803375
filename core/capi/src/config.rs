//! The configuration as C has it.

use core::ffi::CStr;

use scanseg_core::{
    self as scanseg, AnyConfig, AnySegmenter, Beams, Columns, ConfigError, EdgeConfig, Element, MAX_COLUMNS, Memory,
    PlaneConfig, Ranging, RegionConfig, Sizes, TurnAxis,
};

use crate::check::{SCANSEG_ABI_VERSION, check_pointer, check_struct};
use crate::status::{SCANSEG_ERROR_ABI_VERSION, SCANSEG_ERROR_ALIGNMENT, SCANSEG_ERROR_CONFIG, Status};

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
    /// Most live labels; 0 (default): as many as any image needs, columns / 2 + 1. Fewer save 84
    /// bytes each.
    pub max_labels: u32,

    /// `SCANSEG_NODDING_Y`, `SCANSEG_NODDING_Z`, `SCANSEG_SPINNING` or `SCANSEG_PINHOLE`. No
    /// default.
    pub beams: u32,
    /// Spinning: 1 if the last column neighbours the first, else 0. Even columns must then go round
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
    /// Pinhole: focal length along a row, pixels; not 0.
    pub fx_px: f32,
    /// Pinhole: focal length along a column, pixels; not 0.
    pub fy_px: f32,
    /// Pinhole: column of the optical axis.
    pub cx_px: f32,
    /// Pinhole: row of the optical axis.
    pub cy_px: f32,

    /// Standard deviation of one range, metres, 0 to 10; default 0.01.
    pub range_noise_m: f32,
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
            fx_px: 0.0,
            fy_px: 0.0,
            cx_px: 0.0,
            cy_px: 0.0,
            range_noise_m: edge.ranging.range_noise_m,
            min_range_m: edge.ranging.min_range_m,
            max_range_m: edge.ranging.max_range_m,
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

/// Why a configuration cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Refused {
    pub status: Status,
    /// Of `SCANSEG_ERROR_CONFIG`.
    pub field: Option<&'static CStr>,
}

impl From<Status> for Refused {
    fn from(status: Status) -> Refused {
        Refused { status, field: None }
    }
}

fn refuse<T>(field: &'static CStr) -> Result<T, Refused> {
    Err(Refused { status: SCANSEG_ERROR_CONFIG, field: Some(field) })
}

/// A configuration that was checked, and the lists that it refers to.
pub(crate) struct Checked<'a> {
    pub config: Config,
    pub angles_rad: &'a [f32],
    pub traces: [scanseg::Trace; SCANSEG_MAX_TRACES],
}

impl<'a> Checked<'a> {
    /// Reads and checks a configuration.
    ///
    /// # Safety
    /// `config` is NULL, or points to `struct_size` bytes, and its list to as many angles as it
    /// says, for `'a`.
    pub unsafe fn read(config: *const Config) -> Result<Checked<'a>, Refused> {
        // SAFETY: the caller's promise; no more than the size is read before that is checked.
        let config = unsafe {
            check_struct(config, &raw const (*config).struct_size)?;
            config.read()
        };
        if config.abi_version != SCANSEG_ABI_VERSION {
            return Err(SCANSEG_ERROR_ABI_VERSION.into());
        }
        if config.columns == 0 || config.columns as usize > MAX_COLUMNS {
            return refuse(c"columns");
        }
        if config.trace_count == 0 || config.trace_count as usize > SCANSEG_MAX_TRACES {
            return refuse(c"trace_count");
        }
        let angles_rad = if config.column_angles_rad.is_null() {
            if config.column_angle_count > 0 {
                return refuse(c"column_angles_rad");
            }
            &[]
        } else {
            check_pointer(config.column_angles_rad).map_err(|_| SCANSEG_ERROR_ALIGNMENT)?;
            if config.column_angle_count != config.columns {
                return refuse(c"column_angle_count");
            }
            // SAFETY: aligned, not NULL, and the caller promises that there are as many.
            unsafe { core::slice::from_raw_parts(config.column_angles_rad, config.columns as usize) }
        };
        let traces = config.traces.map(|trace| scanseg::Trace { rows: trace.rows, columns: trace.columns });
        let checked = Checked { config, angles_rad, traces };
        checked.check()?;
        Ok(checked)
    }

    /// Whether there is a list of column angles that is used.
    pub fn listed(&self) -> bool {
        !self.angles_rad.is_empty() && self.config.beams != SCANSEG_PINHOLE
    }

    pub fn used_traces(&self) -> &[scanseg::Trace] {
        self.traces.get(..self.config.trace_count as usize).unwrap_or_default()
    }

    /// The configuration of each approach, with traces anywhere.
    fn configs<'b>(&self, traces: &'b [scanseg::Trace]) -> [AnyConfig<'b>; 3] {
        let c = &self.config;
        let ranging = Ranging::new(c.range_noise_m).with_limits(c.min_range_m, c.max_range_m);
        let edge = EdgeConfig::paper()
            .with_ranging(ranging)
            .with_traces(traces)
            .with_roof_angle_rad(c.roof_angle_rad)
            .with_step_angle_rad(c.step_angle_rad)
            .with_closing(if c.closing == SCANSEG_SQUARE { Element::Square } else { Element::Plus });
        let region = RegionConfig::paper()
            .with_ranging(ranging)
            .with_line_angle_rad(c.line_angle_rad)
            .with_plane_distance_m(c.plane_distance_m);
        [PlaneConfig::new(ranging).into(), edge.into(), region.into()]
    }

    /// The configuration of the approach that was chosen, with traces anywhere.
    pub fn any_config<'b>(&self, traces: &'b [scanseg::Trace]) -> AnyConfig<'b> {
        let [plane, edge, region] = self.configs(traces);
        match self.config.approach {
            SCANSEG_EDGE => edge,
            SCANSEG_REGION => region,
            _ => plane,
        }
    }

    /// What the memory of any approach has room for.
    pub fn sizes(&self) -> Sizes {
        let columns = self.config.columns as usize;
        let [plane, edge, region] = self.configs(self.used_traces()).map(|config| config.sizes(columns));
        plane.max(edge).max(region)
    }

    /// The beams, with a list of column angles anywhere.
    pub fn beams<'b>(&self, angles_rad: &'b [f32]) -> Beams<'b> {
        let c = &self.config;
        let columns = if self.listed() {
            Columns::Listed(angles_rad)
        } else {
            Columns::Even { start_rad: c.column_start_rad, step_rad: c.column_step_rad }
        };
        match c.beams {
            SCANSEG_PINHOLE => Beams::Pinhole { fx_px: c.fx_px, fy_px: c.fy_px, cx_px: c.cx_px, cy_px: c.cy_px },
            SCANSEG_SPINNING => Beams::Spinning { columns, wraps: c.wraps == 1 },
            SCANSEG_NODDING_Z => Beams::Nodding { columns, axis: TurnAxis::Z },
            _ => Beams::Nodding { columns, axis: TurnAxis::Y },
        }
    }

    fn check(&self) -> Result<(), Refused> {
        let c = &self.config;
        for (field, value, first, last) in [
            (c"approach", c.approach, SCANSEG_PLANE, SCANSEG_REGION),
            (c"beams", c.beams, SCANSEG_NODDING_Y, SCANSEG_PINHOLE),
            (c"wraps", c.wraps, 0, 1),
            (c"closing", c.closing, SCANSEG_PLUS, SCANSEG_SQUARE),
        ] {
            if !(first..=last).contains(&value) {
                return refuse(field);
            }
        }
        // the settings of all approaches, whichever is chosen
        for config in self.configs(self.used_traces()) {
            let no_memory = Memory { numbers: &mut [], halves: &mut [], words: &mut [], areas: &mut [] };
            match AnySegmenter::new(config, self.beams(self.angles_rad), c.columns as usize, no_memory).err() {
                // all that was wrong with it: the rest is good
                Some(ConfigError::Memory { .. }) | None => {}
                Some(ConfigError::Value { field, .. } | ConfigError::Count { field, .. }) => {
                    return refuse(field_of(field));
                }
                Some(_) => return refuse(c"column_angle_count"),
            }
        }
        Ok(())
    }
}

/// Our name of a field that the core refuses.
fn field_of(name: &str) -> &'static CStr {
    match name {
        "range_noise_m" => c"range_noise_m",
        "min_range_m" => c"min_range_m",
        "max_range_m" => c"max_range_m",
        "roof_angle_rad" => c"roof_angle_rad",
        "step_angle_rad" => c"step_angle_rad",
        "line_angle_rad" => c"line_angle_rad",
        "plane_distance_m" => c"plane_distance_m",
        "traces.rows" | "traces.columns" => c"traces",
        "start_rad" => c"column_start_rad",
        "step_rad" => c"column_step_rad",
        "wraps: step_rad" => c"wraps",
        "columns" => c"column_angles_rad",
        "fx_px" => c"fx_px",
        "fy_px" => c"fy_px",
        "cx_px" => c"cx_px",
        "cy_px" => c"cy_px",
        _ => c"unknown",
    }
}
