"""Flat surfaces in range images, depth images and organised point clouds.

`segment`, `segment_depth` and `segment_cloud` take a whole image, `Segmenter` takes rows one at a
time. Coordinates are metres in the scanner's frame: x forward, y left, z up.

Arrays come in as float32, float64 or whole numbers, in C or Fortran order, masked or not. What is
masked, NaN, infinite, or not above 0 is a pixel without a return. A value that cannot be used raises
`ValueError`, which names it.
"""

from scanseg._files import Scan, read
from scanseg._result import SEGMENT, Result, Rows
from scanseg._scanseg import Beams, ScanFile, read_labels, write_labels, write_ranges
from scanseg._scenes import Hoover, Office, evaluate, office
from scanseg._segment import Approach, Segmenter, segment, segment_cloud, segment_depth

__all__ = [
    "SEGMENT",
    "Approach",
    "Beams",
    "Hoover",
    "Office",
    "Result",
    "Rows",
    "Scan",
    "ScanFile",
    "Segmenter",
    "evaluate",
    "office",
    "read",
    "read_labels",
    "segment",
    "segment_cloud",
    "segment_depth",
    "write_labels",
    "write_ranges",
]
