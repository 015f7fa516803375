//! Slamtec RPLIDAR line scanners (A1, A2, C1, S2 and others with the same scans) on their serial
//! line.
//!
//! They turn clockwise, all the way round, and send when they are told to: [`Command`] has the
//! bytes. A scanner answers a command with a descriptor, which says what follows. [`Rplidar`] reads
//! it and makes rows of the scan:
//!
//! | scan | command | [`Format`] | of |
//! |---|---|---|---|
//! | standard | [`Command::Scan`] | nodes of one beam | all |
//! | express | [`Command::ExpressScan`] | capsules of 32 beams, each with an angle of its own | A1, A2 |
//! | express, dense | [`Command::ExpressScan`] | capsules of 40 beams, evenly spaced | C1, S2 |
//!
//! A node has no checksum, only three bits and an angle that goes on: choose an express scan where
//! the wires are bad. A capsule has a checksum of 8 bits.
//!
//! | | A1, A2M8 | A2M7, A2M12 | C1 | S2 |
//! |---|---|---|---|---|
//! | bits a second, 8N1 | 115 200 | 256 000 | 460 800 | 1 000 000 |
//!
//! The motor of A1 and A2 turns when the line MOTOCTL is driven; C1 and S2 start it themselves.
//! Between a command to stop or to reset and the next command a scanner needs 1 ms and 2 ms, and a
//! C1 or S2 up to 500 ms after a reset.
//!
//! Sources: Slamtec's protocol and the unpackers of its SDK (`sl_lidar_protocol.h`,
//! `handler_capsules.cpp`). The angle of an express beam is corrected by 0 to 7.9 degrees, as the
//! SDK reads it, not by a number with a sign.

mod command;
mod packet;
mod scanner;

pub use command::{Command, CommandBytes};
pub use packet::{Format, PacketError};
pub use scanner::Rplidar;
