//! Morphological closing of bit images (paper, section 4).

use super::Size;

/// A structuring element of 3x3 pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// The pixel and its 4 neighbours: the paper's.
    Plus,
    /// The pixel and its 8 neighbours.
    Square,
}

impl Element {
    /// Its pixels, as rows down and columns to the right of the centre.
    pub fn offsets(self) -> &'static [(isize, isize)] {
        match self {
            Element::Plus => &[(-1, 0), (0, -1), (0, 0), (0, 1), (1, 0)],
            Element::Square => &[(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 0), (0, 1), (1, -1), (1, 0), (1, 1)],
        }
    }
}

/// Sets every pixel that has a set one under the element. Outside of the image nothing is set.
pub fn dilate(size: Size, element: Element, bits: &[bool]) -> Vec<bool> {
    let set = |pixel, &(down, right): &(isize, isize)| {
        size.neighbour(pixel, down, right).is_some_and(|(row, column)| bits[size.index(row, column)])
    };
    size.pixels().map(|pixel| element.offsets().iter().any(|offset| set(pixel, offset))).collect()
}

/// Keeps every pixel that has only set ones under the element. Outside of the image everything is
/// set.
pub fn erode(size: Size, element: Element, bits: &[bool]) -> Vec<bool> {
    let set = |pixel, &(down, right): &(isize, isize)| {
        size.neighbour(pixel, down, right).is_none_or(|(row, column)| bits[size.index(row, column)])
    };
    size.pixels().map(|pixel| element.offsets().iter().all(|offset| set(pixel, offset))).collect()
}

/// Dilation, then erosion. Neither sees anything outside of the image.
pub fn close(size: Size, element: Element, bits: &[bool]) -> Vec<bool> {
    erode(size, element, &dilate(size, element, bits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::art::Picture;
    use proptest::prelude::*;

    fn closed(element: Element, wraps: bool, art: &str) -> Picture {
        let picture = Picture::parse(art);
        Picture::bits(picture.columns, &close(picture.size(wraps), element, &picture.to_bits()))
    }

    #[test]
    fn dilation_and_erosion() {
        let dot = Picture::parse("|.....|\n|.....|\n|..#..|\n|.....|\n|.....|");
        let size = dot.size(false);
        let plus = Picture::parse("|.....|\n|..#..|\n|.###.|\n|..#..|\n|.....|");
        let square = Picture::parse("|.....|\n|.###.|\n|.###.|\n|.###.|\n|.....|");
        assert_eq!(Picture::bits(5, &dilate(size, Element::Plus, &dot.to_bits())), plus);
        assert_eq!(Picture::bits(5, &dilate(size, Element::Square, &dot.to_bits())), square);
        assert_eq!(Picture::bits(5, &erode(size, Element::Plus, &plus.to_bits())), dot);
        assert_eq!(Picture::bits(5, &erode(size, Element::Square, &square.to_bits())), dot);
        assert_eq!(Picture::bits(5, &erode(size, Element::Plus, &square.to_bits())), dot);
    }

    /// A gap of one pixel in a line of one pixel: the plus leaves it, the square closes it.
    #[test]
    fn gap_of_one_in_a_thin_line() {
        let art = "
            |.......|
            |.......|
            |###.###|
            |.......|
            |.......|";
        let line = "
            |.......|
            |.......|
            |#######|
            |.......|
            |.......|";
        // Plus: dilation sets all of the middle row, and the rows beside it but for column 3.
        // Erosion at column 3 of the middle row needs (1, 3), which is not set: the gap stays.
        assert_eq!(closed(Element::Plus, false, art), Picture::parse(art));
        assert_eq!(closed(Element::Square, false, art), Picture::parse(line));
    }

    /// The ridges that Sobel makes are two pixels wide: the plus leaves the gap, the square seals
    /// it.
    #[test]
    fn gap_of_one_in_a_ridge() {
        let art = "
            |..##..|
            |..##..|
            |......|
            |..##..|
            |..##..|";
        let ridge = "
            |..##..|
            |..##..|
            |..##..|
            |..##..|
            |..##..|";
        // Plus at (2, 2): dilation leaves (2, 1) unset, so that erosion does.
        assert_eq!(closed(Element::Plus, false, art), Picture::parse(art));
        assert_eq!(closed(Element::Square, false, art), Picture::parse(ridge));
    }

    /// What the plus does close: a hole whose 4 neighbours are set.
    #[test]
    fn holes() {
        let ring = "
            |.....|
            |..#..|
            |.#.#.|
            |..#..|
            |.....|";
        let full = "
            |.....|
            |..#..|
            |.###.|
            |..#..|
            |.....|";
        assert_eq!(closed(Element::Plus, false, ring), Picture::parse(full));
        // The square: dilation sets all but the four corners; erosion keeps what has no corner in
        // its 3x3, which beyond the border is set.
        let to_the_border = "
            |..#..|
            |..#..|
            |#####|
            |..#..|
            |..#..|";
        assert_eq!(closed(Element::Square, false, ring), Picture::parse(to_the_border));
    }

    /// Outside counts as set in the erosion: a gap that is open to the border is closed where only
    /// the border lies beyond, and what lies on the border is not eaten.
    #[test]
    fn border() {
        let art = "
            |.#..|
            |#...|
            |....|";
        // Dilation sets (0,0) (0,1) (0,2) (1,0) (1,1) (2,0); erosion keeps (0,0): its neighbours
        // (0,1), (1,0); (0,1): (0,0), (0,2), (1,1); (1,0): (0,0), (1,1), (2,0).
        let expected = "
            |##..|
            |#...|
            |....|";
        assert_eq!(closed(Element::Plus, false, art), Picture::parse(expected));
        assert_eq!(closed(Element::Plus, false, "|#|"), Picture::parse("|#|"));
        assert_eq!(closed(Element::Square, false, "|.|"), Picture::parse("|.|"));
        // One row: the rows beside it are outside, the gap of one closes.
        assert_eq!(closed(Element::Plus, false, "|..#.#....|"), Picture::parse("|..###....|"));
        // The pixel between a set one and the border closes, too: beyond the border counts as set.
        assert_eq!(closed(Element::Plus, false, "|.#.......|"), Picture::parse("|##.......|"));
        assert_eq!(closed(Element::Plus, false, "|..#......|"), Picture::parse("|..#......|"));
    }

    #[test]
    fn wraps_around() {
        // One row: the gap of one at column 0 lies between columns 7 and 1.
        assert_eq!(closed(Element::Plus, true, "|.#.....#|"), Picture::parse("|##.....#|"));
        assert_eq!(closed(Element::Plus, true, "|.#......|"), Picture::parse("|.#......|"));
        assert_eq!(closed(Element::Plus, true, "|#.|"), Picture::parse("|##|"));
        assert_eq!(closed(Element::Plus, true, "|#|\n|.|\n|#|"), Picture::parse("|#|\n|#|\n|#|"));
    }

    fn image() -> impl Strategy<Value = (Size, Vec<bool>)> {
        (1usize..8, 1usize..8, any::<bool>()).prop_flat_map(|(rows, columns, wraps)| {
            let bits = prop::collection::vec(any::<bool>(), rows * columns);
            (Just(Size { rows, columns, wraps }), bits)
        })
    }

    proptest! {
        /// What makes it a closing: it only adds, and doing it again adds nothing.
        #[test]
        fn extensive_and_idempotent((size, bits) in image(), square in any::<bool>()) {
            let element = if square { Element::Square } else { Element::Plus };
            let once = close(size, element, &bits);
            prop_assert!(bits.iter().zip(&once).all(|(before, after)| !before | after));
            prop_assert_eq!(&close(size, element, &once), &once);
        }
    }
}
