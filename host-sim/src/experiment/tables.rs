//! The results as tables: for people (Markdown, HTML) and for programs (CSV).

use crate::experiment::counts::Counts;
use crate::experiment::drawing::escaped;
use crate::experiment::method::TOLERANCES;
use crate::experiment::results::Results;
use crate::experiment::runs::Run;

/// The tolerances of the tables, percent.
pub const TABLE_TOLERANCES: [u32; 2] = [80, 90];

/// A table; the first columns name a line, those from `numbers` on hold numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    head: Vec<String>,
    numbers: usize,
    lines: Vec<Vec<String>>,
}

impl Table {
    fn new(head: &[&str], numbers: usize, lines: impl Iterator<Item = Vec<String>>) -> Table {
        Table { head: head.iter().map(|name| name.to_string()).collect(), numbers, lines: lines.collect() }
    }

    /// As Markdown, columns aligned.
    pub fn markdown(&self) -> String {
        let all = || [&self.head].into_iter().chain(&self.lines);
        let width = |i: usize| all().map(|line| line[i].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |cells: &[String]| {
            let cell = |(i, text): (usize, &String)| {
                let width = widths[i];
                if i < self.numbers { format!(" {text:width$} |") } else { format!(" {text:>width$} |") }
            };
            format!("|{}\n", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let rule = widths.iter().enumerate().map(|(i, width)| {
            let dashes = "-".repeat(width + 1);
            if i < self.numbers { format!("{dashes}-|") } else { format!("{dashes}:|") }
        });
        let rule = format!("|{}\n", rule.collect::<String>());
        line(&self.head) + &rule + &self.lines.iter().map(|cells| line(cells)).collect::<String>()
    }

    /// As HTML.
    pub fn html(&self) -> String {
        let line = |tag: &str, cells: &[String]| {
            let cell = |(i, text): (usize, &String)| {
                let class = if i < self.numbers { "" } else { " class=\"n\"" };
                format!("<{tag}{class}>{}</{tag}>", escaped(text))
            };
            format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let lines: String = self.lines.iter().map(|cells| line("td", cells)).collect();
        format!(
            "<div class=\"wide\"><table>\n<thead>{}</thead>\n<tbody>\n{lines}</tbody>\n</table></div>\n",
            line("th", &self.head)
        )
    }

    /// As comma-separated values; names are in lower case, with underscores. No cell may hold a
    /// comma.
    pub fn csv(&self) -> String {
        let head: Vec<_> = self.head.iter().map(|name| name.to_lowercase().replace([' ', '-'], "_")).collect();
        [&head].into_iter().chain(&self.lines).map(|line| line.join(",") + "\n").collect()
    }
}

const COUNTED: [&str; 7] =
    ["truth regions", "segments", "correct", "over-segmented", "under-segmented", "missed", "noise"];

fn cells(c: &Counts) -> [String; 7] {
    [c.truth_regions, c.segments, c.correct, c.over_segmented, c.under_segmented, c.missed, c.noise]
        .map(|n| n.to_string())
}

/// Returns the classes at one tolerance of [`TOLERANCES`], all scenes together: a line for each
/// level of noise and method.
pub fn classes(results: &Results, tolerance_percent: u32) -> Table {
    let line = |mm: u32, method: usize| {
        let counts = results.counts(method, mm, tolerance_percent);
        let share = format!("{:.1}", counts.percent(counts.correct));
        [vec![mm.to_string(), results.methods[method].to_string()], cells(&counts).into(), vec![share]].concat()
    };
    let head = [&["noise mm", "method"][..], &COUNTED, &["correct %"]].concat();
    let lines = results.noises_mm.iter().flat_map(|&mm| (0..results.methods.len()).map(move |method| line(mm, method)));
    Table::new(&head, 2, lines)
}

/// Correct detections in each scene at one tolerance of [`TOLERANCES`]: a line for each scene, a
/// column for each method and level of noise.
pub fn scenes(results: &Results, tolerance_percent: u32) -> Table {
    let at = (tolerance_percent - TOLERANCES.start()) as usize;
    let mut head = vec!["scene".to_string(), "truth regions".to_string()];
    for method in &results.methods {
        head.extend(results.noises_mm.iter().map(|mm| format!("{method} {mm} mm")));
    }
    let lines = (0..results.scenes).map(|scene| {
        let runs: Vec<&Run> = results.runs.iter().filter(|run| run.scene == scene).collect();
        let truth = runs.first().map_or(0, |run| run.at[at].truth_regions);
        let mut line = vec![scene.to_string(), truth.to_string()];
        line.extend(runs.iter().map(|run| run.at[at].correct.to_string()));
        line
    });
    Table { head, numbers: 1, lines: lines.collect() }
}

/// Returns the classes at the tolerances of the tables: a line for each scene, level of noise,
/// method and tolerance.
pub fn all_scenes(results: &Results) -> Table {
    let head = [&["scene", "noise mm", "method", "tolerance"][..], &COUNTED].concat();
    let lines = results.runs.iter().flat_map(|run| {
        TABLE_TOLERANCES.map(|percent| {
            let counts = &run.at[(percent - TOLERANCES.start()) as usize];
            let named = [run.scene.to_string(), run.noise_mm.to_string(), results.methods[run.method].to_string()];
            [&named[..], &[tolerance(percent)], &cells(counts)].concat()
        })
    });
    Table::new(&head, 4, lines)
}

/// All points of Figs. 7 to 9.
pub fn curves(results: &Results) -> Table {
    let head = [&["noise mm", "method", "tolerance"][..], &COUNTED].concat();
    let mut lines = vec![];
    for &mm in &results.noises_mm {
        for (method, name) in results.methods.iter().enumerate() {
            lines.extend(TOLERANCES.map(|percent| {
                let named = [mm.to_string(), name.to_string(), tolerance(percent)];
                [&named[..], &cells(&results.counts(method, mm, percent))].concat()
            }));
        }
    }
    Table::new(&head, 3, lines.into_iter())
}

/// Returns the costs.
pub fn costs(results: &Results) -> Table {
    let lines = results.costs.iter().map(|cost| {
        let size = [cost.rows, cost.columns, cost.points()].map(|n| n.to_string());
        let name = results.methods[cost.method].to_string();
        [&[name][..], &size, &[format!("{:.1}", cost.instructions_per_point)]].concat()
    });
    Table::new(&["method", "rows", "columns", "points", "instructions per point"], 1, lines)
}

fn tolerance(percent: u32) -> String {
    (f64::from(percent) / 100.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::made_up::made_up;

    #[test]
    fn tables_of_hand_made_results() {
        // correct detections fall by one in each scene for every 0.1 of T
        let results = made_up([[9, 4], [12, 6]]);
        let [all, by_scene] = [classes(&results, 80), scenes(&results, 90)];
        let csv = [all_scenes(&results), curves(&results), costs(&results)].map(|table| table.csv());
        assert_eq!([0, 1].map(|i| csv[i].lines().count()), [1 + 2 * 2 * 2 * 2, 1 + 2 * 2 * 50]);
        let some = csv.iter().map(|csv| csv.lines().take(5).collect::<Vec<_>>().join("\n"));
        let texts = [all.markdown(), by_scene.markdown(), by_scene.html()].into_iter().chain(some);
        insta::assert_snapshot!(texts.collect::<Vec<_>>().join("\n"));
    }
}
