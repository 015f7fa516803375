//! What an RPLIDAR sends.
//!
//! ```text
//! descriptor  A5 | 5A | length of 30 bits, 2 bits | type
//! node        quality of 6 bits, not S, S | angle of 15 bits in 1/64 deg, 1 | range in 1/4 mm
//! capsule     A, check bits 0-3 | 5, check bits 4-7 | S, angle of 15 bits in 1/64 deg | 80 bytes
//!   express   16 x (range in mm, 2 bits of angle | the same | 4 bits of angle each), angles in 1/8 deg
//!   dense     40 x range in mm
//! S: the first of a turn (node), of the scan (capsule); words are 16 bits, low byte first
//! ```

/// Bytes of a descriptor.
pub(super) const DESCRIPTOR: usize = 7;
/// Bytes of the longest packet.
pub(super) const LONGEST: usize = 84;
/// Bytes of a capsule before its beams.
const HEAD: usize = 4;
/// A full turn in the angles of packets.
const TURN_Q6: u16 = 360 << 6;

/// The packets of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Format {
    /// Nodes of one beam, 5 bytes: the standard scan.
    Node,
    /// Capsules of 32 beams, 84 bytes: the express scan of A1 and A2.
    Express,
    /// Capsules of 40 beams, 84 bytes: the express scan of C1 and S2.
    Dense,
}

impl Format {
    /// Returns the bytes of a packet.
    #[must_use]
    pub const fn length(self) -> usize {
        match self {
            Self::Node => 5,
            Self::Express | Self::Dense => 84,
        }
    }

    /// Returns the beams of a packet.
    #[must_use]
    pub const fn beams(self) -> usize {
        match self {
            Self::Node => 1,
            Self::Express => 32,
            Self::Dense => 40,
        }
    }

    /// Returns whether a packet can begin with this byte.
    pub(super) fn begins(self, byte: u8) -> bool {
        match self {
            Self::Node => matches!(byte & 3, 1 | 2),
            Self::Express | Self::Dense => byte & 0xF0 == 0xA0,
        }
    }

    /// Reads a descriptor.
    pub(super) fn of_descriptor(bytes: &[u8; DESCRIPTOR]) -> Result<Self, PacketError> {
        let [_, _, length, 0, 0, 0x40, kind] = *bytes else { return Err(PacketError::Answer) };
        match (kind, length) {
            (0x81, 5) => Ok(Self::Node),
            (0x82, 84) => Ok(Self::Express),
            (0x85, 84) => Ok(Self::Dense),
            _ => Err(PacketError::Answer),
        }
    }
}

/// Why bytes that began like a packet are none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PacketError {
    /// A descriptor of something else than a scan that is understood.
    Answer,
    /// The checksum of a capsule differs.
    Check {
        /// Computed over the bytes.
        computed: u8,
        /// Found before them.
        found: u8,
    },
    /// The constant bits of a node differ.
    Flags,
    /// The next packet begins too early or too late for it: a byte was lost or inserted.
    Length,
    /// An angle is beyond a turn, 1/64 degree.
    Angle(u16),
    /// The angle of a node does not go on from the last one.
    Elsewhere {
        /// From the last node to this one, degrees, -180 to 180.
        moved_deg: i16,
    },
}

impl core::fmt::Display for PacketError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Answer => write!(f, "the answer announces no scan that is understood"),
            Self::Check { computed, found } => write!(f, "checksum is {found:#04x}, should be {computed:#04x}"),
            Self::Flags => write!(f, "the constant bits of a node differ"),
            Self::Length => write!(f, "the next packet begins too early or too late"),
            Self::Angle(angle_q6) => write!(f, "{angle_q6} / 64 degrees are beyond a turn"),
            Self::Elsewhere { moved_deg } => write!(f, "a node lies {moved_deg} degrees from the last one"),
        }
    }
}

impl core::error::Error for PacketError {}

/// A valid node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Clockwise from ahead, 2^-32 of a turn.
    pub angle: u32,
    pub range_m: f32,
}

impl Node {
    /// Checks the bytes of a node.
    pub fn new(bytes: &[u8; 5]) -> Result<Self, PacketError> {
        let [quality_and_flags, angle_low, angle_high, range @ ..] = *bytes;
        if !Format::Node.begins(quality_and_flags) || angle_low & 1 == 0 {
            return Err(PacketError::Flags);
        }
        let angle = units(u16::from_le_bytes([angle_low, angle_high]) >> 1)?;
        Ok(Self { angle, range_m: f32::from(u16::from_le_bytes(range)) / 4000.0 })
    }

    /// Returns the angle of a node that begins with these bytes; `None` if none does.
    pub fn angle(bytes: &[u8]) -> Option<u32> {
        let [first, low, high, ..] = *bytes else { return None };
        Some(Self::new(&[first, low, high, 0, 0]).ok()?.angle)
    }
}

/// A valid capsule.
#[derive(Clone, Copy, Debug)]
pub(super) struct Capsule {
    bytes: [u8; LONGEST],
    format: Format,
    /// Angle of its first beam, clockwise from ahead, 2^-32 of a turn.
    pub start: u32,
    /// The first of the scan.
    pub first: bool,
}

impl Capsule {
    /// Returns whether a capsule can begin with these bytes.
    pub fn begins(bytes: &[u8]) -> bool {
        let mut syncs = bytes.iter().zip([0xA0, 0x50]);
        syncs.all(|(byte, sync)| byte & 0xF0 == sync)
    }

    /// Checks the bytes of a capsule.
    pub fn new(bytes: &[u8; LONGEST], format: Format) -> Result<Self, PacketError> {
        let [check_low, check_high, covered @ ..] = bytes;
        let (computed, found) = (covered.iter().fold(0, |sum, byte| sum ^ byte), check_low & 15 | check_high << 4);
        if computed != found {
            return Err(PacketError::Check { computed, found });
        }
        let angle = word(bytes, 2);
        let start = units(angle & 0x7FFF)?;
        Ok(Self { bytes: *bytes, format, start, first: angle & 0x8000 != 0 })
    }

    /// Returns the number of beams.
    pub fn beams(&self) -> usize {
        self.format.beams()
    }

    /// Returns a beam: how far its angle lies behind that of evenly spaced beams, 2^-32 of a turn,
    /// and its range, metres.
    pub fn beam(&self, beam: usize) -> (u32, f32) {
        match self.format {
            Format::Dense => (0, f32::from(word(&self.bytes, HEAD + 2 * beam)) / 1000.0),
            _ => {
                let (cabin, half) = (HEAD + 5 * (beam / 2), beam % 2);
                let range = word(&self.bytes, cabin + 2 * half);
                let low = self.bytes.get(cabin + 4).copied().unwrap_or(0) >> (4 * half) & 15;
                let behind_q3 = u32::from(low) | u32::from(range & 3) << 4;
                // 1/8 degree is 1/2880 of a turn
                (behind_q3 * 1_491_308, f32::from(range >> 2) / 1000.0)
            }
        }
    }
}

fn word(bytes: &[u8], at: usize) -> u16 {
    bytes.get(at..).and_then(|rest| rest.first_chunk()).map_or(0, |word| u16::from_le_bytes(*word))
}

/// Returns an angle in units of 2^-32 of a turn.
fn units(angle_q6: u16) -> Result<u32, PacketError> {
    if angle_q6 >= TURN_Q6 {
        return Err(PacketError::Angle(angle_q6));
    }
    Ok(((u64::from(angle_q6) << 32) / u64::from(TURN_Q6)) as u32)
}
