//! Rotations and positions: of transforms, and in time.

/// A rotation, then a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Unit quaternion x, y, z, w.
    pub rotation: [f64; 4],
    /// Metres.
    pub shift_m: [f64; 3],
}

impl Pose {
    pub const NONE: Pose = Pose { rotation: [0.0, 0.0, 0.0, 1.0], shift_m: [0.0; 3] };

    /// Returns the pose of a transform, `None` if it is no rotation.
    pub fn new(rotation: [f64; 4], shift_m: [f64; 3]) -> Option<Pose> {
        let length = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
        let good = (0.9..1.1).contains(&length) && shift_m.iter().all(|m| m.is_finite());
        good.then(|| Pose { rotation: rotation.map(|x| x / length), shift_m })
    }

    /// Returns a turn about the axis to the left.
    pub fn about_y(turn_rad: f64) -> Pose {
        let (sine, cosine) = (turn_rad / 2.0).sin_cos();
        Pose { rotation: [0.0, sine, 0.0, cosine], shift_m: [0.0; 3] }
    }

    /// Returns where a point lies in the frame in which this is a pose.
    pub fn of_point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(point);
        [0, 1, 2].map(|i| turned[i] + self.shift_m[i])
    }

    fn turn(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z, w] = self.rotation;
        let u = [x, y, z];
        let t = cross(u, v).map(|c| 2.0 * c);
        let tt = cross(u, t);
        [0, 1, 2].map(|i| v[i] + w * t[i] + tt[i])
    }

    /// Returns the pose of what has the pose `inner` within this one.
    pub fn then(&self, inner: &Pose) -> Pose {
        Pose { rotation: product(self.rotation, inner.rotation), shift_m: self.of_point(inner.shift_m) }
    }

    /// Returns the turn from this pose to another as an axis times radians.
    pub fn turn_to(&self, other: &Pose) -> [f64; 3] {
        let [x, y, z, w] = self.rotation;
        let [x, y, z, w] = product([-x, -y, -z, w], other.rotation);
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        let sine = (x * x + y * y + z * z).sqrt();
        let scale = if sine > 1e-12 { 2.0 * sine.atan2(w.abs()) / sine } else { 2.0 };
        [x, y, z].map(|v| sign * scale * v)
    }

    /// Returns the pose a part of the way to another, 0 to 1, for turns of some degrees.
    fn between(&self, other: &Pose, part: f64) -> Pose {
        let dot: f64 = self.rotation.iter().zip(&other.rotation).map(|(a, b)| a * b).sum();
        let sign = if dot < 0.0 { -1.0 } else { 1.0 };
        let mixed = [0, 1, 2, 3].map(|i| self.rotation[i] + part * (sign * other.rotation[i] - self.rotation[i]));
        let shift_m = [0, 1, 2].map(|i| self.shift_m[i] + part * (other.shift_m[i] - self.shift_m[i]));
        let length = mixed.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
        Pose { rotation: mixed.map(|x| x / length), shift_m }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a, b);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// Poses in the order of time.
#[derive(Clone, Debug, Default)]
pub struct Poses(Vec<(i64, Pose)>);

impl Poses {
    /// Adds a pose. One that is not later than the last one is left out.
    pub fn add(&mut self, time_ns: i64, pose: Pose) {
        if self.0.last().is_none_or(|(last_ns, _)| time_ns > *last_ns) {
            self.0.push((time_ns, pose));
        }
    }

    /// The poses without their times.
    pub fn iter(&self) -> impl Iterator<Item = &Pose> {
        self.0.iter().map(|(_, pose)| pose)
    }

    /// The time of the last one.
    pub fn last_ns(&self) -> Option<i64> {
        self.0.last().map(|(ns, _)| *ns)
    }

    /// Removes the poses before a time, but for the last of them.
    pub fn forget_before(&mut self, time_ns: i64) {
        let before = self.0.partition_point(|(ns, _)| *ns < time_ns);
        self.0.drain(..before.saturating_sub(1));
    }

    /// Returns the pose at a time; `None` before the first and after the last one.
    pub fn at(&self, time_ns: i64) -> Option<Pose> {
        let next = self.0.partition_point(|(ns, _)| *ns < time_ns);
        let (after_ns, after) = self.0.get(next)?;
        if *after_ns == time_ns {
            return Some(*after);
        }
        let (before_ns, before) = self.0.get(next.checked_sub(1)?)?;
        let part = (time_ns - before_ns) as f64 / (after_ns - before_ns) as f64;
        Some(before.between(after, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn turns_add_up_and_come_back() {
        let quarter = Pose::about_y(std::f64::consts::FRAC_PI_2);
        assert!(near(quarter.of_point([1.0, 2.0, 0.0]), [0.0, 2.0, -1.0]));
        let moved = Pose { shift_m: [0.0, 0.0, 3.0], ..quarter };
        assert!(near(moved.then(&moved).of_point([1.0, 0.0, 0.0]), moved.of_point(moved.of_point([1.0, 0.0, 0.0]))));
        assert!(near(Pose::about_y(0.1).turn_to(&Pose::about_y(-0.3)), [0.0, -0.4, 0.0]));
        assert!(Pose::new([0.0; 4], [0.0; 3]).is_none());
        assert!(Pose::new([0.0, 0.0, f64::NAN, 1.0], [0.0; 3]).is_none());
    }

    #[test]
    fn between_two_times_lies_a_pose_between() {
        let mut poses = Poses::default();
        for (ns, rad) in [(1000, 0.0), (2000, 0.1), (1500, 9.0), (3000, 0.2)] {
            poses.add(ns, Pose::about_y(rad));
        }
        let turn = |ns| poses.at(ns).map(|pose| Pose::NONE.turn_to(&pose)[1]);
        assert!((turn(1500).unwrap() - 0.05).abs() < 1e-4 && (turn(3000).unwrap() - 0.2).abs() < 1e-9);
        assert_eq!((turn(999), turn(3001)), (None, None));
        poses.forget_before(2500);
        assert_eq!(poses.at(1999), None);
        assert!((poses.at(2500).map(|pose| Pose::NONE.turn_to(&pose)[1]).unwrap() - 0.15).abs() < 1e-4);
    }
}
