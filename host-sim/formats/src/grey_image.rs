//! Grey images of 8 or 16 bits: reading PGM (binary, P5) and PNG, writing both.
//!
//! Values are kept as stored: nothing is scaled to the largest value. Formats: netpbm's `pgm(5)`;
//! PNG, 3rd edition.
use std::error::Error;
use std::fmt;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use crate::file::{Cause, FileError};

/// A grey image, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GreyImage {
    /// Rows, 1 or more.
    pub rows: usize,
    /// Columns, 1 or more.
    pub columns: usize,
    /// Largest value that the file can hold, 1 to 65535; below 256 its values have 8 bits.
    pub max_value: u16,
    /// `rows * columns` values; row r, column c is at `r * columns + c`.
    pub values: Vec<u16>,
}

impl GreyImage {
    /// Reads an image file, PGM or PNG by its content.
    ///
    /// # Errors
    /// Names the file, and says what the system or [`GreyImage::decode`] says.
    pub fn read(path: impl AsRef<Path>) -> Result<GreyImage, FileError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|e| FileError::new(path, e))?;
        GreyImage::read_from(file).map_err(|cause| FileError::of(path, cause))
    }

    /// Reads an image from its first byte on.
    pub(crate) fn read_from(source: impl Read) -> Result<GreyImage, Cause> {
        let mut bytes = vec![];
        source.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
        match GreyImage::decode(&bytes) {
            // the header of a file that goes on
            Err(e @ ImageError::Pixels { .. }) => Err(e.into()),
            _ if bytes.len() as u64 > MAX_FILE_BYTES => Err(ImageError::FileBytes.into()),
            decoded => Ok(decoded?),
        }
    }

    /// Reads the bytes of a PGM (P5, largest value 1 to 65535) or PNG (grey, 8 or 16 bits) file,
    /// told apart by their first bytes. The header is read first: what claims more than
    /// [`MAX_PIXELS`] pixels, or more than its file can hold, is not decoded.
    ///
    /// # Errors
    /// Anything else than exactly one whole such image.
    pub fn decode(bytes: &[u8]) -> Result<GreyImage, ImageError> {
        if bytes.starts_with(&PNG_SIGNATURE) {
            decode_png(bytes)
        } else if bytes.starts_with(b"P5") {
            decode_pgm(bytes)
        } else if bytes.len() >= 2 && bytes[0] == b'P' && (b'1'..=b'7').contains(&bytes[1]) {
            Err(ImageError::OtherNetpbm { digit: bytes[1] - b'0' })
        } else {
            Err(ImageError::NotAnImage)
        }
    }

    /// Returns a PGM file of the image: one byte per value where `max_value` is below 256, else
    /// two, the high one first.
    ///
    /// # Panics
    /// As [`GreyImage::to_png`].
    pub fn to_pgm(&self) -> Vec<u8> {
        let mut bytes = format!("P5\n{} {}\n{}\n", self.columns, self.rows, self.max_value).into_bytes();
        bytes.extend(self.samples());
        bytes
    }

    /// Returns a PNG file of the image, of 8 bits where `max_value` is below 256, else 16. PNG has
    /// no other largest values than 255 and 65535; read back, `max_value` is one of these.
    ///
    /// # Panics
    /// If the fields break what they promise: a side of 0 or above 2^31, or not `rows * columns`
    /// values up to `max_value`.
    pub fn to_png(&self) -> Vec<u8> {
        let samples = self.samples();
        let mut bytes = Vec::new();
        let [width, height] = [self.columns, self.rows].map(|n| u32::try_from(n).expect("a side is too long"));
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_compression(png::Compression::Fastest);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(if self.max_value < 256 { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
        let mut writer = encoder.write_header().expect("a PNG header in memory");
        writer.write_image_data(&samples).expect("PNG data in memory");
        writer.finish().expect("a PNG end in memory");
        bytes
    }

    /// Returns the values as both formats store them.
    fn samples(&self) -> Vec<u8> {
        assert!(self.rows > 0 && self.columns > 0 && self.values.len() == self.rows * self.columns, "image size");
        assert!(self.values.iter().all(|v| *v <= self.max_value), "value above max_value");
        if self.max_value < 256 {
            self.values.iter().map(|v| *v as u8).collect()
        } else {
            let samples: Vec<[u8; 2]> = self.values.iter().map(|v| v.to_be_bytes()).collect();
            samples.into_flattened()
        }
    }
}

/// The most pixels of an image: as 4096 x 4096, or 16 384 x 1024. A PNG packs a thousand pixels into
/// a byte or two, so that its length bounds nothing.
pub const MAX_PIXELS: usize = 1 << 24;

/// No image is longer: four bytes a pixel.
const MAX_FILE_BYTES: u64 = 4 * MAX_PIXELS as u64;

/// PNG's largest side, taken for PGM as well.
const MAX_SIDE: u32 = i32::MAX as u32;

const PNG_SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

fn decode_pgm(bytes: &[u8]) -> Result<GreyImage, ImageError> {
    let mut at = 2;
    let columns = pgm_number(bytes, &mut at, "width", MAX_SIDE)? as usize;
    let rows = pgm_number(bytes, &mut at, "height", MAX_SIDE)? as usize;
    let max_value = pgm_number(bytes, &mut at, "largest value", 65535)? as u16;
    match bytes.get(at) {
        Some(b) if b.is_ascii_whitespace() => at += 1,
        _ => return Err(ImageError::PgmHeader { what: "white space after the largest value", offset: at }),
    }
    check_pixels(rows, columns)?;

    let wide = max_value >= 256;
    let data = &bytes[at..];
    let row_bytes = columns as u128 * if wide { 2 } else { 1 };
    let (needed, found) = (row_bytes * rows as u128, data.len() as u128);
    if found < needed {
        return Err(ImageError::TooShort { rows, columns, needed, found: data.len(), whole_rows: found / row_bytes });
    }
    if found > needed {
        return Err(ImageError::TooLong { excess: data.len() - needed as usize });
    }
    let values = samples_to_values(data, wide);
    if let Some(i) = values.iter().position(|v| *v > max_value) {
        return Err(ImageError::TooBright { row: i / columns, column: i % columns, value: values[i], max_value });
    }
    Ok(GreyImage { rows, columns, max_value, values })
}

fn check_pixels(rows: usize, columns: usize) -> Result<(), ImageError> {
    let fits = rows.checked_mul(columns).is_some_and(|pixels| pixels <= MAX_PIXELS);
    if fits { Ok(()) } else { Err(ImageError::Pixels { rows, columns }) }
}

/// Reads one number from 1 to `limit` of a PGM header, after white space and comments, of which
/// there must be some.
fn pgm_number(bytes: &[u8], at: &mut usize, what: &'static str, limit: u32) -> Result<u32, ImageError> {
    let start = *at;
    while let Some(b) = bytes.get(*at) {
        match b {
            b'#' => *at += bytes[*at..].iter().take_while(|b| !matches!(b, b'\n' | b'\r')).count(),
            b if b.is_ascii_whitespace() => *at += 1,
            _ => break,
        }
    }
    let offset = *at;
    *at += bytes[offset..].iter().take_while(|b| b.is_ascii_digit()).count();
    if offset == start || *at == offset {
        return Err(ImageError::PgmHeader { what, offset });
    }
    let digits = bytes[offset..*at].iter().map(|b| u32::from(b - b'0'));
    let number = digits.fold(0u32, |n, digit| n.saturating_mul(10).saturating_add(digit));
    if number == 0 || number > limit {
        return Err(ImageError::PgmNumber { what, offset, limit });
    }
    Ok(number)
}

fn samples_to_values(data: &[u8], wide: bool) -> Vec<u16> {
    if wide {
        data.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect()
    } else {
        data.iter().map(|b| u16::from(*b)).collect()
    }
}

fn decode_png(bytes: &[u8]) -> Result<GreyImage, ImageError> {
    let mut cursor = Cursor::new(bytes);
    let decoded = decode_png_at(&mut cursor, bytes.len());
    let offset = cursor.position() as usize;
    match decoded {
        Ok(_) if offset < bytes.len() => Err(ImageError::TooLong { excess: bytes.len() - offset }),
        Ok(image) => Ok(image),
        Err(PngFailure::Damaged(e)) => Err(ImageError::Png { offset, message: e.to_string().replace('\n', ", ") }),
        Err(PngFailure::Other(e)) => Err(e),
    }
}

enum PngFailure {
    /// What the decoder says, to which the place in the file belongs.
    Damaged(png::DecodingError),
    Other(ImageError),
}

impl From<png::DecodingError> for PngFailure {
    fn from(e: png::DecodingError) -> Self {
        PngFailure::Damaged(e)
    }
}

fn decode_png_at(cursor: &mut Cursor<&[u8]>, file_bytes: usize) -> Result<GreyImage, PngFailure> {
    let mut decoder = png::Decoder::new(cursor);
    // Texts and colour profiles may be packed as well, and are of no use.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info()?;
    let (rows, columns) = (header.height as usize, header.width as usize);
    let (colour, depth) = (header.color_type, header.bit_depth);
    let wide = depth == png::BitDepth::Sixteen;
    check_pixels(rows, columns).map_err(PngFailure::Other)?;
    // Deflate packs at most 1032 bytes into one: a size beyond that is a false claim, for which
    // nothing is allocated.
    let needed = rows as u128 * columns as u128 * if wide { 2 } else { 1 };
    if needed > 1032 * file_bytes as u128 {
        return Err(PngFailure::Other(ImageError::PngSize { rows, columns, file_bytes }));
    }

    let mut reader = decoder.read_info()?;
    let plain = reader.info().trns.is_none() && reader.info().animation_control.is_none();
    if colour != png::ColorType::Grayscale || !matches!(depth as u8, 8 | 16) || !plain {
        let extra = if plain { "" } else { ", transparent or animated" };
        let found = format!("{colour:?}, {} bits{extra}", depth as u8);
        return Err(PngFailure::Other(ImageError::PngKind { found }));
    }
    let mut data = vec![0; needed as usize];
    reader.next_frame(&mut data)?;
    reader.finish()?;
    let max_value = if wide { 65535 } else { 255 };
    Ok(GreyImage { rows, columns, max_value, values: samples_to_values(&data, wide) })
}

/// Why bytes are not a grey image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// Neither a PGM nor a PNG file.
    NotAnImage,
    /// Another format of the PGM family, P1 to P7.
    OtherNetpbm {
        /// The digit after the P.
        digit: u8,
    },
    /// The header of a PGM lacks something.
    PgmHeader {
        /// What should be there.
        what: &'static str,
        /// Where, bytes from the start.
        offset: usize,
    },
    /// A number in the header of a PGM is 0 or too large.
    PgmNumber {
        /// Which one.
        what: &'static str,
        /// Where, bytes from the start.
        offset: usize,
        /// Largest one allowed.
        limit: u32,
    },
    /// A PGM ends before its last value.
    TooShort {
        /// Rows by the header.
        rows: usize,
        /// Columns by the header.
        columns: usize,
        /// Bytes of values by the header.
        needed: u128,
        /// Bytes of values in the file.
        found: usize,
        /// Rows that are complete.
        whole_rows: u128,
    },
    /// Bytes follow the image.
    TooLong {
        /// How many.
        excess: usize,
    },
    /// A value of a PGM exceeds the largest one that its header allows.
    TooBright {
        /// Row of the first such value.
        row: usize,
        /// Column of the first such value.
        column: usize,
        /// The value.
        value: u16,
        /// Largest one allowed.
        max_value: u16,
    },
    /// A PNG that is not plain grey of 8 or 16 bits.
    PngKind {
        /// What it is.
        found: String,
    },
    /// More than [`MAX_PIXELS`] pixels by the header.
    Pixels {
        /// Rows by the header.
        rows: usize,
        /// Columns by the header.
        columns: usize,
    },
    /// The file is longer than any image of [`MAX_PIXELS`] pixels.
    FileBytes,
    /// A PNG whose header claims more pixels than the file can hold.
    PngSize {
        /// Rows by the header.
        rows: usize,
        /// Columns by the header.
        columns: usize,
        /// Length of the file.
        file_bytes: usize,
    },
    /// A damaged PNG.
    Png {
        /// Bytes read until then.
        offset: usize,
        /// What the PNG reader says.
        message: String,
    },
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ImageError::NotAnImage => write!(f, "neither a PGM (P5) nor a PNG file"),
            ImageError::OtherNetpbm { digit } => write!(f, "a P{digit} file; only P5 (binary PGM) and PNG are read"),
            ImageError::PgmHeader { what, offset } => write!(f, "PGM header: no {what} at byte {offset}"),
            ImageError::PgmNumber { what, offset, limit } => {
                write!(f, "PGM header: {what} at byte {offset} is not from 1 to {limit}")
            }
            ImageError::TooShort { rows, columns, needed, found, whole_rows } => write!(
                f,
                "PGM of {rows} x {columns} needs {needed} bytes of values, the file has {found}: {whole_rows} whole rows"
            ),
            ImageError::TooLong { excess } => write!(f, "{excess} bytes too many after the image"),
            ImageError::TooBright { row, column, value, max_value } => {
                write!(f, "PGM value {value} in row {row}, column {column} is above the header's {max_value}")
            }
            ImageError::PngKind { found } => write!(f, "PNG is not plain grey of 8 or 16 bits: {found}"),
            ImageError::Pixels { rows, columns } => {
                let pixels = *rows as u128 * *columns as u128;
                write!(f, "{rows} rows x {columns} columns are {pixels} pixels, the most are {MAX_PIXELS}")
            }
            ImageError::FileBytes => {
                write!(f, "more than {} MiB, longer than any image of {MAX_PIXELS} pixels", MAX_FILE_BYTES >> 20)
            }
            ImageError::PngSize { rows, columns, file_bytes } => {
                write!(f, "PNG claims {rows} x {columns} pixels, more than a file of {file_bytes} bytes can hold")
            }
            ImageError::Png { offset, message } => write!(f, "PNG damaged at or before byte {offset}: {message}"),
        }
    }
}

impl Error for ImageError {}
