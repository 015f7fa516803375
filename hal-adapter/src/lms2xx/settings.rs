//! What can be set on an LMS 2xx.

use super::scan::ScanFormat;

/// Rate of the serial line, always 8 data bits, no parity, one stop bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    /// Every rate, the likeliest after a cold start first.
    pub const ALL: [Self; 4] = [Self::B9600, Self::B38400, Self::B500000, Self::B19200];

    /// Bits a second.
    #[must_use]
    pub const fn bits_per_s(self) -> u32 {
        match self {
            Self::B9600 => 9_600,
            Self::B19200 => 19_200,
            Self::B38400 => 38_400,
            Self::B500000 => 500_000,
        }
    }

    /// Time that `bytes` take on the line, ten bits each, in microseconds, rounded up.
    #[must_use]
    pub const fn line_time_us(self, bytes: u32) -> u32 {
        (bytes as u64 * 10_000_000).div_ceil(self.bits_per_s() as u64) as u32
    }

    /// Pause that the scanner wants between two bytes sent to it, in microseconds.
    #[must_use]
    pub const fn gap_us(self) -> u32 {
        match self {
            Self::B500000 => 60,
            _ => 0,
        }
    }
}

/// Field of view and step: the five variants that the scanner knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Variant {
    /// 100 degrees in steps of 1 degree: 101 values.
    Deg100Step1,
    /// 100 degrees in steps of 0.5 degree: 201 values.
    Deg100Step05,
    /// 100 degrees in steps of 0.25 degree: 401 values.
    Deg100Step025,
    /// 180 degrees in steps of 1 degree: 181 values.
    Deg180Step1,
    /// 180 degrees in steps of 0.5 degree: 361 values.
    Deg180Step05,
}

impl Variant {
    /// Every variant.
    pub const ALL: [Self; 5] =
        [Self::Deg100Step1, Self::Deg100Step05, Self::Deg100Step025, Self::Deg180Step1, Self::Deg180Step05];

    /// Field of view in degrees: 100 or 180.
    #[must_use]
    pub const fn view_deg(self) -> u16 {
        match self {
            Self::Deg100Step1 | Self::Deg100Step05 | Self::Deg100Step025 => 100,
            Self::Deg180Step1 | Self::Deg180Step05 => 180,
        }
    }

    /// Step between values of a complete scan in hundredths of a degree: 100, 50 or 25.
    #[must_use]
    pub const fn step_cdeg(self) -> u16 {
        100 / self.turns()
    }

    /// Mirror turns that a complete scan takes: 1, 2 or 4. A turn measures every degree; the scanner merges turns that are
    /// shifted against each other by a fraction of a degree.
    #[must_use]
    pub const fn turns(self) -> u16 {
        match self {
            Self::Deg100Step1 | Self::Deg180Step1 => 1,
            Self::Deg100Step05 | Self::Deg180Step05 => 2,
            Self::Deg100Step025 => 4,
        }
    }

    /// Values in a complete scan.
    #[must_use]
    pub const fn columns(self) -> u16 {
        self.view_deg() * self.turns() + 1
    }

    /// Values in the partial scan that begins `quarter` quarter degrees (0 to 3) from the right edge; `None` where this
    /// variant has no such partial scan.
    #[must_use]
    pub const fn partial_columns(self, quarter: u8) -> Option<u16> {
        let between = quarter as u16 * self.turns();
        if quarter == 0 {
            Some(self.view_deg() + 1)
        } else if quarter < 4 && between.is_multiple_of(4) {
            Some(self.view_deg())
        } else {
            None
        }
    }
}

/// What one count of a measured value means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unit {
    /// 10 mm.
    Centimetre,
    /// 1 mm.
    Millimetre,
    /// 100 mm.
    Decimetre,
}

impl Unit {
    /// Every unit.
    pub const ALL: [Self; 3] = [Self::Centimetre, Self::Millimetre, Self::Decimetre];

    /// Millimetres in one count: 10, 1 or 100.
    #[must_use]
    pub const fn mm(self) -> u32 {
        match self {
            Self::Centimetre => 10,
            Self::Millimetre => 1,
            Self::Decimetre => 100,
        }
    }

    /// As the configuration block and the count word of a scan say it: 0, 1, 2.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Centimetre => 0,
            Self::Millimetre => 1,
            Self::Decimetre => 2,
        }
    }

    pub(crate) const fn from_code(code: u16) -> Option<Self> {
        Some(match code {
            0 => Self::Centimetre,
            1 => Self::Millimetre,
            2 => Self::Decimetre,
            _ => return None,
        })
    }
}

/// Measuring mode: how the 16 bits of a measured value are shared between range and flags. Nothing in a scan telegram says
/// which mode the scanner is in, and a wrong guess turns 9.007 m into 0.815 m, so it must be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MeasuringMode {
    /// 13 bits (8.18 m in mm, 81.8 m in cm); flags: field A, field B, dazzle or field C. The scanner's own default.
    Range8Fields,
    /// 13 bits; flags: reflector level 0 to 7.
    Range8Reflector,
    /// 13 bits; flags: fields A, B, C.
    Range8FieldsAbc,
    /// 14 bits (16.37 m in mm); flags: reflector level 0 to 3.
    Range16Reflector,
    /// 14 bits; flags: fields A, B.
    Range16Fields,
    /// 15 bits (32.75 m in mm); flag: reflector.
    Range32Reflector,
    /// 15 bits; flag: field A.
    Range32Field,
    /// All 16 bits are range.
    Range32Immediate,
}

impl MeasuringMode {
    /// Every mode.
    pub const ALL: [Self; 8] = [
        Self::Range8Fields,
        Self::Range8Reflector,
        Self::Range8FieldsAbc,
        Self::Range16Reflector,
        Self::Range16Fields,
        Self::Range32Reflector,
        Self::Range32Field,
        Self::Range32Immediate,
    ];

    /// Bits of a value word that are range: 13 to 16. The rest, above them, are flags.
    #[must_use]
    pub const fn range_bits(self) -> u32 {
        match self {
            Self::Range8Fields | Self::Range8Reflector | Self::Range8FieldsAbc => 13,
            Self::Range16Reflector | Self::Range16Fields => 14,
            Self::Range32Reflector | Self::Range32Field => 15,
            Self::Range32Immediate => 16,
        }
    }

    /// As the configuration block says it.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Range8Fields => 0x00,
            Self::Range8Reflector => 0x01,
            Self::Range8FieldsAbc => 0x02,
            Self::Range16Reflector => 0x03,
            Self::Range16Fields => 0x04,
            Self::Range32Reflector => 0x05,
            Self::Range32Field => 0x06,
            Self::Range32Immediate => 0x0F,
        }
    }
}

/// How the scanner shall be set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    /// Rate of the line. [`Baud::B500000`] needs RS-422: over RS-232 the scanner agrees to it and is not heard again until
    /// its power is cycled.
    pub baud: Baud,
    /// Field of view and step.
    pub variant: Variant,
    /// Unit of the values. With measuring mode and unit as the scanner has them nothing is written into its EEPROM.
    pub unit: Unit,
    /// How the bits of a value are used.
    pub mode: MeasuringMode,
    /// Each mirror turn sent on its own instead of merged with its neighbours, which suits a turning scanner best.
    pub interlaced: bool,
}

impl Settings {
    /// What scans look like under these settings.
    #[must_use]
    pub const fn format(&self) -> ScanFormat {
        ScanFormat { variant: self.variant, unit: self.unit, interlaced: self.interlaced }
    }

    /// Length of a scan telegram in bytes, without index bytes; of interlaced scans the longest.
    #[must_use]
    pub const fn telegram_bytes(&self) -> u32 {
        let columns = if self.interlaced { self.variant.view_deg() + 1 } else { self.variant.columns() };
        2 * columns as u32 + 10
    }

    /// Time from one scan telegram to the next, in microseconds: as many whole scans as the line needs time for one.
    #[must_use]
    pub const fn period_us(&self) -> u32 {
        // 75 mirror turns a second.
        let turns = if self.interlaced { 1 } else { self.variant.turns() as u32 };
        let scan_us = turns * 40_000 / 3;
        self.baud.line_time_us(self.telegram_bytes()).div_ceil(scan_us) * scan_us
    }
}
