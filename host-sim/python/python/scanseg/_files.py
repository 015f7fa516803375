"""Files with scans."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scanseg import _scanseg

if TYPE_CHECKING:
    from scanseg._scanseg import Beams


@dataclass(frozen=True)
class Scan:
    """A scan of a file.

    Attributes
    ----------
    name : str
        What messages call it.
    ranges : (H, W) float32
        Ranges along the beams, metres; 0 without a return.
    beams : Beams
        Where the pixels look, and what the file states of limits and noise.
    remarks : list of str
        What its reader took it for, where the file does not say it.
    """

    name: str
    ranges: NDArray[np.float32]
    beams: Beams
    remarks: list[str]


def read(
    path: str | PathLike[str],
    frame: int = 0,
    *,
    geometry: str | PathLike[str] | None = None,
    unit_m: float | None = None,
    fx: float | None = None,
    fy: float | None = None,
    cx: float | None = None,
    cy: float | None = None,
    topic: str | None = None,
) -> Scan:
    """Read a scan of a file.

    Parameters
    ----------
    path : path
        The file.
    frame : int
        Which of its scans, from 0 on; negative ones count from the end.
    geometry, unit_m, fx, fy, cx, cy, topic
        As of `ScanFile`.

    Returns
    -------
    Scan
        For ``segment(scan.ranges, scan.beams)``.

    Raises
    ------
    IndexError
        A frame that the file does not have.
    OSError
        A file that cannot be read.
    ValueError
        A file that has no scan, or that is not as its format says.
    """
    file = _scanseg.ScanFile(path, geometry=geometry, unit_m=unit_m, fx=fx, fy=fy, cx=cx, cy=cy, topic=topic)
    return file[frame]
