"""Simulated offices, and evaluation against the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scanseg import _scanseg
from scanseg._scanseg import Beams


@dataclass(frozen=True)
class Hoover:
    """How well labels match the truth, by the classes of Hoover et al. (1996).

    Attributes
    ----------
    tolerance : float
        Part of its pixels that a region must share.
    truth_regions, segments : int
        Regions of the truth, and of the labels.
    correct : int
        Correct detections.
    over_segmented, under_segmented : int
        Regions of the truth in several segments; segments over several regions of the truth.
    missed, noise : int
        Regions of the truth, and segments, that are in none of these.
    """

    tolerance: float
    truth_regions: int
    segments: int
    correct: int
    over_segmented: int
    under_segmented: int
    missed: int
    noise: int


def evaluate(labels: ArrayLike, truth: ArrayLike, *, tolerance: float = 0.8, min_pixels: int = 1) -> Hoover:
    """Compare labels with the truth.

    Parameters
    ----------
    labels, truth : (H, W) arrays of whole numbers
        A region a number, 1 to 65535; 0 is no region.
    tolerance : float
        Part of its pixels that a region must share, above 0.5, up to 1.
    min_pixels : int
        Regions of fewer pixels count as no region, in both.

    Returns
    -------
    Hoover

    Raises
    ------
    ValueError
        Arrays of different shapes, a label or a tolerance out of range.
    """
    return Hoover(**_scanseg.evaluate(labels, truth, tolerance, min_pixels))


@dataclass(frozen=True)
class Office:
    """A scan of a simulated office.

    Attributes
    ----------
    ranges : (H, W) float32
        Ranges along the beams, metres; 0 without a return.
    truth : (H, W) uint16
        The surface of each pixel, from 1 on with gaps; 0 without a return.
    beams : Beams
        Where the pixels look, as far as the scanner knows.
    """

    ranges: NDArray[np.float32]
    truth: NDArray[np.uint16]
    beams: Beams


def office(
    scene: int,
    *,
    set: Literal["tuning", "validation"] = "tuning",
    sensor: Literal["nodding", "spinning", "pinhole"] = "nodding",
    shape: tuple[int, int] | None = None,
    noise_m: float = 0.0,
    seed: int = 0,
) -> Office:
    """Scan a simulated office.

    Parameters
    ----------
    scene : int
        Which one: 0 to 24; from 25 on further ones of the same kinds.
    set : {"tuning", "validation"}
        Which of the two sets of scenes.
    sensor : {"nodding", "spinning", "pinhole"}
        The scanner: one that nods, one that spins, a depth camera.
    shape : (int, int), optional
        Rows and columns; 200 x 361, 128 x 1024 and 240 x 320.
    noise_m : float
        Standard deviation of one range, metres.
    seed : int
        Another one gives other errors.

    Returns
    -------
    Office
        The same on every platform.

    Raises
    ------
    ValueError
        A value that is out of range.

    Examples
    --------
    >>> import scanseg
    >>> office = scanseg.office(3, noise_m=0.01)
    >>> result = scanseg.segment(office.ranges, office.beams)
    >>> scanseg.evaluate(result.labels, office.truth, min_pixels=30).correct
    8
    """
    return Office(**_scanseg.office(scene, set, sensor, shape, noise_m, seed))
