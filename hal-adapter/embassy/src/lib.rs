//! What the images on embassy share: the loop, and for the boards their memory and the link.
#![no_std]

#[cfg(feature = "board")]
pub mod board;

use embassy_futures::select::{Either, select};
use embedded_hal_async::delay::DelayNs;
use scanseg_core::Segmenter;
use scanseg_hal::Clock;
use scanseg_hal::encoder::{Encoder, Tilt};
use scanseg_hal::link::Reporter;
use scanseg_hal::lms2xx::asynch::Port;
use scanseg_hal::lms2xx::{Error, Scanner};
use scanseg_hal::rig::Rig;

/// How often the rig is told the time while nothing comes.
const IDLE_MS: u32 = 20;

/// Runs until the scanner's port ends, which on a board is never: each event of the scanner, and the
/// tilt at that time, to the rig; segments of `min_pixels` or more as frames to `send`. An error of the
/// port is survived, and counted as a byte that was taken out too late.
pub async fn run<P: Port, C: Clock, D: DelayNs, E: Encoder>(
    scanner: &mut Scanner<P, C, D>,
    mut tilt: Tilt<E>,
    (mut clock, mut delay): (impl Clock, impl DelayNs),
    rig: &mut Rig<'_, impl Segmenter>,
    min_pixels: u32,
    send: impl FnMut(&[u8]),
) {
    let mut reporter = Reporter::new(min_pixels, send);
    let mut overruns: u32 = 0;
    let mut ended = false;
    while !ended {
        match select(scanner.next_event_async(), delay.delay_ms(IDLE_MS)).await {
            Either::First(Ok(event)) => {
                // before `handle`
                rig.tilt(tilt.read(&mut clock).ok());
                rig.handle(event, scanner.scan_line(), &mut reporter);
            }
            Either::First(Err(Error::Ended)) => ended = true,
            Either::First(Err(_)) => {
                overruns = overruns.wrapping_add(1);
                rig.port_lost(overruns, 0);
            }
            Either::Second(()) => {}
        }
        rig.idle(clock.now_us(), &mut reporter);
    }
}
