//! Bodies made of surfaces, and where a ray meets them.

/// A point or direction: x, y, z in metres.
pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Slack at the rims of surfaces, so that no ray slips between two faces that share an edge.
const RIM_M: f64 = 1e-9;

/// One surface of a body. Each is seen from its outer side only.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// The points corner + a u + b v with a in 0..width and b in 0..height, outside the holes;
    /// outer side u x v.
    Rectangle {
        corner: Vector,
        u: Vector,
        v: Vector,
        width: f64,
        height: f64,
        /// Openings: lowest a, lowest b, highest a, highest b.
        holes: Vec<[f64; 4]>,
    },
    /// A level disc; outer side up or down.
    Disc { centre: Vector, radius: f64, up: bool },
    /// The side of an upright cylinder.
    Tube { base: Vector, radius: f64, height: f64 },
}

impl Surface {
    /// Distance along the unit vector `ray` from `origin` to this surface.
    fn hit(&self, origin: Vector, ray: Vector) -> Option<f64> {
        match self {
            Surface::Rectangle { corner, u, v, width, height, holes } => {
                let normal = cross(*u, *v);
                let t = plane_hit(*corner, normal, origin, ray)?;
                let p = minus([0, 1, 2].map(|i| origin[i] + t * ray[i]), *corner);
                let (a, b) = (dot(p, *u), dot(p, *v));
                let on = a >= -RIM_M && a <= width + RIM_M && b >= -RIM_M && b <= height + RIM_M;
                let open = holes.iter().any(|h| a > h[0] && b > h[1] && a < h[2] && b < h[3]);
                (on && !open).then_some(t)
            }
            Surface::Disc { centre, radius, up } => {
                let t = plane_hit(*centre, upright(*up), origin, ray)?;
                let p = minus([0, 1, 2].map(|i| origin[i] + t * ray[i]), *centre);
                (p[0] * p[0] + p[1] * p[1] <= (radius + RIM_M) * (radius + RIM_M)).then_some(t)
            }
            Surface::Tube { base, radius, height } => {
                let p = minus(origin, *base);
                let a = ray[0] * ray[0] + ray[1] * ray[1];
                let b = p[0] * ray[0] + p[1] * ray[1];
                let c = p[0] * p[0] + p[1] * p[1] - radius * radius;
                let root = b * b - a * c;
                if root <= 0.0 {
                    return None;
                }
                let t = (-b - libm::sqrt(root)) / a;
                let z = p[2] + t * ray[2];
                (t > 0.0 && z >= -RIM_M && z <= height + RIM_M).then_some(t)
            }
        }
    }

    /// Its plane as outer unit normal and a point on it; none where it is curved.
    pub fn plane(&self) -> Option<(Vector, Vector)> {
        match self {
            Surface::Rectangle { corner, u, v, .. } => Some((cross(*u, *v), *corner)),
            Surface::Disc { centre, up, .. } => Some((upright(*up), *centre)),
            Surface::Tube { .. } => None,
        }
    }

    /// Corners of a box around it, enough for a bounding sphere.
    fn extremes(&self) -> Vec<Vector> {
        let around = |c: &Vector, r: f64, height: f64| {
            [(-r, -r), (-r, r), (r, -r), (r, r)]
                .iter()
                .flat_map(|(x, y)| [0.0, height].map(|z| [c[0] + x, c[1] + y, c[2] + z]))
                .collect()
        };
        match self {
            Surface::Rectangle { corner, u, v, width, height, .. } => [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
                .iter()
                .map(|(a, b)| [0, 1, 2].map(|i| corner[i] + a * width * u[i] + b * height * v[i]))
                .collect(),
            Surface::Disc { centre, radius, .. } => around(centre, *radius, 0.0),
            Surface::Tube { base, radius, height } => around(base, *radius, *height),
        }
    }
}

fn upright(up: bool) -> Vector {
    [0.0, 0.0, if up { 1.0 } else { -1.0 }]
}

/// Distance to a plane seen from its outer side.
fn plane_hit(point: Vector, normal: Vector, origin: Vector, ray: Vector) -> Option<f64> {
    let facing = dot(normal, ray);
    let t = dot(normal, minus(point, origin)) / facing;
    (facing < 0.0 && t > 0.0).then_some(t)
}

/// Surfaces with ids that follow one another, inside a bounding sphere.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Id of the first surface; 0 for glass, whose surfaces all have the id 0.
    pub first_id: u16,
    pub surfaces: Vec<Surface>,
    centre: Vector,
    radius: f64,
}

impl Body {
    pub fn new(first_id: u16, surfaces: Vec<Surface>) -> Self {
        let points: Vec<Vector> = surfaces.iter().flat_map(Surface::extremes).collect();
        let low = points.iter().fold([f64::MAX; 3], |m, p| [0, 1, 2].map(|i| m[i].min(p[i])));
        let high = points.iter().fold([f64::MIN; 3], |m, p| [0, 1, 2].map(|i| m[i].max(p[i])));
        let centre = [0, 1, 2].map(|i| (low[i] + high[i]) / 2.0);
        let half = minus(high, centre);
        Self { first_id, surfaces, centre, radius: libm::sqrt(dot(half, half)) + RIM_M }
    }

    /// Nearest hit before `limit` along the unit vector `ray`: distance and id.
    pub fn hit(&self, origin: Vector, ray: Vector, limit: f64) -> Option<(f64, u16)> {
        let to_centre = minus(self.centre, origin);
        let along = dot(to_centre, ray);
        let aside = dot(to_centre, to_centre) - along * along;
        if aside > self.radius * self.radius || along < -self.radius || along - self.radius > limit {
            return None;
        }
        let mut nearest: Option<(f64, u16)> = None;
        for (i, surface) in self.surfaces.iter().enumerate() {
            if let Some(t) = surface.hit(origin, ray).filter(|&t| t < nearest.map_or(limit, |n| n.0)) {
                nearest = Some((t, if self.first_id == 0 { 0 } else { self.first_id + i as u16 }));
            }
        }
        nearest
    }
}

/// A spot and a heading: local x ahead, y left, z up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    origin: Vector,
    cos: f64,
    sin: f64,
}

impl Place {
    /// At a point of the floor, local x turned left by `yaw_deg`.
    pub fn new(x: f64, y: f64, yaw_deg: f64) -> Self {
        let yaw = yaw_deg.to_radians();
        Self { origin: [x, y, 0.0], cos: libm::cos(yaw), sin: libm::sin(yaw) }
    }

    pub fn direction(&self, [x, y, z]: Vector) -> Vector {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y, z]
    }

    pub fn point(&self, local: Vector) -> Vector {
        let d = self.direction(local);
        [0, 1, 2].map(|i| self.origin[i] + d[i])
    }

    /// Returns a place given in this one's terms.
    pub fn then(&self, at: Vector, yaw_deg: f64) -> Self {
        let turn = Place::new(0.0, 0.0, yaw_deg);
        let [cos, sin, _] = self.direction([turn.cos, turn.sin, 0.0]);
        Self { origin: self.point(at), cos, sin }
    }
}

/// Adds bodies and numbers their surfaces.
#[derive(Clone, Debug, Default)]
pub(super) struct Builder {
    pub bodies: Vec<Body>,
    /// Highest id given so far.
    last_id: u16,
}

impl Builder {
    pub fn body(&mut self, surfaces: Vec<Surface>) {
        let first_id = self.last_id + 1;
        self.last_id += surfaces.len() as u16;
        self.bodies.push(Body::new(first_id, surfaces));
    }

    /// A surface that swallows beams.
    pub fn glass(&mut self, surface: Surface) {
        self.bodies.push(Body::new(0, vec![surface]));
    }

    /// A block of six faces around `centre`.
    pub fn block(&mut self, place: &Place, centre: Vector, size: Vector) {
        self.leaning_block(place, centre, size, 0.0);
    }

    /// A block leaning back: turned about the local y axis through its centre so that its top moves
    /// towards -x.
    pub fn leaning_block(&mut self, place: &Place, centre: Vector, size: Vector, lean_deg: f64) {
        let (s, c) = (libm::sin(lean_deg.to_radians()), libm::cos(lean_deg.to_radians()));
        let axes = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]].map(|axis| place.direction(axis));
        let centre = place.point(centre);
        let mut faces = Vec::new();
        for n in 0..3 {
            // (u, v, n) is right-handed, so (v, u) faces the other way.
            let (u, v) = ((n + 1) % 3, (n + 2) % 3);
            for (u, v, side) in [(u, v, 0.5), (v, u, -0.5)] {
                let at = |i: usize| {
                    centre[i] + side * size[n] * axes[n][i] - (size[u] * axes[u][i] + size[v] * axes[v][i]) / 2.0
                };
                let corner = [0, 1, 2].map(at);
                let (width, height) = (size[u], size[v]);
                faces.push(Surface::Rectangle { corner, u: axes[u], v: axes[v], width, height, holes: vec![] });
            }
        }
        self.body(faces);
    }

    /// An upright cylinder: its side, its lid and its bottom.
    pub fn cylinder(&mut self, place: &Place, base: Vector, radius: f64, height: f64) {
        let base = place.point(base);
        let top = [base[0], base[1], base[2] + height];
        self.body(vec![
            Surface::Tube { base, radius, height },
            Surface::Disc { centre: top, radius, up: true },
            Surface::Disc { centre: base, radius, up: false },
        ]);
    }
}

/// Returns a rectangle in the terms of a place: its outer side is u x v.
pub(super) fn rectangle(place: &Place, corner: Vector, u: Vector, v: Vector, size: [f64; 2]) -> Surface {
    Surface::Rectangle {
        corner: place.point(corner),
        u: place.direction(u),
        v: place.direction(v),
        width: size[0],
        height: size[1],
        holes: vec![],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(builder: &Builder, origin: Vector, ray: Vector) -> Option<(f64, u16)> {
        let hits = builder.bodies.iter().filter_map(|b| b.hit(origin, ray, f64::MAX));
        hits.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    #[test]
    fn rays_meet_a_block_on_the_face_turned_to_them() {
        let mut builder = Builder::default();
        builder.block(&Place::new(3.0, 0.0, 0.0), [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]);
        // Faces in the order +x, -x, +y, -y, +z, -z, from id 1.
        assert_eq!(hit(&builder, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some((2.0, 2)));
        assert_eq!(hit(&builder, [9.0, 0.2, 1.2], [-1.0, 0.0, 0.0]), Some((5.0, 1)));
        assert_eq!(hit(&builder, [3.5, 4.0, 1.0], [0.0, -1.0, 0.0]), Some((3.5, 3)));
        assert_eq!(hit(&builder, [3.5, -4.0, 1.0], [0.0, 1.0, 0.0]), Some((3.5, 4)));
        assert_eq!(hit(&builder, [3.5, 0.0, 2.25], [0.0, 0.0, -1.0]), Some((1.0, 5)));
        assert_eq!(hit(&builder, [3.5, 0.0, 0.0], [0.0, 0.0, 1.0]), Some((0.75, 6)));
        assert_eq!(hit(&builder, [0.0, 0.6, 1.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(hit(&builder, [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]), None);
        assert_eq!(hit(&builder, [3.0, 0.0, 1.0], [1.0, 0.0, 0.0]), None, "from inside");
    }

    #[test]
    fn a_block_turns_left_and_leans_back() {
        let mut builder = Builder::default();
        builder.leaning_block(&Place::new(0.0, 0.0, 90.0), [2.0, 0.0, 0.0], [0.2, 4.0, 4.0], 45.0);
        // Local x is now room y. The near face rises towards -y: one metre up is one metre nearer.
        let (low, id) = hit(&builder, [0.0, 0.0, -0.5], [0.0, 1.0, 0.0]).unwrap();
        let (high, _) = hit(&builder, [0.0, 0.0, 0.5], [0.0, 1.0, 0.0]).unwrap();
        assert_eq!(id, 2);
        assert!((low - high - 1.0).abs() < 1e-12, "{low} {high}");
    }

    #[test]
    fn rays_meet_a_cylinder_outside_and_on_its_lid() {
        let mut builder = Builder::default();
        builder.cylinder(&Place::new(3.0, 0.0, 0.0), [0.0, 0.0, 0.0], 0.5, 1.0);
        assert_eq!(hit(&builder, [0.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some((2.5, 1)));
        // Beside the middle: 3 - sqrt(0.5^2 - 0.3^2) = 2.6.
        let (t, _) = hit(&builder, [0.0, 0.3, 0.5], [1.0, 0.0, 0.0]).unwrap();
        assert!((t - 2.6).abs() < 1e-12);
        assert_eq!(hit(&builder, [3.2, 0.2, 3.0], [0.0, 0.0, -1.0]), Some((2.0, 2)));
        assert_eq!(hit(&builder, [3.2, 0.2, -3.0], [0.0, 0.0, 1.0]), Some((3.0, 3)));
        assert_eq!(hit(&builder, [0.0, 0.0, 1.1], [1.0, 0.0, 0.0]), None);
        assert_eq!(hit(&builder, [0.0, 0.6, 0.5], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn holes_let_rays_through() {
        let place = Place::new(2.0, 0.0, 180.0);
        let mut wall = rectangle(&place, [0.0, -2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [4.0, 3.0]);
        if let Surface::Rectangle { holes, .. } = &mut wall {
            holes.push([1.0, 1.0, 2.0, 2.0]);
        }
        let body = Body::new(1, vec![wall]);
        // Seen from the origin, local y (left of the wall's own heading) runs to -y: the hole is at
        // y in 0..1.
        assert_eq!(body.hit([0.0, 0.5, 1.5], [1.0, 0.0, 0.0], 9.0), None);
        assert!(body.hit([0.0, -0.5, 1.5], [1.0, 0.0, 0.0], 9.0).is_some());
        assert!(body.hit([0.0, 0.5, 0.5], [1.0, 0.0, 0.0], 9.0).is_some());
        assert_eq!(body.hit([0.0, -0.5, 1.5], [1.0, 0.0, 0.0], 1.5), None, "beyond the limit");
    }
}
