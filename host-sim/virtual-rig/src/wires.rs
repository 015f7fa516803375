//! What wires do to bytes.

use scanseg_hal::lms2xx::Baud;

/// Damage on the wires, in both directions: of so many bytes one suffers, 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WireFaults {
    /// Bytes that vanish.
    pub drop_one_in: u32,
    /// Bytes of which one bit flips.
    pub flip_one_in: u32,
    /// Bytes that are followed by another, invented one.
    pub insert_one_in: u32,
    /// Bytes with which a burst of [`BURST`] invented ones begins.
    pub burst_one_in: u32,
}

/// Bytes that are replaced in a burst.
pub const BURST: u32 = 60;

/// Wires with faults. Chance is the same in every run.
#[derive(Clone, Debug)]
pub struct Wires {
    /// Damage from now on.
    pub faults: WireFaults,
    burst_left: u32,
    random: u64,
}

impl Default for Wires {
    fn default() -> Self {
        Self { faults: WireFaults::default(), burst_left: 0, random: 0x9E37_79B9_7F4A_7C15 }
    }
}

impl Wires {
    /// Returns what becomes of a byte: nothing, itself, another one, or two.
    pub fn damage(&mut self, byte: u8) -> impl Iterator<Item = u8> + use<> {
        let faults = self.faults;
        let mut strikes = |one_in: u32| one_in > 0 && self.next_random().is_multiple_of(u64::from(one_in));
        let (dropped, flipped, inserted) =
            (strikes(faults.drop_one_in), strikes(faults.flip_one_in), strikes(faults.insert_one_in));
        if strikes(faults.burst_one_in) {
            self.burst_left = BURST;
        }
        let random = self.next_random();
        let byte = if self.burst_left > 0 { (random >> 16) as u8 } else { byte };
        self.burst_left = self.burst_left.saturating_sub(1);
        let byte = if flipped { byte ^ 1 << (random % 8) } else { byte };
        let kept = (!dropped).then_some(byte);
        kept.into_iter().chain(inserted.then_some((random >> 8) as u8))
    }

    /// Returns what a byte sent at one rate is taken for at another: nothing at all, or anything.
    pub fn garble(&mut self, byte: u8, sent_at: Baud, read_at: Baud) -> Option<u8> {
        if sent_at == read_at {
            return Some(byte);
        }
        let random = self.next_random();
        random.is_multiple_of(3).then_some((random >> 8) as u8)
    }

    fn next_random(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random >> 16
    }
}
