"""sdf_world: models become cells, in worlds written as those of the BARN challenge are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SEED = 22
RADIUS = 0.075


def cylinder(name: str, pose: str = "0 0 0 0 0 0", radius: str = "0.075", more: str = "") -> str:
    geometry = f"<geometry><cylinder><radius>{radius}</radius><length>1</length></cylinder></geometry>"
    link = f"<collision name='collision'>{geometry}</collision><visual name='visual'>{geometry}</visual>"
    return (
        f"<model name='{name}'><static>1</static><pose frame=''>{pose}</pose><link name='link'>{link}</link>{more}</model>"
    )


def box(size: str, pose: str, frame: str = " frame=''") -> str:
    geometry = f"<geometry><box><size>{size}</size></box></geometry>"
    link = f"<link name='box_link'><collision name='collision'>{geometry}</collision></link>"
    return f"<model name='wall'><static>1</static><pose{frame}>{pose}</pose>{link}</model>"


PLANE = "<plane><normal>0 0 1</normal><size>100 100</size></plane>"
FLOOR = f"<model name='ground_plane'><link name='link'><collision><geometry>{PLANE}</geometry></collision></link></model>"


def write(folder: Path, *models: str, start: str = "") -> Path:
    path = folder / "world_0.world"
    path.write_text(f"{start}<sdf version='1.6'>\n<world name='default'>\n{FLOOR}{''.join(models)}</world>\n</sdf>\n")
    return path


def drawn(grid: mrs.OccupancyGrid) -> list[str]:
    return ["".join("#" if cell else "." for cell in row) for row in grid.cells[::-1]]


def test_a_cylinder_and_a_box_are_where_they_stand(tmp_path: Path) -> None:
    world = write(tmp_path, cylinder("unit_cylinder_0", "-0.075 0.075 0 0 0 0"), box("0.2 0.05 1", "0.1 0.225 .5 0 0 0"))
    grid = mrs.load_map(world)
    assert drawn(grid) == [
        ".........",
        "....####.",
        ".........",
        ".###.....",
        ".###.....",
        ".###.....",
        ".........",
    ]
    assert tuple(grid.origin) == pytest.approx((-0.2, -0.05, 0.0))


def test_a_box_turns_with_its_yaw_and_poses_add_up(tmp_path: Path) -> None:
    link = "<pose>1 0 0 0 0 0</pose><collision><pose>0 0.5 0 0 0 0</pose>"
    turned = box("2 1 1", f"3 4 0 0 0 {np.pi / 2}").replace("<collision name='collision'>", link)
    grid = mrs.load_map(write(tmp_path, turned), resolution=0.5)
    # The centre is at (3, 4) + R(90°) (1, 0.5) = (2.5, 5). The box is 1 m wide along x and 2 m along y.
    rows, cols = np.nonzero(grid.cells)
    assert (cols.min() * 0.5 + grid.origin.x, (cols.max() + 1) * 0.5 + grid.origin.x) == (2.0, 3.0)
    assert (rows.min() * 0.5 + grid.origin.y, (rows.max() + 1) * 0.5 + grid.origin.y) == (4.0, 6.0)


def test_a_generated_world_of_barn_equals_its_definition(tmp_path: Path) -> None:
    """Cylinders on a lattice of 0.15 m, as BARN places them. A cell is occupied if its nearest point is in a cylinder."""
    random = np.random.default_rng(SEED)
    places = [(-0.075 - 0.15 * i, 0.075 + 0.15 * j) for i in range(30) for j in range(60) if random.random() < 0.15]
    models = [cylinder(f"unit_cylinder_{i}", f"{x:f} {y:f} 0 0 0 0") for i, (x, y) in enumerate(places)]
    grid = mrs.load_map(write(tmp_path, *models), resolution=0.04)
    rows, cols = np.indices(grid.shape)
    left, low = cols * 0.04 + grid.origin.x, rows * 0.04 + grid.origin.y
    expected = np.zeros(grid.shape, bool)
    for x, y in places:
        expected |= np.hypot(x - np.clip(x, left, left + 0.04), y - np.clip(y, low, low + 0.04)) < RADIUS - 1e-9
    assert np.array_equal(grid.cells == 100, expected)


def test_the_state_of_the_world_moves_its_models(tmp_path: Path) -> None:
    state = "<state><model name='a'><pose frame=''>5 5 0 0 0 0</pose><scale>1 1 1</scale></model></state>"
    grid = mrs.load_map(write(tmp_path, cylinder("a"), cylinder("b"), state))
    assert grid.cell_at(5, 5) is not None and grid.cells[grid.cell_at(5, 5)] == 100
    assert grid.cells[grid.cell_at(0, 0)] == 100 and grid.cells.sum() == 100 * 2 * 16


def test_oddities_of_dynabarn(tmp_path: Path) -> None:
    """An attribute without a value, an empty line before the declaration, included models, and moving cylinders."""
    plugin = "<plugin name='easylibobs_21' filename='easylibobs_21.so'/>"
    includes = "<include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include>"
    wall = box("20 .5 1", "0 -10 .5 0 0 0", " frame=")
    path = write(tmp_path, includes, cylinder("easylibobs_21", more=plugin), wall, start='\n\n<?xml version="1.0" ?>\n')
    with pytest.warns(UserWarning, match="1 models have a plugin that moves them; they are left out"):
        grid = mrs.load_map(path, resolution=0.25)
    assert grid.shape == (4, 82) and (grid.cells == 100).sum() == 2 * 80


@pytest.mark.parametrize(
    ("models", "message"),
    [
        ([], "must have a model with a box, cylinder or sphere that does not move, got none"),
        ([cylinder("a", "0 0 0 0.1 0 0")], "model 'a': a pose must have roll and pitch 0, got '0 0 0 0.1 0 0'"),
        ([cylinder("a", "0 0 0")], "model 'a': pose must be 6 finite numbers, got '0 0 0'"),
        ([cylinder("a", "0 0 nan 0 0 0")], "model 'a': pose must be 6 finite numbers, got '0 0 nan 0 0 0'"),
        ([cylinder("a", radius="0")], "model 'a': radius of a cylinder must be positive, got '0'"),
        ([cylinder("a", radius="wide")], "model 'a': radius must be a finite number, got 'wide'"),
        ([box("1 2", "0 0 0 0 0 0")], "model 'wall': size must be 3 finite numbers, got '1 2'"),
        ([box("1 2 1", "0 0 0 0 0 0", " frame='b'")], "model 'wall': a pose must be relative to its parent, got frame 'b'"),
        (
            [cylinder("a").replace("cylinder>", "mesh>")],
            "model 'a': a geometry must be a box, cylinder, sphere or plane, got 'mesh'",
        ),
        ([cylinder("a", more="<model name='b'/>")], "model 'a': must have no models in it"),
        (["<include><uri>model://jersey_barrier</uri></include>"], "an included model must be the ground plane or the sun"),
        (
            [cylinder("a"), "<state><model name='a'><scale>2 1 1</scale></model></state>"],
            "the scale of model 'a' must be 1 1 1",
        ),
        ([cylinder("a"), box("1e7 1 1", "0 0 0 0 0 0")], "a grid must have at most"),
        (["<model>"], "not valid XML: mismatched tag"),
        (["<!ENTITY a 'b'>"], "must define no entities"),
    ],
)
def test_worlds_that_are_not_flat_or_malformed_are_errors(tmp_path: Path, models: list[str], message: str) -> None:
    path = write(tmp_path, *models)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{path}: {message}")
