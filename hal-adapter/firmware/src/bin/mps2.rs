//! Image for the MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7).
#![no_std]
#![no_main]

use scanseg_core::{Beams, Columns, Config, EdgeSegmenter, TurnAxis, buffers};
use scanseg_firmware::{chain, meter::CmsdkTimer, uart::cmsdk::Uart, wire::SpiOver};
use scanseg_hal::lms2xx::{Decoder, Variant};

const CONFIG: Config = Config { min_range_m: 0.48, ..Config::paper() };
const COLUMNS: usize = 361;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: buffers!(COLUMNS, CONFIG) = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    static mut DECODER: Decoder = Decoder::new();
    static mut ROW: [f32; COLUMNS] = [0.0; COLUMNS];
    // SAFETY: these UARTs and this timer are there on both boards, and each is taken once.
    let (scanner, encoder, link, timer) = unsafe {
        (
            Uart::new(0x4000_4000, 50),
            Uart::new(0x4000_5000, 50),
            Uart::new(0x4000_6000, 50),
            CmsdkTimer::new(0x4000_0000),
        )
    };
    let columns = Columns::Even { start_rad: -core::f32::consts::FRAC_PI_2, step_rad: 0.5_f32.to_radians() };
    let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
    let Ok(segmenter) = EdgeSegmenter::new(CONFIG, beams, COLUMNS, BUFFERS.memory()) else { loop {} };
    chain::run(scanner, SpiOver(encoder), link, segmenter, DECODER, ROW, Variant::Deg180Step05, 226, timer)
}
