//! Signals that end the program: nothing half written stays behind.

use std::thread;

use scanseg_formats::remove_temporaries;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

/// Removes temporary files when a signal ends the program, which ends as it does without.
pub fn remove_temporaries_at_end() {
    // without a thread or a pipe to spare the program works all the same
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    _ = thread::Builder::new().spawn(move || {
        for signal in signals.forever() {
            remove_temporaries();
            _ = emulate_default_handler(signal);
        }
    });
}
