//! The header of PLY files.

use std::fmt::Display;

use crate::cloud::number::Number;
use crate::scan_error::ScanError;

/// No header is longer.
const MAX_HEADER_BYTES: usize = 65_536;

/// How the values are stored.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    Ascii,
    Binary { little_endian: bool },
}

/// What elements of a kind have.
pub(super) struct Property {
    pub name: String,
    pub number: Number,
    /// Of a list the type of its length.
    pub length: Option<Number>,
}

/// A kind of elements.
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// What the lines at the start of a file say.
pub(super) struct Header {
    pub form: Form,
    /// Rows and columns by the comments.
    pub size: Option<(usize, usize)>,
    pub elements: Vec<Element>,
}

pub(super) fn damaged(what: impl Display) -> ScanError {
    ScanError::damaged("PLY", what)
}

impl Header {
    /// Returns the header, and what follows it.
    pub fn parse(bytes: &[u8]) -> Result<(Header, &[u8]), ScanError> {
        let (mut form, mut elements, mut notes, mut at) = (None, Vec::<Element>::new(), vec![], 0);
        loop {
            let rest = &bytes[at..bytes.len().min(MAX_HEADER_BYTES)];
            let end = rest.iter().position(|&b| b == b'\n').ok_or_else(|| damaged("no end_header"))?;
            at += end + 1;
            let line = String::from_utf8_lossy(&rest[..end]);
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["end_header"] => break,
                ["format", kind, _] => form = Some(form_of(kind)?),
                ["element", name, count] => {
                    let count =
                        count.parse().map_err(|_| damaged(format!("{count:.20} is not a number of elements")))?;
                    elements.push(Element { name: name.into(), count, properties: vec![] });
                }
                ["property", "list", length, kind, name] => {
                    property(&mut elements, kind, Some(length), name)?;
                }
                ["property", kind, name] => property(&mut elements, kind, None, name)?,
                ["comment" | "obj_info", ..] => notes.push(words[1..].join(" ")),
                ["ply"] | [] => {}
                _ => return Err(damaged(format!("a line that begins with `{:.20}`", words[0]))),
            }
        }
        let form = form.ok_or_else(|| ScanError::lacks("PLY", "a line format in its header"))?;
        Ok((Header { form, size: size(&notes), elements }, &bytes[at..]))
    }
}

fn form_of(kind: &str) -> Result<Form, ScanError> {
    match kind {
        "ascii" => Ok(Form::Ascii),
        "binary_little_endian" => Ok(Form::Binary { little_endian: true }),
        "binary_big_endian" => Ok(Form::Binary { little_endian: false }),
        _ => Err(damaged(format!("format {kind:.30}"))),
    }
}

fn property(elements: &mut [Element], kind: &str, length: Option<&str>, name: &str) -> Result<(), ScanError> {
    let number = |kind: &str| {
        let (letter, bytes) = match kind {
            "char" | "int8" => ("I", 1),
            "uchar" | "uint8" => ("U", 1),
            "short" | "int16" => ("I", 2),
            "ushort" | "uint16" => ("U", 2),
            "int" | "int32" => ("I", 4),
            "uint" | "uint32" => ("U", 4),
            "float" | "float32" => ("F", 4),
            "double" | "float64" => ("F", 8),
            _ => return Err(damaged(format!("a property of type {kind:.20}"))),
        };
        Number::of(letter, bytes).ok_or_else(|| damaged("a property without a type"))
    };
    let element = elements.last_mut().ok_or_else(|| damaged("a property before any element"))?;
    let length = length.map(number).transpose()?;
    element.properties.push(Property { name: name.into(), number: number(kind)?, length });
    Ok(())
}

/// Returns rows and columns by the comments: `num_rows 480`, `height: 480`.
fn size(notes: &[String]) -> Option<(usize, usize)> {
    let number = |keys: &[&str]| {
        notes.iter().find_map(|note| {
            let mut words = note.split(|c: char| c.is_whitespace() || c == ':' || c == '=').filter(|w| !w.is_empty());
            let key = words.next()?.to_ascii_lowercase();
            let value = words.next()?.parse().ok()?;
            keys.contains(&key.as_str()).then_some(value)
        })
    };
    number(&["num_rows", "rows", "height"]).zip(number(&["num_cols", "num_columns", "cols", "columns", "width"]))
}
