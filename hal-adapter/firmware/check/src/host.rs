//! The chain of the images, on this host.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use scanseg_core::{AnyConfig, AnySegmenter, Approach};
use scanseg_firmware::approach::{EDGE, PLANE, REGION};
use scanseg_firmware::figures::Timed;
use scanseg_firmware::run::{LineClock, Ports, limits, run};
use scanseg_hal::lms2xx::{Session, Settings};
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
    let mut session = Session::listening(*settings);
    let clock = Rc::new(RefCell::new(LineClock::new(settings)));
    let tilt_clock = clock.clone();
    let sensor = VirtualAs5048a::new(move || Recording::tilt_turns(settings, tilt_clock.borrow().now_us()));
    let mut link = Vec::new();
    let mut frames = Frames::new();
    let ports =
        Ports { scanner: Clocked { stream, clock }, encoder: Spy { sensor, frames: &mut frames }, link: &mut link };
    // runs until the stream ends
    run(ports, settings, &mut session, &mut rig, || (0, 0), || {});
    Ok(Expected { link, frames })
}

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
