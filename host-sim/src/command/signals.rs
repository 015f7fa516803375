//! Signals that end the program: nothing half written stays behind.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use scanseg_formats::remove_temporaries;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

static ASKS: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);

/// Removes temporary files when a signal ends the program, which ends as it does without.
pub fn remove_temporaries_at_end() {
    // without a thread or a pipe to spare the program works all the same
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    _ = thread::Builder::new().spawn(move || {
        for signal in signals.forever() {
            if ASKS.load(Ordering::Relaxed) && !STOP.swap(true, Ordering::Relaxed) {
                continue;
            }
            remove_temporaries();
            _ = emulate_default_handler(signal);
        }
    });
}

/// From now on the first signal asks the program to stop, and only the second ends it. Returns
/// whether it was asked.
pub fn ask_to_stop() -> &'static AtomicBool {
    ASKS.store(true, Ordering::Relaxed);
    &STOP
}
