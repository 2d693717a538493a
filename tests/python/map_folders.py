"""Maps for tests: those in tests/maps, which the repository carries, and real ones, which it does not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

CARRIED_MAPS = Path(__file__).parents[1] / "maps"
"""Small generated maps with the traits of real ones; `make.py` there makes them."""

SHARED_MAPS = Path(__file__).parents[2] / ".." / "shared" / "maps"
"""Real maps beside the repository: NAME/map.yaml with its image. Tests that need them are skipped if they are absent."""

needs_real_maps = pytest.mark.skipif(
    not SHARED_MAPS.is_dir(), reason="real maps are not part of the repository: put them into ../shared/maps/NAME/map.yaml"
)


def maps(*, carried: list[str], real: list[str]) -> list[Any]:
    """YAML files as parameters of a test: carried maps by their folders, real maps by `FOLDER/FILE`."""
    return [
        *(pytest.param(CARRIED_MAPS / name / "map.yaml", id=name) for name in carried),
        *(pytest.param(SHARED_MAPS / name, id=name, marks=needs_real_maps) for name in real),
    ]
