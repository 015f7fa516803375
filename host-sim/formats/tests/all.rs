//! The tests of this folder in one program: what they share is built once.

mod captures;
mod clouds;
mod geometry_file;
mod image_files;
mod lidars;
mod memory;
mod scan_files;
