//! LDROBOT LD06, LD19 and STL-27L line scanners on their serial line.
//!
//! They need no command: they send as soon as they have power, one way, packets of 12 beams. The
//! mirror turns clockwise, all the way round.
//!
//! - [`Packet`] reads one packet. [`PacketError`] says why bytes are none.
//! - [`Ld06`] finds the packets in bytes and makes rows of them, see
//!   [`LineScanner`](crate::scanner::LineScanner).
//!
//! Sources: LDROBOT's own driver (`ldlidar_stl_ros2`), the packet in the manual of the LD06, and
//! recorded bytes of an LD06, which are tests.

mod packet;
mod scanner;

pub use packet::{BEAMS, LENGTH, Model, Packet, PacketError};
pub use scanner::Ld06;
