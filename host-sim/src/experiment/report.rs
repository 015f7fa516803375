//! The files of an experiment: figures, tables, and a page that shows them all.

use crate::experiment::chart::{escaped, png};
use crate::experiment::claims::{Claim, Verdict, claims};
use crate::experiment::cost;
use crate::experiment::figures::{Figure, figures};
use crate::experiment::method::{EDGE, MIN_PIXELS, REGION, SIZE};
use crate::experiment::results::Results;
use crate::experiment::tables::{self, TABLE_TOLERANCES, Table};
use crate::office::Set;

/// Everything to write, by file name.
pub fn files(results: &Results) -> Vec<(String, Vec<u8>)> {
    let figures = figures(results);
    let mut files = vec![("index.html".to_string(), page(results, &figures).into_bytes())];
    for figure in &figures {
        files.push((format!("{}.svg", figure.name), figure.svg.clone().into_bytes()));
        files.push((format!("{}.png", figure.name), png(&figure.svg, figure.scale)));
    }
    for (name, table) in data(results) {
        files.push((name.to_string(), table.csv().into_bytes()));
    }
    files.push(("tables.md".to_string(), markdown(results).into_bytes()));
    files
}

/// Returns the tables as CSV files.
fn data(results: &Results) -> [(&'static str, Table); 3] {
    let [curves, scenes, costs] = [tables::curves(results), tables::all_scenes(results), tables::costs(results)];
    [("curves.csv", curves), ("scenes.csv", scenes), ("cost.csv", costs)]
}

fn title(tolerance_percent: u32) -> String {
    format!("All scenes, T = {:.1}", f64::from(tolerance_percent) / 100.0)
}

fn scenes_title() -> String {
    format!("Correct detections by scene, T = {:.1}", f64::from(TABLE_TOLERANCES[0]) / 100.0)
}

/// Returns the tables as Markdown.
pub fn markdown(results: &Results) -> String {
    let by_class = TABLE_TOLERANCES.map(|percent| (title(percent), tables::classes(results, percent)));
    let by_scene = (scenes_title(), tables::scenes(results, TABLE_TOLERANCES[0]));
    let all = by_class.into_iter().chain([by_scene]);
    all.map(|(title, table)| format!("## {title}\n\n{}\n", table.markdown())).collect::<String>().trim_end().to_string()
        + "\n"
}

/// Returns the page. It needs no other file but for its links to the data.
pub fn page(results: &Results, figures: &[Figure]) -> String {
    let parts = [
        ("{{version}}", env!("CARGO_PKG_VERSION").to_string()),
        ("{{summary}}", summary(results)),
        ("{{what}}", what(results)),
        ("{{figures}}", figures.iter().zip(6..).map(|(figure, number)| shown(figure, number)).collect()),
        ("{{tables}}", shown_tables(results)),
        ("{{claims}}", claims(results).iter().map(judged).collect()),
        ("{{links}}", data(results).map(|(name, _)| format!("<a href=\"{name}\">{name}</a>")).join(", ")),
    ];
    parts.iter().fold(include_str!("report.html").to_string(), |page, (name, part)| page.replace(name, part))
}

/// Returns the result in two sentences.
fn summary(results: &Results) -> String {
    let percent = TABLE_TOLERANCES[0];
    let at = |name: &str, mm: u32| {
        let counts = results.counts(results.method(name)?, mm, percent);
        Some(format!("{:.0} %", counts.percent(counts.correct)))
    };
    let by_noise = results.noises_mm.iter().filter_map(|&mm| {
        let names = results.methods.iter().map(|name| Some(format!("{} ({})", at(name, mm)?, escaped(name))));
        Some(format!("{} at {mm} mm of noise", names.collect::<Option<Vec<_>>>()?.join(", ")))
    });
    let verdicts = claims(results);
    let held = verdicts.iter().filter(|claim| claim.verdict == Verdict::Holds).count();
    format!(
        "Regions found correctly at T = {:.1}: {}. Of the {} claims of the paper examined here, {held} hold in full.",
        f64::from(percent) / 100.0,
        by_noise.collect::<Vec<_>>().join("; "),
        verdicts.len()
    )
}

fn what(results: &Results) -> String {
    let (set, sort) = match results.set {
        Set::Tuning => ("tuning", "private offices, shared offices, store rooms"),
        Set::Validation => ("validation", "meeting rooms, open-plan offices, libraries"),
    };
    let regions = results.counts(0, results.noises_mm[0], TABLE_TOLERANCES[0]).truth_regions;
    let (rows, columns) = SIZE;
    let noises: Vec<_> = results.noises_mm.iter().map(u32::to_string).collect();
    format!(
        "<p>{} scenes of the {set} set of the simulated office ({sort}), with {regions} truth regions of {MIN_PIXELS} \
         pixels or more; smaller regions and segments do not count. The scanner nods: {rows} rows of {columns} beams, 0.5 \
         degrees apart both ways. Its ranges have normal noise of {} mm (one standard deviation).</p>\n\
         <p>Methods: {}. The paper’s two, {EDGE} and {REGION}, have the settings of <code>EdgeConfig::paper()</code> and \
         <code>RegionConfig::paper()</code>, with <code>range_noise_m</code> that of the scanner, at least 1 mm.</p>\n\
         <p>Classes are those of Hoover et al. (1996): a segment is a correct detection of a truth region if they share the \
         part T or more of both. Cost: median of {} to {} rounds of the core alone on one processor core, from ranges in memory to labels \
         and planes, on scans whose noise is 3 % of the distance between points at 4 m.</p>",
        results.scenes,
        noises.join(", "),
        results.methods.join(", "),
        cost::ROUNDS.start(),
        cost::ROUNDS.end()
    )
}

fn shown(figure: &Figure, number: u32) -> String {
    let (name, caption) = (figure.name, escaped(&figure.caption));
    format!(
        "<figure id=\"{name}\">\n{}<figcaption><b>Fig. {number}.</b> {caption} <a href=\"{name}.svg\">SVG</a>, \
         <a href=\"{name}.png\">PNG</a></figcaption>\n</figure>\n",
        figure.svg
    )
}

fn shown_tables(results: &Results) -> String {
    let by_class = TABLE_TOLERANCES
        .map(|percent| format!("<h3>{}</h3>\n{}", title(percent), tables::classes(results, percent).html()))
        .concat();
    let by_scene = tables::scenes(results, TABLE_TOLERANCES[0]).html();
    let cost = tables::costs(results).html();
    let (scenes, times) = (scenes_title(), "Cost");
    format!(
        "{by_class}<details><summary>{scenes}</summary>\n{by_scene}</details>\n<details><summary>{times}</summary>\n{cost}</details>\n"
    )
}

fn judged(claim: &Claim) -> String {
    let class = match claim.verdict {
        Verdict::Holds => "holds",
        Verdict::HoldsInPart | Verdict::Open => "in-part",
        Verdict::DoesNotHold => "not",
    };
    let found: String = claim.found.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
    let why = if claim.why.is_empty() { String::new() } else { format!("<p>{}</p>\n", escaped(&claim.why)) };
    format!(
        "<h3>{} <span class=\"{class}\">This {}.</span></h3>\n<p class=\"quiet\">{}</p>\n<ul>\n{found}</ul>\n{why}",
        escaped(claim.claim),
        claim.verdict.words(),
        escaped(&claim.criterion)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::made_up::made_up;

    #[test]
    fn the_page_is_whole_and_its_links_lead_to_files() {
        let results = made_up([[9, 4], [12, 6]]);
        let files = files(&results);
        let page = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(!page.contains("{{"), "a part is missing");
        let links: Vec<&str> = page.split("<a href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(links.len(), 5 * 2 + 3);
        for link in links {
            assert!(files.iter().any(|(name, bytes)| name == link && !bytes.is_empty()), "{link}");
        }
        // every element that is opened is closed
        for tag in
            ["figure", "svg", "table", "thead", "tbody", "tr", "td", "th", "ul", "li", "details", "p", "h3", "text"]
        {
            let count = |start: &str| {
                [">", " "].map(|end| page.matches(&format!("{start}{tag}{end}")).count()).iter().sum::<usize>()
            };
            assert_eq!(count("<"), count("</"), "{tag}");
        }
        assert_eq!(page.matches("<svg ").count(), 5);
        assert_eq!(page.matches("<span class=").count(), 4);
    }
}
