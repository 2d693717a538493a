"""Gazebo worlds as SDF, such as those of the BARN challenge.

Sources: http://sdformat.org/spec?ver=1.6, and the worlds in https://github.com/Daffan/the-barn-challenge. Of each model, the
collision shapes are read. They are boxes, cylinders and spheres on a flat floor, at any height.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from .._core import Pose
from ..quoting import quoted
from .cell_map import CellMap
from .raster import Raster
from .xml_document import read_xml

__all__ = ["read_sdf_world"]

_NO_OBSTACLES = ("model://ground_plane", "model://sun")
_GEOMETRIES = {"box": ("size", 3), "cylinder": ("radius", 1), "sphere": ("radius", 1)}


class _Solid(NamedTuple):
    """A shape of a model, seen from above."""

    pose: Pose
    radius: float
    """Radius of a disc [m], 0 for a rectangle."""

    sides: tuple[float, float]
    """Sides of a rectangle along its x and y [m]."""

    def corners(self) -> list[tuple[float, float]]:
        """Corners of the rectangle, or of the square around the disc, in the map frame [m]."""
        x, y = (self.radius, self.radius) if self.radius else (self.sides[0] / 2, self.sides[1] / 2)
        places = [self.pose * Pose(*corner, 0.0) for corner in ((-x, -y), (x, -y), (x, y), (-x, y))]
        return [(place.x, place.y) for place in places]


def read_sdf_world(path: Path, resolution: float) -> CellMap:
    """Returns the cells of a Gazebo world: those that a box, cylinder or sphere covers in part are occupied.

    Planes are the floor and are left out. So are models with a plugin, because these move. Poses in `state`, which Gazebo
    applies at the start, replace those of the models.

    Args:
        path: The file.
        resolution: Side of a cell [m].

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is malformed, has nothing to draw, or has something else than the above: another geometry, an
            included model, a tilted shape, a frame of its own or a scale.

    Warns:
        UserWarning: Models that move were left out.
    """
    root = read_xml(path)
    try:
        world = _world(root)
        poses = _state(world)
        solids: list[_Solid] = []
        moving = 0
        for include in world.iterfind("include"):
            uri = (include.findtext("uri") or "").strip()
            if uri not in _NO_OBSTACLES:
                raise ValueError(f"an included model must be the ground plane or the sun, got {quoted(uri)}")
        for model in world.iterfind("model"):
            if model.find("plugin") is not None:
                moving += 1
            else:
                solids += _solids(model, poses.get(model.get("name", "")))
        if not solids:
            raise ValueError("must have a model with a box, cylinder or sphere that does not move, got none")
        corners = np.array([corner for solid in solids for corner in solid.corners()])
        discs = np.array([(solid.pose.x, solid.pose.y, solid.radius) for solid in solids])
        low = np.minimum(corners.min(axis=0), (discs[:, :2] - discs[:, 2:]).min(axis=0))
        high = np.maximum(corners.max(axis=0), (discs[:, :2] + discs[:, 2:]).max(axis=0))
        raster = Raster(low.tolist(), high.tolist(), resolution)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    for solid in solids:
        if solid.radius:
            raster.add_disc((solid.pose.x, solid.pose.y), solid.radius)
        else:
            raster.add_area([np.array(solid.corners())])
    if moving:
        warnings.warn(f"{path}: {moving} models have a plugin that moves them; they are left out", stacklevel=3)
    return raster.cell_map()


def _world(root: ElementTree.Element) -> ElementTree.Element:
    world = root.find("world")
    if root.tag != "sdf" or world is None:
        raise ValueError(f"must be an sdf with a world, got {quoted(root.tag)}")
    return world


def _state(world: ElementTree.Element) -> dict[str, Pose]:
    """Returns the poses of models at the start, by name. Their scale must be 1."""
    poses = {}
    for model in world.iterfind("state/model"):
        scale = (model.findtext("scale") or "1 1 1").split()
        if {*scale} - {"1", "1.0"}:
            raise ValueError(f"the scale of model {quoted(model.get('name'))} must be 1 1 1, got {quoted(' '.join(scale))}")
        if model.find("pose") is not None:
            poses[model.get("name", "")] = _pose(model)
    return poses


def _solids(model: ElementTree.Element, pose: Pose | None) -> Iterator[_Solid]:
    """Yields the shapes of a model that is at its own pose, or at another one."""
    name = quoted(model.get("name"))
    try:
        map_from_model = pose or _pose(model)
        for link in model.iterfind("link"):
            map_from_link = map_from_model * _pose(link)
            for collision in link.iterfind("collision"):
                yield from _solid(collision, map_from_link * _pose(collision))
    except ValueError as error:
        raise ValueError(f"model {name}: {error}") from None
    if model.find("model") is not None or model.find("include") is not None:
        raise ValueError(f"model {name}: must have no models in it")


def _solid(collision: ElementTree.Element, pose: Pose) -> Iterator[_Solid]:
    for shape in collision.iterfind("geometry/*"):
        if shape.tag == "plane":
            continue
        if shape.tag not in _GEOMETRIES:
            raise ValueError(f"a geometry must be a box, cylinder, sphere or plane, got {quoted(shape.tag)}")
        name, count = _GEOMETRIES[shape.tag]
        sizes = _numbers(shape, name, count)
        if min(sizes) <= 0:
            raise ValueError(f"{name} of a {shape.tag} must be positive, got {quoted(shape.findtext(name))}")
        yield _Solid(pose, sizes[0], (0.0, 0.0)) if count == 1 else _Solid(pose, 0.0, (sizes[0], sizes[1]))


def _pose(element: ElementTree.Element) -> Pose:
    """Returns the pose of an element relative to its parent, seen from above."""
    pose = element.find("pose")
    if pose is None:
        return Pose(0.0, 0.0, 0.0)
    if frame := pose.get("frame") or pose.get("relative_to"):
        raise ValueError(f"a pose must be relative to its parent, got frame {quoted(frame)}")
    x, y, _, roll, pitch, yaw = _numbers(element, "pose", 6)
    if abs(roll) > 1e-6 or abs(pitch) > 1e-6:
        raise ValueError(f"a pose must have roll and pitch 0, got {quoted(pose.text)}")
    return Pose(x, y, yaw)


def _numbers(element: ElementTree.Element, name: str, count: int) -> list[float]:
    text = element.findtext(name) or ""
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        needed = "a finite number" if count == 1 else f"{count} finite numbers"
        raise ValueError(f"{name} must be {needed}, got {quoted(text)}")
    return numbers
