//! LZF, the packing of PCD files (Marc Lehmann's liblzf).

/// The most bytes that one byte of it stands for: three make 264.
const MOST_PER_BYTE: usize = 88;

/// Returns the `size` bytes that were packed. Nothing is allocated for a size that the packed bytes
/// cannot have.
pub(crate) fn unpack(packed: &[u8], size: usize) -> Result<Vec<u8>, &'static str> {
    const SHORT: &str = "its packed points end early";
    if size > packed.len().saturating_mul(MOST_PER_BYTE) {
        return Err("its packed points cannot be so many");
    }
    let mut out = Vec::with_capacity(size);
    let mut rest = packed.iter();
    while let Some(&control) = rest.next() {
        let control = usize::from(control);
        if control < 32 {
            let (literal, after) = rest.as_slice().split_at_checked(control + 1).ok_or(SHORT)?;
            out.extend_from_slice(literal);
            rest = after.iter();
        } else {
            let mut length = control >> 5;
            if length == 7 {
                length += usize::from(*rest.next().ok_or(SHORT)?);
            }
            let back = ((control & 31) << 8) + usize::from(*rest.next().ok_or(SHORT)?) + 1;
            let start = out.len().checked_sub(back).ok_or("its packed points refer to what is not there")?;
            // what is copied may reach into what it makes
            let mut left = length + 2;
            while left > 0 {
                let piece = left.min(out.len() - start);
                out.extend_from_within(start..start + piece);
                left -= piece;
            }
        }
        if out.len() > size {
            return Err("its packed points are too many");
        }
    }
    if out.len() == size { Ok(out) } else { Err("its packed points are too few") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_and_what_repeats() {
        // two literals; five bytes from two back, which overlap; fourteen from one back
        let packed = [1, b'a', b'b', 3 << 5, 1, 7 << 5, 5, 0];
        assert_eq!(unpack(&packed, 21).unwrap(), b"abababaaaaaaaaaaaaaaa");
    }

    #[test]
    fn what_is_not_whole_is_refused() {
        let whole = [1, b'a', b'b', 3 << 5, 1];
        assert!(unpack(&whole, 7).is_ok());
        for (packed, size) in [(&whole[..2], 2), (&whole[..4], 7), (&whole, 6), (&whole, 8), (&[3 << 5, 1], 5)] {
            assert!(unpack(packed, size).is_err(), "{packed:?} {size}");
        }
        assert!(unpack(&whole, 1 << 40).is_err());
    }
}
