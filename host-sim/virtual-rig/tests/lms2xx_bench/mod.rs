//! A session and a virtual scanner on one line.

use scanseg_hal::lms2xx::{Action, Baud, MeasuringMode, Session, SessionEvent, Settings, Trouble, Unit, Variant};
use scanseg_virtual_rig::{Beam, VirtualLms};

pub const SETTINGS: Settings = Settings {
    baud: Baud::B38400,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};

/// Ranges that tell the bearing: 1000 and 40 a degree.
pub fn ramp(beam: Beam) -> u16 {
    1000 + (beam.bearing_deg * 40.0) as u16
}

/// What the scanner says when it has been switched on, and when it has been reset.
pub const RESTARTS: [&[u8]; 2] =
    [b"\x02\x80\x17\x00\x90LMS200;301063;V02.10 \x10\x63\x5E", &[0x02, 0x80, 0x02, 0x00, 0x91, 0x10, 0x79, 0x30]];

/// A session and a scanner on one simulated line.
pub struct Bench {
    pub session: Session,
    pub lms: VirtualLms,
    pub port: Baud,
    pub now_us: u64,
    pub troubles: Vec<Trouble>,
    pub scans: u32,
    pub rejected: u32,
}

impl Bench {
    pub fn new(lms: VirtualLms, settings: Settings) -> Self {
        let session = Session::new(settings);
        Self { session, lms, port: Baud::B9600, now_us: 0, troubles: vec![], scans: 0, rejected: 0 }
    }

    pub fn now_ms(&self) -> u32 {
        // The clock wraps soon after the start.
        (u32::MAX - 5_000).wrapping_add((self.now_us / 1000) as u32)
    }

    /// Does what the session says once; waits are taken in steps of a millisecond.
    pub fn step(&mut self) {
        match self.session.poll(self.now_ms()) {
            Action::SetBaud(baud) => {
                self.lms.read(self.now_us, self.port);
                self.port = baud;
                assert_eq!(self.session.baud(), baud);
            }
            Action::Send { bytes, gap_us } => {
                for byte in bytes.as_slice() {
                    self.now_us = self.lms.write(self.now_us, &[*byte], self.port) + u64::from(gap_us);
                }
            }
            Action::Wait { ms } => {
                assert!(ms > 0);
                self.now_us += 1000;
                let bytes = self.lms.read(self.now_us, self.port);
                self.receive(&bytes);
            }
            Action::Tell(trouble) => self.troubles.push(trouble),
        }
    }

    pub fn receive(&mut self, mut bytes: &[u8]) {
        loop {
            let (used, event) = self.session.feed(self.now_ms(), bytes);
            bytes = &bytes[used..];
            match event {
                SessionEvent::NeedMore => return assert!(bytes.is_empty()),
                SessionEvent::Start { .. } => {}
                SessionEvent::Rejected(_) => self.rejected += 1,
                SessionEvent::ScanLine => {
                    let settings = *self.session.settings();
                    let scan = self.session.scan_line().expect("scan");
                    assert_eq!(scan.unit(), settings.unit);
                    match scan.partial_quarter() {
                        None => assert_eq!(scan.columns(), settings.variant.columns()),
                        Some(quarter) => assert_eq!(Some(scan.columns()), settings.variant.partial_columns(quarter)),
                    }
                    assert_eq!(scan.partial_quarter().is_some(), settings.interlaced);
                    self.scans += 1;
                }
            }
        }
    }

    /// Past the scanner's own start, during which it is looked for in vain.
    pub fn run_up(&mut self) {
        self.run_scans(1, 30_000);
        assert!(self.troubles.iter().all(|trouble| matches!(trouble, Trouble::NotFound | Trouble::Restarted)));
        self.troubles.clear();
    }

    /// Until as many more scans have come; how many milliseconds that took.
    pub fn run_scans(&mut self, scans: u32, at_most_ms: u64) -> u64 {
        let (goal, begin) = (self.scans + scans, self.now_us);
        while self.scans < goal {
            self.step();
            let took_ms = (self.now_us - begin) / 1000;
            assert!(took_ms < at_most_ms, "{:?} after {took_ms} ms, {:?}", self.session.phase(), self.troubles);
        }
        (self.now_us - begin) / 1000
    }

    pub fn run_ms(&mut self, ms: u64) {
        let end = self.now_us + ms * 1000;
        while self.now_us < end {
            self.step();
        }
    }
}
