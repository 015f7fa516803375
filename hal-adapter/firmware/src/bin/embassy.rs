//! The image `mps2` on embassy: the interrupt of the scanner's UART fills the queue and wakes the task,
//! whose loop is that of the boards in `../embassy`. QEMU has no board whose UART embassy knows, so the
//! port is the one of `mps2`. What it sends is, byte for byte, what the same loop sends on the host.
#![no_std]
#![no_main]
#![allow(missing_docs, missing_debug_implementations)] // what embassy makes has none

use core::cell::RefCell;
use core::convert::Infallible;
use core::future::poll_fn;
use core::task::Poll;

use cortex_m as _; // critical section
use embassy_executor::Spawner;
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io::{Read as _, Write as _};
use embedded_io_async::{ErrorType, Read};
use scanseg_core::buffers;
use scanseg_firmware::approach::{CONFIG, ImageSegmenter};
use scanseg_firmware::asynch::{LineDelay, Pieces};
use scanseg_firmware::interrupt::{self, Own};
use scanseg_firmware::receive::{Bytes, Input, Lost, Output};
use scanseg_firmware::run::{AHEAD, LineClock, MIN_PIXELS, MPS2, limits};
use scanseg_firmware::uart::cmsdk::Uart;
use scanseg_firmware::wire::SpiOver;
use scanseg_hal::encoder::Tilt;
use scanseg_hal::encoder::as5048a::As5048a;
use scanseg_hal::lms2xx::Scanner;
use scanseg_hal::rig::{Rig, beams};
use static_cell::{ConstStaticCell, StaticCell};

const COLUMNS: usize = MPS2.variant.columns() as usize;
type Buffers = buffers!(COLUMNS, CONFIG);
/// Peripheral clock, 25 MHz, by 50: 500 000 Bd.
const DIVIDER: u32 = 50;
/// The interrupt of UART 0.
const IRQ: usize = 0;

static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::EMPTY);
static ROWS_M: ConstStaticCell<[f32; 2 * COLUMNS]> = ConstStaticCell::new([0.0; 2 * COLUMNS]);
static BYTES: StaticCell<Bytes> = StaticCell::new();
static LOST: Lost = Lost::new();
static COME: AtomicWaker = AtomicWaker::new();
static HANDLER: Own<(Uart, Input<'static>)> = Own::new();

unsafe extern "C" fn scanner_interrupt() {
    // SAFETY: called here alone, and the interrupt is enabled after `put`.
    let (scanner, input) = unsafe { HANDLER.get() };
    scanner.interrupted(input);
    COME.wake();
}

/// The loop's end of the queue.
struct Come(Output<'static>);

impl ErrorType for Come {
    type Error = Infallible;
}

impl Read for Come {
    /// Waits until all are there, and takes none before: what is dropped while it waits loses nothing.
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        poll_fn(|context| {
            COME.register(context.waker());
            if self.0.bytes.len() < bytes.len() {
                return Poll::Pending;
            }
            let _ = self.0.read_exact(bytes);
            Poll::Ready(Ok(bytes.len()))
        })
        .await
    }
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    // SAFETY: the board has these UARTs, and each is taken once.
    let [scanner, encoder, mut link] =
        [0x4000_4000, 0x4000_5000, 0x4000_6000].map(|base| unsafe { Uart::new(base, DIVIDER) });
    let (input, bytes) = BYTES.init(Bytes::new()).split();
    // SAFETY: the interrupt is not enabled yet.
    unsafe { HANDLER.put((scanner, Input { bytes: input, lost: &LOST })) };
    interrupt::enable(IRQ);
    scanner.receive_by_interrupt();
    // a byte may be there already
    interrupt::raise(IRQ);

    let clock = RefCell::new(LineClock::new(&MPS2));
    let now_us = || clock.borrow().now_us();
    let port = Pieces { bytes: Come(Output { bytes, lost: &LOST, raise: || interrupt::raise(IRQ) }), clock: &clock };
    let mut scanner = Scanner::listening(port, now_us, LineDelay(&clock), MPS2);
    let tilt = Tilt::new(As5048a::new(SpiOver(encoder)), AHEAD);
    let segmenter = ImageSegmenter::new(CONFIG, beams(MPS2.variant), COLUMNS, BUFFERS.take().memory());
    if let Ok(segmenter) = segmenter
        && let Ok(mut rig) = Rig::new(MPS2, limits(&MPS2), segmenter, ROWS_M.take())
    {
        let times = (now_us, LineDelay(&clock));
        scanseg_embassy::run(&mut scanner, tilt, times, &mut rig, MIN_PIXELS, |frame| {
            let _ = link.write_all(frame);
        })
        .await;
    }
}

/// The vectors of interrupts, up to the one that is used.
// SAFETY: the section and the name are those that cortex-m-rt's linker script expects.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); IRQ + 1] = [scanner_interrupt; IRQ + 1];
