//! Image for the MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7): 361 columns. Scanner on UART
//! 0, by interrupt, encoder on UART 1, link on UART 2. With the feature `figures` scanner and
//! encoder are in flash, see `paced.rs`.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use scanseg_core::buffers;
use scanseg_firmware::approach::{CONFIG, ImageSegmenter, of_scanner};
use scanseg_firmware::figures::{self, Timed};
use scanseg_firmware::interrupt::{self, Own};
#[cfg(feature = "figures")]
use scanseg_firmware::paced::{Answers, IRQ, Tape};
use scanseg_firmware::receive::{Bytes, Input, Lost, Output};
use scanseg_firmware::run::{MPS2, Ports, limits, run};
use scanseg_firmware::uart::cmsdk::Uart;
#[cfg(not(feature = "figures"))]
use scanseg_firmware::wire::SpiOver;
use scanseg_hal::lms2xx::Session;
use scanseg_hal::rig::{Rig, beams};

const COLUMNS: usize = MPS2.variant.columns() as usize;
/// Peripheral clock, 25 MHz, by 50: 500 000 Bd.
const DIVIDER: u32 = 50;
/// The interrupt of a byte of the scanner: that of UART 0.
#[cfg(not(feature = "figures"))]
const IRQ: usize = 0;

static LOST: Lost = Lost::new();

/// What the interrupt of the scanner's port has.
struct Handler {
    input: Input<'static>,
    #[cfg(not(feature = "figures"))]
    scanner: Uart,
    #[cfg(feature = "figures")]
    scanner: Tape,
    #[cfg(feature = "figures")]
    link: Uart,
}

static HANDLER: Own<Handler> = Own::new();

unsafe extern "C" fn scanner_interrupt() {
    // SAFETY: called here alone, and the interrupt is enabled after `put`.
    let handler = unsafe { HANDLER.get() };
    #[cfg(not(feature = "figures"))]
    handler.scanner.interrupted(&mut handler.input);
    #[cfg(feature = "figures")]
    {
        let mut over = false;
        figures::in_interrupt(|| over = handler.scanner.interrupted(&mut handler.input));
        if over {
            let (overruns, queue_full) = LOST.counts();
            figures::send(handler.link, [handler.scanner.deepest(), overruns, queue_full]);
        }
    }
}

/// Makes the session in the memory given. A static that begins with its values would lie in flash
/// as well.
// Not inlined: on its way there the session is on the stack, which is then free again.
#[inline(never)]
fn new_session(memory: &mut MaybeUninit<Session>) -> &mut Session {
    memory.write(Session::listening(MPS2))
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: buffers!(COLUMNS, CONFIG) = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    static mut ROWS_M: [f32; 2 * COLUMNS] = [0.0; 2 * COLUMNS];
    static mut SESSION: MaybeUninit<Session> = MaybeUninit::uninit();
    static mut BYTES: Bytes = Bytes::new();
    let session = new_session(SESSION);
    figures::begin();
    // SAFETY: both boards have these UARTs, and each is taken once.
    let [scanner, _encoder, link] =
        [0x4000_4000, 0x4000_5000, 0x4000_6000].map(|base| unsafe { Uart::new(base, DIVIDER) });
    let segmenter = ImageSegmenter::new(CONFIG, beams(MPS2.variant), COLUMNS, BUFFERS.memory());
    if let Ok(segmenter) = segmenter
        && let Ok(mut rig) = Rig::new(of_scanner(MPS2), limits(&MPS2), Timed(segmenter), ROWS_M)
    {
        let (input, bytes) = BYTES.split();
        let input = Input { bytes: input, lost: &LOST };
        #[cfg(not(feature = "figures"))]
        let (handler, encoder) = (Handler { input, scanner }, SpiOver(_encoder));
        #[cfg(feature = "figures")]
        let (handler, encoder) = (Handler { input, scanner: Tape::new(&MPS2), link }, Answers::new());
        // SAFETY: no interrupt is enabled yet.
        unsafe { HANDLER.put(handler) };
        interrupt::enable(IRQ);
        #[cfg(not(feature = "figures"))]
        {
            scanner.receive_by_interrupt();
            interrupt::raise(IRQ);
        }
        #[cfg(feature = "figures")]
        Tape::start(byte_ticks(scanner));
        let output = Output { bytes, lost: &LOST, raise: || interrupt::raise(IRQ) };
        let ports = Ports { scanner: output, encoder, link };
        run(ports, &MPS2, session, &mut rig, || LOST.counts(), || {});
    }
    loop {
        core::hint::spin_loop();
    }
}

/// Returns the time of a byte, ticks of the timer, which the host sends first.
#[cfg(feature = "figures")]
fn byte_ticks(mut host: Uart) -> u32 {
    let mut ticks = [0; 4];
    let _ = embedded_io::Read::read_exact(&mut host, &mut ticks);
    u32::from_le_bytes(ticks)
}

/// The vectors of interrupts, up to the one that is used: 240 entries would take 956 bytes of flash.
// SAFETY: the section and the name are those that cortex-m-rt's linker script expects; no other
// interrupt is ever enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); IRQ + 1] = [scanner_interrupt; IRQ + 1];
