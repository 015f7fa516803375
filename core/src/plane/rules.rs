//! Every tuned number of the default, with its unit, its reason and its worth.
//!
//! Worth: what `tests/ablation.sh` finds without the rule, in points of correct detections at T =
//! 0.8 on the validation offices at 0 / 5 / 10 mm of noise, and in overlap of the large planes of
//! the two recorded corridor scans. The whole table is in ARCHITECTURE.md. Squared errors are in
//! units of the noise: 9 is three standard deviations.

/// Areas above a line that are tried.
pub(crate) const TRIED_AREAS: usize = 8;

/// Pairs of neighbours that are remembered as tried.
pub(crate) const REMEMBERED_PAIRS: usize = 8;

/// Last cuts that are kept while a run is cut into lines.
pub(crate) const CANDIDATE_CUTS: usize = 8;

/// Every so many columns a pixel is looked at for the turn of its row.
pub(crate) const TURN_STRIDE: usize = 4;

/// The tuned numbers of [`PlaneSegmenter`](crate::PlaneSegmenter). They are the same for every
/// scanner and scene; the noise of the ranges is a setting and stands in
/// [`Ranging`](crate::Ranging).
///
/// [`Rules::TUNED`] is what the segmenter uses. Other values are for measuring what a rule is
/// worth; values out of reason give senseless segments, never a panic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rules {
    /// Least standard deviation of a range, metres. Beams are not quite where they are said to be,
    /// ranges are rounded, walls are not quite flat. With 0.5 mm: 4.2 / -0.4 / -0.4 points.
    pub least_noise_m: f32,

    /// Columns to either side in which a pixel looks for a plane of the row above. With 0: 4.8 /
    /// 3.7 / 1.4 points.
    pub reach_columns: usize,
    /// Squared error at which a pixel lies on no plane: 3.2 standard deviations.
    pub off_plane: f32,
    /// Squared error that a pixel is given once it has left all planes. Between the 1 of chance and
    /// [`Rules::off_plane`].
    pub left_price: f32,
    /// Squared error that leaving a plane, or coming back, is given: more than noise gathers in a
    /// few pixels. With 0: -0.1 / 3.4 / 4.5 points.
    pub leave_price: f32,
    /// Variance of the direction of a beam, rad^2: 0.02 deg. It counts where a surface is seen at a
    /// grazing angle. With 0: 0.05 of the first corridor scan.
    pub beam_rad2: f32,
    /// Squared tangent of the largest angle of incidence that is told: surfaces seen at less than 4
    /// deg are taken for seen at 4 deg.
    pub max_tan_square: f32,
    /// Most that the turn angle may add to the variance of a range, in units of the noise.
    pub most_turn: f32,

    /// Squared errors that a cut between two lines must save: fewer than two more numbers fitted
    /// save by chance once in a thousand.
    pub line_price: f32,
    /// Squared error that a pixel in no line is given.
    pub lone_price: f32,
    /// Least pixels of a line. With 3: 5.2 / 2.8 / -0.1 points.
    pub min_line_pixels: usize,

    /// Squared errors that a common plane may add by chance. It has three numbers less than two
    /// planes, whose squares exceed 20 once in 6000 times.
    pub chance: f64,
    /// And for each point of the smaller area: surfaces are not quite flat, and noise is not quite
    /// what it is said to be.
    pub uneven: f64,
    /// Excess over the noise at which an area still lies near a plane: scanners with less noise
    /// than they are said to have bend their ranges. Without: 0.8 / 0 / -0.3 points, 0.03 of the
    /// first corridor scan.
    pub bent: f64,
    /// Variances of the turn angle by which a surface may be bent.
    pub wobble: f64,
    /// Most of that, in units of the noise.
    pub most_wobble: f64,
    /// Least rows of areas that join a neighbour: one row has no plane. Without such joins: 1.3 /
    /// 1.4 / -0.4 points, 0.12 and 0.14 of the corridor scans.
    pub neighbour_rows: u16,
    /// Least points of areas that join across a gap. Without such joins: 8.0 / 7.0 / 5.2 points,
    /// 0.15 and 0.08 of the corridor scans.
    pub gap_points: u32,
    /// Squared cosine of the largest angle, 3 deg, at which two large areas are one that the
    /// scanner bends. Without such joins: 0.2 / 0 / -1.0 points, 0.06 of the first corridor scan.
    pub bend_cos_square: f32,
    /// Squared step between the two: three standard deviations of a range.
    pub bend_step: f32,
    /// Least points of each of the two.
    pub bend_points: u32,
    /// Least rows of each of the two.
    pub bend_rows: u16,

    /// Standard deviation of the turn that is expected beyond what the encoder says, radians: 2
    /// deg. Twice as much is believed.
    pub turn_rad: f32,
    /// Squared errors that such a turn must explain in all. Without turns: 0 / -0.3 / -0.3 points,
    /// 0.32 and 0.24 of the corridor scans.
    pub turn_gain: f32,
    /// Squared errors that it must explain for each pixel.
    pub turn_gain_per_pixel: f32,
    /// Squared error beyond which a pixel is on another surface.
    pub turn_off: f32,
    /// Least points of a plane that tells a turn: smaller ones may themselves be wrong.
    pub turn_points: u32,
    /// Least rows of a plane that tells a turn.
    pub turn_rows: u16,
}

impl Rules {
    /// The numbers that the default uses.
    pub const TUNED: Rules = Rules {
        least_noise_m: 0.002,
        reach_columns: 1,
        off_plane: 10.0,
        left_price: 2.5,
        leave_price: 12.0,
        beam_rad2: 1.2e-7,
        max_tan_square: 200.0,
        most_turn: 9.0,
        line_price: 14.0,
        lone_price: 10.0,
        min_line_pixels: 2,
        chance: 20.0,
        uneven: 0.1,
        bent: 0.1,
        wobble: 4.0,
        most_wobble: 9.0,
        neighbour_rows: 2,
        gap_points: 20,
        bend_cos_square: 0.99726,
        bend_step: 9.0,
        bend_points: 500,
        bend_rows: 4,
        turn_rad: 2.0 * core::f32::consts::PI / 180.0,
        turn_gain: 8.0,
        turn_gain_per_pixel: 0.5,
        turn_off: 9.0,
        turn_points: 50,
        turn_rows: 4,
    };
}
