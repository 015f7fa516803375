//! Every tuned number of the default.

/// Every tuned number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Least standard deviation of a range, metres.
    pub least_noise_m: f32,
    /// Least standard deviation of the direction of a beam, rad.
    pub least_beam_rad: f32,
    /// Squared error at which a pixel lies on no plane.
    pub off: f32,
    /// Price of a pixel that has left.
    pub left: f32,
    /// Price of leaving.
    pub leave: f32,
    /// Price of a line.
    pub line: f32,
    /// Price of a pixel in no line.
    pub lone: f32,
    /// Squares that a common plane may add by chance.
    pub chance: f32,
    /// And for each point of the smaller.
    pub uneven: f32,
    /// Excess over the noise at which an area still lies near a plane.
    pub bent: f32,
    /// Most excess of an area that is followed.
    pub rough: f32,
    /// Columns without a return that a line goes across.
    pub gap_columns: u16,
    /// Least points of a bridge.
    pub gap_points: u32,
    /// Of a border pixels that must be hidden, of 16.
    pub hidden: u32,
    /// Bent large areas: squared cosine, squared step.
    pub bend_cos_square: f32,
    /// See above.
    pub bend_step: f32,
    /// See above.
    pub bend_points: u32,
    /// Turn: expected, rad.
    pub turn_expected_rad: f32,
    /// Offset of a ring that is expected, metres.
    pub ring_expected_m: f32,
    /// Gain that a second plane must have, and how its normal must differ.
    pub turn_other: f32,
    /// See above.
    pub turn_cos_square: f32,
    /// Turn of a seam, rad, and what it may leave for each point.
    pub seam_rad: f32,
    /// See above.
    pub seam_uneven: f32,
    /// Size of areas that a seam parts.
    pub seam_points: u32,
    /// See above.
    pub seam_columns: u16,
    /// Of the turn from row to row so much to so much, if one plane alone tells it.
    pub turn_alone: [f32; 2],
    /// Gain in all and per pixel.
    pub turn_gain: f32,
    /// See above.
    pub turn_gain_per_pixel: f32,
    /// Noise is measured by this quantile of second differences,
    pub noise_share: f32,
    /// which lies at this square of normal ones.
    pub noise_square: f32,
    /// Variance that is believed, of that measured.
    pub noise_less: f32,
    /// Least factor of the variance that is believed.
    pub noise_trust: f32,
    /// Most factor of the variance.
    pub noise_most: f32,
}

impl Rules {
    /// What is used.
    pub const TUNED: Rules = Rules {
        least_noise_m: 0.002,
        least_beam_rad: 3.5e-4,
        off: 10.0,
        left: 2.5,
        leave: 12.0,
        line: 14.0,
        lone: 10.0,
        chance: 20.0,
        uneven: 0.1,
        bent: 0.1,
        rough: 6.0,
        gap_columns: 3,
        gap_points: 20,
        hidden: 4,
        bend_cos_square: 0.99726,
        bend_step: 9.0,
        bend_points: 500,
        turn_expected_rad: 2.0 * core::f32::consts::PI / 180.0,
        ring_expected_m: 0.05,
        turn_other: 4.0,
        turn_cos_square: 0.9,
        seam_rad: 0.045,
        seam_uneven: 0.3,
        seam_points: 100,
        seam_columns: 48,
        turn_alone: [0.3, 6.0],
        turn_gain: 8.0,
        turn_gain_per_pixel: 0.5,
        noise_share: 0.3,
        noise_square: 0.1485,
        noise_less: 0.9,
        noise_trust: 2.0,
        noise_most: 1000.0,
    };
}
