//! Scanner, angle encoder and segmenter together: bytes and samples of the tilt in, segments out.
//!
//! A [`Rig`] needs no port and no clock. It takes events by these calls, and gives the results to a
//! [`RigSink`]:
//!
//! - [`Rig::tilt`]: a sample of the tilt. One per telegram is enough.
//! - [`Rig::receive`]: bytes of the scanner, with the [`Session`](crate::lms2xx::Session) that
//!   decodes them. Or [`Rig::handle`]: an event of a [`blocking`](crate::lms2xx::blocking) or
//!   [`asynch`](crate::lms2xx::asynch) scanner. A rig with a [`Mount`] takes them with any
//!   [`LineScanner`](crate::scanner::LineScanner).
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
//! # Two kinds of rigs
//! [`Rig::new`] is for an LMS 2xx: its columns are even, and the turn angle of a row is enough.
//! [`Rig::mounted`] is for every line scanner, such as an LD06 or RPLIDAR on a servo. Each beam has
//! the angle that its scanner tells, the turn angle at its own time, and an origin beside the axis.
//! Its rows go to the segmenter as free directions, which takes it some two times as long. Pairing,
//! limits, scans and counts are the same. [`Counters::telegrams`] are then rows of the scanner;
//! [`Counters::lost`] and [`Counters::rejected`] are those of its packets.
//!
//! ```
//! use scanseg_core::TurnAxis;
//! use scanseg_hal::rig::Mount;
//! // an LD06 that stands upright on a panning servo, 37.5 mm beside the axis
//! let columns = 450;
//! let mount = Mount {
//!     axis: TurnAxis::Z,
//!     columns,
//!     start_rad: core::f32::consts::PI,
//!     step_rad: -core::f32::consts::TAU / f32::from(columns),
//!     lever_arm_m: 0.0375,
//!     row_us: 100_000,
//! };
//! # assert_eq!(mount.beams(), scanseg_core::Beams::Free { wraps: true });
//! ```
//!
//! # Rows of an LMS 2xx
//! A row has all columns of the variant. A partial scan line is a row of its own, with its own turn
//! angle: it has ranges in every second or fourth column, and none in those between. The default
//! segmenter sees surfaces through such gaps; the paper's two approaches do not. A sub-range has
//! ranges in its own columns. Of means over several scans the turn angle is that of the last.
//!
//! All beams of a row get the mean turn angle of the row, or each the one of its own time:
//! `Rig::new(OwnTurns::new(settings), ..)`. On a floor 1 m below, at 0.5 rad/s, where two mirror turns make a
//! row, points are off by 5.7 mm, and by 0.4 mm with [`OwnTurns`]
//! (`cargo test -p scanseg-virtual-rig --test all moving -- --nocapture`). That takes a Cortex-M4F 10 % more
//! instructions by the default and 38 % more by edges, a Cortex-M0 by edges 94 % more, and 1 KB of
//! flash. Without it, use a variant in steps of 1 degree for a tilt that moves. Of a sub-range that does
//! not begin with the first mirror turn all beams have the mean turn angle.
//!
//! # How long a call takes, and the buffer of the port
//! [`Rig::tilt`] and [`Rig::idle`] do not segment, but for the end of a scan. [`Rig::receive`] and
//! [`Rig::handle`] take as long as the segmenter needs for the row that a telegram completes. In
//! that time the scanner goes on sending, and interrupt or DMA must have room for it. For 361
//! columns at 500 000 Bd, on a Cortex-M4F of 168 MHz at one instruction a cycle (it needs up to
//! twice as long; the instructions are those of `tests/firmware.sh`):
//!
//! | approach | a row | bytes meanwhile | buffer |
//! |---|---|---|---|
//! | by edges | 1.2 ms | 60 | 256 |
//! | by regions | 2.3 ms | 113 | 512 |
//! | by planes | 2.7 ms; up to 7 times as long where no plane explains what is seen | 134 to 940 | 2048 |
//!
//! A buffer of 64 bytes is enough for none. The end of a scan takes longer than a row by planes: it
//! joins pieces across gaps, 16 tries a column at most. Bytes that are lost cost their telegram,
//! which is counted.
//!
//! # Example
//! The main loop of a board. Here its ports are empty, and no scanner answers.
//!
//! ```
//! use core::ops::ControlFlow;
//! use scanseg_core::{LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Sink, buffers};
//! use scanseg_hal::Latch;
//! use scanseg_hal::lms2xx::{Action, Baud, MeasuringMode, Session, Settings, Trouble, Unit, Variant};
//! use scanseg_hal::rig::{Rig, RigSink, TiltLimits, beams};
//! use static_cell::ConstStaticCell;
//!
//! /// The board, to be filled in: UART with its ring buffer, clock, encoder.
//! struct Board {
//!     now_us: u64,
//! }
//! impl Board {
//!     /// Sets the UART to a rate of the scanner, and drops what it has received.
//!     fn set_baud(&mut self, baud: Baud) {
//!         println!("UART: {} Bd", baud.bits_per_s());
//!     }
//!     /// Sends bytes and waits until they have left the port, `gap_us` after each.
//!     fn send(&mut self, bytes: &[u8], gap_us: u32) {
//!         println!("to the scanner: {bytes:02x?}, {gap_us} us between");
//!     }
//!     /// Takes what has come; waits for it for at most `ms`. Returns the number of bytes.
//!     fn receive(&mut self, _bytes: &mut [u8], ms: u32) -> usize {
//!         self.now_us += 1000 * u64::from(ms);
//!         0
//!     }
//!     /// Reads the tilt: its turn angle and when that was.
//!     fn tilt(&mut self) -> Option<Latch> {
//!         Some(Latch { turn_rad: 0.0, time_us: self.now_us })
//!     }
//! }
//!
//! struct Print;
//! impl Sink for Print {
//!     fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
//!         ControlFlow::Continue(())
//!     }
//!     fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
//!         println!("{} pixels: {:?}", segment.pixels(), segment.plane());
//!         ControlFlow::Continue(())
//!     }
//! }
//! impl RigSink for Print {
//!     fn trouble(&mut self, trouble: Trouble) {
//!         println!("trouble: {trouble:?}");
//!     }
//! }
//!
//! const SETTINGS: Settings = Settings {
//!     baud: Baud::B500000,
//!     variant: Variant::Deg180Step1,
//!     unit: Unit::Millimetre,
//!     mode: MeasuringMode::Range32Field,
//!     interlaced: false,
//! };
//! const LIMITS: TiltLimits =
//!     TiltLimits { min_rate_rad_per_s: 0.2, max_rate_rad_per_s: 0.6, sweep_rad: 3.0, pause_us: 1_000_000 };
//! const COLUMNS: usize = SETTINGS.variant.columns() as usize;
//! const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::SICK_LMS200);
//!
//! type SegmenterBuffers = buffers!(COLUMNS, CONFIG);
//! static BUFFERS: ConstStaticCell<SegmenterBuffers> = ConstStaticCell::new(SegmenterBuffers::EMPTY);
//! static ROWS_M: ConstStaticCell<[f32; 2 * COLUMNS]> = ConstStaticCell::new([0.0; 2 * COLUMNS]);
//! static SESSION: ConstStaticCell<Session> = ConstStaticCell::new(Session::new(SETTINGS));
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let segmenter = PlaneSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, BUFFERS.take().memory())?;
//!     let mut rig = Rig::new(SETTINGS, LIMITS, segmenter, ROWS_M.take())?;
//!     let session = SESSION.take();
//!     let mut board = Board { now_us: 0 };
//!     while rig.counters().troubles == 0 {
//!         match session.poll((board.now_us / 1000) as u32) {
//!             Action::SetBaud(baud) => board.set_baud(baud),
//!             Action::Send { bytes, gap_us } => board.send(bytes.as_slice(), gap_us),
//!             Action::Wait { ms } => {
//!                 let mut bytes = [0; 256];
//!                 let count = board.receive(&mut bytes, ms);
//!                 rig.tilt(board.tilt()); // before `receive`
//!                 rig.receive(session, &bytes[..count], board.now_us, &mut Print);
//!             }
//!             Action::Tell(trouble) => rig.trouble(trouble, &mut Print),
//!         }
//!         rig.idle(board.now_us, &mut Print);
//!     }
//!     println!("{:?}", rig.counters());
//!     Ok(())
//! }
//! ```

mod counters;
mod limits;
mod lms;
mod mount;
mod pipeline;
mod place;
mod sink;

pub use counters::{Counters, Dropped};
pub use limits::{RigError, TiltLimits, beams};
pub use lms::{LmsRows, OwnTurns};
pub use mount::Mount;
pub use pipeline::{Rig, Turns};
pub use sink::{End, RigSink, ScanFinished, ScanStarted};
