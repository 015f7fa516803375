//! The check word of SICK telegrams.

/// Returns the check word over `bytes`: from the start byte to the last byte before the check word.
/// In the telegram it follows low byte first.
///
/// The rule is SICK's own and in no catalogue of CRCs. The register shifts by one bit for each
/// byte, and each byte enters together with the one before it. Every single flipped bit is found.
/// Bit `k` of one byte and bit `k + 1` of the next, flipped together, are not found, so telegrams
/// are checked further.
#[must_use]
pub fn check_word(bytes: &[u8]) -> u16 {
    // in 32 bits, of which the lower half counts: half the instructions of 16 on a 32-bit processor
    let mut crc = 0u32;
    let mut previous = 0;
    for &byte in bytes {
        let byte = u32::from(byte);
        let carry = ((crc << 16) as i32 >> 31) as u32 & 0x8005;
        crc = (crc << 1) ^ carry ^ byte ^ (previous << 8);
        previous = byte;
    }
    crc as u16
}

#[cfg(test)]
mod tests {
    use super::check_word;

    #[test]
    fn check_value() {
        assert_eq!(check_word(b"123456789"), 0xA656);
        assert_eq!(check_word(&[]), 0);
    }

    #[test]
    fn known_blind_spot_and_single_bits() {
        let good = [0x02, 0x80, 0x03, 0x00, 0xA0, 0x00, 0x10];
        let word = check_word(&good);
        for byte in 0..good.len() {
            for bit in 0..8 {
                let mut bad = good;
                bad[byte] ^= 1 << bit;
                assert_ne!(check_word(&bad), word);
                if bit < 7 && byte + 2 < good.len() {
                    bad[byte + 1] ^= 2 << bit;
                    assert_eq!(check_word(&bad), word, "the blind spot that the further checks are for");
                }
            }
        }
    }
}
