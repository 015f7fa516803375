//! Image for the micro:bit (Cortex-M0, 16 KiB of RAM): 181 columns. Scanner, encoder and link share
//! the UART, see [`scanseg_firmware::mux`].
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

#[cfg(not(feature = "figures"))]
use m0_float as _;
use scanseg_core::{Memory, buffers};
use scanseg_firmware::approach::{APPROACH, CONFIG, ImageSegmenter, microbit_areas, of_scanner};
use scanseg_firmware::figures::{self, Timed};
use scanseg_firmware::mux::{Channel, Line};
use scanseg_firmware::run::{MICROBIT, Ports, limits, run};
use scanseg_firmware::uart::nrf51::Uart;
use scanseg_firmware::wire::SpiOver;
use scanseg_hal::lms2xx::Session;
use scanseg_hal::rig::{LmsRows, Rig, RigError, beams};
use small_memory as _;

const COLUMNS: usize = MICROBIT.variant.columns() as usize;
const AREAS: usize = microbit_areas(APPROACH);

/// Makes the session in the memory given. A static that begins with its values would lie in flash
/// as well.
// Not inlined: on its way there the session is on the stack, which is then free again.
#[inline(never)]
fn new_session(memory: &mut MaybeUninit<Session>) -> &mut Session {
    memory.write(Session::listening(MICROBIT))
}

/// Makes the rig of this image; none where a setting is refused.
// Not inlined, as above: on its way the segmenter is on the stack three times.
#[inline(never)]
fn new_rig<'m>(
    memory: Memory<'m>,
    rows_m: &'m mut [f32],
) -> Option<Result<Rig<'m, Timed<ImageSegmenter<'m>>, impl LmsRows + use<>>, RigError>> {
    let segmenter = ImageSegmenter::new(CONFIG, beams(MICROBIT.variant), COLUMNS, memory).ok()?;
    Some(Rig::new(of_scanner(MICROBIT), limits(&MICROBIT), Timed(segmenter), rows_m))
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: buffers!(COLUMNS, CONFIG, AREAS) = <buffers!(COLUMNS, CONFIG, AREAS)>::EMPTY;
    static mut ROWS_M: [f32; 2 * COLUMNS] = [0.0; 2 * COLUMNS];
    static mut SESSION: MaybeUninit<Session> = MaybeUninit::uninit();
    // an image that counts also tries its arithmetic; one that fails says nothing
    #[cfg(feature = "figures")]
    if !m0_float::is_right(20_000) {
        loop {
            core::hint::spin_loop();
        }
    }
    let session = new_session(SESSION);
    figures::begin();
    // SAFETY: this is an nRF51, and its UART is taken once.
    let uart = unsafe { Uart::new() };
    let [scanner, encoder, link] = [Line::Scanner, Line::Encoder, Line::Link].map(|line| Channel::new(uart, line));
    if let Some(Ok(rig)) = &mut new_rig(BUFFERS.memory(), ROWS_M) {
        let ports = Ports { scanner, encoder: SpiOver(encoder), link };
        run(ports, &MICROBIT, session, rig, || (0, 0), || figures::send(link, [0; 3]));
    }
    loop {
        core::hint::spin_loop();
    }
}

/// The vectors of interrupts: there are none.
// SAFETY: the section and the name are those that cortex-m-rt's linker script expects; no interrupt
// is ever enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [usize; 1] = [0];
