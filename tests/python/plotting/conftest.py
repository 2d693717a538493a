"""Fixtures of the tests of plotting."""

from collections.abc import Iterator

import matplotlib
import pytest
from matplotlib import pyplot


@pytest.fixture
def agg() -> Iterator[None]:
    """Pyplot without a display; closes all figures at the end."""
    before = matplotlib.get_backend()
    pyplot.switch_backend("agg")
    yield
    pyplot.close("all")
    pyplot.switch_backend(before)
