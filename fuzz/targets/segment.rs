//! Scans of any kind, by every approach: what can be refused is, and the rest is as in the whole-image reference.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scanseg_fuzz::case::Case;
use scanseg_tests::checks::{bearings, edges, planes, regions};
use scanseg_tests::stream::{Approach, Room};

fuzz_target!(|case: Case| {
    let (scan, config) = (&case.scan, case.settings.config());
    if !case.is_taken() {
        // by all approaches alike
        let refused = [Approach::Plane, Approach::Edge, Approach::Region].map(|approach| {
            let mut room = Room::new(scan.columns, &config, case.areas);
            approach.segmenter(config, scan.beams(), scan.columns, room.memory()).err().map(|error| error.to_string())
        });
        assert!(refused.iter().all(|error| *error == refused[0]), "{refused:?}");
        return;
    }
    match case.approach {
        Approach::Edge if !case.is_roomy() => _ = edges::assert_consistent(scan, &config, case.areas),
        Approach::Edge if case.usual_beams => {
            edges::assert_same(scan, &config);
            if config.min_range_m >= 0.05 && config.max_range_m <= 100.0 {
                config.traces.iter().for_each(|&trace| bearings::assert_same(scan, &config, trace, |_, _, _| ()));
            }
        }
        Approach::Edge => _ = edges::assert_same_labels(scan, &config),
        Approach::Region => {
            regions::assert_consistent(scan, &config, case.areas);
            if case.is_roomy() && case.usual_beams {
                regions::assert_same(scan, &config);
            }
        }
        Approach::Plane => {
            planes::assert_consistent(scan, &config, case.areas);
            if case.is_roomy() && case.usual_beams {
                planes::assert_same(scan, &config);
            }
        }
    }
});
