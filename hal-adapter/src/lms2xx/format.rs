//! The format of the scan lines of an LMS 2xx: field of view, step, unit, use of the bits of a
//! value.

/// Field of view and step. The scanner has five variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// All variants.
    pub const ALL: [Self; 5] =
        [Self::Deg100Step1, Self::Deg100Step05, Self::Deg100Step025, Self::Deg180Step1, Self::Deg180Step05];

    /// Returns the field of view in degrees: 100 or 180.
    #[must_use]
    pub const fn view_deg(self) -> u16 {
        match self {
            Self::Deg100Step1 | Self::Deg100Step05 | Self::Deg100Step025 => 100,
            Self::Deg180Step1 | Self::Deg180Step05 => 180,
        }
    }

    /// Returns the step between the values of a complete scan line, hundredths of a degree: 100, 50
    /// or 25.
    #[must_use]
    pub const fn step_cdeg(self) -> u16 {
        100 / self.mirror_turns()
    }

    /// Returns the number of mirror turns in a complete scan line: 1, 2 or 4. A mirror turn
    /// measures a beam every degree; the scanner merges turns that are shifted by a fraction of a
    /// degree.
    #[must_use]
    pub const fn mirror_turns(self) -> u16 {
        match self {
            Self::Deg100Step1 | Self::Deg180Step1 => 1,
            Self::Deg100Step05 | Self::Deg180Step05 => 2,
            Self::Deg100Step025 => 4,
        }
    }

    /// Returns the number of values in a complete scan line.
    #[must_use]
    pub const fn columns(self) -> u16 {
        self.view_deg() * self.mirror_turns() + 1
    }

    /// Returns the number of values in the partial scan line that begins `quarter` quarter degrees
    /// (0 to 3) from the right edge; `None` if this variant has no such partial scan line.
    #[must_use]
    pub const fn partial_columns(self, quarter: u8) -> Option<u16> {
        let between = quarter as u16 * self.mirror_turns();
        if quarter == 0 {
            Some(self.view_deg() + 1)
        } else if quarter < 4 && between.is_multiple_of(4) {
            Some(self.view_deg())
        } else {
            None
        }
    }
}

/// Unit of a measured value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// All units.
    pub const ALL: [Self; 3] = [Self::Centimetre, Self::Millimetre, Self::Decimetre];

    /// Returns the millimetres in one count: 10, 1 or 100.
    #[must_use]
    pub const fn mm(self) -> u32 {
        match self {
            Self::Centimetre => 10,
            Self::Millimetre => 1,
            Self::Decimetre => 100,
        }
    }

    /// Returns the code in the configuration block and in the count word of a scan line: 0, 1, 2.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Centimetre => 0,
            Self::Millimetre => 1,
            Self::Decimetre => 2,
        }
    }

    /// Returns the unit of a code.
    pub(crate) const fn from_code(code: u16) -> Option<Self> {
        Some(match code {
            0 => Self::Centimetre,
            1 => Self::Millimetre,
            2 => Self::Decimetre,
            _ => return None,
        })
    }
}

/// Measuring mode: the division of the 16 bits of a measured value between range and flags. A scan
/// telegram does not tell the mode, and with a wrong one 9.007 m reads as 0.815 m, so it must be
/// set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MeasuringMode {
    /// 13 bits (8.18 m in mm, 81.8 m in cm); flags: field A, field B, dazzle or field C. The
    /// scanner's own default.
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
    /// All modes.
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

    /// Returns the number of bits of a value that are range: 13 to 16. The higher bits are flags.
    #[must_use]
    pub const fn range_bits(self) -> u32 {
        match self {
            Self::Range8Fields | Self::Range8Reflector | Self::Range8FieldsAbc => 13,
            Self::Range16Reflector | Self::Range16Fields => 14,
            Self::Range32Reflector | Self::Range32Field => 15,
            Self::Range32Immediate => 16,
        }
    }

    /// Returns the code in the configuration block.
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

/// The format that every scan line of a scanner must have once it has been set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanLineFormat {
    /// Field of view and step.
    pub variant: Variant,
    /// Unit of the values.
    pub unit: Unit,
    /// Whether the scanner sends a partial scan line after each mirror turn instead of complete
    /// ones.
    pub interlaced: bool,
}
