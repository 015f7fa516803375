//! The scan after a fault of wires, scanner or encoder is that of a rig that has seen nothing
//! before.

use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::rc::Rc;

use scanseg_core::{
    AnyConfig, AnySegmenter, EdgeConfig, Join, LabelRow, PlaneConfig, Ranging, RegionConfig, Segment, Sink,
};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Session, Settings, Unit, Variant};
use scanseg_hal::rig::{Rig, RigSink, ScanFinished, TiltLimits, beams};
use scanseg_sim::office::{Scene, Set};
use scanseg_sim::segmentation::OwnedMemory;
use scanseg_virtual_rig::{Arrival, Chain, EncoderFault, Motion, WireFaults, scanner_on_tilt};

const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
const COLUMNS: usize = SETTINGS.variant.columns() as usize;

/// Rate of the tilt.
const RATE_RAD_PER_S: f64 = 0.6;
const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.3, max_rate_rad_per_s: 0.9, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };

/// Back and forth between -0.6 and 0.6 rad.
fn to_and_fro(time_us: f64) -> f64 {
    let phase = (time_us * 1e-6 * RATE_RAD_PER_S / 1.2).rem_euclid(2.0);
    1.2 * (if phase < 1.0 { phase } else { 2.0 - phase }) - 0.6
}

/// What comes out of each scan, word for word.
#[derive(Default)]
struct Told {
    now: Vec<String>,
    over: Vec<Vec<String>>,
}

impl Sink for Told {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.now.push(format!("{:?}", row.pixels().collect::<Vec<_>>()));
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.now.push(format!("{join:?}"));
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.now.push(format!("{segment:?} {:?}", segment.plane()));
        ControlFlow::Continue(())
    }
}

impl RigSink for Told {
    fn scan_finished(&mut self, _: &ScanFinished) {
        self.over.push(std::mem::take(&mut self.now));
    }
}

fn rig(config: AnyConfig<'static>) -> Rig<'static, AnySegmenter<'static>> {
    let memory = Box::leak(Box::new(OwnedMemory::new(config, COLUMNS, None)));
    let segmenter = AnySegmenter::new(config, beams(SETTINGS.variant), COLUMNS, memory.memory()).unwrap();
    Rig::new(SETTINGS, LIMITS, segmenter, Vec::leak(vec![0.0; 2 * COLUMNS])).unwrap()
}

type Trial = Chain<'static, AnySegmenter<'static>>;

/// What goes wrong.
type Fault = Box<dyn Fn(&mut Trial)>;

fn faults() -> [(&'static str, Fault); 11] {
    let wires = |faults: WireFaults| move |chain: &mut Trial| chain.lms.wires.faults = faults;
    let encoder = |fault: EncoderFault| move |chain: &mut Trial| chain.encoder_fault = fault;
    let reset = |baud: Baud| {
        move |chain: &mut Trial| {
            chain.lms.permanent_baud = baud;
            chain.lms.power_cycle(chain.now_us());
        }
    };
    let none = WireFaults::default();
    let everything = |chain: &mut Trial| {
        chain.lms.wires.faults =
            WireFaults { drop_one_in: 1000, flip_one_in: 1000, insert_one_in: 1000, burst_one_in: 10_000 };
        chain.encoder_fault = EncoderFault::Off { by_rad: 0.4 };
    };
    [
        ("loss", Box::new(wires(WireFaults { drop_one_in: 100, ..none }))),
        ("flips", Box::new(wires(WireFaults { flip_one_in: 100, ..none }))),
        ("insertions", Box::new(wires(WireFaults { insert_one_in: 100, ..none }))),
        ("bursts", Box::new(wires(WireFaults { burst_one_in: 3000, ..none }))),
        ("reset, another rate", Box::new(reset(Baud::B9600))),
        ("reset, the same rate", Box::new(reset(Baud::B500000))),
        ("silence", Box::new(|chain: &mut Trial| chain.lms.fall_silent(chain.now_us()))),
        ("stuck", Box::new(encoder(EncoderFault::Stuck))),
        ("dead", Box::new(encoder(EncoderFault::Dead))),
        ("jump", Box::new(encoder(EncoderFault::Off { by_rad: -0.3 }))),
        ("everything", Box::new(everything)),
    ]
}

/// A chain that looks at a scene.
fn trial(config: AnyConfig<'static>, scene: &Rc<Scene>) -> Trial {
    let motion: Motion = Rc::new(to_and_fro);
    let scene = Rc::clone(scene);
    let range_m = move |bearing_deg: f64, turn_rad: f64| {
        let bearing_rad = bearing_deg * PI / 180.0 - PI / 2.0;
        let (across, along) = bearing_rad.sin_cos();
        let direction = [along * turn_rad.cos(), across, along * turn_rad.sin()];
        scene.cast(direction).map_or(0.0, |(range_m, _)| range_m)
    };
    let lms = scanner_on_tilt(SETTINGS, &motion, range_m).running(Baud::B500000, SETTINGS.variant);
    Chain::new(SETTINGS, lms, motion, rig(config))
}

/// Runs the chain through a fault and some scans more. Returns the last of them, and all that came
/// since the fault was over.
fn run_through(chain: &mut Trial, fault: &Fault, name: &str) -> (Vec<String>, Vec<Arrival>) {
    let (mut told, mut came) = (Told::default(), vec![]);
    let mut run = |chain: &mut Trial, until: &dyn Fn(&Trial, &Told) -> bool| {
        came.clear();
        while !until(chain, &told) {
            came.push(chain.step(&mut told));
            assert!(chain.now_us() < 60_000_000, "{name}: {:?}", chain.rig.counters());
        }
    };
    run(chain, &|chain, told| chain.rig.counters().rows > 250 && told.now.len() > 50);
    fault(chain);
    let end_us = chain.now_us() + 1_500_000;
    run(chain, &|chain, _| chain.now_us() > end_us);
    chain.lms.wires.faults = WireFaults::default();
    chain.encoder_fault = EncoderFault::None;
    let scans = chain.rig.counters().scans;
    run(chain, &|chain, _| chain.rig.counters().scans == scans + 4);
    (told.over.pop().unwrap(), came)
}

/// What a fresh rig makes of the same: the last scan.
fn by_fresh_rig(config: AnyConfig<'static>, came: &[Arrival]) -> Vec<String> {
    let (mut rig, mut told) = (rig(config), Told::default());
    let mut session = Session::listening(SETTINGS);
    for came in came.iter().filter(|came| !came.bytes.is_empty()) {
        rig.tilt(came.latch);
        rig.receive(&mut session, &came.bytes, came.time_us, &mut told);
    }
    told.over.pop().unwrap()
}

/// Whatever has gone wrong, the next whole scan is, bit for bit, that of a rig that has seen
/// nothing before.
#[test]
fn the_next_scan_is_that_of_a_fresh_rig() {
    let scene = Rc::new(Scene::numbered(Set::Tuning, 4));
    let ranging = Ranging::new(0.005);
    let configs: [AnyConfig<'_>; 3] = [
        PlaneConfig::new(ranging).into(),
        EdgeConfig::paper().with_ranging(ranging).into(),
        RegionConfig::paper().with_ranging(ranging).into(),
    ];
    for config in configs {
        let approach = config.approach();
        for (name, fault) in &faults() {
            let (scan, came) = run_through(&mut trial(config, &scene), fault, name);
            println!("{approach:?}, after {name}: {} rows and events", scan.len());
            assert!(scan.len() > 150 && scan == by_fresh_rig(config, &came), "{approach:?}, after {name}");
        }
    }
}
