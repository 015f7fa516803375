//! Captures of lidars: Ouster, Velodyne, LDROBOT LD06.

mod datagrams;
mod error;
mod ip;
#[cfg(test)]
mod made_up;
mod ouster;
mod ouster_metadata;
mod turns;
pub mod velodyne;

pub use datagrams::{Datagram, Datagrams, Flow};
pub use error::LidarError;
pub use ouster::{Assembler, OusterFrame};
pub use ouster_metadata::{Metadata, Profile};
pub use turns::{Turn, Turns};
