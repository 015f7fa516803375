//! A row of the image: its beams, packed bits and runs, and safe access to its elements.

pub(crate) mod bits;
pub(crate) mod fan;
pub(crate) mod points;
pub(crate) mod slots;
pub(crate) mod within;
