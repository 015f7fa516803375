//! Troubles between a session and its scanner.

/// A trouble with the scanner. The session retries by itself and never gives up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Trouble {
    /// The scanner answers at no baud rate. The search goes on.
    NotFound,
    /// A command was not answered, several times.
    NoAnswer {
        /// Its code.
        command: u8,
    },
    /// A command arrived damaged (NACK), several times.
    NotAcknowledged {
        /// Its code.
        command: u8,
    },
    /// The scanner refused a command, several times.
    Refused {
        /// Its code.
        command: u8,
        /// The reason it gave, see [`super::command::Answer::Refused`].
        reason: u8,
    },
    /// The configuration block has a length that no known scanner has.
    Configuration {
        /// Its length in bytes.
        length: u16,
    },
    /// Scan lines stopped coming, or none fits the settings.
    Silent,
    /// The scanner announced that it has been switched on or was reset.
    Restarted,
}

impl core::fmt::Display for Trouble {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotFound => write!(f, "no scanner answers at any baud rate"),
            Self::NoAnswer { command } => write!(f, "command {command:#04x} is not answered"),
            Self::NotAcknowledged { command } => write!(f, "command {command:#04x} arrives damaged"),
            Self::Refused { command, reason } => write!(f, "command {command:#04x} is refused with {reason:#04x}"),
            Self::Configuration { length } => write!(f, "configuration block has {length} bytes"),
            Self::Silent => write!(f, "scans have stopped"),
            Self::Restarted => write!(f, "scanner has restarted"),
        }
    }
}

impl core::error::Error for Trouble {}
