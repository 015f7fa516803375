//! Commands to an RPLIDAR.

/// A command to the scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Stop sending. Not answered.
    Stop,
    /// Restart. Not answered, but for a line of text by some.
    Reset,
    /// Begin a standard scan.
    Scan,
    /// Begin an express scan.
    ExpressScan {
        /// The scan mode: 0 for the express scan of an A1 or A2, the mode called "DenseBoost" for a
        /// C1 or S2 (1 by those tried).
        mode: u8,
    },
}

/// The bytes of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CommandBytes {
    bytes: [u8; 9],
    length: usize,
}

impl CommandBytes {
    /// Returns the bytes, start byte to checksum.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }
}

impl Command {
    /// Returns the bytes to send.
    #[must_use]
    pub const fn encode(self) -> CommandBytes {
        let code = match self {
            Self::Stop => 0x25,
            Self::Reset => 0x40,
            Self::Scan => 0x20,
            // with a length, five bytes, and the XOR of all before
            Self::ExpressScan { mode } => {
                let check = 0xA5 ^ 0x82 ^ 5 ^ mode;
                return CommandBytes { bytes: [0xA5, 0x82, 5, mode, 0, 0, 0, 0, check], length: 9 };
            }
        };
        CommandBytes { bytes: [0xA5, code, 0, 0, 0, 0, 0, 0, 0], length: 2 }
    }
}
