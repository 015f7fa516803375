//! The status byte at the end of every telegram of the scanner.

/// Status byte of the scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScannerStatus(
    /// The byte as sent.
    pub u8,
);

/// Severity of a status, bits 0 to 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Severity {
    /// No fault.
    Ok,
    /// Information.
    Info,
    /// Warning.
    Warning,
    /// Error.
    Error,
    /// Fatal error: the scanner needs service.
    Fatal,
}

impl ScannerStatus {
    /// Returns the severity, bits 0 to 2. `None` for 5 to 7, which no scanner sends: telegrams with
    /// them are rejected.
    #[must_use]
    pub fn severity(self) -> Option<Severity> {
        Some(match self.0 & 0x07 {
            0 => Severity::Ok,
            1 => Severity::Info,
            2 => Severity::Warning,
            3 => Severity::Error,
            4 => Severity::Fatal,
            _ => return None,
        })
    }

    /// Returns bits 3 and 4: 2 for an ordinary LMS, 3 for the LMS 2xx-S14.
    #[must_use]
    pub fn device(self) -> u8 {
        (self.0 >> 3) & 0x03
    }

    /// Returns bit 5: the scanner is restarting. It is set in the first answers after power-on.
    #[must_use]
    pub fn restarting(self) -> bool {
        self.0 & 0x20 != 0
    }

    /// Returns bit 6: the measured values are implausible.
    #[must_use]
    pub fn implausible(self) -> bool {
        self.0 & 0x40 != 0
    }

    /// Returns bit 7: the front screen is polluted.
    #[must_use]
    pub fn polluted(self) -> bool {
        self.0 & 0x80 != 0
    }
}
