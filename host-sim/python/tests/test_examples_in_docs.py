"""The examples in docstrings."""

import doctest

import scanseg._segment


def test_docstrings():
    results = doctest.testmod(scanseg._segment)
    assert results.attempted > 5 and results.failed == 0
