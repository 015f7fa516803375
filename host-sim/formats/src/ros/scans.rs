//! The scans of a recording.

use std::collections::VecDeque;
use std::path::Path;
use std::rc::Rc;

use crate::file::Cause;
use crate::ros::laser::Sweeps;
use crate::ros::mcap::McapRecording;
use crate::ros::per_message::{PerMessage, Read};
use crate::ros::recording::{Open, Recording};
use crate::ros::survey::{Content, Survey};
use crate::ros::velodyne::VelodynePackets;
use crate::ros::{cloud, depth};
use crate::scan::ReadOptions;
use crate::streamed::{Stream, Streamed};

/// Returns the scans of an MCAP file.
pub(crate) fn frames_of_mcap(path: &Path, options: &ReadOptions) -> Result<Streamed, Cause> {
    let file = path.to_path_buf();
    frames(path, options, Rc::new(move || Ok(Box::new(McapRecording::open(&file)?) as Box<dyn Recording>)))
}

/// Returns the scans of an SQLite file.
#[cfg(feature = "db3")]
pub(crate) fn frames_of_db3(path: &Path, options: &ReadOptions) -> Result<Streamed, Cause> {
    let file = path.to_path_buf();
    let open = move || Ok(Box::new(crate::ros::db3::Db3Recording::open(&file)?) as Box<dyn Recording>);
    frames(path, options, Rc::new(open))
}

/// Says that this build cannot.
#[cfg(not(feature = "db3"))]
pub(crate) fn frames_of_db3(_: &Path, _: &ReadOptions) -> Result<Streamed, Cause> {
    let what = "the feature db3 of this build; `rosbags-convert` makes an MCAP file of it";
    Err(crate::scan_error::ScanError::lacks("an SQLite recording", what).into())
}

fn frames(path: &Path, options: &ReadOptions, open: Open) -> Result<Streamed, Cause> {
    let survey = Survey::of(&open)?;
    let (topic, content) = survey.choose(options.topic.as_deref())?;
    let name = format!("{} {}", path.display(), topic.name);
    let options = options.clone();
    let each = |read: Read| -> Box<dyn Fn() -> Result<Box<dyn Stream>, Cause>> {
        let (open, topic) = (Rc::clone(&open), Rc::clone(&topic));
        Box::new(move || {
            let (recording, topic, read) = (open()?, Rc::clone(&topic), Rc::clone(&read));
            Ok(Box::new(PerMessage { recording, topic, read, data: vec![] }))
        })
    };
    let streams: Box<dyn Fn() -> Result<Box<dyn Stream>, Cause>> = match content {
        Content::Clouds => each(Rc::new(move |data| cloud::scan(name.clone(), data, &options))),
        Content::Depths => {
            let camera = depth::camera(&topic.name, &survey.cameras)?.clone();
            each(Rc::new(move |data| depth::scan(name.clone(), data, &camera, &options)))
        }
        Content::Lasers { frame } => {
            let turned = Rc::new(survey.turning.of(&frame)?);
            Box::new(move || {
                let (recording, topic, turned) = (open()?, Rc::clone(&topic), Rc::clone(&turned));
                let (name, options) = (name.clone(), options.clone());
                Ok(Box::new(Sweeps { name, options, recording, topic, turned, rows: vec![], sweep: vec![] }))
            })
        }
        Content::Velodyne => Box::new(move || {
            let (recording, topic, packets) = (open()?, Rc::clone(&topic), VecDeque::new());
            let (name, options) = (name.clone(), options.clone());
            Ok(Box::new(VelodynePackets { name, options, recording, topic, packets, turns: None, turn: None }))
        }),
    };
    Streamed::new("a recording", streams)
}
