//! What the page is told, as JSON.

use scanseg_sim::view::ToldSegment;
use serde::Serialize;

/// A scan that was made or read.
#[derive(Serialize)]
pub struct ToldScan<'a> {
    pub name: &'a str,
    pub rows: usize,
    pub columns: usize,
    /// Pixels with a range.
    pub returns: usize,
    /// What its reader took it for.
    pub remarks: &'a [String],
    /// The noise that its file states, metres; 0 for none.
    pub range_noise_m: f64,
    /// How its pixels are turned for people to look at, see `scanseg_sim::overview::View`.
    pub transpose: bool,
    pub flip: bool,
    pub mirror: bool,
    /// Colours of labels 0 to 20; then they begin anew at that of 1.
    pub palette: Vec<[u8; 3]>,
    /// The ranges that 2 % of the returns are nearer, farther than, metres.
    pub near_m: f32,
    pub far_m: f32,
}

/// How far a scan has come.
#[derive(Serialize)]
pub struct ToldState {
    /// Rows pushed.
    pub row: usize,
    pub complete: bool,
    /// The noise that counts at 3 m, metres; none by edges and by regions.
    pub noise_m: Option<f32>,
    /// The segments that are complete, the largest first.
    pub segments: Vec<ToldSegment>,
}

/// Why a call did nothing.
#[derive(Serialize)]
pub struct ToldError {
    pub error: String,
}
