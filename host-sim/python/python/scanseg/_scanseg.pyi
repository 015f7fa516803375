from os import PathLike
from typing import Any, Literal, TypedDict, final, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scanseg._files import Scan

__all__ = [
    "Beams",
    "RowSegmenter",
    "ScanFile",
    "SegmentedScan",
    "evaluate",
    "office",
    "read_labels",
    "segment",
    "segment_cloud",
    "write_labels",
    "write_ranges",
]

@type_check_only
class Found(TypedDict):
    columns: dict[str, Any]
    polygons: list[NDArray[np.float64]]
    labels: NDArray[np.uint32]
    edges: NDArray[np.bool_]
    ranges: NDArray[np.float32]
    noise_m: float | None
    noise_range_m: float | None
    unlabelled: int
    beams: Beams
    files: SegmentedScan

@type_check_only
class FoundRows(TypedDict):
    first_row: int | None
    labels: NDArray[np.uint32]
    joins: NDArray[np.uint32]
    columns: dict[str, Any]

@final
class Beams:
    @staticmethod
    def nodding(
        beam_deg: ArrayLike,
        turn_deg: ArrayLike | None = None,
        axis: Literal["y", "z"] = "y",
        *,
        column_offset_deg: ArrayLike | None = None,
        lever_arm_m: float = 0.0,
    ) -> Beams: ...
    @staticmethod
    def spinning(
        azimuth_deg: ArrayLike,
        elevation_deg: ArrayLike,
        *,
        wraps: bool = True,
        row_offset_deg: ArrayLike | None = None,
    ) -> Beams: ...
    @staticmethod
    def pinhole(fx: float, fy: float, cx: float, cy: float, *, depth: Literal["z", "range"] = "z") -> Beams: ...
    @staticmethod
    def free(directions: ArrayLike, *, wraps: bool = False) -> Beams: ...
    @staticmethod
    def read(path: str | PathLike[str]) -> Beams: ...
    @staticmethod
    def from_toml(text: str) -> Beams: ...
    def to_toml(self) -> str: ...
    @property
    def kind(self) -> Literal["nodding", "spinning", "pinhole", "free"]: ...
    @staticmethod
    def _unpickled(
        toml: str, has_unit: bool, no_turns: bool, directions: ArrayLike | None, wraps: bool
    ) -> Beams: ...
    def points(self, ranges: ArrayLike) -> NDArray[np.float64]: ...

@final
class ScanFile:
    def __new__(
        cls,
        path: str | PathLike[str],
        *,
        geometry: str | PathLike[str] | None = None,
        unit_m: float | None = None,
        fx: float | None = None,
        fy: float | None = None,
        cx: float | None = None,
        cy: float | None = None,
        topic: str | None = None,
    ) -> ScanFile: ...
    def __len__(self) -> int: ...
    def __getitem__(self, n: int, /) -> Scan: ...

@final
class RowSegmenter:
    def __new__(
        cls,
        beams: Beams,
        columns: int | None,
        noise: float | str | None,
        approach: str,
        unit_m: float | None,
        min_range_m: float | None,
        max_range_m: float | None,
    ) -> RowSegmenter: ...
    def push(self, ranges: ArrayLike, turn_deg: float | None) -> FoundRows: ...
    def finish(self) -> FoundRows: ...
    @property
    def columns(self) -> int: ...

@final
class SegmentedScan:
    def write_points(self, path: str | PathLike[str]) -> None: ...
    def write_outlines(self, path: str | PathLike[str]) -> None: ...

def segment(
    ranges: ArrayLike,
    beams: Beams,
    noise: float | str | None,
    approach: str,
    unit_m: float | None,
    min_range_m: float | None,
    max_range_m: float | None,
    min_pixels: int,
) -> Found: ...
def segment_cloud(
    xyz: ArrayLike,
    noise: float | str | None,
    approach: str,
    unit_m: float | None,
    min_range_m: float | None,
    max_range_m: float | None,
    min_pixels: int,
) -> Found: ...
def evaluate(
    labels: ArrayLike, truth: ArrayLike, tolerance: float, min_pixels: int
) -> dict[str, Any]: ...
def office(
    scene: int, set: str, sensor: str, shape: tuple[int, int] | None, noise_m: float, seed: int
) -> dict[str, Any]: ...
def read_labels(path: str | PathLike[str]) -> NDArray[np.uint16]: ...
def write_labels(path: str | PathLike[str], labels: ArrayLike) -> None: ...
def write_ranges(
    path: str | PathLike[str], ranges: ArrayLike, beams: Beams, *, unit_m: float = 0.001
) -> None: ...
