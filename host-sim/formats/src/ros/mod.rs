//! Recordings of ROS 2: MCAP, and with the feature `db3` SQLite.

mod cdr;
mod cloud;
#[cfg(feature = "db3")]
mod db3;
mod depth;
mod laser;
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

pub(crate) use recording::is_folder_of_one;
pub(crate) use scans::{frames_of_db3, frames_of_mcap};
