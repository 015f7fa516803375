//! How planar a segment is.

use scanseg_core::{Rules, Segment};

use crate::export::segmented::{Segmented, dot};
use crate::segmentation::stated_noise_m;

/// From so many times the noise on points do not lie on a plane.
const ROUGH: f32 = 1.5;
/// From this standard deviation of its normal on a plane is uncertain.
const UNCERTAIN_DEG: f32 = 5.0;

/// How planar a segment is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planarity {
    /// `rms_m` of its plane over what the noise alone makes it: about 1 of a plane. None without a
    /// plane.
    pub residual_per_noise: Option<f32>,
    /// What that means.
    pub verdict: Verdict,
}

/// Whether a segment is a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Its points lie on its plane within the noise.
    Planar,
    /// They lie off it by more than 1.5 times the noise: a curved or rough surface, leaves.
    Rough,
    /// It has no plane, one of a single row, or one whose normal is uncertain by 5 degrees or more.
    Uncertain,
}

impl Verdict {
    /// Returns its name in lists.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Planar => "planar",
            Verdict::Rough => "rough",
            Verdict::Uncertain => "uncertain",
        }
    }
}

impl Planarity {
    /// Returns how planar a segment of these pixels is.
    fn of(scan: &Segmented<'_>, segment: &Segment, pixels: &[usize]) -> Planarity {
        let Some(plane) = segment.plane() else {
            return Planarity { residual_per_noise: None, verdict: Verdict::Uncertain };
        };
        let normal = plane.normal.map(f64::from);
        let beam_rad = f64::from(scan.ranging.beam_noise_rad.max(Rules::TUNED.least_beam_rad));
        let flatness_m = f64::from(scan.ranging.flatness_m);
        let (mut sum_m2, columns) = (0.0, scan.image.columns);
        for &pixel in pixels {
            let range_m = scan.image.range_m[pixel];
            let noise_m =
                scan.range_noise_m.get(pixel).copied().unwrap_or_else(|| stated_noise_m(scan.ranging, range_m));
            let facing = dot(normal, scan.geometry.direction(pixel / columns, pixel % columns)).powi(2).min(1.0);
            let aside_m2 = (f64::from(range_m) * beam_rad).powi(2);
            sum_m2 += f64::from(noise_m).powi(2) * facing + aside_m2 * (1.0 - facing) + flatness_m * flatness_m;
        }
        let expected_m = (sum_m2 / pixels.len() as f64).sqrt() as f32;
        let residual = Some(plane.rms_m / expected_m).filter(|residual| residual.is_finite());
        let variance: f32 = (0..3).map(|i| plane.covariance[i][i]).sum();
        let certain = variance.sqrt() < UNCERTAIN_DEG.to_radians() && segment.first_row != segment.last_row;
        let verdict = match residual {
            Some(residual) if certain && residual < ROUGH => Verdict::Planar,
            Some(_) if certain => Verdict::Rough,
            _ => Verdict::Uncertain,
        };
        Planarity { residual_per_noise: residual, verdict }
    }
}

/// Returns how planar each segment is.
pub fn planarities_of(scan: &Segmented<'_>) -> Vec<Planarity> {
    scan.segments.iter().zip(&scan.pixels()).map(|(segment, pixels)| Planarity::of(scan, segment, pixels)).collect()
}
