//! Measured values in scan telegrams: 0xB0 (whole field of view) and 0xB7 (a part of it).
//!
//! ```text
//! B0 | count word | values, 2 bytes each | 0 to 2 index bytes | STATUS
//! B7 | first | last | count word | values | ...
//! count word: bits 0-9 number of values, 11-12 offset of a partial scan in 0.25 deg, 13 partial, 14-15 unit
//! ```

use super::settings::{MeasuringMode, Unit, Variant};
use super::status::Status;

/// Code of a telegram with all values of a scan.
pub const SCAN: u8 = 0xB0;
/// Code of a telegram with the values of a sub-range of the scan.
pub const SUB_RANGE: u8 = 0xB7;

/// What the scans of a scanner that has been set up must look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanFormat {
    /// Field of view and step.
    pub variant: Variant,
    /// Unit of the values.
    pub unit: Unit,
    /// Partial scans, each sent directly after its mirror turn, instead of complete ones.
    pub interlaced: bool,
}

/// How the fields of a scan telegram contradict each other or the [`ScanFormat`] expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScanError {
    /// Too short to hold its fixed fields.
    TooShort {
        /// Bytes from code to status.
        length: u16,
    },
    /// The length is not that of so many values.
    Length {
        /// Bytes from code to status.
        length: u16,
        /// Number of values announced.
        count: u16,
    },
    /// No variant of the scanner, or not the one expected, has so many values.
    Count(u16),
    /// The two unit bits are not those expected, or 3, which is no unit.
    Unit(u8),
    /// The bits about partial scans are not those expected, or make no sense together.
    Partial {
        /// Bit 13: partial.
        partial: bool,
        /// Bits 11 and 12: offset in quarter degrees.
        quarter: u8,
    },
    /// First and last column of a sub-range do not fit its count.
    SubRange {
        /// First column, 1-based.
        first: u16,
        /// Last column, 1-based.
        last: u16,
    },
}

impl core::fmt::Display for ScanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooShort { length } => write!(f, "{length} bytes are too few"),
            Self::Length { length, count } => write!(f, "{length} bytes do not hold {count} values"),
            Self::Count(count) => write!(f, "{count} values are not expected"),
            Self::Unit(code) => write!(f, "unit code {code} is not expected"),
            Self::Partial { partial, quarter } => write!(f, "partial = {partial} at quarter {quarter} is not expected"),
            Self::SubRange { first, last } => write!(f, "sub-range {first} to {last} does not fit the count"),
        }
    }
}

impl core::error::Error for ScanError {}

/// A scan, borrowed from the [`super::Decoder`] that holds its telegram. Column 0 is at the right, columns run
/// counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub struct Scan<'a> {
    count_word: CountWord,
    first_column: u16,
    values: &'a [u8],
    index_bytes: &'a [u8],
    status: Status,
}

#[derive(Debug, Clone, Copy)]
struct CountWord(u16);

impl CountWord {
    fn count(self) -> u16 {
        self.0 & 0x03FF
    }

    fn quarter(self) -> u8 {
        ((self.0 >> 11) & 3) as u8
    }

    fn partial(self) -> bool {
        self.0 & 0x2000 != 0
    }

    fn unit_code(self) -> u16 {
        self.0 >> 14
    }
}

impl<'a> Scan<'a> {
    /// Bytes from the code to the count word; `None` if the code is not that of a scan.
    pub(crate) fn head_length(code: u8) -> Option<usize> {
        match code {
            SCAN => Some(3),
            SUB_RANGE => Some(7),
            _ => None,
        }
    }

    /// Checks everything that the check word may have let through. `head` is code to count word, `length` code to status.
    pub(crate) fn check_head(head: &[u8], length: usize, format: Option<&ScanFormat>) -> Result<(), ScanError> {
        let (&code, Some(&count_word)) = (head.first().unwrap_or(&0), head.last_chunk::<2>()) else {
            return Err(ScanError::TooShort { length: length as u16 });
        };
        let word = CountWord(u16::from_le_bytes(count_word));
        let count = word.count();
        let index_bytes = length.checked_sub(head.len() + 2 * usize::from(count) + 1);
        if !matches!(index_bytes, Some(0..=2)) {
            return Err(ScanError::Length { length: length as u16, count });
        }
        let unit = Unit::from_code(word.unit_code());
        if unit.is_none() || format.is_some_and(|format| Some(format.unit) != unit) {
            return Err(ScanError::Unit(word.unit_code() as u8));
        }
        let (partial, quarter) = (word.partial(), word.quarter());
        let interlaced = format.map_or(partial, |format| format.interlaced);
        if partial != interlaced || (!partial && quarter != 0) {
            return Err(ScanError::Partial { partial, quarter });
        }
        let columns_of = |variant: Variant| {
            if partial { variant.partial_columns(quarter) } else { Some(variant.columns()) }
        };
        if code == SUB_RANGE {
            let (first, last) = sub_range(head).unwrap_or((0, 0));
            let most =
                format.map_or(Some(Variant::Deg100Step025.columns()), |format| columns_of(format.variant)).unwrap_or(0);
            if first == 0 || last > most || last.checked_sub(first) != count.checked_sub(1) {
                return Err(ScanError::SubRange { first, last });
            }
        } else {
            let known = match format {
                Some(format) => columns_of(format.variant) == Some(count),
                None => Variant::ALL.into_iter().any(|variant| columns_of(variant) == Some(count)),
            };
            if !known {
                return Err(ScanError::Count(count));
            }
        }
        Ok(())
    }

    /// Splits a payload (code to status) that has passed `check_head`.
    pub(crate) fn new(payload: &'a [u8]) -> Option<Self> {
        let head_length = Self::head_length(*payload.first()?)?;
        let (head, rest) = payload.split_at_checked(head_length)?;
        let count_word = CountWord(u16::from_le_bytes(*head.last_chunk()?));
        let (values, rest) = rest.split_at_checked(2 * usize::from(count_word.count()))?;
        let (&status, index_bytes) = rest.split_last()?;
        let first_column = sub_range(head).map_or(0, |(first, _)| first.saturating_sub(1));
        Some(Self { count_word, first_column, values, index_bytes, status: Status(status) })
    }

    /// Number of values, 1 to 401.
    #[must_use]
    pub fn columns(&self) -> u16 {
        self.count_word.count()
    }

    /// Column of the first value within the scanner's field of view: 0 except in a sub-range.
    #[must_use]
    pub fn first_column(&self) -> u16 {
        self.first_column
    }

    /// Unit of the values.
    #[must_use]
    pub fn unit(&self) -> Unit {
        Unit::from_code(self.count_word.unit_code()).unwrap_or(Unit::Centimetre)
    }

    /// For the partial scan of one mirror turn, whose values are 1 degree apart: how far its first value is from the right
    /// edge of the field of view, in quarter degrees, 0 to 3. `None` for a complete scan.
    #[must_use]
    pub fn partial_quarter(&self) -> Option<u8> {
        self.count_word.partial().then(|| self.count_word.quarter())
    }

    /// State of the scanner when it sent this.
    #[must_use]
    pub fn status(&self) -> Status {
        self.status
    }

    /// Counters that the scanner appends if so configured (real-time index, telegram index): 0 to 2 bytes.
    #[must_use]
    pub fn index_bytes(&self) -> &'a [u8] {
        self.index_bytes
    }

    /// The value words as sent, from right to left.
    pub fn words(&self) -> impl ExactSizeIterator<Item = u16> + Clone + use<'a> {
        self.values.as_chunks().0.iter().map(|word| u16::from_le_bytes(*word))
    }

    /// The ranges from right to left in metres, 0 where there was no return to measure; as many as there are, or as there is
    /// room for.
    pub fn ranges_m(&self, mode: MeasuringMode, to_m: &mut [f32]) {
        let unit_mm = self.unit().mm();
        for (to_m, word) in to_m.iter_mut().zip(self.words()) {
            let range_mm = match Beam::new(word, mode).reading {
                Reading::Range(counts) => u32::from(counts) * unit_mm,
                _ => 0,
            };
            *to_m = range_mm as f32 / 1000.0;
        }
    }

    /// The values from right to left, read as the scanner's measuring mode demands.
    pub fn beams(&self, mode: MeasuringMode) -> impl ExactSizeIterator<Item = Beam> + Clone + use<'a> {
        self.words().map(move |word| Beam::new(word, mode))
    }
}

fn sub_range(head: &[u8]) -> Option<(u16, u16)> {
    match head {
        [SUB_RANGE, first_low, first_high, last_low, last_high, ..] => {
            Some((u16::from_le_bytes([*first_low, *first_high]), u16::from_le_bytes([*last_low, *last_high])))
        }
        _ => None,
    }
}

/// One measured value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beam {
    /// What was measured.
    pub reading: Reading,
    /// The bits above the range: fields or reflector level, as [`MeasuringMode`] says.
    pub flags: u8,
}

/// What the scanner measured along one beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reading {
    /// A range in counts of the scan's [`Unit`]. 0 is a reading of the scanner like any other, but nothing is that near.
    Range(u16),
    /// Not a valid value.
    Invalid,
    /// The receiver was dazzled.
    Dazzled,
    /// Overflow in the calculation.
    Overflow,
    /// Signal-to-noise ratio too small.
    WeakSignal,
    /// Error when reading channel 1.
    ChannelError,
    /// Farther than the measuring mode can say. The one case in which the beam is known to have been free.
    AboveMaximum,
    /// One of the codes among the special values to which SICK gives no meaning.
    Unassigned(u16),
}

impl Beam {
    /// Reads one value word. The nine highest counts of every measuring mode are codes; those of the 16-bit mode are taken
    /// to lie as in the others.
    #[must_use]
    pub const fn new(word: u16, mode: MeasuringMode) -> Self {
        let max = (0xFFFF_u32 >> (16 - mode.range_bits())) as u16;
        let counts = word & max;
        let reading = match max - counts {
            0 => Reading::Invalid,
            1 => Reading::Dazzled,
            2 => Reading::Overflow,
            4 => Reading::WeakSignal,
            5 => Reading::ChannelError,
            8 => Reading::AboveMaximum,
            3 | 6 | 7 => Reading::Unassigned(counts),
            _ => Reading::Range(counts),
        };
        Self { reading, flags: (word as u32 >> mode.range_bits()) as u8 }
    }

    /// The range in millimetres; `None` if there was no return to measure.
    #[must_use]
    pub const fn range_mm(&self, unit: Unit) -> Option<u32> {
        match self.reading {
            Reading::Range(counts) => Some(counts as u32 * unit.mm()),
            _ => None,
        }
    }
}
