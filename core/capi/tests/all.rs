//! The tests of this folder in one program: what they share is built once.

mod beam_stretch;
mod misuse;
mod results;
