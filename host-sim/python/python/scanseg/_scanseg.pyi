from os import PathLike
from typing import Any, Literal, TypedDict, final, type_check_only

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Beams", "RowSegmenter", "segment", "segment_cloud"]

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
    def points(self, ranges: ArrayLike) -> NDArray[np.float64]: ...

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
