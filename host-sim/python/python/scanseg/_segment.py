"""Segmentation of whole images, and row by row."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from scanseg import _scanseg
from scanseg._result import Result, Rows, _result, _rows
from scanseg._scanseg import Beams

Approach = Literal["plane", "edge", "region"]
"""How a scan is segmented: by planes that go on from row to row (the default), by the paper's edges, or
by the paper's regions."""


def segment(
    ranges: ArrayLike,
    beams: Beams,
    *,
    noise: float | str | None = None,
    approach: Approach = "plane",
    unit_m: float | None = None,
    min_range_m: float | None = None,
    max_range_m: float | None = None,
    min_pixels: int = 30,
) -> Result:
    """Segment a range image.

    Parameters
    ----------
    ranges : (H, W) array
        Ranges along the beams; of pinhole beams with ``depth="z"``, depths along the camera's axis. Real
        numbers are metres unless `unit_m` is given. Up to 65535 x 16384.
    beams : Beams
        Where the pixels look.
    noise : float or str, optional
        Standard deviation of a range, metres, 0 to 10; or the name of a sensor, such as "kinect-v1" or
        "sick-lms200". Without it that of the beams counts, and where these say nothing the noise is
        measured in the scan (0.01 by edges and regions).
    approach : {"plane", "edge", "region"}
        How to segment.
    unit_m : float, optional
        Metres of one count, above 0. Whole numbers need it, unless the beams come from a geometry file.
    min_range_m, max_range_m : float, optional
        Nearer and farther ranges are no returns, metres. Without them the limits of the beams count, and
        where these have none 0.05 and 100.
    min_pixels : int
        Smaller segments are left out.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        A value that cannot be used, which the message names.

    Notes
    -----
    Takes some 0.1 microseconds a pixel, and releases the interpreter's lock meanwhile.

    Examples
    --------
    >>> import numpy as np, scanseg
    >>> beam_deg, turn_deg = np.linspace(-45, 45, 181), np.arange(-30, 30)
    >>> cosines = np.cos(np.radians(turn_deg))[:, None] * np.cos(np.radians(beam_deg))
    >>> wall = 2 / cosines  # 2 m ahead
    >>> result = scanseg.segment(wall, scanseg.Beams.nodding(beam_deg, turn_deg), noise=0.01)
    >>> result.segments["pixels"], result.segments["distance_m"].round(3)
    (array([10860], dtype=uint32), array([2.], dtype=float32))
    """
    return _result(_scanseg.segment(ranges, beams, noise, approach, unit_m, min_range_m, max_range_m, min_pixels))


def segment_depth(
    depth: ArrayLike,
    fx: float,
    fy: float,
    cx: float,
    cy: float,
    *,
    noise: float | str | None = None,
    approach: Approach = "plane",
    unit_m: float | None = None,
    min_range_m: float | None = None,
    max_range_m: float | None = None,
    min_pixels: int = 30,
) -> Result:
    """Segment a depth image.

    Parameters
    ----------
    depth : (H, W) array
        Depths along the camera's axis, row 0 at the top. Real numbers are metres unless `unit_m` is given.
        Lens distortion must have been taken out.
    fx, fy : float
        Focal lengths along a row and along a column, pixels.
    cx, cy : float
        Column and row of the optical axis, counted from 0, pixels.
    noise, approach, unit_m, min_range_m, max_range_m, min_pixels
        As of `segment`. Whole numbers need `unit_m`: 0.001 of most cameras, 1 / 5000 of TUM's images.

    Returns
    -------
    Result
        The camera looks along x; right is -y, down is -z.

    Raises
    ------
    ValueError
        A value that cannot be used, which the message names.
    """
    beams = Beams.pinhole(fx, fy, cx, cy, depth="z")
    return segment(
        depth,
        beams,
        noise=noise,
        approach=approach,
        unit_m=unit_m,
        min_range_m=min_range_m,
        max_range_m=max_range_m,
        min_pixels=min_pixels,
    )


def segment_cloud(
    xyz: ArrayLike,
    *,
    noise: float | str | None = None,
    approach: Approach = "plane",
    unit_m: float | None = None,
    min_range_m: float | None = None,
    max_range_m: float | None = None,
    min_pixels: int = 30,
) -> Result:
    """Segment an organised point cloud.

    Parameters
    ----------
    xyz : (H, W, 3) array
        Points in rows and columns as the scanner or camera saw them, from the origin; NaN, infinite,
        masked or (0, 0, 0) where nothing was measured. Metres unless `unit_m` is given. Beams of a
        scanner or camera are recognised; clouds in the axes of a camera (x right, y down, z forward) are
        turned.
    noise, approach, unit_m, min_range_m, max_range_m, min_pixels
        As of `segment`; `unit_m` is the metres of one unit of the coordinates.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        A value that cannot be used, which the message names.
    """
    return _result(_scanseg.segment_cloud(xyz, noise, approach, unit_m, min_range_m, max_range_m, min_pixels))


class Segmenter:
    """Segments a scan while its rows come in.

    Parameters
    ----------
    beams : Beams
        Where the pixels look. Nodding beams without ``turn_deg`` take the turn with each row.
    columns : int, optional
        Columns of a row, 1 to 16384. Needed where the beams do not tell.
    noise, approach, unit_m, min_range_m, max_range_m
        As of `segment`.

    Raises
    ------
    ValueError
        A value that cannot be used, which the message names.

    Examples
    --------
    >>> import numpy as np, scanseg
    >>> beam_deg, turn_deg = np.linspace(-45, 45, 181), np.arange(-30, 30)
    >>> wall = 2 / (np.cos(np.radians(turn_deg))[:, None] * np.cos(np.radians(beam_deg)))
    >>> segmenter = scanseg.Segmenter(scanseg.Beams.nodding(beam_deg, turn_deg), noise=0.01)
    >>> for found in segmenter.segments(wall):
    ...     print(found["pixels"], "pixels,", found["distance_m"].round(3), "m away")
    10860 pixels, 2.0 m away
    """

    def __init__(
        self,
        beams: Beams,
        columns: int | None = None,
        *,
        noise: float | str | None = None,
        approach: Approach = "plane",
        unit_m: float | None = None,
        min_range_m: float | None = None,
        max_range_m: float | None = None,
    ) -> None:
        self._rows = _scanseg.RowSegmenter(beams, columns, noise, approach, unit_m, min_range_m, max_range_m)

    @property
    def columns(self) -> int:
        """Columns of a row."""
        return self._rows.columns

    def push(self, ranges: ArrayLike, turn_deg: float | None = None) -> Rows:
        """Take the next row.

        Parameters
        ----------
        ranges : (W,) array
            Its ranges, as of `segment`.
        turn_deg : float, optional
            The turn of a nodding scanner, degrees, in place of that of the beams.

        Returns
        -------
        Rows
            The labels of the row that is now decided, and the joins and segments that it brings.

        Raises
        ------
        ValueError
            A row of another length, or one more than the beams have. The segmenter is as it was before.
        """
        return _rows(self._rows.push(ranges, turn_deg))

    def finish(self) -> Rows:
        """End the scan: complete all segments. The next row is the first of a new scan.

        Returns
        -------
        Rows
        """
        return _rows(self._rows.finish())

    def segments(self, rows: Iterable[ArrayLike]) -> Iterator[np.void]:
        """Segment a scan, and yield each segment as soon as it is complete.

        Parameters
        ----------
        rows : iterable of (W,) arrays
            Its rows, as they come; or pairs of a row and its turn in degrees, where the beams have no
            ``turn_deg``.

        Yields
        ------
        numpy.void
            A segment; the fields are those of `SEGMENT`. One that goes on behind what hides a part of it
            comes again under its label, and counts in place of the former.
        """
        for row in rows:
            ranges, turn_deg = row if isinstance(row, tuple) else (row, None)
            yield from self.push(ranges, turn_deg).segments
        yield from self.finish().segments
