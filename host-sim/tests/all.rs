//! The tests of this folder, but those of recordings of ROS 2, in one program: what they share is built once.

mod command;
mod command_counts;
mod command_noise;
mod command_options;
mod command_pictures;
mod command_recorded;
mod command_streams;
mod command_warnings;
mod experiment;
mod live;
mod lms_telegrams;
mod office;
mod outputs;
mod pages;
mod pictures;
mod program;
mod recorded;
mod recovery;
mod rig_command;
mod rules;
mod troubles;
