//! Bytes that may begin a packet.

use crate::bytes::{copy, move_down};

/// The bytes of one packet of at most `N`, or of what may be one. The search for a packet resumes
/// behind the first byte of a false one.
#[derive(Clone, Debug)]
pub(crate) struct Window<const N: usize> {
    bytes: [u8; N],
    held: usize,
}

impl<const N: usize> Window<N> {
    pub const fn new() -> Self {
        Self { bytes: [0; N], held: 0 }
    }

    /// Returns the bytes held.
    pub fn held(&self) -> &[u8] {
        self.bytes.get(..self.held).unwrap_or(&[])
    }

    /// Takes bytes until so many are held. Returns how many it took: 0 only if there are none.
    pub fn fill(&mut self, bytes: &[u8], until: usize) -> usize {
        let Some(room) = self.bytes.get_mut(self.held..until) else { return 0 };
        copy(room, bytes);
        let taken = room.len().min(bytes.len());
        self.held += taken;
        taken
    }

    /// Drops so many bytes, and those behind them with which no packet can begin. Returns how many
    /// it dropped.
    pub fn drop(&mut self, bytes: usize, begins: impl Fn(u8) -> bool) -> usize {
        let next = self.held().iter().skip(bytes).position(|&byte| begins(byte));
        let from = next.map_or(self.held, |at| at + bytes).min(N);
        move_down(&mut self.bytes, from);
        self.held = self.held.saturating_sub(from);
        from
    }
}
