"""material_layer: the optional key `materials` of a map_server YAML file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs

CELLS = np.array([[0, 100, 100], [100, 0, -1]], np.int8)
NUMBERS = np.array([[0, 1, 2], [1, 0, 0]], np.uint8)
PANE = mrs.Material("glass", reflectivity=0.3, return_chance=0.25)

YAML = """image: map.pgm
resolution: 0.5
origin: [1.0, 2.0, 0.5]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def save(folder: Path, **materials: object) -> Path:
    """Saves the map with these arguments of `with_materials`."""
    grid = mrs.OccupancyGrid(CELLS, resolution=0.5, origin=(1.0, 2.0, 0.5))
    path = folder / "map.yaml"
    mrs.save_map(grid.with_materials(**materials) if materials else grid, path)  # type: ignore[arg-type]
    return path


def test_a_saved_map_has_the_same_materials(tmp_path: Path) -> None:
    loaded = mrs.load_map(save(tmp_path, materials=NUMBERS, table=["wall", PANE, "mirror"]))
    assert loaded.materials is not None and loaded.materials.tolist() == NUMBERS.tolist()
    assert loaded.material_table == [mrs.Material(), PANE, mrs.Material.named("mirror")]
    assert loaded.cells.tolist() == CELLS.tolist()
    assert loaded.origin == mrs.Pose(1.0, 2.0, 0.5)


def test_a_map_without_materials_is_saved_as_before(tmp_path: Path) -> None:
    path = save(tmp_path)
    assert "materials" not in path.read_text()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["map.pgm", "map.yaml"]
    assert mrs.load_map(path).materials is None


def test_the_table_has_the_named_materials_by_default(tmp_path: Path) -> None:
    path = save(tmp_path, materials=NUMBERS)
    path.write_text(YAML + "materials: {image: map_materials.pgm}\n")
    names = ("wall", "glass", "mirror", "dark")
    assert mrs.load_map(path).material_table == [mrs.Material.named(name) for name in names]


def test_a_map_with_other_unknown_cells_keeps_its_materials(tmp_path: Path) -> None:
    grid = mrs.load_map(save(tmp_path, materials=NUMBERS))
    sim = mrs.Simulation(grid, parameters={"unknown": "occupied"}, start=(1.2, 2.3, 0.0))
    assert sim.grid.unknown == "occupied"
    assert sim.grid.materials is not None and sim.grid.materials.tolist() == NUMBERS.tolist()


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("map_materials.pgm", "materials must be a mapping with the key image, got 'map_materials.pgm' in line 7"),
        ("{table: [wall]}", "materials must be a mapping with the key image"),
        ("{image: [a]}", "image must be a path, got"),
        ("{image: map_materials.pgm, names: []}", "materials must have the keys image and table only, got 'names'"),
        ("{image: map_materials.pgm, table: wall}", "table must be a list of materials, got 'wall' in line 7"),
        ("{image: map_materials.pgm, table: [wood]}", 'the material must be one of wall, glass, mirror, dark, got "wood"'),
        ("{image: map_materials.pgm, table: [[wall]]}", "a material must be a name or a mapping of kind, reflectivity"),
        ("{image: map_materials.pgm, table: [{color: 1}]}", "a material must have kind, reflectivity"),
        ("{image: map_materials.pgm, table: [{reflectivity: x}]}", "reflectivity"),
        ("{image: map_materials.pgm, table: [wall]}", "materials must be numbers of the 1 in the table, got 1 in row 0"),
        ("&a {image: map_materials.pgm, table: [*a]}", "a material must be a name"),
    ],
)
def test_bad_entries_are_rejected(tmp_path: Path, entry: str, message: str) -> None:
    path = save(tmp_path, materials=NUMBERS)
    path.write_text(f"{YAML}materials: {entry}\n")
    with pytest.raises(ValueError) as error:
        mrs.load_map(path)
    assert message in str(error.value)


def test_an_image_of_another_size_is_rejected(tmp_path: Path) -> None:
    path = save(tmp_path, materials=NUMBERS)
    (tmp_path / "map_materials.pgm").write_bytes(b"P5\n2 2\n255\n\0\0\0\0")
    with pytest.raises(ValueError, match=r"the image must have 3 x 2 pixels, as that of the map .*map.yaml, got 2 x 2"):
        mrs.load_map(path)
    (tmp_path / "map_materials.pgm").unlink()
    with pytest.raises(FileNotFoundError, match=r"map_materials.pgm"):
        mrs.load_map(path)
