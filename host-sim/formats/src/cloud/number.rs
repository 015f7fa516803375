//! Numbers as binary files store them, little end first.

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Number {
    /// Returns the type of a letter (`F` real, `I` whole, `U` whole and not negative) and a size in
    /// bytes.
    pub fn of(kind: &str, bytes: usize) -> Option<Number> {
        Some(match (kind, bytes) {
            ("I", 1) => Number::I8,
            ("U", 1) => Number::U8,
            ("I", 2) => Number::I16,
            ("U", 2) => Number::U16,
            ("I", 4) => Number::I32,
            ("U", 4) => Number::U32,
            ("I", 8) => Number::I64,
            ("U", 8) => Number::U64,
            ("F", 4) => Number::F32,
            ("F", 8) => Number::F64,
            _ => return None,
        })
    }

    /// Returns its size.
    pub fn bytes(self) -> usize {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::I16 | Number::U16 => 2,
            Number::I32 | Number::U32 | Number::F32 => 4,
            Number::I64 | Number::U64 | Number::F64 => 8,
        }
    }

    /// Returns the number of its bytes, big end first.
    pub fn big_endian(self, bytes: &[u8]) -> f64 {
        let mut turned = [0; 8];
        let turned = &mut turned[..self.bytes()];
        turned.iter_mut().zip(bytes.iter().rev()).for_each(|(to, from)| *to = *from);
        self.at(turned, 0)
    }

    /// Returns the number at a place of `data`; NaN beyond its end.
    pub fn at(self, data: &[u8], place: usize) -> f64 {
        fn array<const N: usize>(data: &[u8], place: usize) -> Option<[u8; N]> {
            data.get(place..)?.first_chunk().copied()
        }
        let number = match self {
            Number::I8 => array(data, place).map(|b| i8::from_le_bytes(b).into()),
            Number::U8 => array(data, place).map(|b| u8::from_le_bytes(b).into()),
            Number::I16 => array(data, place).map(|b| i16::from_le_bytes(b).into()),
            Number::U16 => array(data, place).map(|b| u16::from_le_bytes(b).into()),
            Number::I32 => array(data, place).map(|b| i32::from_le_bytes(b).into()),
            Number::U32 => array(data, place).map(|b| u32::from_le_bytes(b).into()),
            Number::I64 => array(data, place).map(|b| i64::from_le_bytes(b) as f64),
            Number::U64 => array(data, place).map(|b| u64::from_le_bytes(b) as f64),
            Number::F32 => array(data, place).map(|b| f32::from_le_bytes(b).into()),
            Number::F64 => array(data, place).map(f64::from_le_bytes),
        };
        number.unwrap_or(f64::NAN)
    }
}
