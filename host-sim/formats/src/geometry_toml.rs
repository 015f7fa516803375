//! The geometry file: TOML to [`Geometry`] and back.
//!
//! Keys are taken out of the table one by one, so that every error names its key and what remains
//! is unknown. All that is wrong is told at once.
use std::fmt::Write;
use std::path::Path;

use toml::{Table, Value};

use crate::angles::Angles;
use crate::beside::Beside;
use crate::file::{FileError, read_at_most};
use crate::geometry::{Depth, Geometry, Kind, TurnAxis, check_order};
use crate::geometry_error::{GeometryError, short};
use crate::limits::{
    ANGLE_DEG, CENTRE_PX, ERROR_M, FOCAL_PX, LEVER_ARM_M, Limits, MAX_RANGE_M, MIN_RANGE_M, STEP_DEG, UNIT_M,
};
use crate::noise::{LIMITS, Noise};
use crate::sensors::{KNOWN, Sensor};

const NODDING: &str = "nodding";
const SPINNING: &str = "spinning";
const PINHOLE: &str = "pinhole";
const KINDS: [&str; 3] = [NODDING, SPINNING, PINHOLE];

/// Keys of every geometry file.
const KEYS: [&str; 16] = [
    "version",
    "unit_m",
    "no_return",
    "min_range_m",
    "max_range_m",
    "sensor",
    "range_noise_m",
    "range_noise_per_m",
    "range_noise_per_m2",
    "range_step_m",
    "range_step_per_m2",
    "noise_correlation_px",
    "beam_noise_deg",
    "turn_noise_deg",
    "flatness_m",
    "kind",
];
/// Keys of each of [`KINDS`].
const KEYS_OF_KINDS: [&[&str]; 3] = [
    &["beam_deg", "turn_deg", "turn_axis", "row_offset_deg", "column_offset_deg", "lever_arm_m"],
    &["azimuth_deg", "elevation_deg", "wraps", "row_offset_deg"],
    &["fx", "fy", "cx", "cy", "depth"],
];

/// What angles must be.
const ANGLES: &str = "a list of angles or { start, step } (degrees)";

/// What `version` must be.
const VERSION: &str = "the whole number 1";

/// No geometry file is longer: 65 535 + 16 384 angles and a comment at each.
pub(crate) const MAX_FILE_BYTES: u64 = 16 << 20;

impl Geometry {
    /// Reads the text of a geometry file, version 1.
    ///
    /// # Errors
    /// What is not TOML; or all keys that are missing, unknown (also: of another kind), ill-typed or
    /// out of their range, by name; the ranges are those of [`Geometry::check`].
    pub fn parse(toml_text: &str) -> Result<Geometry, GeometryError> {
        let table = toml_text.parse::<Table>().map_err(|e| {
            let offset = e.span().map_or(0, |span| span.start).min(toml_text.len());
            let line = 1 + toml_text.as_bytes()[..offset].iter().filter(|b| **b == b'\n').count();
            GeometryError::Syntax { line, message: e.message().replace('\n', ", ") }
        })?;
        let mut keys = Keys { table, prefix: String::new(), errors: vec![] };
        let geometry = geometry(&mut keys);
        GeometryError::all(keys.errors)?;
        Ok(geometry.expect("every value that is not there is an error"))
    }

    /// Reads a geometry file.
    ///
    /// # Errors
    /// Names the file, and says what the system or [`Geometry::parse`] says.
    pub fn read(path: impl AsRef<Path>) -> Result<Geometry, FileError> {
        let path = path.as_ref();
        let bytes = read_at_most(path, MAX_FILE_BYTES).map_err(|e| FileError::new(path, e))?;
        let text = String::from_utf8(bytes).map_err(|e| FileError::new(path, e.utf8_error()))?;
        Geometry::parse(&text).map_err(|e| FileError::new(path, e))
    }

    /// Returns the text of a geometry file from which [`Geometry::parse`] makes an equal geometry,
    /// provided that it passes [`Geometry::check`]. The numbers of a sensor that was named are
    /// written out.
    pub fn to_toml(&self) -> String {
        let mut text = format!("version = 1\nunit_m = {:?}\nno_return = {:?}\n", self.unit_m, self.no_return);
        // Writing to a string cannot fail; `{:?}` of an f64 is the shortest text that reads back as
        // the same number.
        let mut line = |key: &str, value: String| {
            let _ = writeln!(text, "{key} = {value}");
        };
        let limits = [
            ("min_range_m", self.min_range_m),
            ("max_range_m", self.max_range_m),
            ("range_noise_m", self.range_noise_m),
        ];
        for (key, value) in limits {
            if let Some(m) = value {
                line(key, format!("{m:?}"));
            }
        }
        for ((key, value), (_, none)) in { self.noise }.keys().into_iter().zip({ Noise::NONE }.keys()) {
            if *value != *none {
                line(key, format!("{value:?}"));
            }
        }
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, turn_axis } => {
                line("kind", format!("{NODDING:?}"));
                line("beam_deg", angles_toml(beam_deg));
                line("turn_deg", angles_toml(turn_deg));
                let axis = match turn_axis {
                    TurnAxis::Y => "y",
                    TurnAxis::Z => "z",
                };
                line("turn_axis", format!("{axis:?}"));
            }
            Kind::Spinning { azimuth_deg, elevation_deg, wraps } => {
                line("kind", format!("{SPINNING:?}"));
                line("azimuth_deg", angles_toml(azimuth_deg));
                line("elevation_deg", angles_toml(elevation_deg));
                line("wraps", wraps.to_string());
            }
            Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, depth } => {
                line("kind", format!("{PINHOLE:?}"));
                let depth = match depth {
                    Depth::Z => "z",
                    Depth::Range => "range",
                };
                line("depth", format!("{depth:?}"));
                for (key, value) in [("fx", fx_px), ("fy", fy_px), ("cx", cx_px), ("cy", cy_px)] {
                    line(key, format!("{value:?}"));
                }
            }
            // no file has it
            Kind::Free { .. } => line("kind", "\"free\"".to_string()),
        }
        let Beside { row_offset_deg, column_offset_deg, lever_arm_m } = &self.beside;
        for (key, angles) in [("row_offset_deg", row_offset_deg), ("column_offset_deg", column_offset_deg)] {
            if let Some(angles) = angles {
                line(key, angles_toml(angles));
            }
        }
        if *lever_arm_m != 0.0 {
            line("lever_arm_m", format!("{lever_arm_m:?}"));
        }
        text
    }
}

fn angles_toml(angles: &Angles) -> String {
    match angles {
        Angles::Even { start_deg, step_deg } => format!("{{ start = {start_deg:?}, step = {step_deg:?} }}"),
        Angles::Listed(list) => format!("{list:?}"),
    }
}

/// Takes all keys out of the table. What is not there has left an error.
fn geometry(keys: &mut Keys) -> Option<Geometry> {
    match keys.required("version", VERSION) {
        Some(Value::Integer(1)) => {}
        Some(other) => {
            // another version may have other keys
            keys.wrong("version", &other, VERSION);
            return None;
        }
        None => {}
    }
    let unit_m = keys.number("unit_m", &UNIT_M);
    let no_return = keys.counts();
    let min_range_m = keys.optional_number("min_range_m", &MIN_RANGE_M);
    let max_range_m = keys.optional_number("max_range_m", &MAX_RANGE_M);
    keys.errors.extend(check_order(min_range_m, max_range_m).err());
    let sensor = keys.sensor();
    let range_noise_m = keys.optional_number("range_noise_m", &ERROR_M).or(sensor.map(|sensor| sensor.range_noise_m()));
    let mut noise = sensor.map_or(Noise::NONE, |sensor| sensor.noise());
    for ((key, value), limits) in noise.keys().into_iter().zip(LIMITS) {
        *value = keys.optional_number(key, limits).unwrap_or(*value);
    }
    let name = keys.word("kind", &KINDS, "one of nodding, spinning, pinhole");
    let kind = match name {
        Some(NODDING) => nodding(keys),
        Some(SPINNING) => spinning(keys),
        Some(_) => pinhole(keys),
        None => None,
    };
    let beside = match name {
        Some(NODDING) => Beside {
            row_offset_deg: keys.optional_angles("row_offset_deg"),
            column_offset_deg: keys.optional_angles("column_offset_deg"),
            lever_arm_m: keys.optional_number("lever_arm_m", &LEVER_ARM_M).unwrap_or(0.0),
        },
        Some(SPINNING) => Beside { row_offset_deg: keys.optional_angles("row_offset_deg"), ..Beside::NONE },
        _ => Beside::NONE,
    };
    keys.nothing_left(name);
    Some(Geometry { unit_m: unit_m?, no_return, min_range_m, max_range_m, range_noise_m, noise, kind: kind?, beside })
}

fn nodding(keys: &mut Keys) -> Option<Kind> {
    let (beam_deg, turn_deg) = (keys.angles("beam_deg"), keys.angles("turn_deg"));
    let turn_axis = match keys.word("turn_axis", &["y", "z"], "y or z")? {
        "y" => TurnAxis::Y,
        _ => TurnAxis::Z,
    };
    Some(Kind::Nodding { beam_deg: beam_deg?, turn_deg: turn_deg?, turn_axis })
}

fn spinning(keys: &mut Keys) -> Option<Kind> {
    let (azimuth_deg, elevation_deg) = (keys.angles("azimuth_deg"), keys.angles("elevation_deg"));
    let wraps = match keys.take("wraps") {
        None => false,
        Some(Value::Boolean(wraps)) => wraps,
        Some(other) => {
            keys.wrong("wraps", &other, "true or false");
            return None;
        }
    };
    Some(Kind::Spinning { azimuth_deg: azimuth_deg?, elevation_deg: elevation_deg?, wraps })
}

fn pinhole(keys: &mut Keys) -> Option<Kind> {
    let [fx_px, fy_px] = ["fx", "fy"].map(|key| keys.number(key, &FOCAL_PX));
    let [cx_px, cy_px] = ["cx", "cy"].map(|key| keys.number(key, &CENTRE_PX));
    let depth = match keys.word("depth", &["z", "range"], "z or range")? {
        "z" => Depth::Z,
        _ => Depth::Range,
    };
    Some(Kind::Pinhole { fx_px: fx_px?, fy_px: fy_px?, cx_px: cx_px?, cy_px: cy_px?, depth })
}

/// The keys of a table that have not been taken yet, and what was wrong with those that have.
struct Keys {
    table: Table,
    /// What stands before the keys in messages: empty, or the table's own key and a dot.
    prefix: String,
    errors: Vec<GeometryError>,
}

impl Keys {
    fn name(&self, key: &str) -> String {
        format!("{}{key}", self.prefix)
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        self.table.remove(key)
    }

    /// Notes a value that is not as it must be.
    fn wrong(&mut self, key: &str, found: &Value, rule: &'static str) {
        self.errors.push(GeometryError::value(&self.name(key), shown(found), rule));
    }

    fn required(&mut self, key: &str, rule: &'static str) -> Option<Value> {
        let value = self.take(key);
        if value.is_none() {
            self.errors.push(GeometryError::Missing { key: self.name(key), rule });
        }
        value
    }

    fn number(&mut self, key: &str, limits: &Limits) -> Option<f64> {
        let value = self.required(key, limits.text)?;
        self.number_of(key, &value, limits)
    }

    fn optional_number(&mut self, key: &str, limits: &Limits) -> Option<f64> {
        let value = self.take(key)?;
        self.number_of(key, &value, limits)
    }

    fn number_of(&mut self, key: &str, value: &Value, limits: &Limits) -> Option<f64> {
        let number = match value {
            Value::Float(x) => *x,
            Value::Integer(i) => *i as f64,
            other => {
                self.wrong(key, other, limits.text);
                return None;
            }
        };
        match limits.check(&self.name(key), number) {
            Ok(()) => Some(number),
            Err(e) => {
                self.errors.push(e);
                None
            }
        }
    }

    fn word(&mut self, key: &str, words: &[&'static str], rule: &'static str) -> Option<&'static str> {
        let found = self.required(key, rule)?;
        let known = words.iter().copied().find(|word| found.as_str() == Some(*word));
        if known.is_none() {
            self.wrong(key, &found, rule);
        }
        known
    }

    /// The counts that are no return.
    fn counts(&mut self) -> Vec<u16> {
        match self.take("no_return") {
            None => vec![],
            Some(Value::Array(list)) => {
                let count = |value: &Value| value.as_integer().and_then(|n| u16::try_from(n).ok());
                if let Some(i) = list.iter().position(|value| count(value).is_none()) {
                    self.wrong(&format!("no_return[{i}]"), &list[i], "a whole number from 0 to 65535");
                }
                list.iter().filter_map(count).collect()
            }
            Some(other) => {
                self.wrong("no_return", &other, "a list of whole numbers from 0 to 65535");
                vec![]
            }
        }
    }

    /// The sensor that the file names.
    fn sensor(&mut self) -> Option<Sensor> {
        let name = self.take("sensor")?;
        let sensor = name.as_str().and_then(Sensor::named);
        if sensor.is_none() {
            self.wrong("sensor", &name, KNOWN);
        }
        sensor
    }

    fn angles(&mut self, key: &'static str) -> Option<Angles> {
        let value = self.required(key, ANGLES)?;
        self.angles_of(key, value)
    }

    fn optional_angles(&mut self, key: &'static str) -> Option<Angles> {
        let value = self.take(key)?;
        self.angles_of(key, value)
    }

    fn angles_of(&mut self, key: &'static str, value: Value) -> Option<Angles> {
        match value {
            Value::Array(list) if list.is_empty() => {
                self.errors.push(GeometryError::value(key, "[]", "one angle or more"));
                None
            }
            Value::Array(list) => {
                // the first that is wrong says enough
                let entries = (0..).zip(&list);
                let entries = entries.map(|(i, value)| self.number_of(&format!("{key}[{i}]"), value, &ANGLE_DEG));
                Some(Angles::Listed(entries.collect::<Option<_>>()?))
            }
            Value::Table(table) => {
                let mut keys = Keys { table, prefix: format!("{key}."), errors: vec![] };
                let (start_deg, step_deg) = (keys.number("start", &ANGLE_DEG), keys.number("step", &STEP_DEG));
                keys.unknown("{ start, step }", &["start", "step"]);
                self.errors.append(&mut keys.errors);
                Some(Angles::Even { start_deg: start_deg?, step_deg: step_deg? })
            }
            other => {
                self.wrong(key, &other, ANGLES);
                None
            }
        }
    }

    /// Notes the keys that are left.
    fn nothing_left(&mut self, kind: Option<&'static str>) {
        let of_kinds = KINDS.into_iter().zip(KEYS_OF_KINDS).filter(|(name, _)| kind.is_none_or(|kind| kind == *name));
        let known: Vec<&str> = of_kinds.flat_map(|(_, keys)| keys).chain(&KEYS).copied().collect();
        if kind.is_none() {
            // whose keys they are is not known
            known.iter().for_each(|key| _ = self.take(key));
        }
        self.unknown(kind.unwrap_or_default(), &known);
    }

    fn unknown(&mut self, kind: &'static str, known: &[&'static str]) {
        for key in self.table.keys() {
            let like = |known: &str| strsim::jaro_winkler(&key.to_lowercase(), known);
            let nearest = known.iter().copied().max_by(|a, b| like(a).total_cmp(&like(b)));
            let nearest = nearest.filter(|nearest| like(nearest) > ALIKE);
            self.errors.push(GeometryError::Unknown { key: short(&self.name(key)), kind, nearest });
        }
    }
}

/// How alike two keys are when one may be meant for the other, of 1.
const ALIKE: f64 = 0.8;

/// A value in a message: what it is, unless it is short.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => format!("\"{}\"", short(text)),
        Value::Integer(i) => i.to_string(),
        Value::Float(x) => format!("{x:?}"),
        Value::Boolean(is) => is.to_string(),
        Value::Datetime(_) => "a date".to_string(),
        Value::Array(_) => "a list".to_string(),
        Value::Table(_) => "a table".to_string(),
    }
}
