//! The chain of the images, on this host.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use scanseg_core::{AnyConfig, AnySegmenter, Approach};
use scanseg_firmware::approach::{EDGE, PLANE, REGION};
use scanseg_firmware::asynch::{LineDelay, Pieces};
use scanseg_firmware::figures::Timed;
use scanseg_firmware::run::{AHEAD, LineClock, MIN_PIXELS, Ports, limits, run};
use scanseg_hal::encoder::Tilt;
use scanseg_hal::encoder::as5048a::As5048a;
use scanseg_hal::lms2xx::{Scanner, Session, Settings};
use scanseg_hal::rig::{Rig, beams};
use scanseg_sim::segmentation::OwnedMemory;
use scanseg_virtual_rig::VirtualAs5048a;

use crate::Result;
use crate::scene::Recording;

/// What went over the encoder's wires, transaction after transaction: to it, and from it.
pub type Frames = VecDeque<([u8; 2], [u8; 2])>;

/// What an image is to do with a stream.
pub struct Expected {
    pub link: Vec<u8>,
    pub frames: Frames,
}

/// Runs the chain on all that the scanner sends.
pub fn expected(stream: &[u8], settings: &Settings, approach: Approach, max_labels: Option<usize>) -> Result<Expected> {
    let mut session = Session::listening(*settings);
    with_rig(settings, approach, max_labels, |clock, encoder, rig, link| {
        let ports = Ports { scanner: Clocked { stream, clock }, encoder, link };
        // runs until the stream ends
        run(ports, settings, &mut session, rig, || (0, 0), || {});
    })
}

/// Runs the chain of the image on embassy.
pub fn expected_async(stream: &[u8], settings: &Settings, approach: Approach) -> Result<Expected> {
    with_rig(settings, approach, None, |clock, encoder, rig, link| {
        let now_us = || clock.borrow().now_us();
        let port = Pieces { bytes: stream, clock: &clock };
        let mut scanner = Scanner::listening(port, now_us, LineDelay(&clock), *settings);
        let tilt = Tilt::new(As5048a::new(encoder), AHEAD);
        let times = (now_us, LineDelay(&clock));
        let send = |frame: &[u8]| link.extend(frame);
        pollster::block_on(scanseg_embassy::run(&mut scanner, tilt, times, rig, MIN_PIXELS, send));
    })
}

/// Gives the encoder and a rig to the loop; returns what went over the encoder's wires and over the link.
fn with_rig(
    settings: &Settings,
    approach: Approach,
    max_labels: Option<usize>,
    run: impl FnOnce(Rc<RefCell<LineClock>>, Spy<'_, Sensor>, &mut Rig<'_, Timed<AnySegmenter<'_>>>, &mut Vec<u8>),
) -> Result<Expected> {
    let columns = usize::from(settings.variant.columns());
    let config: AnyConfig = match approach {
        Approach::Plane => PLANE.into(),
        Approach::Edge => EDGE.into(),
        Approach::Region => REGION.into(),
    };
    let sizes = max_labels.map_or(config.sizes(columns), |areas| config.sizes_with(columns, areas));
    let mut memory = OwnedMemory::of(sizes);
    let segmenter = AnySegmenter::new(config, beams(settings.variant), columns, memory.memory())?;
    let mut rows_m = vec![0.0; 2 * columns];
    let mut rig = Rig::new(*settings, limits(settings), Timed(segmenter), &mut rows_m)?;
    let clock = Rc::new(RefCell::new(LineClock::new(settings)));
    let (tilt_clock, settings) = (clock.clone(), *settings);
    let tilt: Box<dyn FnMut() -> f64> =
        Box::new(move || Recording::tilt_turns(&settings, tilt_clock.borrow().now_us()));
    let mut link = Vec::new();
    let mut frames = Frames::new();
    run(clock, Spy { sensor: VirtualAs5048a::new(tilt), frames: &mut frames }, &mut rig, &mut link);
    Ok(Expected { link, frames })
}

/// The encoder.
type Sensor = VirtualAs5048a<Box<dyn FnMut() -> f64>>;

/// A stream that moves a clock.
struct Clocked<'a> {
    stream: &'a [u8],
    clock: Rc<RefCell<LineClock>>,
}

impl embedded_io::ErrorType for Clocked<'_> {
    type Error = Infallible;
}

impl embedded_io::Read for Clocked<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::result::Result<usize, Infallible> {
        let count = self.stream.read(bytes)?;
        self.clock.borrow_mut().received(count as u32);
        Ok(count)
    }
}

/// Notes what goes over an SPI device's wires.
struct Spy<'a, D> {
    sensor: D,
    frames: &'a mut Frames,
}

impl<D: SpiDevice> ErrorType for Spy<'_, D> {
    type Error = D::Error;
}

impl<D: SpiDevice> SpiDevice for Spy<'_, D> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> std::result::Result<(), D::Error> {
        let frame = |operations: &[Operation<'_, u8>]| match operations {
            [Operation::TransferInPlace([high, low])] => [*high, *low],
            _ => panic!("the driver sends frames of two bytes"),
        };
        let sent = frame(operations);
        self.sensor.transaction(operations)?;
        self.frames.push_back((sent, frame(operations)));
        Ok(())
    }
}
