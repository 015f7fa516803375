//! Packets of the LD06.
//!
//! ```text
//! 54 | 2C | speed | start angle | 12 x (range, confidence) | end angle | time | CRC-8
//! speed in degrees a second, angles in hundredths of a degree, ranges and time in mm and ms; words are 16 bits,
//! low byte first, a confidence is one byte
//! ```

/// Bytes of a packet.
pub const LENGTH: usize = 47;
/// Beams in a packet.
pub const BEAMS: usize = 12;

pub(super) const START: u8 = 0x54;
/// Version 1, 12 beams.
pub(super) const VERSION_AND_BEAMS: u8 = 0x2C;
/// A full turn in the angles of a packet.
const TURN_CDEG: u16 = 36_000;
/// The time stamp goes back to 0 there.
const WRAP_MS: u16 = 30_000;
/// Speeds of the mirror, degrees a second: 1 to 16 turns. The manuals say 5 to 13; it starts slower.
const SPEEDS_DEG_PER_S: core::ops::RangeInclusive<u16> = 360..=5760;

/// The scanners that send these packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Model {
    /// LD06: 4500 beams a second, 230 400 Bd.
    Ld06,
    /// LD19, also sold as STL-19P: as LD06.
    Ld19,
    /// STL-27L: 21 600 beams a second, 921 600 Bd.
    Stl27l,
}

impl Model {
    /// Returns the rate of its line, bits a second: 8 data bits, no parity, one stop bit.
    #[must_use]
    pub const fn bits_per_s(self) -> u32 {
        match self {
            Self::Ld06 | Self::Ld19 => 230_400,
            Self::Stl27l => 921_600,
        }
    }

    /// Returns its beams a second, whatever the speed of the mirror. Those of the scanner recorded
    /// were 1 % more.
    #[must_use]
    pub const fn beams_per_s(self) -> u32 {
        match self {
            Self::Ld06 | Self::Ld19 => 4_500,
            Self::Stl27l => 21_600,
        }
    }
}

/// Why bytes that began like a packet are not one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PacketError {
    /// The CRC differs.
    Check {
        /// Computed over the bytes.
        computed: u8,
        /// Found behind them.
        found: u8,
    },
    /// The next packet begins within it.
    Short,
    /// The CRC is right, but no mirror turns at this speed, degrees a second.
    Speed(u16),
    /// The CRC is right, but an angle is beyond a turn, hundredths of a degree.
    Angle(u16),
    /// The CRC is right, but the time stamp is beyond those of the scanner, milliseconds.
    Time(u16),
    /// The CRC is right, but the beams are not as far apart as the speed makes them.
    Span {
        /// From the first beam to the last, hundredths of a degree.
        span_cdeg: u16,
        /// What the speed makes it.
        expected_cdeg: u16,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Check { computed, found } => write!(f, "CRC is {found:#04x}, should be {computed:#04x}"),
            Self::Short => write!(f, "the next packet begins within it"),
            Self::Speed(speed) => write!(f, "the mirror cannot turn at {speed} deg/s"),
            Self::Angle(angle_cdeg) => write!(f, "{angle_cdeg} hundredths of a degree are beyond a turn"),
            Self::Time(time_ms) => write!(f, "no time stamp is {time_ms} ms"),
            Self::Span { span_cdeg, expected_cdeg } => {
                write!(f, "beams cover {span_cdeg} hundredths of a degree, should be {expected_cdeg}")
            }
        }
    }
}

impl core::error::Error for PacketError {}

/// A valid packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet {
    bytes: [u8; LENGTH],
}

impl Packet {
    /// Checks the bytes of a packet of this model.
    ///
    /// # Errors
    /// [`PacketError`]. Of packets made of other bytes the CRC lets one in 256 pass; what they say
    /// is checked as well.
    pub fn new(bytes: [u8; LENGTH], model: Model) -> Result<Self, PacketError> {
        let [covered @ .., found] = &bytes;
        let (computed, found) = (crc8(covered), *found);
        if computed != found {
            return Err(PacketError::Check { computed, found });
        }
        let packet = Self { bytes };
        let (speed, time_ms) = (packet.speed_deg_per_s(), packet.time_ms());
        if !SPEEDS_DEG_PER_S.contains(&speed) {
            return Err(PacketError::Speed(speed));
        }
        if let Some(angle_cdeg) = [packet.start_cdeg(), packet.end_cdeg()].into_iter().find(|&a| a >= TURN_CDEG) {
            return Err(PacketError::Angle(angle_cdeg));
        }
        if time_ms >= WRAP_MS {
            return Err(PacketError::Time(time_ms));
        }
        let span_cdeg = packet.span_cdeg();
        let expected_cdeg = (u32::from(speed) * 100 * (BEAMS as u32 - 1) / model.beams_per_s()) as u16;
        // the packet in the manual of the LD06 has twice what is expected
        if !(expected_cdeg / 3..=expected_cdeg * 3).contains(&span_cdeg) {
            return Err(PacketError::Span { span_cdeg, expected_cdeg });
        }
        Ok(packet)
    }

    /// Returns the speed of the mirror, degrees a second, 360 to 5760.
    #[must_use]
    pub fn speed_deg_per_s(&self) -> u16 {
        self.word(2)
    }

    /// Returns the angle of the first beam, hundredths of a degree clockwise from ahead, below
    /// 36 000.
    #[must_use]
    pub fn start_cdeg(&self) -> u16 {
        self.word(4)
    }

    /// Returns the angle of the last beam, as [`Packet::start_cdeg`].
    #[must_use]
    pub fn end_cdeg(&self) -> u16 {
        self.word(42)
    }

    /// Returns the scanner's time stamp, milliseconds; it goes back to 0 at 30 000.
    #[must_use]
    pub fn time_ms(&self) -> u16 {
        self.word(44)
    }

    /// Returns the angle from the first beam to the last, hundredths of a degree.
    #[must_use]
    pub fn span_cdeg(&self) -> u16 {
        turned_cdeg(self.start_cdeg(), self.end_cdeg())
    }

    /// Returns range, millimetres, and confidence of a beam; 0 and 0 for a beam from 12 on. The
    /// range is 0 where there was no return.
    #[must_use]
    pub fn beam(&self, beam: usize) -> (u16, u8) {
        let at = 6 + 3 * beam.min(BEAMS);
        if beam < BEAMS { (self.word(at), self.bytes.get(at + 2).copied().unwrap_or(0)) } else { (0, 0) }
    }

    fn word(&self, at: usize) -> u16 {
        self.bytes.get(at..).and_then(|rest| rest.first_chunk()).map_or(0, |word| u16::from_le_bytes(*word))
    }
}

/// Returns the angle from one to another, clockwise, hundredths of a degree.
pub(super) fn turned_cdeg(from_cdeg: u16, to_cdeg: u16) -> u16 {
    if to_cdeg >= from_cdeg { to_cdeg - from_cdeg } else { to_cdeg + (TURN_CDEG - from_cdeg) }
}

/// CRC-8 of polynomial 0x4D from 0, not reflected.
fn crc8(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |crc, &byte| {
        (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x4D })
    })
}
