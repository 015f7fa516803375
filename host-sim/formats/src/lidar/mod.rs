//! Captures of lidars: Ouster, Velodyne, LDROBOT LD06.

mod datagrams;
mod firings;
mod ip;
pub mod ld06;
#[cfg(test)]
mod made_up;
mod ouster;
mod ouster_metadata;
pub(crate) mod pcap;
mod turns;
pub mod velodyne;

pub use datagrams::{Datagram, Datagrams, Flow};
pub use firings::{FiringRow, FiringRows};
pub use ouster::{Assembler, Column, OusterFrame, columns};
pub use ouster_metadata::{Metadata, Profile};
pub use pcap::read_metadata;
pub use turns::{Turn, Turns};
