//! Image for the MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7): 361 columns. Scanner on UART
//! 0, encoder on UART 1, link on UART 2.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use scanseg_core::buffers;
use scanseg_firmware::approach::{CONFIG, ImageSegmenter};
use scanseg_firmware::figures::{self, Timed};
use scanseg_firmware::run::{MPS2, Ports, limits, run};
use scanseg_firmware::uart::cmsdk::Uart;
use scanseg_firmware::wire::SpiOver;
use scanseg_hal::lms2xx::Session;
use scanseg_hal::rig::{Rig, beams};

const COLUMNS: usize = MPS2.variant.columns() as usize;
/// Peripheral clock, 25 MHz, by 50: 500 000 Bd.
const DIVIDER: u32 = 50;

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
    let session = new_session(SESSION);
    figures::begin();
    // SAFETY: both boards have these UARTs, and each is taken once.
    let [scanner, encoder, link] =
        [0x4000_4000, 0x4000_5000, 0x4000_6000].map(|base| unsafe { Uart::new(base, DIVIDER) });
    let segmenter = ImageSegmenter::new(CONFIG, beams(MPS2.variant), COLUMNS, BUFFERS.memory());
    if let Ok(segmenter) = segmenter
        && let Ok(mut rig) = Rig::new(MPS2, limits(&MPS2), Timed(segmenter), ROWS_M)
    {
        let ports = Ports { scanner, encoder: SpiOver(encoder), link };
        run(ports, &MPS2, session, &mut rig, || figures::send(link));
    }
    loop {
        core::hint::spin_loop();
    }
}

/// The vectors of interrupts: there are none, so one entry in place of 240 keeps 956 bytes of
/// flash.
// SAFETY: the section and the name are those that cortex-m-rt's linker script expects; no interrupt
// is ever enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [usize; 1] = [0];
