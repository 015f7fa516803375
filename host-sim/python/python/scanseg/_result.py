"""What comes out."""

from __future__ import annotations

from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from scanseg._scanseg import Beams

if TYPE_CHECKING:
    from scanseg._scanseg import Found, FoundRows, SegmentedScan

SEGMENT = np.dtype(
    [
        ("label", "u4"),
        ("pixels", "u4"),
        ("first_row", "u2"),
        ("last_row", "u2"),
        ("first_column", "u2"),
        ("last_column", "u2"),
        ("normal", "f4", (3,)),
        ("distance_m", "f4"),
        ("rms_m", "f4"),
        ("covariance", "f4", (4, 4)),
    ]
)
"""A segment.

label
    Its value in the labels.
pixels
    Number of its pixels.
first_row, last_row, first_column, last_column
    Its bounds, all inclusive.
normal, distance_m
    Its plane: the points p with ``normal @ p + distance_m == 0``. The normal is a unit vector towards
    the scanner, the distance is not negative, metres. NaN where it has no plane, as in a single row.
rms_m
    Root of the mean squared distance of its points from the plane, metres.
covariance
    Covariance of (normal x, y, z, distance), in rad^2, rad m and m^2. Symmetric, and of rank 3, because
    the normal stays a unit vector.
"""

_WHOLE_SEGMENT = np.dtype(
    [
        *((name, SEGMENT[name]) for name in SEGMENT.names or ()),
        ("residual_per_noise", "f4"),
        ("planarity", "U9"),
        ("area_m2", "f8"),
    ]
)


@dataclass(frozen=True)
class Result:
    """All that is found in a scan of H rows x W columns.

    Attributes
    ----------
    labels : (H, W) uint32
        The segment of each pixel: 1 for the one with the most pixels, 2, 3, ...; 0 for none.
    edges : (H, W) bool
        Pixels with a return that are in no segment for the sake of edges (approach "edge"), on no line
        ("region"), or on no plane ("plane").
    ranges : (H, W) float32
        Ranges along the beams as they were used, metres; 0 without a return.
    segments : (N,) structured
        The segments of at least `min_pixels` pixels. Segment n, counted from 1, is ``segments[n - 1]``.
        The fields are those of `SEGMENT`, and ``residual_per_noise`` (`rms_m` over what the noise alone
        makes it: about 1 of a plane), ``planarity`` ("planar", "rough" or "uncertain") and ``area_m2``
        (of the polygon, square metres).
    polygons : list of N arrays (K, 3) float64
        The convex hull of each segment in its plane, metres, anticlockwise as seen from the scanner; no
        corners without a plane.
    noise_m : float or None
        Standard deviation of a range that counted at `noise_range_m`, metres: the larger of that stated
        and that measured. None by edges and regions, which take what is stated.
    noise_range_m : float or None
        The median range, metres.
    beam_stretch : float
        The share by which the beam angles of a tilting or panning scanner were found to be too small: 0.01
        where a beam said to be 30 deg from the middle is 30.3 deg from it. The planes are those along the
        beams so found. 0 where they are right, or nothing tells.
    unlabelled : int
        Pixels that got no label for want of room.
    beams : Beams
        The beams, with the noise and the unit that were used.
    """

    labels: NDArray[np.uint32]
    edges: NDArray[np.bool_]
    ranges: NDArray[np.float32]
    segments: NDArray[np.void]
    polygons: list[NDArray[np.float64]]
    noise_m: float | None
    noise_range_m: float | None
    beam_stretch: float
    unlabelled: int
    beams: Beams
    _files: SegmentedScan | None = field(repr=False, compare=False)

    def __reduce__(self) -> tuple[Any, ...]:
        # what files are written from stays behind
        fields = {name: value for name, value in vars(self).items() if name != "_files"}
        return _unpickled, (fields,)

    def write_points(self, path: str | PathLike[str]) -> None:
        """Write the points with colours and labels: NAME.ply or NAME.pcd, organised.

        Raises
        ------
        ValueError
            Another ending, or a result that was pickled.
        """
        self._written_from().write_points(path)

    def write_outlines(self, path: str | PathLike[str]) -> None:
        """Write the polygons with their planes: NAME.ply, .csv, .json or .geojson (docs/formats.md).

        Raises
        ------
        ValueError
            Another ending, or a result that was pickled.
        """
        self._written_from().write_outlines(path)

    def _written_from(self) -> SegmentedScan:
        if self._files is None:
            raise ValueError("a result that was pickled writes no files")
        return self._files

    def points(self) -> NDArray[np.float64]:
        """Return the points of the pixels.

        Returns
        -------
        (H, W, 3) float64
            Metres, x forward, y left, z up; NaN without a return.
        """
        return self.beams.points(self.ranges)


@dataclass(frozen=True)
class Rows:
    """What came of a row, or of the end of a scan.

    Attributes
    ----------
    first_row : int or None
        Number of the row that ``labels[0]`` is of; None if no row was decided.
    labels : (N, W) uint32
        The segment of each pixel of the rows that were decided; 0 for none. By edges a row is decided
        three rows later.
    joins : (M, 2) uint32
        Labels that turned out to be one: pixels of ``joins[i, 0]`` belong to ``joins[i, 1]`` from now on,
        and a segment that had the former label is void.
    segments : (N,) structured
        Segments that are complete; the fields are those of `SEGMENT`. One whose label came before is
        reported again, and counts in place of the former.
    """

    first_row: int | None
    labels: NDArray[np.uint32]
    joins: NDArray[np.uint32]
    segments: NDArray[np.void]


def _structured(columns: dict[str, Any], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    array = np.empty(len(columns["label"]), dtype)
    for name in dtype.names or ():
        array[name] = columns[name]
    return array


def _result(found: Found) -> Result:
    segments = _structured(found.pop("columns"), _WHOLE_SEGMENT)  # type: ignore[misc]
    return Result(segments=segments, _files=found.pop("files"), **found)  # type: ignore[misc]


def _unpickled(fields: dict[str, Any]) -> Result:
    return Result(**fields, _files=None)


def _rows(found: FoundRows) -> Rows:
    segments = _structured(found.pop("columns"), SEGMENT)  # type: ignore[misc]
    return Rows(segments=segments, **found)  # type: ignore[misc]
