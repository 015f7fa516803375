//! Images as text, so that a failing test shows two pictures.
//!
//! A row is a line between two bars; `#` is a set bit or an edge, `.` a clear bit or a pixel of an
//! area, a blank a pixel without a return, and a letter or digit the label of an area:
//!
//! ```
//! use scanseg_tests::art::Picture;
//! let picture = Picture::parse(
//!     "
//!     |aa#b|
//!     |a## |
//!     |####|",
//! );
//! assert_eq!((picture.rows, picture.columns), (3, 4));
//! assert_eq!(picture.to_labels()[..4], [1, 1, 0, 2]);
//! assert_eq!(Picture::labels(4, &picture.to_classes(), &picture.to_labels()), picture);
//! ```

use crate::reference::{Size, labels::Class};
use std::collections::HashMap;
use std::fmt;

const LETTERS: &str = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";

/// An image of characters. Prints, in debug output too, as it is parsed.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Row by row.
    pub pixels: Vec<char>,
}

impl Picture {
    /// Reads a picture. Blank lines, and blanks around a line, do not count. Panics if a line is
    /// not between bars or is not as long as the others.
    pub fn parse(art: &str) -> Self {
        let row = |line| str::strip_prefix(line, '|').and_then(|line| line.strip_suffix('|'));
        let lines = art.lines().map(str::trim).filter(|line| !line.is_empty());
        let lines: Vec<Vec<char>> =
            lines.map(|line| row(line).unwrap_or_else(|| panic!("not |...|: {line}")).chars().collect()).collect();
        let columns = lines.first().map_or(0, Vec::len);
        assert!(lines.iter().all(|line| line.len() == columns), "lines of different lengths:{art}");
        Self { rows: lines.len(), columns, pixels: lines.concat() }
    }

    /// A picture of bits.
    pub fn bits(columns: usize, bits: &[bool]) -> Self {
        Self::new(columns, bits.iter().map(|&bit| if bit { '#' } else { '.' }).collect())
    }

    /// A picture of pixel classes.
    pub fn classes(columns: usize, classes: &[Class]) -> Self {
        Self::new(columns, classes.iter().map(|&class| class_pixel(class)).collect())
    }

    /// A picture of labels: 1 is `a`, 26 `z`, then capitals and digits; above 62 all are `*`.
    /// Pixels with label 0 show their class.
    pub fn labels(columns: usize, classes: &[Class], labels: &[u32]) -> Self {
        let pixel = |(&class, &label): (&Class, &u32)| match label {
            0 => class_pixel(class),
            _ => LETTERS.chars().nth(label as usize - 1).unwrap_or('*'),
        };
        Self::new(columns, classes.iter().zip(labels).map(pixel).collect())
    }

    fn new(columns: usize, pixels: Vec<char>) -> Self {
        assert!(columns > 0 && pixels.len().is_multiple_of(columns), "{} pixels in rows of {columns}", pixels.len());
        Self { rows: pixels.len() / columns, columns, pixels }
    }

    /// Its shape.
    pub fn size(&self, wraps: bool) -> Size {
        Size { rows: self.rows, columns: self.columns, wraps }
    }

    /// An image made of its pixels.
    pub fn map<T>(&self, value: impl Fn(char) -> T) -> Vec<T> {
        self.pixels.iter().map(|&pixel| value(pixel)).collect()
    }

    /// The bits. Panics on anything but `#` and `.`.
    pub fn to_bits(&self) -> Vec<bool> {
        self.map(|pixel| match pixel {
            '#' => true,
            '.' => false,
            _ => panic!("'{pixel}' is no bit:\n{self}"),
        })
    }

    /// The classes; whatever is neither `#` nor blank is in an area.
    pub fn to_classes(&self) -> Vec<Class> {
        self.map(|pixel| match pixel {
            '#' => Class::Edge,
            ' ' => Class::NoReturn,
            _ => Class::Area,
        })
    }

    /// The labels; 0 for `#` and blank. Panics on anything that is no label either.
    pub fn to_labels(&self) -> Vec<u32> {
        self.map(|pixel| match (pixel, LETTERS.find(pixel)) {
            ('#' | ' ', _) => 0,
            (_, Some(index)) => index as u32 + 1,
            _ => panic!("'{pixel}' is no label:\n{self}"),
        })
    }
}

fn class_pixel(class: Class) -> char {
    match class {
        Class::NoReturn => ' ',
        Class::Edge => '#',
        Class::Area => '.',
    }
}

impl fmt::Display for Picture {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.pixels.chunks(self.columns.max(1)).try_for_each(|row| writeln!(f, "|{}|", String::from_iter(row)))
    }
}

impl fmt::Debug for Picture {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

/// The same labeling with labels 1, 2, ... in the order in which they first appear; 0 stays. Two
/// labelings are equal up to renumbering where these are equal.
pub fn canonical(labels: &[u32]) -> Vec<u32> {
    let mut numbers = HashMap::from([(0, 0)]);
    let mut number = |label| {
        let next = numbers.len() as u32;
        *numbers.entry(label).or_insert(next)
    };
    labels.iter().map(|&label| number(label)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_what_it_parses() {
        let art = "|.#.|\n|##.|\n";
        let picture = Picture::parse(art);
        assert_eq!(picture.to_string(), art);
        assert_eq!(format!("{picture:?}"), format!("\n{art}"));
        assert_eq!(picture.to_bits(), [false, true, false, true, true, false]);
        assert_eq!(Picture::bits(3, &picture.to_bits()), picture);
        let classes = Picture::parse("|# |\n|..|").to_classes();
        assert_eq!(classes, [Class::Edge, Class::NoReturn, Class::Area, Class::Area]);
        assert_eq!(Picture::classes(2, &classes).to_string(), "|# |\n|..|\n");
        assert_eq!(Picture::labels(2, &classes, &[0, 0, 62, 63]).to_string(), "|# |\n|9*|\n");
    }

    #[test]
    #[should_panic = "lines of different lengths"]
    fn ragged() {
        Picture::parse("|.#|\n|.|");
    }

    #[test]
    #[should_panic = "not |...|"]
    fn no_bars() {
        Picture::parse("|.#|\n.#.");
    }

    #[test]
    fn canonical_labels() {
        assert_eq!(canonical(&[0, 7, 7, 3, 0, 7, 9, 3]), [0, 1, 1, 2, 0, 1, 3, 2]);
        assert_eq!(canonical(&[5, 0]), [1, 0]);
        assert!(canonical(&[]).is_empty());
        assert_ne!(canonical(&[4, 4, 2]), canonical(&[4, 2, 2]));
    }
}
