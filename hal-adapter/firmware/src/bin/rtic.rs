//! The image `mps2` on RTIC 2: the hardware task of the scanner's UART fills the queue, `idle` has the
//! rig and all the rest. What it sends is, byte for byte, what `mps2` sends.
#![no_std]
#![no_main]
#![allow(missing_docs, missing_debug_implementations)] // what RTIC makes has none

// start-up and vectors
use cortex_m_rt as _;

/// What a crate of svd2rust has of the MPS2 boards, as far as it is used here.
mod device {
    #[allow(unused_imports)] // RTIC uses it
    pub use Interrupt as interrupt;

    /// Interrupts of the board.
    #[derive(Clone, Copy)]
    #[repr(u16)]
    pub enum Interrupt {
        /// Of UART 0: a byte has come.
        UART0RX = 0,
    }

    // SAFETY: the number is that of the board's vector.
    unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
        fn number(self) -> u16 {
            self as u16
        }
    }

    /// Bits of a priority.
    pub const NVIC_PRIO_BITS: u8 = 3;

    unsafe extern "C" {
        fn UART0RX();
    }

    /// The vectors of interrupts, up to the one that is used.
    // SAFETY: the section and the name are those that cortex-m-rt's linker script expects.
    #[unsafe(link_section = ".vector_table.interrupts")]
    #[unsafe(no_mangle)]
    static __INTERRUPTS: [unsafe extern "C" fn(); 1] = [UART0RX];
}

#[rtic::app(device = crate::device, peripherals = false)]
mod app {
    use scanseg_core::buffers;
    use scanseg_firmware::approach::{CONFIG, ImageSegmenter};
    use scanseg_firmware::figures::Timed;
    use scanseg_firmware::interrupt;
    use scanseg_firmware::receive::{Bytes, Input, Lost, Output};
    use scanseg_firmware::run::{MPS2, Ports, limits, run};
    use scanseg_firmware::uart::cmsdk::Uart;
    use scanseg_firmware::wire::SpiOver;
    use scanseg_hal::lms2xx::Session;
    use scanseg_hal::rig::{Rig, beams};

    const COLUMNS: usize = MPS2.variant.columns() as usize;
    type Buffers = buffers!(COLUMNS, CONFIG);
    /// Peripheral clock, 25 MHz, by 50: 500 000 Bd.
    const DIVIDER: u32 = 50;
    const IRQ: usize = crate::device::Interrupt::UART0RX as usize;

    static LOST: Lost = Lost::new();

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        scanner: Uart,
        input: Input<'static>,
        output: Output<'static>,
        encoder: SpiOver<Uart>,
        link: Uart,
    }

    #[init(local = [bytes: Bytes = Bytes::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        // SAFETY: the board has these UARTs, and each is taken once.
        let [scanner, encoder, link] =
            [0x4000_4000, 0x4000_5000, 0x4000_6000].map(|base| unsafe { Uart::new(base, DIVIDER) });
        let (input, bytes) = context.local.bytes.split();
        let output = Output { bytes, lost: &LOST, raise: || interrupt::raise(IRQ) };
        scanner.receive_by_interrupt();
        // a byte may be there already
        interrupt::raise(IRQ);
        (
            Shared {},
            Local { scanner, input: Input { bytes: input, lost: &LOST }, output, encoder: SpiOver(encoder), link },
        )
    }

    #[task(binds = UART0RX, local = [scanner, input])]
    fn byte(context: byte::Context) {
        context.local.scanner.interrupted(context.local.input);
    }

    #[idle(local = [
        output,
        encoder,
        link,
        buffers: Buffers = Buffers::EMPTY,
        rows_m: [f32; 2 * COLUMNS] = [0.0; 2 * COLUMNS],
        session: Session = Session::listening(MPS2),
    ])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { output, encoder, link, buffers, rows_m, session, .. } = context.local;
        let segmenter = ImageSegmenter::new(CONFIG, beams(MPS2.variant), COLUMNS, buffers.memory());
        if let Ok(segmenter) = segmenter
            && let Ok(mut rig) = Rig::new(MPS2, limits(&MPS2), Timed(segmenter), rows_m)
        {
            let ports = Ports { scanner: output, encoder, link };
            run(ports, &MPS2, session, &mut rig, || LOST.counts(), || {});
        }
        loop {
            core::hint::spin_loop();
        }
    }
}
