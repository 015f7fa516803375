//! Scanner, angle encoder and segmenter together: bytes and samples of the tilt in, segments out.
//!
//! A [`Rig`] needs no port and no clock. It takes events by these calls, and gives the results to a
//! [`RigSink`]:
//!
//! - [`Rig::tilt`]: a sample of the tilt. One per telegram is enough.
//! - [`Rig::receive`]: bytes of the scanner, with the [`Session`](crate::lms2xx::Session) that
//!   decodes them. Or [`Rig::handle`]: an event of a [`blocking`](crate::lms2xx::blocking) or
//!   [`asynch`](crate::lms2xx::asynch) scanner.
//! - [`Rig::idle`]: the present time.
//!
//! A scan is one sweep of the tilt. It ends when the tilt turns back, when the sweep has covered
//! the angle set, when rows stop coming, and when the scanner restarts. The rig then gives out the
//! last segments and starts the next scan with an empty segmenter.
//!
//! A row is used only with a known turn angle. For a telegram to become a row, the tilt must have
//! been sampled near its beams, must have turned at a plausible rate ([`TiltLimits`]), and must
//! continue the rows before it. A scan begins with two rows that agree. Every other telegram is
//! dropped with its reason ([`Dropped`]) and counted ([`Counters`]).
//!
//! An encoder error that keeps the rate within the limits is not detected. Such an error is at most
//! the difference between the rate and a limit, times the time between two rows. That holds for
//! rows up to four telegrams apart. Over a longer gap the samples must have been continuous as
//! well, and the time between two samples counts instead.
//!
//! A row has all columns of the variant. A partial scan line is a row of its own, with its own turn
//! angle: it has ranges in every second or fourth column, and none in those between. The default
//! segmenter sees surfaces through such gaps; the paper's two approaches do not. A sub-range has
//! ranges in its own columns. Of means over several scans the turn angle is that of the last.
//!
//! All beams of a row get the mean turn angle of the row. [`pairing`](crate::pairing) has a table
//! of the error that this leaves: on a floor, at 0.5 rad/s, 5.6 mm if two mirror turns make a row,
//! 1.1 mm if each is a row of its own. So use a variant in steps of 1 degree for a tilt that moves.
//!
//! ```
//! use core::ops::ControlFlow;
//! use scanseg_core::{LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Sink, buffers};
//! use scanseg_hal::lms2xx::{Action, Baud, MeasuringMode, Session, Settings, Unit, Variant};
//! use scanseg_hal::rig::{Rig, RigSink, TiltLimits, beams};
//!
//! struct Print;
//! impl Sink for Print {
//!     fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> { ControlFlow::Continue(()) }
//!     fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
//!         println!("{:?}", segment.plane());
//!         ControlFlow::Continue(())
//!     }
//! }
//! impl RigSink for Print {}
//!
//! const SETTINGS: Settings = Settings {
//!     baud: Baud::B500000,
//!     variant: Variant::Deg180Step1,
//!     unit: Unit::Millimetre,
//!     mode: MeasuringMode::Range32Field,
//!     interlaced: false,
//! };
//! const COLUMNS: usize = SETTINGS.variant.columns() as usize;
//! const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));
//! let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY; // on a microcontroller: statics
//! let mut rows_m = [0.0; 2 * COLUMNS];
//! let segmenter = PlaneSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, buffers.memory())?;
//! let limits = TiltLimits { min_rate_rad_per_s: 0.2, max_rate_rad_per_s: 0.6, sweep_rad: 3.0, pause_us: 1_000_000 };
//! let mut rig = Rig::new(SETTINGS, limits, segmenter, &mut rows_m)?;
//! let mut session = Session::new(SETTINGS);
//! # let (now_us, received, sample) = (0u64, [0u8; 0], None);
//! // in the main loop:
//! match session.poll((now_us / 1000) as u32) {
//!     Action::SetBaud(_) | Action::Send { .. } => {} // on the port
//!     Action::Wait { .. } => {
//!         rig.tilt(sample);
//!         rig.receive(&mut session, &received, now_us, &mut Print);
//!     }
//!     Action::Tell(trouble) => rig.trouble(trouble, &mut Print),
//! }
//! rig.idle(now_us, &mut Print);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod counters;
mod limits;
mod pipeline;
mod place;
mod sink;

pub use counters::{Counters, Dropped};
pub use limits::{RigError, TiltLimits, beams};
pub use pipeline::Rig;
pub use sink::{End, RigSink, ScanFinished, ScanStarted};
