//! The axes of a cloud.

use std::ops::Neg;

use crate::cloud::pinhole;

/// Where the axes of a cloud point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// x forward, y left, z up.
    Forward,
    /// Those of a camera: x right, y down, z forward.
    Optical,
    /// Those of a camera in computer graphics: x right, y up, z backward.
    Graphics,
}

impl Axes {
    /// Returns the axes of points in rows of so many columns; forward where they tell nothing else.
    pub(crate) fn of(points: &[[f32; 3]], columns: usize) -> Axes {
        let is = |axes: &Axes| pinhole::looks(points, columns, |point| axes.forward(point));
        [Axes::Forward, Axes::Optical, Axes::Graphics].into_iter().find(is).unwrap_or(Axes::Forward)
    }

    /// Returns a point with x forward, y left, z up.
    pub fn forward<T: Neg<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Axes::Forward => [x, y, z],
            Axes::Optical => [z, -x, -y],
            Axes::Graphics => [-z, -x, y],
        }
    }

    /// Returns a point in these axes: the inverse of [`Axes::forward`].
    pub fn back<T: Neg<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Axes::Forward => [x, y, z],
            Axes::Optical => [-y, -z, x],
            Axes::Graphics => [-y, z, -x],
        }
    }

    /// Returns what is to be said where points were turned.
    pub(crate) fn remark(self) -> Option<String> {
        let axes = match self {
            Axes::Forward => return None,
            Axes::Optical => "x right, y down, z forward",
            Axes::Graphics => "x right, y up, z backward",
        };
        Some(format!("its axes are those of a camera ({axes}); in the results x is forward, y left, z up"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_turned_forward_comes_back() {
        for axes in [Axes::Forward, Axes::Optical, Axes::Graphics] {
            assert_eq!(axes.back(axes.forward([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0]);
        }
        assert_eq!(Axes::Optical.forward([1.0, 2.0, 3.0]), [3.0, -1.0, -2.0]);
        assert_eq!(Axes::Graphics.forward([1.0, 2.0, 3.0]), [-3.0, -1.0, 2.0]);
    }
}
