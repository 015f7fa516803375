//! A furnished room and where the scanner stands in it.

use crate::office::body::{Body, Place, Vector, dot};
use crate::office::layouts::lay_out;
use crate::office::set::Set;

/// A furnished room and the scanner's stand in it. The scanner's frame: x forward, y left, z up,
/// metres.
#[derive(Clone, Debug)]
pub struct Scene {
    bodies: Vec<Body>,
    position: Vector,
    heading: Place,
    /// The keys of its random numbers.
    pub(super) set: Set,
    pub(super) number: u32,
}

impl Scene {
    /// Scene `number` of a set. The sets count from 0 to [`SCENES`](crate::office::SCENES) - 1;
    /// higher numbers are further scenes of the same kinds.
    pub fn numbered(set: Set, number: u32) -> Self {
        let (builder, position, heading_deg) = lay_out(set, number);
        Self { bodies: builder.bodies, position, heading: Place::new(0.0, 0.0, heading_deg), set, number }
    }

    /// Returns the first surface that a beam meets: range in metres and surface id. `direction` is
    /// a unit vector in the scanner's frame. None where the beam is lost in a window.
    pub fn cast(&self, direction: [f64; 3]) -> Option<(f64, u16)> {
        let ray = self.heading.direction(direction);
        let mut nearest = (f64::INFINITY, 0);
        for body in &self.bodies {
            nearest = body.hit(self.position, ray, nearest.0).unwrap_or(nearest);
        }
        (nearest.1 != 0).then_some(nearest)
    }

    /// Returns the plane of a surface in the scanner's frame: the points p with n . p = d, n being
    /// the unit normal on its outer side and d in metres. None for curved surfaces and ids that the
    /// scene does not have.
    pub fn plane(&self, id: u16) -> Option<([f64; 3], f64)> {
        let holds = |b: &&Body| b.first_id != 0 && (b.first_id..b.first_id + b.surfaces.len() as u16).contains(&id);
        let body = self.bodies.iter().find(holds)?;
        let (normal, point) = body.surfaces[usize::from(id - body.first_id)].plane()?;
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| self.heading.direction(e));
        Some(([dot(x, normal), dot(y, normal), dot(z, normal)], dot(normal, point) - dot(normal, self.position)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::office::SCENES;

    #[test]
    fn beams_are_lost_in_windows_and_nowhere_else() {
        let mut with_window = 0;
        for (set, number) in [Set::Tuning, Set::Validation].into_iter().flat_map(|s| (0..SCENES).map(move |n| (s, n))) {
            let scene = Scene::numbered(set, number);
            let mut open = scene.clone();
            open.bodies.retain(|body| body.first_id != 0);
            let mut lost = 0;
            // All round, up and down.
            for i in 0..4000 {
                let z = 1.0 - (f64::from(i) + 0.5) / 2000.0;
                let (around, r) = (f64::from(i) * 2.4, libm::sqrt(1.0 - z * z));
                let direction = [r * libm::cos(around), r * libm::sin(around), z];
                if scene.cast(direction).is_none() {
                    lost += 1;
                    let ray = scene.heading.direction(direction);
                    let panes = scene.bodies.iter().filter(|body| body.first_id == 0);
                    let pane_m = panes
                        .filter_map(|p| p.hit(scene.position, ray, f64::INFINITY))
                        .map(|hit| hit.0)
                        .reduce(f64::min);
                    let pane_m = pane_m.expect("lost in a pane, not between surfaces");
                    assert!(open.cast(direction).is_none_or(|(range_m, _)| range_m > pane_m));
                }
            }
            with_window += u32::from(lost > 10);
        }
        assert!(with_window >= 40, "{with_window} of 50 rooms have a window in view");
    }

    #[test]
    fn planes_are_given_in_the_frame_of_the_scanner() {
        let scene = Scene::numbered(Set::Validation, 2);
        for (direction, [x, y, z]) in [([0.6, 0.48, 0.64], [0.6, 0.48, 0.64]), ([0.0, 0.6, -0.8], [0.0, 0.6, -0.8])] {
            let (range_m, id) = scene.cast(direction).unwrap();
            let (n, d) = scene.plane(id).unwrap();
            assert!(((n[0] * x + n[1] * y + n[2] * z) * range_m - d).abs() < 1e-12);
            assert!(d < 0.0, "the outer side faces the scanner");
        }
        assert_eq!(scene.plane(0), None);
        assert_eq!(scene.plane(u16::MAX), None);
        let curved = scene.bodies.iter().find(|b| b.surfaces[0].plane().is_none()).unwrap();
        assert_eq!(scene.plane(curved.first_id), None);
        assert!(scene.plane(curved.first_id + 1).is_some());
    }
}
