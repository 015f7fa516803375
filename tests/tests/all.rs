//! The tests of this folder, in one program: what they share is built once.

mod alike;
mod any;
mod beam_stretch;
mod checked;
mod common;
mod covariances;
mod field_cases;
mod fitted;
mod goldens;
mod goldens_planes;
mod goldens_regions;
mod hoover;
mod labels_and_planes;
mod memory;
mod missing_pixels;
mod noise;
mod one_plane;
mod planes;
mod properties;
mod readme;
mod recorded;
mod regions;
mod rooms;
mod row_beams;
mod streaming;
mod surfaces;
