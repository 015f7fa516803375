"""Where recorded scans and the command are."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

PROJECT = Path(__file__).resolve().parents[3]
SHARED = PROJECT.parent / "shared"


@pytest.fixture(scope="session")
def command():
    """Return a function that runs the command; `SCANSEG` is its path."""
    program = os.environ.get("SCANSEG")
    if not program:
        pytest.skip("SCANSEG does not say where the command is")

    def run(*arguments):
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def recorded():
    """Return a function from a name in ../shared to its path."""

    def find(name):
        path = SHARED / name
        if not path.exists():
            pytest.skip(f"no recorded scan {name}")
        return path

    return find


@pytest.fixture
def room():
    """Return beams, and the ranges of a corner: two walls and a floor."""
    import scanseg

    beam_deg, turn_deg = np.linspace(-60, 60, 121), np.linspace(20, -40, 61)
    beams = scanseg.Beams.nodding(beam_deg, turn_deg)
    x, y, z = np.moveaxis(beams.points(np.ones((61, 121))), 2, 0)
    with np.errstate(divide="ignore"):
        walls = [3 / np.maximum(x, 0), 1.5 / np.maximum(y, 0), 1.2 / np.maximum(-z, 0)]
    return beams, np.minimum.reduce(walls)
