//! The core in the browser: functions that `page.js` calls, with numbers and pointers alone.
//!
//! JavaScript writes what comes in to [`input`], and reads what goes out where [`text`] and
//! [`array`] say. Pointers hold until the next call. Everything is of the one thread that a page
//! has.

mod live;
mod page;
mod told;

use std::cell::RefCell;

use crate::page::Page;

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn with<T>(call: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(call)
}

/// The functions by their names in the module. The attribute counts as unsafe because two functions
/// of one name would clash; nothing here follows a pointer.
#[allow(unsafe_code)]
mod interface {
    use crate::with;

    /// Returns where JavaScript may write `length` bytes: 0 a file, 1 its name, 2 its geometry file,
    /// 3 the name of that.
    #[unsafe(no_mangle)]
    pub extern "C" fn input(which: usize, length: usize) -> *mut u8 {
        with(|page| page.input(which, length))
    }

    /// Makes scan `number` of the tuning set, with noise in metres. [`text`] describes it.
    #[unsafe(no_mangle)]
    pub extern "C" fn office(number: u32, range_noise_m: f64) {
        with(|page| page.office(number, range_noise_m));
    }

    /// Reads the file of [`input`]; its bytes are dropped. `fx_px` is the focal length of a depth
    /// image without a geometry file, 0 if it is not known. [`text`] describes the scan, or says in
    /// `error` why there is none; the scan before then remains.
    #[unsafe(no_mangle)]
    pub extern "C" fn read(fx_px: f64) {
        with(|page| page.read(fx_px));
    }

    /// Begins to segment the scan: approach 0 planes, 1 edges, 2 regions; noise in metres, or less
    /// than 0 for what the file says. [`text`] has `error` if that cannot be.
    #[unsafe(no_mangle)]
    pub extern "C" fn begin(approach: u32, range_noise_m: f64) {
        with(|page| page.begin(approach, range_noise_m));
    }

    /// Pushes up to so many rows; after the last one the scan is complete. [`text`] tells how far it
    /// has come, and the segments that are complete.
    #[unsafe(no_mangle)]
    pub extern "C" fn push(rows: usize) {
        with(|page| page.push(rows));
    }

    /// Returns where the text of the last call is, UTF-8.
    #[unsafe(no_mangle)]
    pub extern "C" fn text() -> *const u8 {
        with(|page| page.text().as_ptr())
    }

    /// Returns its length in bytes.
    #[unsafe(no_mangle)]
    pub extern "C" fn text_length() -> usize {
        with(|page| page.text().len())
    }

    /// Returns where four bytes for each pixel are, or three times four: 0 ranges in metres, 1 points
    /// in metres, 2 labels so far, 3 numbers of segments as in the list of [`push`].
    #[unsafe(no_mangle)]
    pub extern "C" fn array(which: usize) -> *const u8 {
        with(|page| page.array(which))
    }
}
