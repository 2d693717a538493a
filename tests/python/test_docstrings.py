"""docstrings: every class and function of the core has one, its examples run, and its signature shows the real defaults."""

from __future__ import annotations

import doctest
import importlib
import inspect
import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import _core


def documented() -> Iterator[tuple[str, Any]]:
    """Every public object of the core, with its dotted name."""
    yield "_core", _core
    for name in _core.__all__:
        thing = getattr(_core, name)
        if not callable(thing):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for member in sorted(vars(thing)):
                if not member.startswith("_"):
                    yield f"{name}.{member}", getattr(thing, member)


DOCUMENTED = dict(documented())
CALLABLE = [name for name, thing in DOCUMENTED.items() if callable(thing)]
# `prepare` has no visible effect that an example could show.
WITHOUT_EXAMPLE = {"OccupancyGrid.prepare"}


@pytest.mark.parametrize("name", DOCUMENTED)
def test_there_is_a_docstring_whose_first_line_is_a_sentence(name: str) -> None:
    first, *rest = inspect.cleandoc(DOCUMENTED[name].__doc__ or "").split("\n")
    assert first[:1].isupper() and first.endswith(".") and (not rest or rest[0] == "")


@pytest.mark.parametrize("name", CALLABLE)
def test_examples_run(name: str) -> None:
    examples = doctest.DocTestParser().get_doctest(inspect.cleandoc(DOCUMENTED[name].__doc__), {}, name, None, None)
    assert bool(examples.examples) is (name not in WITHOUT_EXAMPLE)
    report: list[str] = []
    with np.printoptions(precision=6, suppress=True, floatmode="maxprec", linewidth=100):
        doctest.DocTestRunner(verbose=False).run(examples, out=report.append)
    assert not report, "".join(report)


@pytest.mark.parametrize("name", CALLABLE)
def test_every_parameter_is_described(name: str) -> None:
    lines = inspect.cleandoc(DOCUMENTED[name].__doc__).split("\n")
    for parameter in inspect.signature(DOCUMENTED[name]).parameters:
        assert parameter == "self" or any(line.startswith(f"    {parameter}: ") for line in lines), parameter


@pytest.mark.parametrize(
    "made",
    [
        _core.BeamModel(),
        _core.LaserScanner(),
        _core.Limits(),
        _core.MotionNoise(),
        _core.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0),
        _core.Pose(),
        _core.SurfaceModel(),
    ],
    ids=lambda made: type(made).__name__,
)
def test_signatures_show_the_real_defaults(made: Any) -> None:
    shown = {
        name: parameter.default
        for name, parameter in inspect.signature(type(made)).parameters.items()
        if parameter.default is not parameter.empty
    }
    assert shown
    real = {f"alpha{number}": value for number, value in enumerate(getattr(made, "alpha", ()), 1)}
    for name, value in shown.items():
        found = real[name] if name in real else getattr(made, name)
        # None means that another argument says it.
        assert value is None or (tuple(found) if isinstance(found, _core.Pose) else found) == value, name


PACKAGE = Path(mrs.__file__).parent
WITH_EXAMPLES = [
    ".".join(("mobile_robot_simulator", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
    for path in sorted(PACKAGE.rglob("*.py"))
    if ">>>" in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_of_python_modules_run(name: str) -> None:
    tests = [test for test in doctest.DocTestFinder().find(importlib.import_module(name)) if test.examples]
    assert tests
    report: list[str] = []
    for test in tests:
        doctest.DocTestRunner(verbose=False).run(test, out=report.append)
    assert not report, "".join(report)


def test_the_stub_has_the_docstrings_of_the_core() -> None:
    """After a change of a docstring in Rust, run `python docs/tools/stub_docstrings.py`."""
    tool = Path(__file__).parents[2] / "docs" / "tools" / "stub_docstrings.py"
    names = runpy.run_path(str(tool))
    stub = names["STUB"].read_text(encoding="utf-8")
    assert names["with_docstrings"](stub) == stub
    assert "Returns the true ranges of one scan, without noise." in stub
