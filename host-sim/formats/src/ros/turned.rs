//! What turns a 2D scanner: transforms (`/tf`), or a joint.

use std::collections::BTreeMap;

use crate::ros::messages::{JointState, TfMessage};
use crate::ros::pose::{Pose, Poses};
use crate::scan_error::ScanError;

/// A joint that moves less than this does not turn a scanner, radians.
const LEAST_TURN_RAD: f64 = 0.03;
/// The most frames from a scanner to what turns it.
const MAX_CHAIN: usize = 16;

/// All that turns in a recording.
#[derive(Default)]
pub struct Turning {
    /// Parent and poses of each frame.
    frames: BTreeMap<String, (String, Poses)>,
    joints: BTreeMap<String, Poses>,
}

/// How a scanner is turned: the pose of its frame at each time.
pub struct Turned {
    /// In time.
    poses: Poses,
    /// Of the scanner within what is turned.
    mount: Pose,
    /// The frame in which the poses are.
    pub frame: String,
    /// To be said to the user.
    pub remark: Option<String>,
}

impl Turned {
    /// The time of the last pose.
    pub fn last_ns(&self) -> Option<i64> {
        self.poses.last_ns()
    }

    /// Returns the pose of the scanner; `None` where it is not known.
    pub fn at(&self, time_ns: i64) -> Option<Pose> {
        Some(self.poses.at(time_ns)?.then(&self.mount))
    }
}

impl Turning {
    /// Adds what a message says. What stands still (`/tf_static`) may have any time.
    pub fn add_transforms(&mut self, topic: &str, message: TfMessage) {
        for transform in message.transforms {
            let Some(pose) = Pose::new(transform.rotation, transform.translation) else { continue };
            let time_ns = if topic.ends_with("tf_static") { 0 } else { transform.header.stamp.ns() };
            let (parent, poses) = self.frames.entry(transform.child_frame_id).or_default();
            *parent = transform.header.frame_id;
            poses.add(time_ns, pose);
        }
    }

    /// Adds the positions of joints.
    pub fn add_joints(&mut self, message: &JointState) {
        for (name, position) in message.name.iter().zip(&message.position) {
            // as the axis to the left of ROS: a positive turn is downwards
            let pose = Pose::about_y(*position);
            if position.is_finite() {
                self.joints.entry(name.clone()).or_default().add(message.header.stamp.ns(), pose);
            }
        }
    }

    /// Forgets poses before a time, but for the last of each.
    pub fn forget_before(&mut self, time_ns: i64) {
        self.frames.values_mut().for_each(|(_, poses)| poses.forget_before(time_ns));
        self.joints.values_mut().for_each(|poses| poses.forget_before(time_ns));
    }

    /// Returns how the scanner of a frame is turned: by the first transform above it that moves, or
    /// by the only joint that does.
    pub fn of(&self, frame: &str) -> Result<Turned, ScanError> {
        let (mut mount, mut at) = (Pose::NONE, frame);
        for _ in 0..MAX_CHAIN {
            let Some((parent, poses)) = self.frames.get(at) else { break };
            if turn_rad(poses) > LEAST_TURN_RAD {
                return Ok(Turned { poses: poses.clone(), mount, frame: parent.clone(), remark: None });
            }
            mount = poses.iter().next().unwrap_or(&Pose::NONE).then(&mount);
            at = parent;
        }
        let mut moving = self.joints.iter().filter(|(_, poses)| turn_rad(poses) > LEAST_TURN_RAD);
        match (moving.next(), moving.next()) {
            (Some((name, poses)), None) => {
                let remark = format!("the joint {name} is taken to turn the scanner about its axis to the left");
                Ok(Turned { poses: poses.clone(), mount: Pose::NONE, frame: frame.into(), remark: Some(remark) })
            }
            (None, _) => {
                let what = format!("a transform that turns {frame}, or a joint that moves: its scans would be one row");
                Err(ScanError::lacks("a recording", what))
            }
            (Some((a, _)), Some((b, _))) => {
                let what = format!("a transform that turns {frame}; of its joints more than one moves: {a}, {b}");
                Err(ScanError::lacks("a recording", what))
            }
        }
    }
}

/// How far apart the turns of poses are, radians.
fn turn_rad(poses: &Poses) -> f64 {
    let mut poses = poses.iter();
    let Some(first) = poses.next() else { return 0.0 };
    let turns = poses.map(|pose| first.turn_to(pose).iter().map(|x| x * x).sum::<f64>().sqrt());
    turns.fold(0.0, f64::max)
}
