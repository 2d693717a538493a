"""Arguments and options that several commands share, and functions that read their values.

What reads values is imported by the functions, because the help pages need only the options.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .._core import OccupancyGrid, Pose
from .console import print_note

if TYPE_CHECKING:
    from ..faults import Fault

MapFile = Annotated[
    Path, typer.Argument(metavar="MAP", help="Map file: the YAML file of map_server, or a world in another format.")
]
Resolution = Annotated[
    float | None, typer.Option(help="Cell size of a world in metres. Without it, the usual one of the format is used.")
]
Unit = Annotated[
    float | None,
    typer.Option(help="Length of a unit of a drawing, SVG or DXF, in metres. Without it: that of a DXF file, or 1."),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option("-p", "--param", metavar="NAME:=VALUE", help="Set a parameter. Can be given several times."),
]
ParamsFile = Annotated[Path | None, typer.Option("--params-file", metavar="FILE", help="ROS 2 parameter file in YAML.")]
RosArgs = Annotated[
    bool, typer.Option("--ros-args", help="Accepted before -p and --params-file, as in ROS 2. It has no effect.")
]
FaultTexts = Annotated[
    list[str] | None,
    typer.Option(
        "--fault",
        metavar="FAULT",
        help="Add a fault, such as \"Drop('/scan', probability=0.1)\". Can be given several times.",
    ),
]
Seed = Annotated[
    int | None, typer.Option(help="Random seed. Without it, the parameter seed is used, which is 0 by default.")
]


def read_values(assignments: list[str] | None, file: Path | None) -> dict[str, Any]:
    """Returns parameter values by name. Assignments on the command line override the file.

    Raises:
        OSError: The file cannot be read.
        ValueError: An assignment or the file is malformed, or names an unknown parameter.
    """
    from ..parameter_files import read_assignment, read_file, translated

    values = read_file(file) if file is not None else {}
    assigned = dict(map(read_assignment, assignments or []))
    kept = {key: value for key, value in values.items() if key.rpartition(":")[2] not in assigned}
    return translated({**kept, **assigned})


def read_faults(texts: Iterable[str] | None, others: Iterable[str] = ()) -> list[Fault]:
    """Returns the faults that texts describe.

    Args:
        texts: Texts of the command line.
        others: Texts of a parameter file, which follow them.

    Raises:
        ValueError: A text does not describe a fault.
    """
    from ..faults.reading import read_fault

    return [read_fault(text) for text in (*(texts or ()), *others)]


def check_positive(option: str, value: float) -> None:
    """Checks that the value of an option is positive and finite.

    Raises:
        ValueError: It is not. The message names the option.
    """
    if not 0.0 < value < math.inf:
        raise ValueError(f"{option} must be positive and finite, got {value}")


def pose_of(numbers: tuple[float, float, float], option: str) -> Pose:
    """Returns the pose that an option gives as X Y YAW.

    Raises:
        ValueError: A number is not finite. The message names the option.
    """
    try:
        return Pose(*numbers)
    except ValueError as error:
        raise ValueError(f"{option}: {error}") from None


def load_grid(
    map_file: Path, values: dict[str, Any], *, resolution: float | None = None, unit: float | None = None
) -> OccupancyGrid:
    """Returns the grid of a map file. The laser's parameter `unknown` decides whether unknown cells block beams.

    `resolution` and `unit` are those of `load_map`. Prints a hint if unknown cells shall block and a map of map_server has
    none, because its thresholds make the usual grey free.
    """
    from ..maps import load_map
    from ..parameters import LaserParameters, for_node

    unknown = for_node(LaserParameters, values).unknown
    grid = load_map(map_file, unknown=unknown, resolution=resolution, unit=unit)
    if unknown == "occupied" and map_file.suffix.lower() in (".yaml", ".yml") and (grid.cells >= 0).all():
        print_note(
            f"{map_file}: no cell is unknown, so unknown:=occupied has no effect. If grey areas should be unknown, "
            "lower free_thresh: with 0.196, grey 205 is unknown, as map_server means it."
        )
    return grid


def seed_of(seed: int | None, values: dict[str, Any]) -> int:
    """Returns the seed from the command line if there is one, otherwise the parameter `seed`.

    Raises:
        ValueError: The seed is out of range.
    """
    from ..parameters import LaserParameters, for_node

    return for_node(LaserParameters, values if seed is None else {**values, "seed": seed}).seed
