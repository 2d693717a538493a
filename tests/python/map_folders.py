"""Maps for tests: generated maps in tests/maps, which are part of the repository, and real maps, which are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

CARRIED_MAPS = Path(__file__).parents[1] / "maps"
"""Small generated maps with the features of real ones. `make.py` in this folder generates them."""

SHARED_MAPS = Path(__file__).parents[2] / ".." / "shared" / "maps"
"""Real maps next to the repository, as NAME/map.yaml with an image. Without them, the tests that need them are skipped."""

needs_real_maps = pytest.mark.skipif(
    not SHARED_MAPS.is_dir(), reason="real maps are not part of the repository: put them into ../shared/maps/NAME/map.yaml"
)


def maps(*, carried: list[str], real: list[str]) -> list[Any]:
    """Returns YAML files as test parameters. `carried` are folders in tests/maps; `real` are paths `FOLDER/FILE`."""
    return [
        *(pytest.param(CARRIED_MAPS / name / "map.yaml", id=name) for name in carried),
        *(pytest.param(SHARED_MAPS / name, id=name, marks=needs_real_maps) for name in real),
    ]
