//! Areas between edges, and their labels (paper, section 4).

use super::{Image, Size};

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// It has no return.
    NoReturn,
    /// It has one and is an edge in the closed edge image.
    Edge,
    /// It has one and lies in an area.
    Area,
}

/// The class of every pixel. Panics if there is not one bit per pixel.
pub fn classes(image: &Image, closed: &[bool]) -> Vec<Class> {
    assert_eq!(closed.len(), image.range_m.len(), "one bit per pixel");
    let class = |(pixel, &closed)| match (image.range(pixel), closed) {
        (None, _) => Class::NoReturn,
        (Some(_), true) => Class::Edge,
        (Some(_), false) => Class::Area,
    };
    image.size.pixels().zip(closed).map(class).collect()
}

/// The 4-connected components of area pixels, by flood fill: 1, 2, ... in scan order of their first
/// pixels, 0 where the pixel is in no area.
pub fn labels(size: Size, classes: &[Class]) -> Vec<u32> {
    let mut labels = vec![0; classes.len()];
    let mut last_label = 0;
    for start in size.pixels() {
        let unlabelled = |labels: &[u32], (row, column)| {
            let index = size.index(row, column);
            classes[index] == Class::Area && labels[index] == 0
        };
        if !unlabelled(&labels, start) {
            continue;
        }
        last_label += 1;
        let mut to_visit = vec![start];
        while let Some(pixel) = to_visit.pop() {
            if unlabelled(&labels, pixel) {
                labels[size.index(pixel.0, pixel.1)] = last_label;
                let neighbours = [(-1, 0), (0, -1), (0, 1), (1, 0)];
                to_visit.extend(neighbours.iter().filter_map(|&(down, right)| size.neighbour(pixel, down, right)));
            }
        }
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::art::{Picture, canonical};

    fn labelled(wraps: bool, art: &str) -> Picture {
        let picture = Picture::parse(art);
        let classes = picture.to_classes();
        let labels = labels(picture.size(wraps), &classes);
        assert_eq!(canonical(&labels), labels, "numbered in scan order");
        Picture::labels(picture.columns, &classes, &labels)
    }

    /// Two arms that meet only at the bottom, a third area between them, one within.
    #[test]
    fn u_shape() {
        let art = "
            |..#..#..|
            |..#..#..|
            |..####..|
            |........|
            |.#######|
            |.#. ....|";
        let expected = "
            |aa#bb#aa|
            |aa#bb#aa|
            |aa####aa|
            |aaaaaaaa|
            |a#######|
            |a#c dddd|";
        assert_eq!(labelled(false, art), Picture::parse(expected));
        // Cyclic: the last row's right end touches the U's left arm.
        let wrapped = "
            |aa#bb#aa|
            |aa#bb#aa|
            |aa####aa|
            |aaaaaaaa|
            |a#######|
            |a#c aaaa|";
        assert_eq!(labelled(true, art), Picture::parse(wrapped));
    }

    #[test]
    fn spiral() {
        let art = "
            |.......|
            |######.|
            |.....#.|
            |.###.#.|
            |.#...#.|
            |.#####.|
            |.......|";
        assert_eq!(labelled(false, art).to_string().replace('a', "."), Picture::parse(art).to_string());
    }

    /// Diagonal neighbours are not connected: every pixel is an area of its own.
    #[test]
    fn checkerboard() {
        let art = "
            |.#.#.|
            |#.#.#|
            |.#.#.|";
        let expected = "
            |a#b#c|
            |#d#e#|
            |f#g#h|";
        assert_eq!(labelled(false, art), Picture::parse(expected));
        // Cyclic with an odd number of columns: the first and the last one touch.
        let wrapped = "
            |a#b#a|
            |#c#d#|
            |e#f#e|";
        assert_eq!(labelled(true, art), Picture::parse(wrapped));
        assert_eq!(labelled(true, "|.#|\n|#.|"), Picture::parse("|a#|\n|#b|"));
    }

    /// No return separates as an edge does.
    #[test]
    fn no_return_separates() {
        assert_eq!(labelled(false, "|.. ..|\n|..#..|"), Picture::parse("|aa bb|\n|aa#bb|"));
        assert_eq!(labelled(false, "| |"), Picture::parse("| |"));
        assert_eq!(labelled(true, "|.|"), Picture::parse("|a|"));
    }

    #[test]
    fn classes_of_pixels() {
        let mut image = Image::new(Size { rows: 1, columns: 4, wraps: false }, vec![2.0, 0.0, 2.0, 9.0]);
        image.max_range_m = 5.0;
        let classes = classes(&image, &[true, true, false, false]);
        assert_eq!(Picture::classes(4, &classes), Picture::parse("|# . |"));
    }
}
