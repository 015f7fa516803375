//! The files of an experiment: figures, tables, and a page that shows them all.

use crate::experiment::claims::{Claim, Verdict, claims};
use crate::experiment::drawing::{Drawing, escaped};
use crate::experiment::figures::{Figure, figures};
use crate::experiment::method::{DEFAULT, EDGE, MIN_PIXELS, REGION, SIZE};
use crate::experiment::results::Results;
use crate::experiment::tables::{self, TABLE_TOLERANCES, Table};
use crate::office::Set;

/// Everything to write, by file name.
pub fn files(results: &Results) -> Vec<(String, Vec<u8>)> {
    let figures = figures(results);
    let mut files = vec![("index.html".to_string(), page(results, &figures).into_bytes())];
    for figure in &figures {
        files.push((format!("{}.svg", figure.name), figure.whole.svg().into_bytes()));
        files.push((format!("{}.png", figure.name), figure.whole.pixels(figure.scale).to_png()));
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
        ("{{style}}", include_str!("../style.css").to_string()),
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

/// Returns the result in a few sentences that can be read aloud.
fn summary(results: &Results) -> String {
    let noises: Vec<String> = results.noises_mm.iter().filter(|mm| **mm > 0).map(u32::to_string).collect();
    let methods: String = (0..results.methods.len()).map(|method| finds(results, method)).collect();
    let verdicts = claims(results);
    let judged: Vec<String> = [Verdict::Holds, Verdict::HoldsInPart, Verdict::DoesNotHold, Verdict::Open]
        .into_iter()
        .map(|verdict| (verdict, verdicts.iter().filter(|claim| claim.verdict == verdict).count()))
        .filter(|(_, count)| *count > 0)
        .map(|(verdict, count)| {
            format!("{} {}", in_words(count), if count == 1 { verdict.words() } else { verdict.words_of_many() })
        })
        .collect();
    let found_at = TABLE_TOLERANCES[0];
    format!(
        "<p>This page repeats the experiment of the paper on {} simulated offices. A simulated scanner looks at each of them \
         without noise in its ranges, and with {} millimetres of noise. Then {} methods divide each scan into flat \
         regions.</p>\n\
         <p>{methods}A region counts as found if a segment covers at least {found_at} percent of it, and at least {found_at} percent of the \
         segment lie on it.</p>\n\
         <p>Of the {} claims of the paper that are judged here, {}.</p>",
        results.scenes,
        listed(&noises),
        in_words(results.methods.len()),
        in_words(verdicts.len()),
        listed(&judged),
    )
}

/// Returns a sentence about what a method finds, without noise and at the most noise; the first
/// one says so.
fn finds(results: &Results, method: usize) -> String {
    let at = |mm: u32| {
        let counts = results.counts(method, mm, TABLE_TOLERANCES[0]);
        match counts.percent(counts.correct) {
            0.0 => "none".to_string(),
            percent if percent < 0.5 => "fewer than one".to_string(),
            percent => format!("{percent:.0}"),
        }
    };
    let name = match results.methods[method] {
        DEFAULT => "default method of this project".to_string(),
        name => format!("{} method of the paper", escaped(name)),
    };
    let most = results.noises_mm[results.noises_mm.len() - 1];
    let (without, with) = (at(results.noises_mm[0]), at(most));
    if method == 0 {
        format!(
            "Of every 100 regions, the {name} finds {without} without noise, and {with} at {most} millimetres of noise. "
        )
    } else {
        format!("The {name} finds {without} without noise, and {with} with it. ")
    }
}

/// Returns `a, b and c`.
fn listed(parts: &[String]) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// Returns a small number as a word.
fn in_words(number: usize) -> String {
    let words = ["none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"];
    words.get(number).map_or_else(|| number.to_string(), |word| word.to_string())
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
         part T or more of both. Cost: instructions of the core alone, counted by callgrind on x86-64 with AVX2 (<code>tests/instructions.sh</code>), \
         from ranges in memory to labels and planes, on scans whose noise is 3 % of the distance between points at 4 m. They \
         are on record; nothing on this page depends on the time of day or the load of a machine.</p>",
        results.scenes,
        noises.join(", "),
        results.methods.join(", "),
    )
}

fn shown(figure: &Figure, number: u32) -> String {
    let (name, caption) = (figure.name, escaped(&figure.caption));
    let legend = figure.legend.iter().map(|legend| format!("<div class=\"legend\">{}</div>\n", legend.svg()));
    let part = |(i, part): (usize, &Drawing)| {
        let class = if i == 0 { "part first" } else { "part" };
        format!("<div class=\"{class}\">{}</div>\n", part.svg())
    };
    let parts: String = figure.parts.iter().flat_map(|row| row.iter().enumerate().map(part)).collect();
    format!(
        "<figure id=\"{name}\">\n{}<div class=\"parts\">\n{parts}</div>\n<figcaption><b>Fig. {number}.</b> {caption} <a \
         href=\"{name}.svg\">SVG</a>, <a href=\"{name}.png\">PNG</a></figcaption>\n</figure>\n",
        legend.collect::<String>()
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
        for tag in [
            "figure", "div", "svg", "table", "thead", "tbody", "tr", "td", "th", "ul", "li", "details", "p", "h3",
            "text",
        ] {
            let count = |start: &str| {
                [">", " "].map(|end| page.matches(&format!("{start}{tag}{end}")).count()).iter().sum::<usize>()
            };
            assert_eq!(count("<"), count("</"), "{tag}");
        }
        // two levels of noise: truth and depth and two methods; charts of one row, two, two, and the
        // cost, each with its legend
        assert_eq!(page.matches("<svg ").count(), 3 * 2 + (2 + 4 + 4 + 1) + 4);
        assert_eq!(page.matches("<span class=").count(), 4);
    }

    /// Plain sentences without signs that a voice stumbles over.
    #[test]
    fn the_opening_can_be_read_aloud() {
        let words = summary(&made_up([[9, 0], [12, 6]]));
        let expected = "<p>Of every 100 regions, the edge-based method of the paper finds 30 without noise, and none at 5 \
             millimetres of noise. The region-based method of the paper finds 45 without noise, and 15 with it. A region";
        assert!(words.contains(expected), "{words}");
        assert!(
            words.ends_with(
                "Of the four claims of the paper that are judged here, two hold, one holds in part and one does not hold.</p>"
            ),
            "{words}"
        );
        let plain = words.replace("<p>", "").replace("</p>", "");
        assert!(!plain.contains(['%', '=', ';', '(', '<', '&', '/']), "{plain}");
    }
}
