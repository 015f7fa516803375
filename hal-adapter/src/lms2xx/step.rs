//! The steps in which a session sets its scanner up and starts it.

use super::command::{Command, Configuration};
use super::settings::Settings;

/// A step, in the order in which they are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Looks for the scanner with a command to stop, at any baud rate.
    Find,
    SetBaud,
    SetVariant,
    ReadConfiguration,
    Install(Configuration),
    WriteConfiguration(Configuration),
    LeaveInstallation,
    Start,
}

impl Step {
    /// Returns the command that is sent in this step.
    pub fn command(self, settings: &Settings) -> Command {
        match self {
            Self::Find | Self::LeaveInstallation => Command::Stop,
            Self::SetBaud => Command::SetBaud(settings.baud),
            Self::SetVariant => Command::SetVariant(settings.variant),
            Self::ReadConfiguration => Command::ReadConfiguration,
            Self::Install(_) => Command::Install,
            Self::WriteConfiguration(configuration) => Command::WriteConfiguration(configuration),
            Self::Start if settings.interlaced => Command::StartInterlaced,
            Self::Start => Command::Start,
        }
    }

    /// Returns how often the command is tried before the session starts over; while searching,
    /// before it goes to another rate.
    pub fn tries(self) -> u8 {
        match self {
            // An EEPROM write is not repeated: the session starts over and first reads what the
            // scanner has.
            Self::WriteConfiguration(_) => 1,
            Self::Find => 2,
            _ => 3,
        }
    }

    /// Returns the longest time from the acknowledgement to the answer: changes of the mode take up
    /// to 3 s, EEPROM writes up to 15 s.
    pub fn answer_ms(self) -> u32 {
        match self {
            Self::Find | Self::ReadConfiguration => 1000,
            Self::WriteConfiguration(_) => 15_000,
            Self::SetBaud | Self::SetVariant | Self::Install(_) | Self::LeaveInstallation | Self::Start => 3000,
        }
    }
}
