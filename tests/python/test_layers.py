"""layers: a room (a module or folder of the package) imports only rooms that come before it in `ROOMS`."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs

PACKAGE = Path(mrs.__file__).parent

ROOMS = (
    "_core",
    "quoting",
    "user_files",
    "new_files",
    "yaml_documents",
    "messages",
    "message_recipe",
    "marker_messages",
    "entity_messages",
    "instant",
    "handle",
    "worker_pool",
    "parameters",
    "scanners",
    "namespaces",
    "nav2_loopback_names",
    "parameter_files",
    "maps",
    "localization",
    "plotting",
    "physics",
    "nodes",
    "bus",
    "ros",
    "simulation",
    "faults",
    "requirements",
    "drivers",
    "scenarios",
    "learning",
    "benchmarks",
    "recording",
    "foxglove",
    "falsification",
    "logs",
    "audit",
    "compare",
    "live",
    "datasets",
    "testing",
    "cli",
)
"""Modules and folders of the package, from the lowest layer to the highest."""

SIDE_BY_SIDE = ({"bus", "ros"},)
"""Sets of rooms that must not import each other in either direction."""

UPWARD = {("simulation/simulation.py", "live")}
"""Imports of a room above, inside functions: `Simulation.show` opens a view of the simulation itself."""

LEAVES = {"foxglove", "learning", "live", "plotting", "recording"}
"""Rooms that need an optional dependency. They are imported only inside functions or under TYPE_CHECKING."""

NEEDS_NO_EXTRA = {"recording.format"}
"""Modules of these rooms that need no extra, so they may be imported anywhere."""

FACADE = {"__init__", "__main__"}
"""Modules of the package itself. They may import every room."""


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_rooms(path: Path) -> list[tuple[str, ast.ImportFrom]]:
    """Rooms from which a file imports, each with the import statement."""
    package = ("mobile_robot_simulator", *path.relative_to(PACKAGE).parent.parts)
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom):
            assert not (isinstance(node, ast.Import) and any("mobile_robot_simulator" in alias.name for alias in node.names))
            continue
        if not node.level:
            assert not (node.module or "").startswith("mobile_robot_simulator"), f"{path}: imports must be relative"
            continue
        base = package[: len(package) - node.level + 1]
        module = [*base, *(node.module.split(".") if node.module else [])][1:]
        found += [(name, node) for name in ([module[0]] if module else [alias.name for alias in node.names])]
    return [(name, node) for name, node in found if name != "__version__"]


def files() -> list[Path]:
    return [path for path in sorted(PACKAGE.rglob("*.py")) if room_of(path) not in FACADE]


def test_every_room_has_its_place() -> None:
    assert {room_of(path) for path in files()} == {*ROOMS} - {"_core"}


@pytest.mark.parametrize("path", files(), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_one_way(path: Path) -> None:
    own = room_of(path)
    for name, node in imported_rooms(path):
        if (str(path.relative_to(PACKAGE)), name) in UPWARD:
            continue
        assert ROOMS.index(name) <= ROOMS.index(own), f"line {node.lineno}: {own} must not import {name}"
        assert name == own or not any({own, name} <= pair for pair in SIDE_BY_SIDE), (
            f"line {node.lineno}: {own} imports {name}"
        )


@pytest.mark.parametrize("path", files(), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_modules_of_a_room_import_each_other_one_way(path: Path) -> None:
    """The modules of a room have no import cycle, even if imports for type annotations count."""
    seen: set[Path] = set()
    waiting = [path]
    while waiting:
        for other in modules_imported(waiting.pop()):
            assert other != path, f"{path.relative_to(PACKAGE)} imports itself through other modules"
            if other not in seen:
                seen.add(other)
                waiting.append(other)


@cache
def modules_imported(path: Path) -> list[Path]:
    """Files of the package from which a file imports."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            folder = path.parents[node.level - 1].joinpath(*(node.module.split(".") if node.module else []))
            candidates = [folder / alias.name for alias in node.names] + [folder]
            found += [
                file for each in candidates for file in (each.with_suffix(".py"), each / "__init__.py") if file.is_file()
            ]
    own = str(path.relative_to(PACKAGE))
    return [file for file in found if file != PACKAGE / "__init__.py" and (own, room_of(file)) not in UPWARD]


def test_leaves_are_imported_when_they_are_needed() -> None:
    """No module imports a leaf outside functions except under TYPE_CHECKING, because extras are optional."""
    for path in files():
        eager = lines_of_eager_imports(ast.parse(path.read_text(encoding="utf-8")).body)
        for name, node in imported_rooms(path):
            if node.module not in NEEDS_NO_EXTRA and name in LEAVES and room_of(path) != name:
                assert node.lineno not in eager, f"{path}, line {node.lineno}"


def lines_of_eager_imports(nodes: Iterable[ast.AST]) -> set[int]:
    """Lines of the imports that run when the module is imported: outside functions and not under TYPE_CHECKING."""
    lines: set[int] = set()
    for node in nodes:
        if isinstance(node, ast.ImportFrom):
            lines.add(node.lineno)
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            lines |= lines_of_eager_imports(node.orelse)
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            lines |= lines_of_eager_imports(ast.iter_child_nodes(node))
    return lines


TESTED_ELSEWHERE = {
    "audit/odometry.py": "audit/test_auditor.py breaks each rule",
    "audit/poses.py": "audit/test_auditor.py breaks each rule",
    "audit/scans.py": "audit/test_auditor.py breaks each rule",
    "audit/stamps.py": "audit/test_auditor.py breaks each rule",
    "audit/transforms.py": "audit/test_auditor.py breaks each rule",
    "benchmarks/control_loop.py": "benchmarks/test_trials.py and falsification/test_drive.py drive with it",
    "cli/falsify.py": "falsification/test_counterexample.py runs the command",
    "cli/console.py": "the tests of each command read what it prints",
    "cli/ros.py": "needs ROS: tests/ros",
    "cli/summary.py": "cli/test_drive.py reads the summary of a drive",
    "learning/actions.py": "learning/test_vector_environment.py gives bad ones to both environments",
    "learning/frame.py": "learning/test_environment.py and test_vector_environment.py look at the pixels",
    "learning/spaces.py": "learning/test_environment.py runs Gymnasium's check of the spaces",
    "learning/stable_baselines3.py": "needs Stable-Baselines3: tests/torch",
    "live/page_view.py": "live/test_view.py and live/test_replay_view.py run what is derived from it",
    "live/page.py": "tests/browser looks at the page in a real browser",
    "live/server.py": "live/test_view.py talks to it, and tests/browser with a real browser",
    "datasets/engines.py": "datasets/test_generation.py compares what they make",
    "datasets/ray_engine.py": "needs Ray: tests/ray",
    "datasets/formats.py": "datasets/test_reader.py opens what is no data set",
    "datasets/episodes.py": "datasets/test_export.py compares episodes with the data set",
    "datasets/minari_export.py": "datasets/test_export.py opens it with Minari",
    "datasets/lerobot_export.py": "needs LeRobot: tests/torch",
    "maps/floor_plans": "maps/test_floor_plans.py checks the plans that its modules draw together",
    "maps/cell_map.py": "maps/test_formats.py gives good and bad sizes of cells",
    "maps/drawing.py": "maps/test_svg.py and test_dxf.py draw with it",
    "maps/map_image.py": "maps/test_map_files.py reads every encoding through load_map",
    "maps/xml_document.py": "maps/test_sdf_world.py and test_svg.py read good and bad documents",
    "foxglove/listener.py": "foxglove/test_server.py calls it through a real client",
    "entity_messages.py": "nodes/test_entity_services.py sends and receives them",
    "falsification/comparison.py": "falsification/test_estimation.py compares controllers",
    "marker_messages.py": "nodes/test_world_server.py sends and receives them",
    "nodes/interface.py": "protocols only",
    "nodes/laser_messages.py": "nodes/test_laser.py reads the messages",
    "nodes/robot_messages.py": "nodes/test_robot_output.py reads the messages",
    "plotting/layers.py": "plotting/test_grid.py, test_scan.py and test_drive.py look at the pixels",
    "plotting/style.py": "plotting/test_grid.py, test_scan.py and test_drive.py look at the pixels",
    "recording/complete_messages.py": "recording/test_recovery.py cuts files of each format",
    "recording/format.py": "a type only",
    "recording/latching.py": "recording/test_ros1_bag.py and test_ros2_bag.py read the bags",
    "ros/ros1.py": "needs ROS: tests/ros",
    "ros/ros2.py": "needs ROS: tests/ros",
}
"""Modules, or folders of modules, without a test of their stem, and why."""


def test_every_module_has_a_test_of_its_stem_or_a_reason() -> None:
    here = Path(__file__).parent
    without = {
        str(path.relative_to(PACKAGE))
        for path in files()
        if path.name != "__init__.py" and not (here / path.relative_to(PACKAGE).parent / f"test_{path.name}").exists()
    }
    named = {next((each for each in TESTED_ELSEWHERE if name.startswith(each)), name) for name in without}
    assert named == set(TESTED_ELSEWHERE)
