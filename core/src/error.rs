//! What can be refused: a configuration, a row.

use core::fmt;

/// A configuration value that cannot be used. Names the field and carries the value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigError {
    /// A number is NaN, infinite or outside of its range.
    Value {
        /// The field of a configuration or of [`Beams`](crate::Beams).
        field: &'static str,
        /// What it was set to.
        value: f32,
    },
    /// A count or an offset is outside of its range.
    Count {
        /// The field.
        field: &'static str,
        /// What it was set to.
        value: i32,
    },
    /// A list of beam angles does not have one entry per column.
    Listed {
        /// Columns of the image.
        columns: usize,
        /// Entries of the list.
        got: usize,
    },
    /// The memory given is too small.
    Memory {
        /// Which part of [`Memory`](crate::Memory).
        field: &'static str,
        /// Elements needed.
        needed: usize,
        /// Elements given.
        got: usize,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            ConfigError::Value { field, value } => write!(f, "{field} cannot be {value}"),
            ConfigError::Count { field, value } => write!(f, "{field} cannot be {value}"),
            ConfigError::Listed { columns, got } => {
                write!(f, "{got} listed beam angles for {columns} columns")
            }
            ConfigError::Memory { field, needed, got } => {
                write!(f, "memory: {field} needs {needed} elements, got {got}")
            }
        }
    }
}

impl core::error::Error for ConfigError {}

/// A row that was not taken. The segmenter is as it was before the call.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PushError {
    /// The row does not have one range per column, or not one direction.
    RowLength {
        /// Columns of the image.
        expected: usize,
        /// Ranges in the row, or directions.
        got: usize,
    },
    /// The turn angle is NaN or infinite, or beyond 6300 rad.
    TurnAngle {
        /// What was given, radians.
        turn_rad: f32,
    },
    /// A number of [`RowBeams`](crate::RowBeams) is NaN, infinite or outside of its range.
    RowBeams {
        /// The field.
        field: &'static str,
        /// What was given.
        value: f32,
    },
    /// The direction of a return is no unit vector, to 0.5 %.
    Direction {
        /// The first such column.
        column: usize,
    },
    /// The scan already has the most rows that a scan may have: call `finish`.
    TooManyRows {
        /// [`MAX_ROWS`](crate::MAX_ROWS).
        max_rows: usize,
    },
}

impl fmt::Display for PushError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            PushError::RowLength { expected, got } => write!(f, "row of {got} columns, expected {expected}"),
            PushError::TurnAngle { turn_rad } => write!(f, "turn angle cannot be {turn_rad}"),
            PushError::RowBeams { field, value } => write!(f, "{field} of a row cannot be {value}"),
            PushError::Direction { column } => write!(f, "the direction of column {column} is no unit vector"),
            PushError::TooManyRows { max_rows } => write!(f, "more than {max_rows} rows in one scan"),
        }
    }
}

impl core::error::Error for PushError {}
