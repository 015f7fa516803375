//! What is wrong with a geometry.

use std::error::Error;
use std::fmt;

/// What is wrong with a geometry, or with a geometry for an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// The text is not TOML.
    Syntax {
        /// Line of the mistake, from 1.
        line: usize,
        /// What the TOML reader says.
        message: String,
    },
    /// A required key is missing.
    Missing {
        /// Its name.
        key: String,
        /// What it must be.
        rule: &'static str,
    },
    /// A key that the format does not have, or not for this kind.
    Unknown {
        /// Its name.
        key: String,
        /// The file's `kind`; empty if that is not known.
        kind: &'static str,
        /// The key that has nearly this name.
        nearest: Option<&'static str>,
    },
    /// A value of the wrong type or outside its range.
    Value {
        /// Its key.
        key: String,
        /// The value as text.
        found: String,
        /// What it must be: type, least and largest value, unit.
        rule: &'static str,
    },
    /// A list of angles does not have one entry per row or column of the image.
    Entries {
        /// Its key.
        key: &'static str,
        /// Entries of the list.
        listed: usize,
        /// `"rows"` or `"columns"`.
        axis: &'static str,
        /// Rows or columns of the image.
        needed: usize,
    },
    /// The numbers are too large for a pixel's beam to have a direction.
    NoDirection {
        /// Row of the pixel.
        row: usize,
        /// Column of the pixel.
        column: usize,
    },
    /// Two or more of the others, in the order of the keys.
    Several(Vec<GeometryError>),
}

/// The most characters of a key or value of a file in a message.
const MOST_CHARACTERS: usize = 40;
/// The most errors in a message.
const MOST_ERRORS: usize = 16;

impl GeometryError {
    /// [`GeometryError::Value`], a long key cut. `found` is not long.
    pub(crate) fn value(key: &str, found: impl AsRef<str>, rule: &'static str) -> Self {
        GeometryError::Value { key: short(key), found: found.as_ref().into(), rule }
    }

    /// Returns nothing, the only error, or all of them in one.
    pub(crate) fn all(mut errors: Vec<GeometryError>) -> Result<(), GeometryError> {
        match errors.len() {
            0 => Ok(()),
            1 => Err(errors.remove(0)),
            _ => Err(GeometryError::Several(errors)),
        }
    }
}

/// Returns the text, or its beginning if it is long.
pub(crate) fn short(text: &str) -> String {
    match text.char_indices().nth(MOST_CHARACTERS) {
        None => text.to_string(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GeometryError::Syntax { line, message } => write!(f, "line {line}: {message}"),
            GeometryError::Missing { key, rule } => write!(f, "missing key `{key}`, {rule}"),
            GeometryError::Unknown { key, kind, nearest } => {
                match *kind {
                    "" => write!(f, "`{key}` is not a key of any geometry")?,
                    kind => write!(f, "`{key}` is not a key of a {kind} geometry")?,
                }
                nearest.map_or(Ok(()), |nearest| write!(f, " (is `{nearest}` meant?)"))
            }
            GeometryError::Value { key, found, rule } => write!(f, "`{key}` is {found}, must be {rule}"),
            GeometryError::Entries { key, listed, axis, needed } => {
                write!(f, "`{key}` lists {listed} angles, the image has {needed} {axis}")
            }
            GeometryError::NoDirection { row, column } => {
                write!(f, "the beam of row {row}, column {column} has no direction: numbers too large")
            }
            GeometryError::Several(errors) => {
                for (i, error) in errors.iter().take(MOST_ERRORS).enumerate() {
                    write!(f, "{}{error}", if i > 0 { "; " } else { "" })?;
                }
                match errors.len().saturating_sub(MOST_ERRORS) {
                    0 => Ok(()),
                    more => write!(f, "; and {more} more"),
                }
            }
        }
    }
}

impl Error for GeometryError {}
