"""The examples in docstrings and in the README."""

import doctest
import re
from pathlib import Path

import numpy as np
import pytest

import scanseg._scenes
import scanseg._segment


@pytest.mark.parametrize("module", [scanseg._segment, scanseg._scenes])
def test_docstrings(module):
    results = doctest.testmod(module)
    assert results.attempted > 3 and results.failed == 0


def test_readme():
    text = (Path(__file__).parents[1] / "README.md").read_text()
    (program,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(program, names)
    assert names["result"].segments["pixels"].tolist() == [10860]
    assert np.all(names["result"].labels == 1)
