//! Simulated offices as wholes, by planes, against weighted least squares in f64: no two segments that meet are one plane,
//! hardly any segment is two. And the noise that is believed in them.

use crate::common::office;
use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, Segmenter, live_labels};
use scanseg_tests::reference::weighted::{Fit, Noise, Return};
use scanseg_tests::stream::{Record, Room, Scan};
use scanseg_tests::walls::Kind;
use std::collections::BTreeMap;

const NOISE_M: f32 = 0.005;
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(NOISE_M));
/// What the default takes for least: 1.5 mm of a range, 0.02 deg of a beam.
const NOISE: Noise = Noise { ranging: CONFIG.ranging, least_m: 0.0015, least_rad: 4e-4 };

/// Chi-square that a common plane, with three numbers less than two planes, adds once in a thousand times.
const CHANCE: f64 = 16.0;

const KINDS: [Kind; 3] = [Kind::Tilting, Kind::Around, Kind::Camera];

/// The first so many offices as each scanner sees them.
fn offices(scenes: u32) -> impl Iterator<Item = (String, Scan)> {
    let seen = |kind, scene| (format!("{kind:?} {scene}"), office(kind, scene, NOISE_M.into()));
    KINDS.into_iter().flat_map(move |kind| (0..scenes).map(move |scene| seen(kind, scene)))
}

/// The returns of each segment of some size that is seen in two rows or more: each with its row and column.
fn segments(scan: &Scan, labels: &[u32]) -> BTreeMap<u32, Vec<([usize; 2], Return)>> {
    let (beams, image) = (scan.reference_beams(), scan.image(&CONFIG.ranging));
    let mut segments = BTreeMap::<u32, Vec<_>>::new();
    for (pixel, &label) in scan.size().pixels().zip(labels).filter(|&(_, &label)| label != 0) {
        let one = Return { beam: beams.direction(pixel), range_m: image.range(pixel).unwrap().into() };
        segments.entry(label).or_default().push(([pixel.0, pixel.1], one));
    }
    let row = |one: &([usize; 2], Return)| one.0[0];
    segments.retain(|_, all| all.len() >= 30 && all.first().map(row) < all.last().map(row));
    segments
}

fn returns(all: &[([usize; 2], Return)]) -> Vec<Return> {
    all.iter().map(|one| one.1).collect()
}

/// How many pixels of two segments meet, along rows and columns.
fn contacts(scan: &Scan, labels: &[u32]) -> BTreeMap<[u32; 2], usize> {
    let mut contacts = BTreeMap::new();
    for row in labels.chunks(scan.columns) {
        row.windows(2).for_each(|two| *contacts.entry([two[0], two[1]]).or_insert(0) += 1);
    }
    for two in labels.chunks(scan.columns).collect::<Vec<_>>().windows(2) {
        two[0].iter().zip(two[1]).for_each(|(&one, &other)| *contacts.entry([one, other]).or_insert(0) += 1);
    }
    let mut sorted = BTreeMap::new();
    for ([one, other], count) in contacts.into_iter().filter(|([one, other], _)| one != other) {
        *sorted.entry([one.min(other), one.max(other)]).or_insert(0) += count;
    }
    sorted
}

/// Segments that meet in five pixels or more are two planes: a common one adds more squares than chance, and but for one
/// pair in a hundred so many that unevenness of a third of the noise does not explain them either.
#[test]
fn segments_that_meet_are_two_planes() {
    let (mut pairs, mut in_doubt) = (0, 0);
    for (name, scan) in offices(10) {
        let labels = scan.record(CONFIG, live_labels(scan.columns)).labels();
        let segments: BTreeMap<_, _> = segments(&scan, &labels)
            .into_iter()
            .filter_map(|(label, all)| {
                let all = returns(&all);
                Some((label, (NOISE.fit(&all)?, all)))
            })
            .collect();
        for (pair, _) in contacts(&scan, &labels).into_iter().filter(|&(_, contacts)| contacts >= 5) {
            let [Some((one, a)), Some((other, b))] = pair.map(|label| segments.get(&label)) else { continue };
            let Some(common) = NOISE.fit(&[a.as_slice(), b].concat()) else { continue };
            let added = common.squares - one.squares - other.squares;
            assert!(added > CHANCE, "{name}: {pair:?}, {} and {} pixels are one plane: {added}", a.len(), b.len());
            pairs += 1;
            in_doubt += usize::from(added < 4.0 * CHANCE + 0.3 * a.len().min(b.len()) as f64);
        }
    }
    println!("{pairs} pairs, {in_doubt} of them in doubt");
    assert!(pairs > 700 && 100 * in_doubt <= pairs, "{in_doubt} of {pairs}");
}

/// What a common plane adds for each pixel of the smaller half, cut across its rows or its columns.
fn two_halves(all: &[([usize; 2], Return)], whole: &Fit, axis: usize) -> Option<f64> {
    let mut places: Vec<_> = all.iter().map(|one| one.0[axis]).collect();
    places.sort_unstable();
    let middle = places[places.len() / 2];
    let (one, other): (Vec<_>, Vec<_>) = all.iter().partition(|one| one.0[axis] < middle);
    let [a, b] = [returns(&one), returns(&other)];
    let own = NOISE.fit(&a)?.squares + NOISE.fit(&b)?.squares;
    Some((whole.squares - own - CHANCE) / a.len().min(b.len()) as f64)
}

/// Of the segments of 60 pixels and more all but one in thirty are one plane: no half of them is off by the noise.
#[test]
fn segments_are_one_plane() {
    let (mut compared, mut two) = (0, 0);
    for (name, scan) in offices(10) {
        let labels = scan.record(CONFIG, live_labels(scan.columns)).labels();
        for (label, all) in segments(&scan, &labels).into_iter().filter(|(_, all)| all.len() >= 60) {
            let Some(whole) = NOISE.fit(&returns(&all)) else { continue };
            let most = [0, 1].into_iter().filter_map(|axis| two_halves(&all, &whole, axis)).fold(0.0, f64::max);
            compared += 1;
            if most > 1.0 {
                println!("{name}: segment {label} of {} pixels: {most:.2} a pixel", all.len());
                two += 1;
            }
        }
    }
    println!("{two} of {compared} are two planes");
    assert!(compared > 350 && 30 * two <= compared, "{two} of {compared}");
}

/// Where what is stated is right, no more than six times as much is believed, at no range and in no row. Clutter is taken for
/// noise in a third of these offices, whose columns are coarse.
#[test]
fn six_times_the_stated_noise_at_most() {
    let mut fooled = 0;
    for (name, scan) in offices(30) {
        let mut room = Room::new(scan.columns, CONFIG, live_labels(scan.columns));
        let mut segmenter = PlaneSegmenter::new(CONFIG, scan.beams(), scan.columns, room.memory()).unwrap();
        let stated_m = segmenter.range_noise_m(10.0);
        let mut most_m = 0f32;
        for row in 0..scan.turn_rad.len() {
            segmenter.push_row(scan.row_m(row), scan.turn_rad[row], &mut Record::default()).unwrap();
            most_m = most_m.max(segmenter.range_noise_m(10.0));
        }
        assert!(most_m < 6.01 * stated_m, "{name}: {most_m} of {stated_m}");
        fooled += usize::from(most_m > 1.3 * stated_m);
    }
    println!("more is believed in {fooled} of 90 offices");
    assert!(fooled <= 36, "{fooled}");
}
