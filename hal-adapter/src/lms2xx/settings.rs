//! The settings of an LMS 2xx.

use super::format::{MeasuringMode, ScanLineFormat, Unit, Variant};

/// Baud rate of the serial port. The format is always 8 data bits, no parity, one stop bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Baud {
    /// 9600 Bd, the usual rate after power-on.
    B9600,
    /// 19 200 Bd.
    B19200,
    /// 38 400 Bd.
    B38400,
    /// 500 000 Bd, on RS-422 only.
    B500000,
}

impl Baud {
    /// All rates, the likeliest after a cold start first.
    pub const ALL: [Self; 4] = [Self::B9600, Self::B38400, Self::B500000, Self::B19200];

    /// Returns the rate in bits a second.
    #[must_use]
    pub const fn bits_per_s(self) -> u32 {
        match self {
            Self::B9600 => 9_600,
            Self::B19200 => 19_200,
            Self::B38400 => 38_400,
            Self::B500000 => 500_000,
        }
    }

    /// Returns the time that so many bytes of ten bits take, microseconds, rounded up. Of up to a million bytes.
    #[must_use]
    pub const fn line_time_us(self, bytes: u32) -> u32 {
        // of a byte, as a fraction: a division of 64 bits takes a microcontroller 0.9 KB of flash
        let (us, per) = match self {
            Self::B9600 => (3125, 3),
            Self::B19200 => (3125, 6),
            Self::B38400 => (3125, 12),
            Self::B500000 => (20, 1),
        };
        bytes.saturating_mul(us).div_ceil(per)
    }

    /// Returns the pause that the scanner needs between two bytes sent to it, microseconds.
    #[must_use]
    pub const fn gap_us(self) -> u32 {
        match self {
            Self::B500000 => 60,
            _ => 0,
        }
    }
}

/// How a session sets its scanner up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Baud rate. [`Baud::B500000`] needs RS-422. Over RS-232 the scanner accepts it and cannot be
    /// reached again until its power is cycled.
    pub baud: Baud,
    /// Field of view and step.
    pub variant: Variant,
    /// Unit of the values. The EEPROM of the scanner is written only if its measuring mode or unit
    /// differ from these.
    pub unit: Unit,
    /// Use of the bits of a value.
    pub mode: MeasuringMode,
    /// Whether each mirror turn is sent on its own instead of merged with its neighbours. That
    /// suits a scanner that tilts best.
    pub interlaced: bool,
}

impl Settings {
    /// Returns the format of the scan lines.
    #[must_use]
    pub const fn format(&self) -> ScanLineFormat {
        ScanLineFormat { variant: self.variant, unit: self.unit, interlaced: self.interlaced }
    }

    /// Returns the length of a scan telegram in bytes, without index bytes; the longest one if
    /// interlaced.
    #[must_use]
    pub const fn telegram_bytes(&self) -> u32 {
        let columns = if self.interlaced { self.variant.view_deg() + 1 } else { self.variant.columns() };
        2 * columns as u32 + 10
    }

    /// Returns the time from one scan telegram to the next, microseconds. It is a whole number of
    /// the scanner's own periods, as many as it takes to send one telegram.
    #[must_use]
    pub const fn period_us(&self) -> u32 {
        // 75 mirror turns a second.
        let turns = if self.interlaced { 1 } else { self.variant.mirror_turns() as u32 };
        let scan_us = turns * 40_000 / 3;
        self.baud.line_time_us(self.telegram_bytes()).div_ceil(scan_us) * scan_us
    }
}
