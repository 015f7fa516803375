//! Scan lines: the measured values of a telegram 0xB0 (whole field of view), 0xB7 (a part of it) or
//! 0xB6 (means over several scans).
//!
//! ```text
//! B0 | count word | values, 2 bytes each | 0 to 2 index bytes | STATUS
//! B6 | number of scans | count word | values | ...
//! B7 | first | last | count word | values | ...
//! count word: bits 0-9 number of values, 11-12 offset of a partial scan in 0.25 deg, 13 partial, 14-15 unit
//! ```

use super::format::{MeasuringMode, ScanLineFormat, Unit, Variant};
use super::status::ScannerStatus;

/// Code of a telegram with a whole scan line.
pub const SCAN_LINE: u8 = 0xB0;
/// Code of a telegram with a sub-range of a scan line.
pub const SUB_RANGE: u8 = 0xB7;
/// Code of a telegram with a scan line of means over several scans.
pub const MEANS: u8 = 0xB6;

/// A contradiction among the fields of a scan telegram, or with the [`ScanLineFormat`] expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ScanLineError {
    /// Too short to hold its fixed fields.
    TooShort {
        /// Bytes from code to status.
        length: u16,
    },
    /// The length does not fit the number of values.
    Length {
        /// Bytes from code to status.
        length: u16,
        /// Number of values announced.
        count: u16,
    },
    /// No variant of the scanner, or not the expected one, has this number of values.
    Count(u16),
    /// The unit bits are not those expected, or 3, which is no unit.
    Unit(u8),
    /// The bits about partial scan lines are not those expected, or contradict each other.
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

impl core::fmt::Display for ScanLineError {
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

impl core::error::Error for ScanLineError {}

/// A scan line: the ranges of one mirror turn, or of several that the scanner has merged. Borrowed
/// from the [`TelegramDecoder`](super::TelegramDecoder) that holds its telegram. Column 0 is at the
/// right, columns run counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct ScanLine<'a> {
    count_word: CountWord,
    scans: u8,
    sub_range: bool,
    first_column: u16,
    values: &'a [u8],
    index_bytes: &'a [u8],
    status: ScannerStatus,
}

/// The word before the values, see the [module](self).
#[derive(Clone, Copy, Debug)]
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

impl<'a> ScanLine<'a> {
    /// Returns the number of bytes from the code to the count word; `None` if the code is not that
    /// of a scan line.
    pub(crate) fn head_length(code: u8) -> Option<usize> {
        match code {
            SCAN_LINE => Some(3),
            SUB_RANGE => Some(7),
            MEANS => Some(4),
            _ => None,
        }
    }

    /// Checks the fields for damage that the check word does not show. `head` is code to count
    /// word, `length` the number of bytes from code to status.
    pub(crate) fn check_head(head: &[u8], length: usize, format: Option<&ScanLineFormat>) -> Result<(), ScanLineError> {
        let (&code, Some(&count_word)) = (head.first().unwrap_or(&0), head.last_chunk::<2>()) else {
            return Err(ScanLineError::TooShort { length: length as u16 });
        };
        let word = CountWord(u16::from_le_bytes(count_word));
        let count = word.count();
        let index_bytes = length.checked_sub(head.len() + 2 * usize::from(count) + 1);
        if !matches!(index_bytes, Some(0..=2)) {
            return Err(ScanLineError::Length { length: length as u16, count });
        }
        let unit = Unit::from_code(word.unit_code());
        if unit.is_none() || format.is_some_and(|format| Some(format.unit) != unit) {
            return Err(ScanLineError::Unit(word.unit_code() as u8));
        }
        let (partial, quarter) = (word.partial(), word.quarter());
        let interlaced = format.map_or(partial, |format| format.interlaced);
        if partial != interlaced || (!partial && quarter != 0) {
            return Err(ScanLineError::Partial { partial, quarter });
        }
        let columns_of = |variant: Variant| {
            if partial { variant.partial_columns(quarter) } else { Some(variant.columns()) }
        };
        if code == SUB_RANGE {
            let (first, last) = sub_range(head).unwrap_or((0, 0));
            let most =
                format.map_or(Some(Variant::Deg100Step025.columns()), |format| columns_of(format.variant)).unwrap_or(0);
            if first == 0 || last > most || last.checked_sub(first) != count.checked_sub(1) {
                return Err(ScanLineError::SubRange { first, last });
            }
        } else {
            let known = match format {
                Some(format) => columns_of(format.variant) == Some(count),
                None => Variant::ALL.into_iter().any(|variant| columns_of(variant) == Some(count)),
            };
            if !known {
                return Err(ScanLineError::Count(count));
            }
        }
        Ok(())
    }

    /// Returns the scan line in a payload (code to status) that has passed `check_head`.
    pub(crate) fn new(payload: &'a [u8]) -> Option<Self> {
        let head_length = Self::head_length(*payload.first()?)?;
        let (head, rest) = payload.split_at_checked(head_length)?;
        let count_word = CountWord(u16::from_le_bytes(*head.last_chunk()?));
        let (values, rest) = rest.split_at_checked(2 * usize::from(count_word.count()))?;
        let (&status, index_bytes) = rest.split_last()?;
        let first_column = sub_range(head).map_or(0, |(first, _)| first.saturating_sub(1));
        let sub_range = payload.first() == Some(&SUB_RANGE);
        let scans = if let [MEANS, scans, ..] = head { *scans } else { 1 };
        Some(Self { count_word, scans, sub_range, first_column, values, index_bytes, status: ScannerStatus(status) })
    }

    /// Returns the number of values, 1 to 401.
    #[must_use]
    pub fn columns(&self) -> u16 {
        self.count_word.count()
    }

    /// Returns the column of the first value within the field of view: 0 except in a sub-range.
    #[must_use]
    pub fn first_column(&self) -> u16 {
        self.first_column
    }

    /// Returns the number of scans of which the values are means: 1 but in a telegram 0xB6.
    #[must_use]
    pub fn scans(&self) -> u8 {
        self.scans
    }

    /// Returns the unit of the values.
    #[must_use]
    pub fn unit(&self) -> Unit {
        Unit::from_code(self.count_word.unit_code()).unwrap_or(Unit::Centimetre)
    }

    /// Returns, for a partial scan line, the distance of its first value from the right edge of the
    /// field of view, quarter degrees, 0 to 3. Its values are 1 degree apart. `None` for a complete
    /// scan line.
    #[must_use]
    pub fn partial_quarter(&self) -> Option<u8> {
        self.count_word.partial().then(|| self.count_word.quarter())
    }

    /// Returns the status of the scanner.
    #[must_use]
    pub fn status(&self) -> ScannerStatus {
        self.status
    }

    /// Returns the 0 to 2 bytes of counters that a scanner can be configured to append (real-time
    /// index, telegram index).
    #[must_use]
    pub fn index_bytes(&self) -> &'a [u8] {
        self.index_bytes
    }

    /// Returns the values as sent, from right to left.
    #[must_use]
    pub fn words(&self) -> impl ExactSizeIterator<Item = u16> + Clone + use<'a> {
        self.values.as_chunks().0.iter().map(|word| u16::from_le_bytes(*word))
    }

    /// Writes the ranges from right to left, metres, 0 where there was no return. Writes as many as
    /// there are values, or as `to_m` is long.
    pub fn ranges_m(&self, mode: MeasuringMode, to_m: &mut [f32]) {
        to_m.iter_mut().zip(self.words()).for_each(|(to_m, word)| *to_m = self.range_m(word, mode));
    }

    /// Returns whether a scanner that is set to `variant` sends such a scan line, complete, partial or
    /// a sub-range.
    #[must_use]
    pub fn fits(&self, variant: Variant) -> bool {
        let columns = match self.partial_quarter() {
            Some(quarter) => variant.partial_columns(quarter).unwrap_or(0),
            None => variant.columns(),
        };
        let end = self.first_column + self.columns();
        if self.sub_range { end <= columns } else { end == columns }
    }

    /// Writes the ranges into a row of all columns of a scanner that is set to `variant`, metres:
    /// each into its own column, and 0 elsewhere. Of a partial scan line every second or fourth
    /// column has a range, of a sub-range those of its own.
    pub fn row_m(&self, mode: MeasuringMode, variant: Variant, row_m: &mut [f32]) {
        let (first, step) = match self.partial_quarter() {
            Some(quarter) => (u16::from(quarter) * variant.mirror_turns() / 4, variant.mirror_turns()),
            None => (self.first_column, 1),
        };
        row_m.iter_mut().for_each(|range_m| *range_m = 0.0);
        let columns = row_m.iter_mut().skip(first.into()).step_by(step.into());
        columns.zip(self.words()).for_each(|(to_m, word)| *to_m = self.range_m(word, mode));
    }

    /// Returns the range that a value is, metres; 0 if it is none.
    fn range_m(&self, word: u16, mode: MeasuringMode) -> f32 {
        let range_mm = Beam::new(word, mode).range_mm(self.unit()).unwrap_or(0);
        range_mm as f32 / 1000.0
    }

    /// Returns the values from right to left, split into range and flags by the measuring mode.
    #[must_use]
    pub fn beams(&self, mode: MeasuringMode) -> impl ExactSizeIterator<Item = Beam> + Clone + use<'a> {
        self.words().map(move |word| Beam::new(word, mode))
    }
}

/// Returns the first and the last column of a sub-range, 1-based.
fn sub_range(head: &[u8]) -> Option<(u16, u16)> {
    match head {
        [SUB_RANGE, first_low, first_high, last_low, last_high, ..] => {
            Some((u16::from_le_bytes([*first_low, *first_high]), u16::from_le_bytes([*last_low, *last_high])))
        }
        _ => None,
    }
}

/// One measured value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beam {
    /// What was measured.
    pub reading: Reading,
    /// The bits above the range: fields or reflector level, as [`MeasuringMode`] says.
    pub flags: u8,
}

/// What the scanner measured along one beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reading {
    /// A range in counts of the scan line's [`Unit`]. The scanner can send 0, but nothing is that
    /// near.
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
    /// Beyond the range of the measuring mode. Only this code shows that the beam was free.
    AboveMaximum,
    /// One of the special values that have no documented meaning.
    Unassigned(u16),
}

impl Beam {
    /// Returns the parts of one value. The nine highest counts of every measuring mode are codes.
    /// Those of the 16-bit mode are taken to lie as in the other modes.
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

    /// Returns the range in millimetres; `None` if there was no return.
    #[must_use]
    pub const fn range_mm(&self, unit: Unit) -> Option<u32> {
        match self.reading {
            Reading::Range(counts) => Some(counts as u32 * unit.mm()),
            _ => None,
        }
    }
}
