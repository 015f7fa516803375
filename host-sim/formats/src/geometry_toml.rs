//! The geometry file: TOML to [`Geometry`] and back.
//!
//! Keys are taken out of the table one by one, so that every error names its key and what remains
//! is unknown.
use std::fmt::Write;
use std::path::Path;

use toml::{Table, Value};

use crate::file::{FileError, read_at_most};
use crate::geometry::{Angles, Depth, Geometry, GeometryError, Kind, TurnAxis, short};
use crate::noise::Noise;
use crate::sensors::{KNOWN, Sensor};

const NODDING: &str = "nodding";
const SPINNING: &str = "spinning";
const PINHOLE: &str = "pinhole";

/// No geometry file is longer: 65 535 + 16 384 angles and a comment at each.
const MAX_FILE_BYTES: u64 = 16 << 20;

impl Geometry {
    /// Reads the text of a geometry file, version 1.
    ///
    /// # Errors
    /// What is not TOML, missing, unknown (also: of another kind), ill-typed or out of its
    /// range, by name; the ranges are those of [`Geometry::check`].
    pub fn parse(toml_text: &str) -> Result<Geometry, GeometryError> {
        let table = toml_text.parse::<Table>().map_err(|e| {
            let offset = e.span().map_or(0, |span| span.start).min(toml_text.len());
            let line = 1 + toml_text.as_bytes()[..offset].iter().filter(|b| **b == b'\n').count();
            GeometryError::Syntax { line, message: e.message().replace('\n', ", ") }
        })?;
        let mut keys = Keys { table, prefix: String::new() };

        match keys.required("version")? {
            Value::Integer(1) => {}
            Value::Integer(version) => return Err(GeometryError::value("version", version, "1")),
            other => return Err(type_error("version", "the integer 1", &other)),
        }
        let unit_m = keys.number("unit_m")?;
        let no_return = keys.take("no_return").map_or(Ok(Vec::new()), counts)?;
        let min_range_m = keys.optional_number("min_range_m")?;
        let max_range_m = keys.optional_number("max_range_m")?;
        let sensor = keys.sensor()?;
        let range_noise_m = keys.optional_number("range_noise_m")?.or(sensor.map(|sensor| sensor.range_noise_m()));
        let mut noise = sensor.map_or(Noise::NONE, |sensor| sensor.noise());
        for (key, value) in noise.keys() {
            *value = keys.optional_number(key)?.unwrap_or(*value);
        }
        let (kind_name, kind) =
            keys.word("kind", &[NODDING, SPINNING, PINHOLE], "one of nodding, spinning, pinhole").and_then(|name| {
                let kind = match name {
                    NODDING => nodding(&mut keys),
                    SPINNING => spinning(&mut keys),
                    _ => pinhole(&mut keys),
                };
                Ok((name, kind?))
            })?;
        keys.finish(kind_name)?;

        let geometry = Geometry { unit_m, no_return, min_range_m, max_range_m, range_noise_m, noise, kind };
        geometry.check()?;
        Ok(geometry)
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

fn nodding(keys: &mut Keys) -> Result<Kind, GeometryError> {
    Ok(Kind::Nodding {
        beam_deg: keys.angles("beam_deg")?,
        turn_deg: keys.angles("turn_deg")?,
        turn_axis: match keys.word("turn_axis", &["y", "z"], "y or z")? {
            "y" => TurnAxis::Y,
            _ => TurnAxis::Z,
        },
    })
}

fn spinning(keys: &mut Keys) -> Result<Kind, GeometryError> {
    Ok(Kind::Spinning {
        azimuth_deg: keys.angles("azimuth_deg")?,
        elevation_deg: keys.angles("elevation_deg")?,
        wraps: match keys.take("wraps") {
            None => false,
            Some(Value::Boolean(wraps)) => wraps,
            Some(other) => return Err(type_error("wraps", "true or false", &other)),
        },
    })
}

fn pinhole(keys: &mut Keys) -> Result<Kind, GeometryError> {
    Ok(Kind::Pinhole {
        fx_px: keys.number("fx")?,
        fy_px: keys.number("fy")?,
        cx_px: keys.number("cx")?,
        cy_px: keys.number("cy")?,
        depth: match keys.word("depth", &["z", "range"], "z or range")? {
            "z" => Depth::Z,
            _ => Depth::Range,
        },
    })
}

/// The keys of a table that have not been taken yet.
struct Keys {
    table: Table,
    /// What stands before the keys in messages: empty, or the table's own key and a dot.
    prefix: String,
}

impl Keys {
    fn name(&self, key: &str) -> String {
        format!("{}{key}", self.prefix)
    }

    fn take(&mut self, key: &str) -> Option<Value> {
        self.table.remove(key)
    }

    fn required(&mut self, key: &str) -> Result<Value, GeometryError> {
        self.take(key).ok_or_else(|| GeometryError::Missing { key: self.name(key) })
    }

    fn number(&mut self, key: &str) -> Result<f64, GeometryError> {
        let value = self.required(key)?;
        number(&self.name(key), &value)
    }

    fn optional_number(&mut self, key: &str) -> Result<Option<f64>, GeometryError> {
        self.take(key).map(|value| number(&self.name(key), &value)).transpose()
    }

    fn word(&mut self, key: &str, words: &[&'static str], rule: &'static str) -> Result<&'static str, GeometryError> {
        match self.required(key)? {
            Value::String(found) => {
                words.iter().copied().find(|w| *w == found).ok_or_else(|| GeometryError::value(key, found, rule))
            }
            other => Err(type_error(key, rule, &other)),
        }
    }

    /// The sensor that the file names.
    fn sensor(&mut self) -> Result<Option<Sensor>, GeometryError> {
        match self.take("sensor") {
            None => Ok(None),
            Some(Value::String(name)) => {
                Sensor::named(&name).map(Some).ok_or_else(|| GeometryError::value("sensor", name, KNOWN))
            }
            Some(other) => Err(type_error("sensor", KNOWN, &other)),
        }
    }

    fn angles(&mut self, key: &'static str) -> Result<Angles, GeometryError> {
        match self.required(key)? {
            Value::Array(list) => {
                let list = list.iter().enumerate().map(|(i, value)| number(&format!("{key}[{i}]"), value));
                Ok(Angles::Listed(list.collect::<Result<_, _>>()?))
            }
            Value::Table(table) => {
                let mut keys = Keys { table, prefix: format!("{key}.") };
                let even = Angles::Even { start_deg: keys.number("start")?, step_deg: keys.number("step")? };
                keys.finish("{ start, step }")?;
                Ok(even)
            }
            other => Err(type_error(key, "a list of angles or { start, step }", &other)),
        }
    }

    fn finish(self, kind: &'static str) -> Result<(), GeometryError> {
        match self.table.keys().next() {
            Some(key) => Err(GeometryError::Unknown { key: short(&self.name(key)), kind }),
            None => Ok(()),
        }
    }
}

fn number(key: &str, value: &Value) -> Result<f64, GeometryError> {
    match value {
        Value::Float(x) => Ok(*x),
        Value::Integer(i) => Ok(*i as f64),
        other => Err(type_error(key, "a number", other)),
    }
}

fn counts(value: Value) -> Result<Vec<u16>, GeometryError> {
    let Value::Array(list) = value else { return Err(type_error("no_return", "a list of counts", &value)) };
    let count = |(i, value): (usize, &Value)| {
        let key = format!("no_return[{i}]");
        match value {
            Value::Integer(n) => u16::try_from(*n).map_err(|_| GeometryError::value(&key, n, "from 0 to 65535")),
            other => Err(type_error(&key, "an integer", other)),
        }
    };
    list.iter().enumerate().map(count).collect()
}

fn type_error(key: &str, expected: &'static str, found: &Value) -> GeometryError {
    let found = match found {
        Value::String(_) => "a string",
        Value::Integer(_) => "an integer",
        Value::Float(_) => "a float",
        Value::Boolean(_) => "a boolean",
        Value::Datetime(_) => "a date",
        Value::Array(_) => "a list",
        Value::Table(_) => "a table",
    };
    GeometryError::Type { key: key.into(), expected, found }
}
