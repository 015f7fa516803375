//! What a method costs per point as scans of one scene grow.

use crate::experiment::method::METHODS;

/// Counted by `tests/instructions.sh`, which also looks whether they still hold.
const COUNTED: &str = include_str!("instructions.csv");

/// The instructions that a method takes for a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Which of [`METHODS`].
    pub method: usize,
    /// Rows of the scan.
    pub rows: usize,
    /// Columns of the scan.
    pub columns: usize,
    /// Instructions of the core per point, from ranges in memory to labels and planes.
    pub instructions_per_point: f64,
}

impl Cost {
    /// Points of the scan.
    pub fn points(&self) -> usize {
        self.rows * self.columns
    }
}

/// Returns the costs of all methods, by method, then size. They are on record, not measured now:
/// time is not the same twice. The noise falls with the distance of the points, of which it is 3 %
/// at 4 m, so that scans of every size show about the same number of segments.
pub(super) fn costs() -> Vec<Cost> {
    let mut costs: Vec<Cost> = COUNTED.lines().skip(1).filter_map(cost).collect();
    costs.sort_by_key(|cost| (cost.method, cost.points()));
    costs
}

/// Returns what a line of the record says; nothing of a method that is not one of [`METHODS`].
fn cost(line: &str) -> Option<Cost> {
    let fields: Vec<&str> = line.split(',').collect();
    let [name, rows, columns, instructions] = fields[..] else { return None };
    Some(Cost {
        method: METHODS.iter().position(|method| method.name == name)?,
        rows: rows.parse().ok()?,
        columns: columns.parse().ok()?,
        instructions_per_point: instructions.parse().ok()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_record_is_read() {
        let costs = costs();
        assert_eq!(costs.len(), COUNTED.lines().count() - 1);
        assert_eq!(costs.len() % METHODS.len(), 0);
        for sizes in costs.chunks(costs.len() / METHODS.len()) {
            assert!(sizes.iter().all(|cost| cost.method == sizes[0].method), "{sizes:?}");
            assert!(sizes.is_sorted_by(|a, b| a.points() < b.points()), "{sizes:?}");
            assert!(sizes[sizes.len() - 1].points() > 50 * sizes[0].points(), "{sizes:?}");
        }
    }
}
