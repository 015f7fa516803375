"""The examples in docstrings and in the README."""

import doctest
import re
from pathlib import Path

import pytest

import scanseg._scenes
import scanseg._segment


@pytest.mark.parametrize("module", [scanseg._segment, scanseg._scenes])
def test_docstrings(module):
    results = doctest.testmod(module)
    assert results.attempted > 3 and results.failed == 0


@pytest.mark.parametrize(
    ("page", "at_least"), [("README.md", 1), ("../../docs/python.md", 10), ("../../docs/covariances.md", 10)]
)
def test_pages(page, at_least):
    text = (Path(__file__).parents[1] / page).read_text()
    (program,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(program, names)
    assert len(names["result"].segments) == names["result"].labels.max() >= at_least
