//! A configuration of C as the core has it.

use core::ffi::CStr;

use scanseg_core::{
    self as scanseg, AnyConfig, AnySegmenter, Beams, Columns, ConfigError, EdgeConfig, Element, MAX_COLUMNS, Memory,
    PlaneConfig, Ranging, RegionConfig, Sizes, TurnAxis,
};

use crate::check::{SCANSEG_ABI_VERSION, check_pointer, check_struct};
use crate::config::{
    Config, SCANSEG_EDGE, SCANSEG_FREE, SCANSEG_MAX_TRACES, SCANSEG_NODDING_Y, SCANSEG_NODDING_Z, SCANSEG_PINHOLE,
    SCANSEG_PLANE, SCANSEG_PLUS, SCANSEG_REGION, SCANSEG_SPINNING, SCANSEG_SQUARE,
};
use crate::status::{SCANSEG_ERROR_ABI_VERSION, SCANSEG_ERROR_ALIGNMENT, SCANSEG_ERROR_CONFIG, Status};

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
    pub turns_rad: &'a [f32],
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
        let names = [c"column_angles_rad", c"column_angle_count"];
        // SAFETY: the caller's promise.
        let angles_rad = unsafe { list(config.column_angles_rad, config.column_angle_count, config.columns, names)? };
        let names = [c"column_turns_rad", c"column_turn_count"];
        // SAFETY: as above.
        let turns_rad = unsafe { list(config.column_turns_rad, config.column_turn_count, config.columns, names)? };
        if angles_rad.is_empty() && !turns_rad.is_empty() {
            return refuse(c"column_angles_rad");
        }
        let traces = config.traces.map(|trace| scanseg::Trace { rows: trace.rows, columns: trace.columns });
        let checked = Checked { config, angles_rad, turns_rad, traces };
        checked.check()?;
        Ok(checked)
    }

    /// Lists of column angles that are used: of the angles, and of the turns.
    pub fn lists(&self) -> usize {
        let used = ![SCANSEG_PINHOLE, SCANSEG_FREE].contains(&self.config.beams);
        [self.angles_rad, self.turns_rad].iter().filter(|list| used && !list.is_empty()).count()
    }

    pub fn used_traces(&self) -> &[scanseg::Trace] {
        self.traces.get(..self.config.trace_count as usize).unwrap_or_default()
    }

    /// The configuration of each approach, with traces anywhere.
    fn configs<'b>(&self, traces: &'b [scanseg::Trace]) -> [AnyConfig<'b>; 3] {
        let c = &self.config;
        let ranging = Ranging::new(c.range_noise_m)
            .with_growing_noise(c.range_noise_per_m, c.range_noise_per_m2)
            .with_steps(c.range_step_m, c.range_step_per_m2)
            .with_correlation_px(c.noise_correlation_px)
            .with_beam_noise_rad(c.beam_noise_rad)
            .with_turn_noise_rad(c.turn_noise_rad)
            .with_flatness_m(c.flatness_m)
            .with_limits(c.min_range_m, c.max_range_m);
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
        let plane = PlaneConfig::new(ranging);
        let plane = if c.full_turns == 1 { plane.with_full_turns() } else { plane };
        [plane.into(), edge.into(), region.into()]
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
        let beams = self.beams(&[], &[]);
        let [plane, edge, region] = self.configs(self.used_traces()).map(|config| config.sizes_for(&beams, columns));
        plane.max(edge).max(region)
    }

    /// The beams, with lists of column angles and of turns anywhere.
    pub fn beams<'b>(&self, angles_rad: &'b [f32], turns_rad: &'b [f32]) -> Beams<'b> {
        let c = &self.config;
        let columns = match self.lists() {
            0 => Columns::Even { start_rad: c.column_start_rad, step_rad: c.column_step_rad },
            1 => Columns::Listed(angles_rad),
            _ => Columns::Beside { angles_rad, turns_rad },
        };
        match c.beams {
            SCANSEG_PINHOLE => Beams::Pinhole { fx_px: c.fx_px, fy_px: c.fy_px, cx_px: c.cx_px, cy_px: c.cy_px },
            SCANSEG_FREE => Beams::Free { wraps: c.wraps == 1 },
            SCANSEG_SPINNING => Beams::Spinning { columns, wraps: c.wraps == 1 },
            SCANSEG_NODDING_Z => Beams::Nodding { columns, axis: TurnAxis::Z },
            _ => Beams::Nodding { columns, axis: TurnAxis::Y },
        }
    }

    fn check(&self) -> Result<(), Refused> {
        let c = &self.config;
        for (field, value, first, last) in [
            (c"approach", c.approach, SCANSEG_PLANE, SCANSEG_REGION),
            (c"beams", c.beams, SCANSEG_NODDING_Y, SCANSEG_FREE),
            (c"wraps", c.wraps, 0, 1),
            (c"full_turns", c.full_turns, 0, 1),
            (c"closing", c.closing, SCANSEG_PLUS, SCANSEG_SQUARE),
        ] {
            if !(first..=last).contains(&value) {
                return refuse(field);
            }
        }
        // the settings of all approaches, whichever is chosen
        for config in self.configs(self.used_traces()) {
            let no_memory = Memory { numbers: &mut [], halves: &mut [], words: &mut [], areas: &mut [] };
            match AnySegmenter::new(config, self.beams(self.angles_rad, self.turns_rad), c.columns as usize, no_memory)
                .err()
            {
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

/// A list of the caller, one number per column, or none.
///
/// # Safety
/// `numbers` is NULL, or points to as many numbers as `count`, for `'a`.
unsafe fn list<'a>(
    numbers: *const f32,
    count: u32,
    columns: u32,
    [name, name_of_count]: [&'static CStr; 2],
) -> Result<&'a [f32], Refused> {
    if numbers.is_null() {
        return if count > 0 { refuse(name) } else { Ok(&[]) };
    }
    check_pointer(numbers).map_err(|_| SCANSEG_ERROR_ALIGNMENT)?;
    if count != columns {
        return refuse(name_of_count);
    }
    // SAFETY: aligned, not NULL, and the caller promises that there are as many.
    Ok(unsafe { core::slice::from_raw_parts(numbers, columns as usize) })
}

/// Our name of a field that the core refuses.
fn field_of(name: &str) -> &'static CStr {
    match name {
        "range_noise_m" => c"range_noise_m",
        "range_noise_per_m" => c"range_noise_per_m",
        "range_noise_per_m2" => c"range_noise_per_m2",
        "range_step_m" => c"range_step_m",
        "range_step_per_m2" => c"range_step_per_m2",
        "noise_correlation_px" => c"noise_correlation_px",
        "beam_noise_rad" => c"beam_noise_rad",
        "turn_noise_rad" => c"turn_noise_rad",
        "flatness_m" => c"flatness_m",
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
        "turns_rad" => c"column_turns_rad",
        "fx_px" => c"fx_px",
        "fy_px" => c"fy_px",
        "cx_px" => c"cx_px",
        "cy_px" => c"cy_px",
        _ => c"unknown",
    }
}
