//! The tests of this folder, but those of line scanners, in one program: what they share is built once.

mod errors;
mod generated;
mod generated_link;
mod link;
mod noisy_line;
mod pairing;
mod rig;
mod scan_lines;
mod stream;
mod telegrams;
