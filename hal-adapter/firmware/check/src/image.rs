//! What an image takes of flash and memory, by its section headers (ELF, 32 bits, little endian).

use std::fs;
use std::path::Path;

use crate::Result;

/// Bytes.
#[derive(Debug, Default, PartialEq)]
pub struct Size {
    /// Vectors and code.
    pub text: u32,
    /// Constants.
    pub rodata: u32,
    /// Variables with values: in flash and in memory.
    pub data: u32,
    /// Variables that begin as zeros.
    pub bss: u32,
}

impl Size {
    pub fn flash(&self) -> u32 {
        self.text + self.rodata + self.data
    }

    pub fn memory(&self) -> u32 {
        self.data + self.bss
    }

    pub fn of(image: &Path) -> Result<Self> {
        let bytes = fs::read(image)?;
        Self::parse(&bytes).ok_or_else(|| format!("{} is no image", image.display()).into())
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
        let half = |at: usize| Some(usize::from(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?)));
        if !bytes.starts_with(b"\x7FELF\x01\x01") {
            return None;
        }
        let (headers, header_length, count) = (word(0x20)? as usize, half(0x2E)?, half(0x30)?);
        let mut size = Self::default();
        for header in (0..count).map(|i| headers + i * header_length) {
            let (kind, flags, length) = (word(header + 4)?, word(header + 8)?, word(header + 20)?);
            let (write, alloc, execute) = (flags & 1 != 0, flags & 2 != 0, flags & 4 != 0);
            match (alloc, kind) {
                (false, _) => {}
                (true, 8) => size.bss += length, // without bytes in the file
                _ if write => size.data += length,
                _ if execute => size.text += length,
                _ => size.rodata += length,
            }
        }
        Some(size)
    }
}
