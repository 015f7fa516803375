//! Scans of all kinds for properties and fuzzing: rooms, patterns that stress the labels, noise,
//! holes.

use crate::stream::{Angles, Rig, Scan};
use scanseg_core::TurnAxis;

/// 0 to 1, the same for the same arguments.
pub fn uniform(seed: u64, row: usize, column: usize) -> f64 {
    let mut x = seed ^ (row as u64) << 40 ^ (column as u64) << 20;
    // splitmix64
    for _ in 0..2 {
        x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
    }
    (x >> 11) as f64 / (1u64 << 53) as f64
}

/// A tilting scanner, 1 deg between columns and between rows, `middle_deg` in the middle column.
pub fn scanner(rows: usize, columns: usize, middle_deg: f32, range_m: impl Fn([f64; 3]) -> f64) -> Scan {
    let start_rad = (middle_deg - (columns - 1) as f32 / 2.0).to_radians();
    let rig = Rig::Nodding { angles: Angles::Even { start_rad, step_rad: 1f32.to_radians() }, axis: TurnAxis::Y };
    let turn_rad = (0..rows).map(|row| (row as f32 - (rows - 1) as f32 / 2.0).to_radians()).collect();
    Scan::of(columns, turn_rad, rig, range_m)
}

/// Chooses one of a few by the seed.
fn choose<T: Copy>(seed: u64, what: usize, from: &[T]) -> T {
    from[(uniform(seed, 1 << 20, what) * from.len() as f64) as usize]
}

/// Patterns that stress the labels: whether a pixel is ground or wall. `cell` is the width of their
/// parts.
const PATTERNS: [fn(&Shape, usize, usize) -> bool; 8] = [
    // checkerboard: the most live labels
    |s, r, c| (r / s.cell + c / s.cell).is_multiple_of(2),
    // combs that open downwards, upwards
    |s, r, c| r + s.cell >= s.rows || (c / s.cell).is_multiple_of(2),
    |s, r, c| r < s.cell || (c / s.cell).is_multiple_of(2),
    // nested U, whose joins come one after the other at the bottom
    |s, r, c| {
        let from_middle = c.abs_diff(s.columns / 2);
        (from_middle.max((r + s.columns / 2).saturating_sub(s.rows)) / s.cell).is_multiple_of(2)
    },
    // a spiral, and nested squares with an opening each, to alternate sides
    |s, r, c| {
        let (x, y) = (c as f64 - s.columns as f64 / 2.0, r as f64 - s.rows as f64 / 2.0);
        let turns = y.atan2(x) / std::f64::consts::TAU;
        (x.hypot(y) / (2 * s.cell) as f64 + turns).rem_euclid(1.0) < 0.6
    },
    |s, r, c| {
        let ring = r.min(c).min(s.rows - 1 - r).min(s.columns - 1 - c) / s.cell;
        let opening = if (ring / 2).is_multiple_of(2) { c < s.columns / 2 } else { c > s.columns / 2 };
        ring.is_multiple_of(2) || (opening && r.abs_diff(s.rows / 2) < 2)
    },
    // sloping strips
    |s, r, c| (2 * r + c) % (3 * s.cell) < 2 * s.cell,
    // any bits
    |s, r, c| uniform(s.seed, r / s.cell, c / s.cell) < s.density,
];

struct Shape {
    rows: usize,
    columns: usize,
    cell: usize,
    density: f64,
    seed: u64,
}

fn nothing(seed: u64, row: usize, column: usize) -> f32 {
    let kinds = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, -3.0, 1e-30, 1e30, f32::NEG_INFINITY];
    kinds[(uniform(seed ^ 1, row, column) * 9.0) as usize]
}

/// A scan of one of the kinds below; everything else about it depends on the seed.
pub fn scan_of(rows: usize, columns: usize, rig: usize, scene: usize, seed: u64) -> Scan {
    let step_deg = choose(seed, 0, &[0.1f32, 0.5, 1.0, 3.0]);
    let step_rad = step_deg.to_radians() * choose(seed, 1, &[1.0, -1.0]);
    let middle_rad = choose(seed, 2, &[0.0f32, 0.3, -1.2, 3.0]);
    let even = Angles::Even { start_rad: middle_rad - step_rad * columns as f32 / 2.0, step_rad };
    let jitter = |c: usize| (c as f32 - columns as f32 / 2.0 + uniform(seed ^ 2, 0, c) as f32) * step_rad;
    let listed = Angles::Listed((0..columns).map(|c| middle_rad + jitter(c)).collect());
    let around = if columns < 4 {
        Angles::Listed((0..columns).map(|c| c as f32 * 6.0 / columns as f32).collect())
    } else {
        Angles::Even { start_rad: middle_rad, step_rad: step_rad.signum() * std::f32::consts::TAU / columns as f32 }
    };
    let rig = match rig {
        0 => Rig::Nodding { angles: even, axis: TurnAxis::Y },
        1 => Rig::Nodding { angles: even, axis: TurnAxis::Z },
        2 => Rig::Nodding { angles: listed, axis: TurnAxis::Y },
        3 => Rig::Spinning { angles: around, wraps: true },
        4 => Rig::Spinning { angles: listed, wraps: true },
        5 => Rig::Spinning { angles: even, wraps: false },
        _ => Rig::Pinhole { fx_px: 60.0, fy_px: -50.0, cx_px: columns as f32 / 2.0, cy_px: 7.3 },
    };
    let mut turn_rad = Vec::new();
    let mut turn = choose(seed, 3, &[-0.5f32, 0.0, 0.7, 9.0]);
    for row in 0..rows {
        turn_rad.push(turn);
        // a row in eight does not turn at all
        let uneven = uniform(seed ^ 3, row, 0) as f32;
        turn += if uneven < 0.125 { 0.0 } else { step_rad * (0.5 + uneven) };
    }
    let shape = Shape {
        rows,
        columns,
        cell: choose(seed, 4, &[1, 2, 3, 4, 6]),
        density: choose(seed, 5, &[0.05, 0.3, 0.5, 0.7, 0.95]),
        seed,
    };
    let pattern = choose(seed, 6, &PATTERNS);
    let mut scan = Scan::of(columns, turn_rad, rig, |direction| {
        // a room of six walls, all oblique
        let wall = |i: usize| {
            let normal = [0, 1, 2].map(|axis| uniform(seed, i, axis) - 0.5);
            let cos: f64 = normal.iter().zip(direction).map(|(n, d)| n * d).sum();
            if cos > 0.0 { (0.2 + uniform(seed, i, 3)) / cos } else { f64::INFINITY }
        };
        (0..6).map(wall).fold(30.0, f64::min)
    });
    let mut near = false;
    for (row, column) in scan.size().pixels() {
        let range_m = &mut scan.range_m[row * columns + column];
        let wall = !pattern(&shape, row, column);
        match scene {
            // a room, without and with noise
            0 => {}
            1 => *range_m += 0.02 * (uniform(seed ^ 4, row, column) as f32 - 0.5),
            // any ranges
            2 => *range_m = 0.3 + 8.0 * uniform(seed ^ 5, row, column) as f32,
            // a pattern in a room, by holes: area pixels are exactly its ground
            3 if wall => *range_m = nothing(seed, row, column),
            // a pattern by jumps along the row: step edges along the row are exactly its walls
            4 => {
                near ^= wall;
                *range_m = if near { 1.0 } else { 5.0 };
            }
            // a pattern of two ranges
            5 => *range_m = if wall { 1.0 } else { 5.0 },
            _ => {}
        }
        let lost = match scene {
            3 => 0.0,
            _ => choose(seed, 7, &[0.0, 0.0, 0.01, 0.2]),
        };
        // single pixels without a return, and whole rows
        let row_lost = uniform(seed ^ 6, row, 1) < choose(seed, 8, &[0.0, 0.0, 0.1]);
        if row_lost || uniform(seed ^ 7, row, column) < lost {
            *range_m = nothing(seed, row, column);
        }
    }
    scan
}
