//! Scans of any kind, by every approach: what can be refused is, and the rest is as in the
//! whole-image reference.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scanseg_core::{AnyConfig, Approach, EdgeConfig, PlaneConfig, RegionConfig};
use scanseg_fuzz::case::Case;
use scanseg_tests::checks::{bearings, edges, planes, regions};

fuzz_target!(|case: Case| {
    let (scan, settings) = (&case.scan, &case.settings);
    if !case.is_taken() {
        // what all configurations share, by all approaches alike
        let configs: [AnyConfig<'_>; 3] = [
            PlaneConfig::new(settings.ranging).into(),
            EdgeConfig::paper().with_ranging(settings.ranging).into(),
            RegionConfig::paper().with_ranging(settings.ranging).into(),
        ];
        let refused = configs.map(|config| case.refused(config).map(|error| error.to_string()));
        assert!(refused.iter().all(|error| *error == refused[0]), "{refused:?}");
        return;
    }
    match case.approach {
        Approach::Edge if !case.is_roomy() => _ = edges::assert_consistent(scan, &settings.edge(), case.areas),
        Approach::Edge if case.usual_beams => {
            let config = settings.edge();
            edges::assert_same(scan, &config);
            if config.ranging.min_range_m >= 0.05 && config.ranging.max_range_m <= 100.0 {
                for &trace in config.traces {
                    bearings::assert_same(scan, &config.ranging, trace, |_, _, _| ());
                }
            }
        }
        Approach::Edge => _ = edges::assert_same_labels(scan, &settings.edge()),
        Approach::Region => {
            regions::assert_consistent(scan, &settings.region, case.areas);
            if case.is_roomy() && case.usual_beams {
                regions::assert_same(scan, &settings.region);
            }
        }
        Approach::Plane => planes::assert_consistent(scan, &settings.plane(), case.areas),
    }
});
