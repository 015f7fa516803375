//! A furnished room and where the scanner stands in it.

use std::collections::BTreeMap;

use crate::office::body::{Body, Place, Vector, dot};
use crate::office::house::lay_out_attic;
use crate::office::layouts::{Laid, lay_out, lay_out_hall};
use crate::office::set::Set;
use crate::office::street::lay_out_street;

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
        Self::of(lay_out(set, number), set, number)
    }

    /// Hall `number` of a set: 30 m long. Ranges need a coarser unit than the usual one:
    /// [`Sensor::quantisation_m`](crate::office::Sensor::quantisation_m) of 1 mm reaches 65 m.
    pub fn hall(set: Set, number: u32) -> Self {
        Self::of(lay_out_hall(set, number), set, number)
    }

    /// Attic `number` of a set: sloped roofs on low walls, a stage, and stairs up to it.
    pub fn attic(set: Set, number: u32) -> Self {
        Self::of(lay_out_attic(set, number), set, number)
    }

    /// Street `number` of a set: house fronts to 32 m away, pavements, parked cars, trees. Above them
    /// beams are lost. Ranges need a coarser unit, as of a [`Scene::hall`].
    pub fn street(set: Set, number: u32) -> Self {
        Self::of(lay_out_street(set, number), set, number)
    }

    fn of((builder, position, heading_deg): Laid, set: Set, number: u32) -> Self {
        Self { bodies: builder.bodies, position, heading: Place::new(0.0, 0.0, heading_deg), set, number }
    }

    /// The same with the scanner along the room: the walls are square to it.
    #[must_use]
    pub fn squared(self) -> Self {
        Self { heading: Place::new(0.0, 0.0, 0.0), ..self }
    }

    /// Returns the truth with one region for each plane: the ids of surfaces that lie on one
    /// infinite plane become the lowest of them.
    pub fn planes_of(&self, truth: &[u16]) -> Vec<u16> {
        let mut seen: BTreeMap<u16, u16> = truth.iter().map(|&id| (id, id)).collect();
        let mut planes: Vec<(u16, [f64; 3], f64)> = vec![];
        for (&id, region) in &mut seen {
            let Some((normal, distance_m)) = self.plane(id) else { continue };
            let same =
                |(_, n, d): &&(u16, [f64; 3], f64)| dot(*n, normal) > 1.0 - 1e-9 && (d - distance_m).abs() < 1e-6;
            match planes.iter().find(same) {
                Some(&(first, ..)) => *region = first,
                None => planes.push((id, normal, distance_m)),
            }
        }
        truth.iter().map(|id| seen[id]).collect()
    }

    /// Returns the first surface that a beam meets: range in metres and surface id. `direction` is
    /// a unit vector in the scanner's frame. None where the beam is lost in a window or
    /// the sky.
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
    fn surfaces_on_one_plane_are_one_region() {
        let scene = Scene::numbered(Set::Tuning, 1);
        let ids: Vec<u16> = (1..400).filter(|&id| scene.plane(id).is_some()).collect();
        let merged = scene.planes_of(&ids);
        assert!(merged.iter().zip(&ids).any(|(region, id)| region != id), "desks have faces in line");
        for (i, (&id, &region)) in ids.iter().zip(&merged).enumerate() {
            let (n, d) = scene.plane(id).unwrap();
            assert!(region <= id);
            for (&other, &its) in ids[..i].iter().zip(&merged) {
                let (m, e) = scene.plane(other).unwrap();
                let same = (0..3).all(|k| (n[k] - m[k]).abs() < 1e-5) && (d - e).abs() < 1e-6;
                assert_eq!(same, region == its, "{id} and {other}");
            }
        }
        assert_eq!(scene.planes_of(&[0, u16::MAX]), [0, u16::MAX]);
    }

    #[test]
    fn squared_scenes_have_walls_square_to_the_scanner() {
        let scene = Scene::numbered(Set::Validation, 26).squared();
        let [ahead, left] = [[1.0, 0.0, 0.1], [0.0, 1.0, 0.1]].map(|d: [f64; 3]| d.map(|x| x / dot(d, d).sqrt()));
        let walls = [ahead, left].map(|direction| scene.cast(direction).and_then(|(_, id)| scene.plane(id)));
        let square = |wall: &Option<([f64; 3], f64)>| wall.is_some_and(|(n, _)| n.iter().any(|x| x.abs() > 0.999_999));
        assert!(walls.iter().any(square), "{walls:?}");
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
