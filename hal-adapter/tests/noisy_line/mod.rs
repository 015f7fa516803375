//! A line that loses, flips, inserts and bursts.

/// splitmix64.
pub struct Random(pub u64);

impl Random {
    /// Any 64 bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ x >> 31
    }

    /// 0 to `below` - 1.
    pub fn below(&mut self, below: usize) -> usize {
        (self.next() % below as u64) as usize
    }

    /// True with this probability.
    pub fn is(&mut self, probability: f64) -> bool {
        ((self.next() >> 11) as f64) < probability * (1u64 << 53) as f64
    }
}

/// What comes of a message with so many faults for each byte: its bytes, and whether they are all
/// there, and no other among them.
pub fn across_the_line(sent: &[u8], rate: f64, random: &mut Random) -> (Vec<u8>, bool) {
    let (mut came, mut whole, mut burst) = (Vec::new(), true, 0);
    for (i, &byte) in sent.iter().enumerate() {
        if burst == 0 && !random.is(rate) {
            came.push(byte);
            continue;
        }
        let kind = if burst > 0 { 3 } else { random.below(4) };
        match kind {
            0 => whole = false,
            1 => {
                came.push(byte ^ 1 << random.below(8));
                whole = false;
            }
            2 => {
                // before the first byte it is between telegrams
                came.extend([random.next() as u8, byte]);
                whole &= i == 0;
            }
            _ => {
                burst = if burst > 0 { burst - 1 } else { random.below(40) };
                let other = random.next() as u8;
                whole &= other == byte;
                came.push(other);
            }
        }
    }
    (came, whole)
}
