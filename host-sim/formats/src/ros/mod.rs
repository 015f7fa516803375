//! Messages of ROS 2: of recordings (MCAP, and with the feature `db3` SQLite), and as they come.

mod cdr;
mod cloud;
#[cfg(feature = "db3")]
mod db3;
mod depth;
mod laser;
mod live;
#[cfg(test)]
mod made_up;
mod mcap;
mod messages;
mod per_message;
mod pose;
mod recording;
mod scans;
mod survey;
mod turned;
mod velodyne;

pub use live::{Came, LiveScan, LiveScans, Needed};
pub(crate) use recording::is_folder_of_one;
pub(crate) use scans::{frames_of_db3, frames_of_mcap};
