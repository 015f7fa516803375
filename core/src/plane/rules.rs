//! Every tuned number of the default, with its unit and its reason.
//!
//! What the rules are worth stands in ARCHITECTURE.md. Squared errors are in units of the noise: 9
//! is three standard deviations.

/// Areas above a line that are tried.
pub(crate) const TRIED_AREAS: usize = 8;

/// Pairs of neighbours that are remembered as tried in a row.
pub(crate) const REMEMBERED_PAIRS: usize = 8;

/// Last cuts that are kept while a run is cut into lines.
pub(crate) const CANDIDATE_CUTS: usize = 8;

/// Every so many columns at least a pixel is looked at for the turn of its row.
pub(crate) const TURN_STRIDE: usize = 8;

/// Planes that are told apart in what the turn of a row explains.
pub(crate) const TURN_PLANES: usize = 8;

/// Slots that are looked at for the smallest area that has ended, when the table is full; an eighth
/// as many that have ended are enough.
pub(crate) const LOOKED_AT: u16 = 64;

/// Squared error beyond which a pixel past a border is nearer or farther.
pub(crate) const BORDER_SQUARE: f32 = 9.0;

/// Budget that trying a pair across a gap costs beside looking at it.
pub(crate) const BRIDGE_TRY: u32 = 5;

/// Allowance of the quick test of such a pair for rounding.
pub(crate) const SURE: f32 = 1.1;

/// Budget of a row for joins across gaps, at least; else a quarter of the columns.
pub(crate) const LEAST_BRIDGES: u32 = 16;

/// Budget of the end of a scan for them, for each column. A larger one finds no more in offices.
pub(crate) const LAST_BRIDGES: u32 = 16;

/// A line whose range is so many times that of an area does not belong to it, nor the other way
/// round. It saves a sixth of the work on noise alone.
pub(crate) const MOST_RATIO: f32 = 1.5;

/// Lines of fewer pixels lie about their mean beam. It saves a fifth of the work on noise alone.
pub(crate) const WIDE: u32 = 8;

/// Squared cosine of the largest incidence, 84 deg, at which the range of a line along its mean beam
/// is told.
pub(crate) const MEETS: f32 = 0.01;

/// Tangent by which lines are taken to lean across the row until they have a plane: 72 deg.
pub(crate) const LEAN: f32 = 3.0;

/// The same of a line that begins an area, for what the turn of its row does to it: 45 deg. 72 deg finds
/// up to a point less in offices.
pub(crate) const ALONE_LEAN: f32 = 1.0;

/// Of the variance of what a row is off by, what is left after its correction.
pub(crate) const LEFT_OF_TURN: f32 = 0.25;

/// The same of the offsets of rings. Twice or half as much costs up to 5 points where rings are 20 mm off.
pub(crate) const LEFT_OF_RING: f32 = 0.03;

/// Most that one row tells of what rows are off by, as a multiple of the variance that is known.
pub(crate) const MOST_TOLD: f32 = 1000.0;

/// Rows that are taken to have told of no turn or offset of a ring but that expected. With four, images of
/// 400 x 721 lose 3 points, rooms seen by 128 rings 1, and the covariances of floors are a fifth larger.
pub(crate) const PRIOR_ROWS: f32 = 1.0;

/// Pixels of a run that are looked at for the share by which beam angles are too small.
pub(crate) const STRETCH_SAMPLES: usize = 24;

/// First rows that are looked at for it, each; then every fourth is.
pub(crate) const STRETCH_ROWS: usize = 16;

/// Least angle of a run that is looked at for it, radians: 11 deg. The bend of narrower ones is below the
/// noise, and looking for it is work.
pub(crate) const STRETCH_RAD: f32 = 0.2;

/// Standard deviation of that share, as it is expected. A run that knows it worse says nothing, nor
/// does one that tells three times as much: it is bent itself. Half of it finds the share of 3 % a
/// few rows later.
pub(crate) const STRETCH: f32 = 0.04;

/// Standard deviation at which it is known well enough: walls of that direction are not looked at any
/// more, which saves most of the work.
pub(crate) const STRETCH_KNOWN: f32 = 1e-3;

/// Least share that counts: walls seen with beams a third of a percent off are not torn.
pub(crate) const STRETCH_LEAST: f32 = 0.003;

/// Least change of it: planes are not changed for less.
pub(crate) const STRETCH_CHANGE: f32 = 2e-4;

/// The tuned numbers of [`PlaneSegmenter`](crate::PlaneSegmenter). They are the same for every
/// scanner and scene; the noise of the ranges is a setting and stands in
/// [`Ranging`](crate::Ranging).
///
/// [`Rules::TUNED`] is what the segmenter uses. Other values are for measuring what a rule is
/// worth; values out of reason give senseless segments, never a panic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rules {
    /// Least standard deviation of a range, metres: ranges are rounded, walls are not quite flat.
    pub least_noise_m: f32,
    /// Least standard deviation of the direction of a beam, radians: 0.02 deg. It counts where a
    /// surface is seen at a grazing angle.
    pub least_beam_rad: f32,

    /// Squared error at which a pixel lies on no plane: 3.2 standard deviations.
    pub off_plane: f32,
    /// Squared error that a pixel is given once it has left all planes. Between the 1 of chance and
    /// [`Rules::off_plane`].
    pub left_price: f32,
    /// Squared error that leaving a plane, or coming back, is given: more than noise gathers in a
    /// few pixels.
    pub leave_price: f32,
    /// Squared tangent of the largest angle of incidence that is told: surfaces seen at less than 4
    /// deg are taken for seen at 4 deg.
    pub max_tan_square: f32,
    /// Most that the turn angle may add to the variance of a range, in units of the noise.
    pub most_turn: f32,
    /// Most squares for each pixel of an area that is followed: what is rougher is no plane.
    pub rough: f32,
    /// And so many squares by chance.
    pub rough_by_chance: f32,

    /// Squared errors that a cut between two lines must save: fewer than two more numbers fitted
    /// save by chance once in a thousand.
    pub line_price: f32,
    /// Squared error that a pixel in a line of its own is given.
    pub lone_price: f32,
    /// Columns without a return that lines and runs go across, and over which neighbours join.
    pub gap_columns: usize,

    /// Squared errors that a common plane may add by chance. It has three numbers less than two
    /// planes, whose squares exceed 20 once in 6000 times.
    pub chance: f32,
    /// And for each point of the smaller area: surfaces are not quite flat, and noise is not quite
    /// what it is said to be.
    pub uneven: f32,
    /// Excess over the noise at which an area still lies near a plane: scanners with less noise
    /// than they are said to have bend their ranges.
    pub bent: f32,
    /// Most by which the squares of two areas say that the noise is more than is known, where they join by chance: twice its
    /// standard deviation. At 1 a recorded office seen by a camera comes in 67 pieces instead of 48, and planes of the recorded
    /// corridors overlap by 0.01 to 0.02 less. At 6, pieces of two walls of that office join.
    pub rougher: f32,
    /// Variances of the turn angle by which a surface may be bent. Half as many find two points more where
    /// turns are off, and tear the walls of the recorded corridors (0.88 to 0.85).
    pub wobble: f32,
    /// Most of that, in units of the noise. Four times as much finds 3 points less where turns are off,
    /// half as much tears the recorded corridors.
    pub most_wobble: f32,
    /// Least points of areas that join across a gap.
    pub gap_points: u32,
    /// Of 16 pixels past the borders that face each other so many must be nearer: then they may
    /// hide the rest of one surface.
    pub hidden: u32,

    /// Squared cosine of the largest angle, 3 deg, at which two large areas are one that the scanner
    /// bends.
    pub bend_cos_square: f32,
    /// Squared step between the two: 2.4 standard deviations of a range.
    pub bend_step: f32,
    /// Least points of each of the two.
    pub bend_points: u32,

    /// Largest turn between two areas that are one but for a turn that was not reported, radians:
    /// 2.6 deg.
    pub seam_rad: f32,
    /// Squares that their common plane may add for each point of the smaller.
    pub seam_uneven: f32,
    /// Least columns of each of the two.
    pub seam_columns: u16,
    /// Least rows of each of the two.
    pub seam_rows: u16,

    /// Standard deviation of the turn that is expected beyond what the encoder says, radians: 2
    /// deg. Twice as much is believed.
    pub turn_rad: f32,
    /// Standard deviation of the offset of a ring of a spinning scanner that is expected, metres.
    /// Twice as much is believed.
    pub ring_m: f32,
    /// Standard deviation of the turn that is expected before any row tells, radians: 0.03 deg. Half as
    /// much finds up to 3 points less where turns are off, twice as much half a point less in offices.
    pub turn_prior_rad: f32,
    /// Standard deviation of the offsets of rings that is expected before any row tells, metres.
    pub ring_prior_m: f32,
    /// Squared errors that either must explain in all.
    pub turn_gain: f32,
    /// Squared errors that it must explain for each pixel.
    pub turn_gain_per_pixel: f32,
    /// Squared errors that it must explain on a second plane.
    pub turn_other: f32,
    /// Squared cosine between the two planes, at most.
    pub turn_cos_square: f32,
    /// A turn that one plane alone tells is believed if the scanner went on by at least so much of
    /// what was reported from row to row. A wall that begins where a floor ends looks as if it had
    /// stopped.
    pub turn_alone_least: f32,
    /// And by at most so much of it.
    pub turn_alone_most: f32,
    /// Squared error beyond which a pixel is on another surface.
    pub turn_off: f32,
    /// Least points of a plane that tells a turn: smaller ones may themselves be wrong.
    pub turn_points: u32,
    /// Least rows of a plane that tells a turn.
    pub turn_rows: u16,

    /// The noise is measured by this quantile of squared second differences: low, because those
    /// across edges are high.
    pub noise_share: f32,
    /// Where normal ones of variance 1 have that quantile.
    pub noise_square: f32,
    /// The variance that counts, of that measured: it is to be a little too small rather than too
    /// large.
    pub noise_less: f32,
    /// Least factor over the stated variance that is believed. At 2 clutter alone is taken for more
    /// noise, which costs up to 3 points; at 3 noise that is stated at a half of the truth stays so.
    pub noise_trust: f32,
    /// Most factor over the stated variance: trees look like noise, and are not. Where none is stated
    /// there is no most.
    pub noise_most: f32,
}

impl Rules {
    /// The numbers that the default uses.
    pub const TUNED: Rules = Rules {
        least_noise_m: 0.0015,
        least_beam_rad: 4e-4,
        off_plane: 10.0,
        left_price: 2.75,
        leave_price: 12.0,
        max_tan_square: 200.0,
        most_turn: 9.0,
        rough: 6.0,
        rough_by_chance: 60.0,
        line_price: 14.0,
        lone_price: 10.0,
        gap_columns: 3,
        chance: 20.0,
        uneven: 0.1,
        bent: 0.1,
        rougher: 4.0,
        wobble: 32.0,
        most_wobble: 6.0,
        gap_points: 20,
        hidden: 8,
        bend_cos_square: 0.99726,
        bend_step: 6.0,
        bend_points: 1000,
        seam_rad: 0.045,
        seam_uneven: 0.6,
        seam_columns: 48,
        seam_rows: 3,
        turn_rad: 2.0 * core::f32::consts::PI / 180.0,
        ring_m: 0.05,
        turn_prior_rad: 5e-4,
        ring_prior_m: 0.005,
        turn_gain: 8.0,
        turn_gain_per_pixel: 0.5,
        turn_other: 4.0,
        turn_cos_square: 0.95,
        turn_alone_least: 0.3,
        turn_alone_most: 10.0,
        turn_off: 9.0,
        turn_points: 50,
        turn_rows: 4,
        noise_share: 0.3,
        noise_square: 0.1485,
        noise_less: 0.9,
        noise_trust: 2.5,
        noise_most: 36.0,
    };
}
