//! What is counted as work, in tests alone: pixels and slots that are looked at, planes that are
//! fitted.

#[cfg(test)]
std::thread_local! {
    static WORK: core::cell::Cell<u64> = const { core::cell::Cell::new(0) };
}

/// Counts so many units of work.
#[inline(always)]
pub(crate) fn count(units: usize) {
    #[cfg(test)]
    WORK.set(WORK.get() + units as u64);
    #[cfg(not(test))]
    let _ = units;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::{Beams, Columns, TurnAxis};
    use crate::config::Ranging;
    use crate::memory::Memory;
    use crate::plane::{PlaneConfig, PlaneSegmenter};
    use crate::scan::Segmenter;
    use crate::sink::{LabelRow, Sink};
    use core::ops::ControlFlow;
    use std::{vec, vec::Vec};

    /// Most units of work for each pixel, whatever is seen.
    const MOST: f64 = 35.0;

    struct Nothing;
    impl Sink for Nothing {
        fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
    }

    /// A number from 0 to 1.
    fn uniform(a: usize, b: usize) -> f32 {
        let mut x = (a as u64) << 32 ^ b as u64 ^ 0x9e37_79b9_7f4a_7c15;
        for _ in 0..3 {
            x = (x ^ x >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        (x >> 40) as f32 / (1 << 24) as f32
    }

    /// The range at a row and column.
    type RangeM = fn(usize, usize) -> f32;

    /// Scenes that make much work.
    const SCENES: [(&str, RangeM); 6] = [
        ("a wall", |_, _| 3.0),
        ("noise alone", |row, column| 1.0 + 4.0 * uniform(row, column)),
        ("noise at three times what is stated", |row, column| 3.0 + 0.1 * (uniform(row, column) - 0.5)),
        ("vegetation", |row, column| {
            let leaf = uniform(row / 3, column / 5);
            if leaf < 0.3 { 12.0 + uniform(row, column) } else { 2.0 + 6.0 * leaf + 0.2 * uniform(row, column) }
        }),
        ("combs of three columns", |_, column| if (column / 3).is_multiple_of(2) { 2.0 } else { 4.0 }),
        ("a chess-board", |row, column| if (row + column).is_multiple_of(2) { 2.0 } else { 0.0 }),
    ];

    const ROWS: usize = 24;

    /// Units of work for 24 rows.
    fn work(range_m: RangeM, columns: usize) -> u64 {
        let config = PlaneConfig::new(Ranging::new(0.01));
        let sizes = config.sizes_with(columns, 2 * columns);
        let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
        let (mut words, mut areas) = (vec![0; sizes.words], vec![crate::Area::EMPTY; sizes.areas]);
        let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
        let step_rad = 2.0 / columns as f32;
        let beams = Beams::Nodding { columns: Columns::Even { start_rad: -1.0, step_rad }, axis: TurnAxis::Y };
        let mut segmenter = PlaneSegmenter::new(config, beams, columns, memory).unwrap();
        WORK.set(0);
        for row in 0..ROWS {
            let ranges_m: Vec<f32> = (0..columns).map(|column| range_m(row, column)).collect();
            segmenter.push_row(&ranges_m, 0.005 * row as f32, &mut Nothing).unwrap();
        }
        segmenter.finish(&mut Nothing);
        WORK.get()
    }

    /// The work for each pixel has a bound, and does not grow with the columns.
    #[test]
    #[cfg_attr(miri, ignore = "slow")]
    fn work_is_bounded() {
        for (name, range_m) in SCENES {
            let of_pixel =
                [113, 452, 1808, 16_384].map(|columns| work(range_m, columns) as f64 / (ROWS * columns) as f64);
            std::println!("{name}: {of_pixel:.1?}");
            assert!(of_pixel.iter().all(|&work| work < MOST), "{name}: {of_pixel:.1?}");
            // in few columns all areas are known before the budgets end
            assert!(of_pixel[3] < 1.25 * of_pixel[2], "{name}: {of_pixel:.1?}");
        }
    }

    /// What the scenes cost, so that a number shows that changes nothing but that.
    #[test]
    #[cfg_attr(miri, ignore = "slow")]
    fn work_is_on_record() {
        let found = SCENES.map(|(_, range_m)| [32, 113, 452].map(|columns| work(range_m, columns)));
        let on_record = [
            [8092, 17675, 46433],
            [12673, 44514, 176281],
            [10010, 16384, 41580],
            [13981, 46853, 192065],
            [11196, 41600, 175369],
            [5554, 14573, 46333],
        ];
        assert_eq!(found, on_record);
    }
}
