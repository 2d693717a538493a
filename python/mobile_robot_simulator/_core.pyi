from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Any, Literal, TypeAlias, final

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Never, Self

__all__ = [
    "FULL_TURN_TOLERANCE",
    "MAX_COMMAND",
    "BeamFit",
    "BeamModel",
    "Contact",
    "Drive",
    "Fleet",
    "FleetState",
    "FleetStep",
    "LaserScanner",
    "LikelihoodField",
    "Limits",
    "Material",
    "MotionNoise",
    "Obstacles",
    "OccupancyGrid",
    "Pose",
    "RandomStream",
    "Shape",
    "SurfaceModel",
    "WheelMotion",
    "__version__",
    "advance",
    "cast_rays",
    "clearance",
    "clearance_batch",
    "commands_from_actions",
    "integrate_twist",
    "judge_steps",
    "laser_presets",
    "scan_each",
    "stays_clear",
    "touches",
]

__version__: str
FULL_TURN_TOLERANCE: float
"""A field of beams within this of 2π [rad] counts as a full turn."""
MAX_COMMAND: float
"""Limit of each component of a command [m/s, rad/s]. Commands beyond it are refused."""

# A pose (x, y, yaw), a twist (vx, vy, wz), and obstacles as (Shape, pose) pairs, in every form that functions take.
# An obstacle that moves during a scan has a twist, or a pose for each beam.
_PoseLike: TypeAlias = Pose | Sequence[float] | NDArray[np.float64]
_TwistLike: TypeAlias = Sequence[float] | NDArray[np.float64]
_Obstacles: TypeAlias = Obstacles | Iterable[tuple[Shape, _PoseLike]]
_MaterialLike: TypeAlias = Material | str
_Trajectory: TypeAlias = _PoseLike | ArrayLike
_MovingObstacles: TypeAlias = Obstacles | Iterable[tuple[Shape, _PoseLike] | tuple[Shape, _PoseLike, _TwistLike]]

@final
class Pose:
    """Position [m] and heading [rad] of one frame in another frame.

    A pose unpacks as `x, y, yaw`, and NumPy reads it as a row of three numbers. Every function that takes a pose also takes
    a sequence of three numbers `(x, y, yaw)`. The product of two poses composes them. Name a transform target first, so
    that neighbouring names match: `map_from_laser = map_from_base * base_from_laser`.

    Args:
        x: Position along x [m].
        y: Position along y [m].
        yaw: Heading [rad], counter-clockwise from the x axis. It is stored as given, not wrapped.

    Raises:
        ValueError: A coordinate is not finite.

    Examples:
        >>> from mobile_robot_simulator import Pose
        >>> Pose(1.0, 2.0, 0.0) * Pose(3.0, 0.5, 0.25)
        Pose(4.0, 2.5, 0.25)
        >>> x, y, yaw = Pose(1.0, 2.0, 0.5)
    """

    def __new__(cls, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> Self: ...
    @staticmethod
    def from_quaternion(x: float, y: float, *, qx: float, qy: float, qz: float, qw: float) -> Pose:
        """Returns the pose at (x, y) with the heading of a quaternion.

        The quaternion need not have length 1. Its roll and pitch are ignored.

        Args:
            x: Position along x [m].
            y: Position along y [m].
            qx: Quaternion component x.
            qy: Quaternion component y.
            qz: Quaternion component z.
            qw: Quaternion component w, the scalar part.

        Returns:
            The pose, with its yaw in [-π, π].

        Raises:
            ValueError: The quaternion has length zero, or a number is not finite.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose.from_quaternion(1.0, 2.0, qx=0.0, qy=0.0, qz=1.0, qw=0.0)
            Pose(1.0, 2.0, 3.141592653589793)
        """
    @property
    def x(self) -> float:
        """Position along x [m]."""
    @property
    def y(self) -> float:
        """Position along y [m]."""
    @property
    def yaw(self) -> float:
        """Heading [rad], counter-clockwise from x."""
    @property
    def quaternion(self) -> tuple[float, float]:
        """The heading as the components `(z, w)` of a unit quaternion; its x and y are zero.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose(1.0, 2.0, 0.0).quaternion
            (0.0, 1.0)
        """
    def inverse(self) -> Pose:
        """Returns the inverse transform: the pose of the parent frame in this frame.

        Raises:
            ValueError: A coordinate of the result is not finite.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> pose = Pose(2.0, 1.0, 0.0)
            >>> pose * pose.inverse()
            Pose(0.0, 0.0, 0.0)
        """
    def wrapped(self) -> Pose:
        """Returns the same pose with its yaw in (-π, π].

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose(0.0, 0.0, 7.0).wrapped().yaw  # 7 - 2π
            0.7168146928204138
        """
    def integrate(self, twist: _TwistLike, dt: float) -> Pose:
        """Returns the pose reached after `dt` seconds at a constant twist.

        The arc is exact, not an Euler step. It is the exponential map of SE(2): with φ = wz·dt, the position changes by
        dt · sin(φ/2)/(φ/2) · R(yaw + φ/2) · (vx, vy) and the yaw by φ. For many poses at once, see `integrate_twist`.

        Args:
            twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            dt: Duration [s]. A negative one goes backwards in time.

        Returns:
            The pose reached. Its yaw is not wrapped.

        Raises:
            ValueError: The pose reached is not finite, because a number in the twist or `dt` is not finite or too large.

        Examples:
            A quarter of a circle with a radius of 1 m:

            >>> import math
            >>> from mobile_robot_simulator import Pose
            >>> x, y, yaw = Pose().integrate((1.0, 0.0, 1.0), dt=math.pi / 2)
            >>> round(x, 9), round(y, 9)
            (1.0, 1.0)
        """
    def trace(self, twist: _TwistLike, times: ArrayLike) -> NDArray[np.float64]:
        """Returns the poses reached at several times at a constant twist: those of `integrate`.

        Args:
            twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            times: (N,) times [s] from this pose on. Anything that NumPy can convert to float64 without loss.

        Returns:
            (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.

        Raises:
            ValueError: `times` is not one-dimensional, or a number or a pose reached is not finite.
            TypeError: `times` cannot be converted to float64 without loss.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose(1.0, 2.0, 0.0).trace((0.5, 0.0, 0.0), times=[0.0, 2.0, 4.0])
            array([[1., 2., 0.],
                   [2., 2., 0.],
                   [3., 2., 0.]])
        """

    def twist_to(self, other: _PoseLike, dt: float) -> tuple[float, float, float]:
        """Returns the constant twist that leads from this pose to another pose in `dt` seconds.

        It is the inverse of `integrate`, and turns the shorter way: by at most half a turn.

        Args:
            other: Pose to reach, in the same frame as this pose.
            dt: Duration [s].

        Returns:
            The twist (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].

        Raises:
            ValueError: `dt` is not positive and finite, or `other` is not finite.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose().twist_to((2.0, 0.0, 0.0), dt=4.0)
            (0.5, 0.0, 0.0)
        """
    def interpolate(self, other: _PoseLike, fraction: float) -> Pose:
        """Returns the pose at a fraction of the arc from this pose to another pose.

        The arc has a constant twist and turns the shorter way: by at most half a turn.

        Args:
            other: Pose at fraction 1, in the same frame as this pose.
            fraction: Fraction of the arc. Values below 0 and above 1 continue the arc beyond its ends.

        Returns:
            The pose, with its yaw in (-π, π].

        Raises:
            ValueError: `other` or `fraction` is not finite.

        Examples:
            >>> from mobile_robot_simulator import Pose
            >>> Pose().interpolate((2.0, 0.0, 0.0), 0.25)
            Pose(0.5, 0.0, 0.0)
        """
    def __mul__(self, inner: _PoseLike, /) -> Pose: ...
    def __rmul__(self, outer: Never, /) -> Never: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> float: ...
    def __iter__(self) -> Iterator[float]: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Material:
    """What a wall or an obstacle is made of.

    An opaque surface returns a beam. A mirror reflects it, and the range is the length of the whole path. Glass lets it pass,
    and returns some beams that meet it nearly at a right angle. Four materials have names: "wall", "glass", "mirror" and "dark".
    A name can be given wherever a `Material` is expected.

    Args:
        kind: "opaque", "glass" or "mirror".
        reflectivity: Share of the light that it returns, 0 to 1. A mirror reflects this share; glass lets the rest pass. None means
            1 for opaque surfaces, 0.08 for glass and 0.9 for mirrors, as for the materials that have names.
        return_chance: Probability that glass returns a beam within `return_angle`. Without noise, a beam takes the likelier way.
        return_angle: Largest angle between a beam and the normal of glass at which it may return [rad], 0 to π/2.

    Raises:
        ValueError: The kind is unknown, or a number is out of range.
        TypeError: An argument has the wrong type.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> mrs.Material("glass", reflectivity=0.2)
        Material('glass', reflectivity=0.2, return_chance=0.9, return_angle=0.1)
        >>> mrs.Material.named("mirror").reflectivity
        0.9
    """

    def __new__(
        cls,
        kind: Literal["opaque", "glass", "mirror"] = "opaque",
        *,
        reflectivity: float | None = None,
        return_chance: float = 0.9,
        return_angle: float = 0.1,
    ) -> Self: ...
    @staticmethod
    def named(name: str) -> Material:
        """Returns the material with a name.

        Args:
            name: "wall", "glass", "mirror" or "dark".

        Raises:
            ValueError: There is no such material.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> mrs.Material.named("dark").reflectivity
            0.024
        """
    @property
    def kind(self) -> Literal["opaque", "glass", "mirror"]:
        """The kind: "opaque", "glass" or "mirror"."""
    @property
    def reflectivity(self) -> float:
        """Share of the light that it returns, 0 to 1."""
    @property
    def return_chance(self) -> float:
        """Probability that glass returns a beam within `return_angle`."""
    @property
    def return_angle(self) -> float:
        """Largest angle between a beam and the normal of glass at which it may return [rad]."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Obstacles:
    """Obstacles that are converted once, for many calls: shapes at poses in the map frame.

    Every function that takes `obstacles` takes them in place of pairs (Shape, pose), with the same result. An obstacle is
    known by its index.

    Args:
        placed: Pairs (Shape, pose), with poses in the map frame.

    Raises:
        TypeError: An item is not such a pair.
        ValueError: A pose is not finite.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> disc = mrs.Shape.disc(1.0)
        >>> obstacles = mrs.Obstacles([(disc, (3.0, 0.0, 0.0)), (disc, (7.0, 0.0, 0.0))])
        >>> len(obstacles)
        2
    """

    def __new__(cls, placed: Iterable[tuple[Shape, _PoseLike]] = ()) -> Self: ...
    def place(self, index: int, shape: Shape, pose: _PoseLike) -> None:
        """Places a shape at a pose, as the obstacle with this index: in place of the one that has it, or as the next one.

        Args:
            index: Index of the obstacle, at most their number.
            shape: The shape.
            pose: Pose (x, y, yaw) in the map frame [m, m, rad].

        Raises:
            ValueError: The index is larger than the number of obstacles, or the pose is not finite. Nothing changes.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> obstacles = mrs.Obstacles([(mrs.Shape.disc(1.0), (3.0, 0.0, 0.0))])
            >>> obstacles.place(0, mrs.Shape.disc(0.5), (4.0, 0.0, 0.0))
            >>> obstacles.placed
            [(Shape.disc(0.5), Pose(4.0, 0.0, 0.0))]
        """

    def without(self, index: int | None) -> Obstacles:
        """Returns the same obstacles as if the one with this index were not there.

        The others keep their indices. What is placed later is placed in both.

        Args:
            index: Index of the obstacle; None leaves out none. There may be none with it yet.

        Raises:
            ValueError: The index is negative.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> disc = mrs.Shape.disc(1.0)
            >>> robots = mrs.Obstacles([(disc, (0.0, 0.0, 0.0)), (disc, (4.0, 0.0, 0.0))])
            >>> grid = mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
            >>> mrs.clearance(grid, disc, (0.0, 0.0, 0.0), limit=9.0, obstacles=robots.without(0))
            2.0
        """

    @property
    def placed(self) -> list[tuple[Shape, Pose]]:
        """All obstacles: a list of pairs (Shape, Pose), with the one that is left out."""
    @property
    def left_out(self) -> int | None:
        """Index of the obstacle that is left out; None for none."""
    def __len__(self) -> int: ...

@final
class OccupancyGrid:
    """A map of square cells, each with an occupancy, as in `nav_msgs/OccupancyGrid`.

    Row 0 is at the bottom. A cell contains its lower and left edges. Outside the grid is free. The first scan builds a
    lookup table of 8 bytes per cell, which the grid keeps; `prepare` builds it earlier.

    Args:
        cells: (H, W) int8, -1 for unknown cells, otherwise the occupancy 0 to 100. The array is copied. A side has at most
            65535 cells, the grid at most 2000000000.
        resolution: Side of a cell [m].
        origin: Pose (x, y, yaw) of the lower-left corner of cell (0, 0) in the map frame [m, m, rad], yaw included.
        occupied_threshold: Cells with this value or more block beams and robots, 1 to 100. None means the default.
        unknown: How unknown cells act, "free" or "occupied". Occupied cells block beams and robots.
        materials: (H, W) uint8, the number of the material of each cell, which only matters where a cell blocks. None means
            walls of one material.
        material_table: The material of each number, 1 to 255 of them, each a `Material` or the name of one. None means
            ("wall", "glass", "mirror", "dark").

    Raises:
        ValueError: The array has another shape or no cells, or a value is outside its range or not finite.
        TypeError: The cells are not int8, or another argument has the wrong type.

    Examples:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=0.5)
        >>> grid
        OccupancyGrid(3x1 cells, 0.5 m, origin=(0.0, 0.0, 0.0), occupied_threshold=60, unknown='free')
        >>> grid.cell_at(1.2, 0.1)
        (0, 2)
    """

    def __new__(
        cls,
        cells: NDArray[np.int8],
        *,
        resolution: float,
        origin: _PoseLike = (0.0, 0.0, 0.0),
        occupied_threshold: int | None = 60,
        unknown: Literal["free", "occupied"] = "free",
        materials: ArrayLike | None = None,
        material_table: Sequence[_MaterialLike] | None = None,
    ) -> Self: ...
    @property
    def cells(self) -> NDArray[np.int8]:
        """Values of the cells: (H, W) int8, row 0 at the bottom, read-only.

        The array does not change when `set_cells` changes the grid.
        """
    @property
    def revision(self) -> int:
        """Number of times that `set_cells` has changed the grid. A result that was computed from the cells holds while it stays."""
    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns (H, W)."""
    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""
    @property
    def origin(self) -> Pose:
        """Pose of the lower-left corner of cell (0, 0) in the map frame, yaw included."""
    @property
    def occupied_threshold(self) -> int:
        """Cells with this value or more block beams and robots."""
    @property
    def unknown(self) -> Literal["free", "occupied"]:
        """How unknown cells act, "free" or "occupied". Occupied cells block beams and robots."""
    def set_cells(self, row: int, col: int, cells: NDArray[np.int8]) -> None:
        """Sets the cells of a rectangle.

        Only the part of the lookup table that the rectangle affects is rebuilt. Scans that run in other threads during the
        call still see the old values, and so do arrays that `cells` returned before.

        Args:
            row: Lowest row of the rectangle.
            col: Lowest column of the rectangle.
            cells: (H, W) int8, -1 for unknown cells, otherwise the occupancy 0 to 100. The array is copied.

        Raises:
            ValueError: The array has another shape or no cells, a value is out of range, or the rectangle is not on the
                grid.
            TypeError: The cells are not int8, or the row or column is not an integer.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
            >>> grid.set_cells(0, 1, np.array([[100, 50]], np.int8))
            >>> grid.cells
            array([[  0, 100,  50],
                   [  0,   0,   0]], dtype=int8)
        """
    def __copy__(self) -> OccupancyGrid: ...
    def __deepcopy__(self, _memo: Any) -> OccupancyGrid: ...
    @property
    def materials(self) -> NDArray[np.uint8] | None:
        """Numbers of the materials of the cells: (H, W) uint8, read-only; None if all are walls of one material."""
    @property
    def material_table(self) -> list[Material] | None:
        """The material of each number in `materials`; None if there are none."""
    def with_materials(self, materials: ArrayLike | None, *, table: Sequence[_MaterialLike] | None = None) -> OccupancyGrid:
        """Returns a copy of the grid with materials of its cells.

        Beams pass glass, and mirrors reflect them; robots touch both.

        Args:
            materials: (H, W) uint8, as in the constructor; None for walls of one material.
            table: The material of each number, as `material_table` in the constructor.

        Raises:
            ValueError: The array has another shape than the cells, or a number is not in the table.
            TypeError: The array is not uint8, or a material is neither a `Material` nor a name.

        Examples:
            A mirror 2 m ahead, and a wall 1 m behind the robot:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[100, 0, 0, 0, 100]], np.int8), resolution=1.0)
            >>> mirror = grid.with_materials(np.array([[0, 0, 0, 0, 2]], np.uint8))
            >>> mrs.LaserScanner(beam_count=1).scan(mirror, (2.0, 0.5, 0.0))
            array([5.], dtype=float32)
        """
    def prepare(self) -> None:
        """Builds the lookup table for scans now instead of at the first scan."""
    def cell_at(self, x: float, y: float) -> tuple[int, int] | None:
        """Returns the cell (row, column) that contains a point, or None if the point is outside the grid.

        Args:
            x: Position along x in the map frame [m].
            y: Position along y in the map frame [m].

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
            >>> grid.cell_at(2.5, 0.5), grid.cell_at(2.5, 2.5)
            ((0, 2), None)
        """
    def center(self, row: int, col: int) -> tuple[float, float]:
        """Returns the centre (x, y) of a cell in the map frame [m].

        Args:
            row: Row of the cell, 0 at the bottom.
            col: Column of the cell, 0 at the left.

        Raises:
            ValueError: The cell is not on the grid.
            TypeError: The row or column is not an integer.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
            >>> grid.center(0, 2)
            (2.5, 0.5)
        """
    def is_free_disc(self, x: float, y: float, radius: float) -> bool:
        """Returns True if no blocking cell reaches into a disc.

        The test is exact. A cell that only touches the edge of the disc does not count. Outside the grid is free.

        Args:
            x: Centre of the disc along x in the map frame [m].
            y: Centre of the disc along y in the map frame [m].
            radius: Radius of the disc [m]. With 0, the point itself is tested.

        Raises:
            ValueError: A number is not finite, or the radius is negative.

        Examples:
            The only wall covers x from 2 m to 3 m:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> grid.is_free_disc(0.5, 0.5, 1.5), grid.is_free_disc(0.5, 0.5, 1.6)
            (True, False)
        """
    def distances(self, max_distance: float, *, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """Returns how far each cell is from the nearest blocking cell.

        The grid keeps what it found, 2 bytes for each cell, until its cells change or another distance is asked for.

        Args:
            max_distance: Largest distance [m], at most 255 cells. Longer ones become this one.
            out: (H, W) float32 in C order, an array for the result. None means a new array.

        Returns:
            (H, W) float32, which is `out` if it was given: the Euclidean distance between the centre of the cell and that of the
                nearest blocking cell [m]; 0 for a blocking cell. Row 0 is at the bottom.

        Raises:
            ValueError: `max_distance` is not positive or too long, or `out` is read-only, in use, not in C order or of another
                shape.
            TypeError: An argument has the wrong type or dtype.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[100, 0, 0, 0]], np.int8), resolution=0.5)
            >>> grid.distances(1.25)
            array([[0.  , 0.5 , 1.  , 1.25]], dtype=float32)
        """
    def wall_directions(self, *, threads: int | None = None, out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """Returns the direction of the wall at each cell.

        Only blocking cells with a free neighbour have one: that of the straight line through such cells around it that are
        connected with it, in a window of 11 x 11 cells, near corners of 9 x 9 or 7 x 7. The grid keeps what it found, 1 byte for
        each cell, and follows `set_cells`.

        Args:
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (H, W) float32 in C order, an array for the result. None means a new array.

        Returns:
            (H, W) float32, which is `out` if it was given: the angle from the x axis of the grid to the wall [rad], 0 to below π in
                steps of π/252; NaN where it is unknown, such as in free cells and within about three cells of a corner. Row 0 is
                at the bottom.

        Raises:
            ValueError: `threads` is out of range, or `out` is read-only, in use, not in C order or of another shape.
            TypeError: An argument has the wrong type or dtype.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> slanting = mrs.OccupancyGrid(np.eye(4, dtype=np.int8) * 100, resolution=0.05)
            >>> np.degrees(slanting.wall_directions().diagonal())
            array([45., 45., 45., 45.], dtype=float32)
        """
    def draw_free_pose(self, *, radius: float, seed: int | RandomStream) -> Pose:
        """Returns a random pose at which a disc is free.

        It is the first pose of `draw_free_poses`. The same seed gives the same pose on every machine.

        Args:
            radius: Radius of the disc [m], for example that of the robot.
            seed: Seed of the draw, 0 to 2**64 - 1, or a `RandomStream`, which counts the poses of all calls.

        Raises:
            ValueError: There is no place for the disc, the radius is negative or not finite, or the seed is out of range.
            TypeError: The seed is not an integer.

        Examples:
            Only the first cell is free:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 100, -1]], np.int8), resolution=1.0)
            >>> x, y, yaw = grid.draw_free_pose(radius=0.2, seed=1)
            >>> grid.cell_at(x, y), x <= 0.8
            ((0, 0), True)
        """
    def draw_free_poses(
        self,
        n: int,
        *,
        radius: float,
        seed: int | RandomStream,
        first_index: int | None = None,
        threads: int | None = None,
        out: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Returns many random poses at which a disc is free.

        The position is uniform over all points of known free cells at which `is_free_disc` is True, not only over the centres
        of cells. The yaw is uniform over [-π, π). Pose i depends only on the grid, the radius and (seed, first_index + i), so
        many poses may be drawn in parts: they are the same bytes for any split, number of threads and machine.

        The first call needs a time that grows with the number of cells. The grid then keeps a table of free places until its
        cells change or another radius is asked for, so that a further pose takes about 0.1 µs.

        Args:
            n: Number of poses.
            radius: Radius of the disc [m], for example that of the robot. With 0, the point itself is free.
            seed: Seed of the draw, 0 to 2**64 - 1, or a `RandomStream`, which counts the poses of all calls.
            first_index: Index of the first pose in the random stream, 0 to 2**64 - 1. None means 0, or that of the
                `RandomStream`.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (N, 3) float64 in C order, an array for the result. None means a new array.

        Returns:
            (N, 3) float64, which is `out` if it was given: x, y [m] and yaw [rad] in the map frame.

        Raises:
            ValueError: There is no place for the disc (the error names the largest one that fits), the radius is negative or
                not finite, an integer is out of range, or `out` is read-only, in use, not in C order or of another shape.
            TypeError: An argument has the wrong type or dtype.
            OSError: The threads could not be started.

        Examples:
            Draw 1000 poses, then 1000 others. The last cell blocks:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> poses = grid.draw_free_poses(1000, radius=0.5, seed=1)
            >>> others = grid.draw_free_poses(1000, radius=0.5, seed=1, first_index=1000)
            >>> poses.shape, bool((poses[:, 0] <= 1.5).all()), bool((poses != others).all())
            ((1000, 3), True, True)
        """
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the grid in Matplotlib axes and returns the axes.

        Walls are dark, free cells white and unknown cells grey. The axes are in metres in the map frame. A grid with more
        cells than the axes have pixels is down-sampled so that walls stay visible.

        Args:
            ax: Matplotlib axes to draw in, which then show the whole grid. None opens a new pyplot figure.

        Returns:
            The Matplotlib axes.

        Raises:
            ImportError: Matplotlib is not installed. The extra `plotting` installs it.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> from matplotlib.figure import Figure
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> ax = grid.plot(Figure().add_subplot())
            >>> ax.get_xlabel(), ax.get_ylabel()
            ('x [m]', 'y [m]')
        """
    def _repr_png_(self) -> bytes | None: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class BeamFit:
    """The beam model of greatest likelihood for some readings, as returned by `BeamModel.fit`.

    Args:
        model: The model.
        log_likelihood: Log-likelihood that the model reaches.
        count: Number of readings that were used.
        iterations: Number of iterations.
        has_converged: False if the likelihood was still growing at the end.
        standard_errors: Standard error of each parameter by its name. None for one that is at its limit or not identified.
        unidentified: Names of the parameters that the readings do not determine.
        offset: What to add to true ranges below the maximum [m]; None if it was not fitted.

    Raises:
        ValueError: A number is negative or not finite, or a name is not one of a parameter.
        TypeError: An argument has the wrong type.

    Examples:
        >>> import numpy as np
        >>> from mobile_robot_simulator import BeamModel
        >>> readings = np.array([4.9, 5.0, 5.1, 8.0], np.float32)
        >>> BeamModel.fit(np.full(4, 5.0, np.float32), readings, max_range=8.0).unidentified
        ('sigma_hit', 'lambda_short')
    """

    def __new__(
        cls,
        *,
        model: BeamModel,
        log_likelihood: float,
        count: int,
        iterations: int,
        has_converged: bool,
        standard_errors: Mapping[str, float | None],
        unidentified: Sequence[str],
        offset: float | None = None,
    ) -> Self: ...
    @property
    def model(self) -> BeamModel:
        """The model."""
    @property
    def offset(self) -> float | None:
        """What to add to true ranges below the maximum [m]; None if it was not fitted."""
    @property
    def log_likelihood(self) -> float:
        """Log-likelihood that the model reaches: the sum of the logarithms of densities [1/m] and probabilities."""
    @property
    def count(self) -> int:
        """Number of readings that were used."""
    @property
    def iterations(self) -> int:
        """Number of iterations."""
    @property
    def has_converged(self) -> bool:
        """False if the likelihood was still growing when the number of iterations reached its limit, 5000."""
    @property
    def standard_errors(self) -> dict[str, float | None]:
        """Standard error of each parameter by its name. None for one that is at its limit or not identified."""
    @property
    def unidentified(self) -> tuple[str, ...]:
        """Names of the parameters that the readings do not determine.

        These are `sigma_hit` and `offset` without hits, and `lambda_short` without short readings. The model has some value for them.
        """

@final
class BeamModel:
    """Noise of a range finder: the beam model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 6.1.

    A reading is drawn from a mixture of four parts:

    - hit: normal around the true range, truncated to [0, max_range];
    - short: exponential, for unexpected objects, truncated to [0, true range];
    - max: exactly max_range, for failures;
    - random: uniform over [0, max_range), for unexplained readings.

    A beam that hits nothing reads exactly max_range in the hit part; its short and random readings are drawn with a true
    range of max_range. The defaults are those of the ROS package mobile_robot_simulator.

    Args:
        sigma_hit: Standard deviation of the hit part [m].
        lambda_short: Rate of the short part [1/m].
        z_hit: Weight of the hit part. The four weights are scaled to sum to 1.
        z_short: Weight of the short part.
        z_max: Weight of the max part.
        z_rand: Weight of the random part.
        range_offset: Distance by which hits lie behind the true range [m]; negative for in front of it. The sum is kept within
            [0, max_range].
        range_sigma_base: Together with `range_sigma_per_metre`: the standard deviation of a hit is at least
            `range_sigma_base + range_sigma_per_metre * true_range` [m].
        range_sigma_per_metre: Growth of that standard deviation with the true range [m/m].
        range_step: Readings are rounded to multiples of this step [m]; 0 for none. Readings of `max_range` stay as they are.
        range_step_share: Largest share of a reading that its step may be, 0 to 0.5, if that is more than `range_step`: with
            0.01, the step doubles where it is 1/100 of the reading. 0 for steps that do not grow.

    Raises:
        ValueError: `sigma_hit` or `lambda_short` is not positive, a weight or another number but `range_offset` is negative, no
            weight is positive, `range_step_share` is more than 0.5, or a number is not finite.

    Examples:
        >>> from mobile_robot_simulator import BeamModel
        >>> BeamModel(z_hit=3.0, z_max=1.0).z_hit
        0.75
    """

    def __new__(
        cls,
        *,
        sigma_hit: float = 0.005,
        lambda_short: float = 2.0,
        z_hit: float = 0.995,
        z_short: float = 0.0,
        z_max: float = 0.005,
        z_rand: float = 0.0,
        range_offset: float = 0.0,
        range_sigma_base: float = 0.0,
        range_sigma_per_metre: float = 0.0,
        range_step: float = 0.0,
        range_step_share: float = 0.0,
    ) -> Self: ...
    @staticmethod
    def preset(name: str) -> BeamModel:
        """Returns the noise of a scanner that is sold. What is not known of it has the default.

        Args:
            name: Name of the preset, such as hokuyo_utm30lx; `laser_presets` lists all.

        Raises:
            ValueError: There is no such preset.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> mrs.BeamModel.preset("hokuyo_utm30lx").sigma_hit
            0.018
        """
    @property
    def sigma_hit(self) -> float:
        """Standard deviation of the hit part [m]."""
    @property
    def lambda_short(self) -> float:
        """Rate of the short part [1/m]."""
    @property
    def z_hit(self) -> float:
        """Weight of the hit part, after scaling."""
    @property
    def z_short(self) -> float:
        """Weight of the short part, after scaling."""
    @property
    def z_max(self) -> float:
        """Weight of the max part, after scaling."""
    @property
    def z_rand(self) -> float:
        """Weight of the random part, after scaling."""
    @property
    def range_offset(self) -> float:
        """Distance by which hits lie behind the true range [m]."""
    @property
    def range_sigma_base(self) -> float:
        """Least standard deviation of a hit at a true range of 0 [m]."""
    @property
    def range_sigma_per_metre(self) -> float:
        """Growth of that standard deviation with the true range [m/m]."""
    @property
    def range_step(self) -> float:
        """Smallest step between readings [m]; 0 for none."""
    @property
    def range_step_share(self) -> float:
        """Largest share of a reading that its step may be; 0 for steps that do not grow."""
    def sigma_by_incidence(
        self,
        true_ranges: ArrayLike,
        readings: ArrayLike,
        incidences: ArrayLike,
        max_range: float,
        *,
        min_range: float = 0.0,
    ) -> NDArray[np.float64]:
        """Returns the standard deviation of the hits for six equal bands of incidence, from 0° to 90°.

        Real readings scatter more on walls that the beam meets at a grazing angle. Each is the one of greatest likelihood,
        with everything else as in this model. `range_offset` counts; what else depends on the range does not.

        Args:
            true_ranges: float32 of any shape, true ranges [m], as for `fit`; with the offset added, if one was fitted.
            readings: float32, measured ranges [m].
            incidences: float32, angle between the beam and the normal of its wall [rad], 0 to π/2. Readings with another one,
                such as NaN, are left out. The shapes of the three arrays are broadcast, as by NumPy.
            max_range: Maximum range of the scanner [m].
            min_range: Smallest valid range of the scanner [m].

        Returns:
            (6,) float64 [m]; NaN for a band with fewer than ten hits.

        Raises:
            ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
                [0, max_range), or a true range is negative or NaN.
            TypeError: An array cannot be converted to float32 without loss.

        Examples:
            >>> import numpy as np
            >>> from mobile_robot_simulator import BeamModel
            >>> true = np.full(100, 5.0, np.float32)
            >>> readings = true + np.float32([0.1, -0.1] * 50)
            >>> model = BeamModel(sigma_hit=0.05, z_hit=1.0)
            >>> model.sigma_by_incidence(true, readings, np.full(100, 0.1, np.float32), max_range=30.0).round(3)
            array([0.1, nan, nan, nan, nan, nan])
        """
    @staticmethod
    def fit(
        true_ranges: ArrayLike, readings: ArrayLike, max_range: float, *, min_range: float = 0.0, fit_offset: bool = False
    ) -> BeamFit:
        """Returns the model of greatest likelihood for measured readings.

        It has one standard deviation for all true ranges, no offset and no steps: `range_offset` and the other `range_...` are 0.
        Method: expectation maximization, as in table 6.2 of the book, with the truncation of the hit and the short part taken into
        account, and with leaps (Varadhan & Roland, 2008). NaN is left out, and so are readings with a true range of 0.

        Args:
            true_ranges: float32 of any shape, true ranges [m]. A true range of `max_range` or more means that the beam hits
                nothing. The shapes of both arrays are broadcast, as by NumPy.
            readings: float32, measured ranges [m]. Readings of `max_range` and above, +inf too, are beams without a return.
            max_range: Maximum range of the scanner [m].
            min_range: Smallest valid range of the scanner [m]. Readings below it, -inf too, count as any reading from 0 to
                `min_range`. If it is 0, they are left out.
            fit_offset: If True, also fits how far real returns lie behind the true ranges, because the walls of a map are often a
                cell thicker than real ones. The model is then that for true ranges with `fit.offset` added to those below
                `max_range`.

        Returns:
            The model with its log-likelihood, the offset, and the standard error of each parameter.

        Raises:
            ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
                [0, max_range), a true range is negative or NaN, or no reading can be used.
            TypeError: An array cannot be converted to float32 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.floor_plan("office", seed=1)
            >>> poses = grid.draw_free_poses(100, radius=0.3, seed=1)
            >>> laser, noise = mrs.LaserScanner(), mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1, z_max=0.0)
            >>> readings = laser.scan_batch(grid, poses, noise=noise, seed=1)
            >>> fit = mrs.BeamModel.fit(laser.scan_batch(grid, poses), readings, max_range=30.0)
            >>> round(fit.model.sigma_hit, 2), round(fit.model.z_rand, 2), fit.unidentified
            (0.05, 0.1, ('lambda_short',))
        """
    def likelihood(
        self, readings: ArrayLike, true_ranges: ArrayLike, max_range: float, *, min_range: float = 0.0
    ) -> NDArray[np.float64]:
        """Returns the likelihood of each reading, given the true range of its beam.

        Args:
            readings: float32 of any shape, measured ranges [m].
            true_ranges: float32, true ranges [m]. A true range of `max_range` or more means that the beam hits nothing. The
                shapes of both arrays are broadcast, as by NumPy.
            max_range: Maximum range of the scanner [m].
            min_range: Smallest valid range of the scanner [m].

        Returns:
            float64 of the broadcast shape. A reading of `max_range` and above, +inf too, has the probability of a beam
                without a return; one below `min_range`, -inf too, that of such a reading. Any other has a probability density
                [1/m], except that 0 has a probability if the true range is 0. If readings are rounded, it is the mean density over
                all that are rounded to the same step. NaN has 1, so that it does not count in a product.

        Raises:
            ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
                [0, max_range), or a true range is negative or NaN.
            TypeError: An array cannot be converted to float32 without loss.

        Examples:
            The probability of reading the maximum, for a beam that hits a wall and for one that hits nothing:

            >>> import numpy as np
            >>> from mobile_robot_simulator import BeamModel
            >>> model = BeamModel(z_hit=0.9, z_max=0.1)
            >>> model.likelihood(np.array([30, 30], np.float32), np.array([5, 30], np.float32), max_range=30.0)
            array([0.1, 1. ])
        """
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class LikelihoodField:
    """A model of readings that looks only at where they end: the likelihood field of Probabilistic Robotics, table 6.3.

    With d for the distance from the end of a reading to the nearest wall, the likelihood of the reading is

        z_hit * exp(-d**2 / (2 * sigma_hit**2)) / (sigma_hit * sqrt(2 * pi)) + z_rand / max_range

    d is the distance between the centre of the cell in which the reading ends and the centre of the nearest blocking cell,
    or `max_distance` if that is smaller. Only readings from `min_range` to below `max_range` count. Of a tilted scanner, readings
    within three times `sigma_hit` of the floor do not count.

    `laser.log_likelihood` takes it as `noise`. It is faster than a `BeamModel`, since no beam is cast, and smoother, since a
    pose that is a little wrong scores a little less. It is not a density of readings: it does not see what lies between
    the scanner and the end of a beam, so it cannot tell a pose behind a wall from one in front of it, and nothing can be
    sampled from it. Source: Thrun, Burgard & Fox 2005. The defaults are those of AMCL.

    Args:
        sigma_hit: Standard deviation of the distance from the end of a reading to the nearest wall [m].
        z_hit: Weight of readings that end at a wall. The two weights are scaled to sum to 1.
        z_rand: Weight of readings that end anywhere.
        max_distance: Largest distance to a wall [m], at most 255 cells. Longer ones count as this one.

    Raises:
        ValueError: `sigma_hit` or `max_distance` is not positive, a weight is negative, both are 0, or a number is not finite.
        TypeError: An argument is not a number.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> grid, laser = mrs.floor_plan("office", seed=1), mrs.LaserScanner(beam_count=61)
        >>> poses = grid.draw_free_poses(10_000, radius=0.3, seed=1)
        >>> scan = laser.scan(grid, poses[7])
        >>> laser.log_likelihood(grid, poses, scan, noise=mrs.LikelihoodField()).argmax()
        np.int64(7)
    """

    def __new__(
        cls,
        *,
        sigma_hit: float = 0.2,
        z_hit: float = 0.95,
        z_rand: float = 0.05,
        max_distance: float = 2.0,
    ) -> Self: ...
    @property
    def sigma_hit(self) -> float:
        """Standard deviation of the distance from the end of a reading to the nearest wall [m]."""
    @property
    def z_hit(self) -> float:
        """Weight of readings that end at a wall, after scaling."""
    @property
    def z_rand(self) -> float:
        """Weight of readings that end anywhere, after scaling."""
    @property
    def max_distance(self) -> float:
        """Largest distance to a wall [m]."""

@final
class Fleet:
    """Many robots that are stepped together, each alone in a world of its own, or several in one.

    Each robot moves, touches and measures as a robot of a `Simulation`, byte by byte, however many threads work. Robots that
    share a world see and touch each other; a robot does not depend on robots in other worlds. A command holds for a step, so it is like `velocity_timeout: 0`. Contact is looked for in time
    steps of 20 ms. Poses are in the map frame, with yaws in (-π, π].

    A robot has a seed. The noise of its scan i is that of `LaserScanner.scan_batch` with this seed and `first_index=i`; the
    first scan after `reset` with a seed has index 0. Only one thread may use a fleet at a time.

    Args:
        grids: The map of all robots, or a sequence of maps.
        poses: (N, 3), the first pose (x, y, yaw) of each robot [m, m, rad]. None means that they are drawn from free space.
        seeds: (N,) integers from 0 to 2**64 - 1, one for each robot. None means 0, 1, 2 and so on.
        grid_of: (N,) integers, the index of each robot's map. None means the first map for all if there is only one, or map i
            for robot i.
        footprint: Outline of the robots; None if they touch nothing.
        contact: What a contact does to the motion, as in `advance`: "stop", "slide" or "report".
        limits: Limits on the velocity and its change: for all robots, or a sequence with one for each. None means no limits.
        drive: The wheels: for all robots, or a sequence with one of the same kind for each. None means robots that move in any
            direction.
        slip: Share of the commanded motion that slipping wheels lose, in 0..1: a number, or (N,) numbers. None means 0.
        scanner: The scanner on each robot; None for no scans.
        noise: Noise of the ranges: for all robots, or a sequence with one for each. None means true ranges.
        surfaces: How what a beam meets changes the noise of its reading: a `SurfaceModel` for all robots, or a sequence with one for
            each. None means not at all. It needs `noise`, and a scanner that is not tilted.
        odometry_noise: Noise of the odometry between two steps: for all robots, or a sequence with one for each. None means
            exact odometry.
        world_of: (N,) integers. Robots with the same number share a world. None means a world for each robot, with its index as
            its number.
        obstacles: Tuples (Shape, trajectory) for an obstacle in each world, or (Shape, trajectory, world) for one world. A
            trajectory is a pose, or (K, 4) waypoints (time, x, y, yaw) [s, m, m, rad], interpolated linearly: the obstacle stands
            at the first one before its time, and at the last one after its time. The time is that of the world.
        clearance: Least free distance around the footprint of a robot at a pose that is drawn [m]. Obstacles and other robots do
            not count.
        clearance_limit: Distance up to which the clearance of each robot is measured after each step [m]; None to not measure it.

    Raises:
        ValueError: There is no robot, a shape or an index is wrong, a number is not finite or out of range, an obstacle is in
            a world without a robot, or a map has no free place for a robot.
        TypeError: An argument has the wrong type or dtype.

    Examples:
        Three robots on an office floor drive ahead for 0.1 s:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> fleet = mrs.Fleet(
        ...     mrs.floor_plan("office", seed=1),
        ...     seeds=[1, 2, 3],
        ...     footprint=mrs.Shape.disc(0.2),
        ...     scanner=mrs.LaserScanner(beam_count=200),
        ...     noise=mrs.BeamModel(),
        ...     clearance=0.1,
        ... )
        >>> step = fleet.step(np.tile([0.5, 0.0, 0.0], (3, 1)), 0.1)
        >>> step.ranges.shape, step.contacts.tolist()
        ((3, 200), [False, False, False])
    """

    def __new__(
        cls,
        grids: OccupancyGrid | Sequence[OccupancyGrid],
        poses: ArrayLike | None = None,
        *,
        seeds: ArrayLike | None = None,
        grid_of: ArrayLike | None = None,
        footprint: Shape | None = None,
        contact: Literal["stop", "slide", "report"] = "stop",
        limits: Limits | Sequence[Limits] | None = None,
        drive: Drive | Sequence[Drive] | None = None,
        slip: float | ArrayLike | None = None,
        scanner: LaserScanner | None = None,
        noise: BeamModel | Sequence[BeamModel] | None = None,
        surfaces: SurfaceModel | Sequence[SurfaceModel] | None = None,
        odometry_noise: MotionNoise | Sequence[MotionNoise] | None = None,
        world_of: ArrayLike | None = None,
        obstacles: Iterable[tuple[Shape, _Trajectory | None] | tuple[Shape, _Trajectory | None, int | None]] = (),
        clearance: float = 0.0,
        clearance_limit: float | None = None,
    ) -> Self: ...
    def step(
        self,
        commands: ArrayLike,
        duration: float,
        *,
        scan: bool = True,
        threads: int | None = None,
        out: FleetStep | None = None,
    ) -> FleetStep:
        """Moves all robots for a duration, each at its command, and takes a scan of each at the end.

        If there is an error, or the call is interrupted, no robot has moved; the arrays of `out` may have changed.

        Args:
            commands: (N, 3), the velocity (vx, vy, wz) in the frame of each robot [m/s, m/s, rad/s], each at most 1000. With a
                drive, the wheels do what they can of it: see `Drive.command`. For Ackermann drives also (N, 2), the speed and
                the steering angle of each robot [m/s, rad], limited to what the drive can do. Anything that NumPy can convert to float64 without loss.
            duration: Duration of the step [s], at most 1e6. It is rounded to nanoseconds.
            scan: Whether to take scans, if there is a scanner. They have the noise of the next index of each robot.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: Result of an earlier step, whose arrays are used again. None means new arrays.

        Returns:
            Poses, velocities, contacts and ranges of all robots; `out` if it was given.

        Raises:
            ValueError: A shape is wrong, a command is not finite or too large, the duration is not positive, `threads` is out
                of range, or an array of `out` cannot be used.
            TypeError: An argument has the wrong type or dtype.
            RuntimeError: Another thread uses the fleet.
            OSError: The threads could not be started.

        Examples:
            The only wall covers x from 2 m to 3 m. A robot of radius 0.2 m drives against it at 1 m/s:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0)], footprint=mrs.Shape.disc(0.2))
            >>> step = fleet.step([(1.0, 0.0, 0.0)], 2.0)
            >>> step.poses.round(3), step.contacts, step.contact_points
            (array([[1.8, 0.5, 0. ]]), array([ True]), array([[2. , 0.5]]))
        """
    def scan(
        self, mask: ArrayLike | None = None, *, threads: int | None = None, out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Takes a scan of each chosen robot where it stands, with the noise of its next index.

        Args:
            mask: (N,) bool, which robots to scan. None means all.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (M, beam_count) float32, an array for the result. None means a new array.

        Returns:
            (M, beam_count) float32, the ranges of the M chosen robots [m], in their order.

        Raises:
            ValueError: A shape is wrong, the fleet has no scanner, or `out` cannot be used.
            TypeError: An argument has the wrong type or dtype.
            RuntimeError: Another thread uses the fleet.
            OSError: The threads could not be started.

        Examples:
            The only wall covers x from 2 m to 3 m:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0)], scanner=mrs.LaserScanner(beam_count=1))
            >>> fleet.scan()
            array([[1.5],
                   [0.5]], dtype=float32)
            >>> fleet.scan([False, True])
            array([[0.5]], dtype=float32)
        """
    def reset(
        self,
        mask: ArrayLike | None = None,
        *,
        poses: ArrayLike | None = None,
        seeds: ArrayLike | None = None,
        grids: ArrayLike | None = None,
    ) -> None:
        """Puts robots at poses, where they stand still.

        The time of a world begins at 0 again, unless other robots stay in it.
        Poses that are not given are drawn from the free space of the robot's map, with the robot's seed: as by
        `OccupancyGrid.draw_free_poses` with the radius `footprint.reach + clearance`. If there is an error, nothing has changed.

        Args:
            mask: (N,) bool, which robots to reset. None means all. Rows of the other robots are ignored below.
            poses: (N, 3), poses (x, y, yaw) in the map frame [m, m, rad].
            seeds: (N,) integers, new seeds: the noise and the poses to draw start again. None means that they go on, so that
                each reset draws another pose.
            grids: (N,) integers, indices of the maps from now on. None means that the maps stay.

        Raises:
            ValueError: A shape or an index is wrong, a pose is not finite, or a map has no free place for a robot.
            TypeError: An argument has the wrong type or dtype.
            RuntimeError: Another thread uses the fleet.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> fleet = mrs.Fleet(grid, seeds=[1, 2, 3])
            >>> first = fleet.poses
            >>> fleet.reset([True, False, False])  # another random pose for robot 0
            >>> (fleet.poses == first).all(axis=1)
            array([False,  True,  True])
            >>> fleet.reset(seeds=[1, 2, 3])
            >>> (fleet.poses == first).all()
            np.True_
        """
    def replace_obstacles(self, obstacles: Iterable[tuple[int, Shape, _Trajectory | None]]) -> None:
        """Replaces obstacles, for example by those of the next episode of a robot. They keep their indices and worlds.

        Args:
            obstacles: Tuples (index, Shape, trajectory), with the index of an obstacle that was given for one world. A trajectory
                is that of the constructor: a pose, waypoints, or None if the obstacle is not there.

        Raises:
            ValueError: There is no such obstacle, it is in each world, or a trajectory is invalid. Nothing changes.
            TypeError: An argument has the wrong type.
            RuntimeError: Another thread uses the fleet.

        Examples:
            Two robots in worlds of their own; an obstacle is put before the second one:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid, disc = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0), mrs.Shape.disc(0.5)
            >>> obstacles = [(disc, None, 0), (disc, None, 1)]
            >>> fleet = mrs.Fleet(grid, [(1.0, 4.0, 0.0)] * 2, footprint=disc, obstacles=obstacles)
            >>> fleet.replace_obstacles([(1, disc, (3.0, 4.0, 0.0))])
            >>> fleet.step([(1.0, 0.0, 0.0)] * 2, 2.0).poses[:, 0].round(3)
            array([3., 2.])
        """
    def save(self, mask: ArrayLike | None = None) -> FleetState:
        """Returns the state of robots, for `restore`: motion, contact, random streams and map.

        Args:
            mask: (N,) bool, which robots to save. None means all.

        Raises:
            ValueError: The mask has the wrong shape.
            TypeError: The mask is not bool.
            RuntimeError: Another thread uses the fleet.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> fleet = mrs.Fleet(grid, [(1.0, 1.0, 0.0), (1.0, 2.0, 0.0)])
            >>> state = fleet.save()
            >>> step = fleet.step([(1.0, 0.0, 0.0)] * 2, 1.0)
            >>> fleet.restore(state)
            >>> fleet.poses
            array([[1., 1., 0.],
                   [1., 2., 0.]])
        """
    def restore(self, state: FleetState, mask: ArrayLike | None = None) -> None:
        """Puts robots into saved states.

        Args:
            state: What `save` returned, of this fleet or of another one with the same maps.
            mask: (N,) bool, which robots to put into the states, in their order; one state can go to any number of robots. None
                means those that were saved.

        Raises:
            ValueError: The mask has the wrong shape, there is neither one state nor one for each robot, a robot or a map does
                not exist, or a robot has another drive than the one saved. Nothing changes.
            TypeError: An argument has the wrong type.
            RuntimeError: Another thread uses the fleet.

        Examples:
            A planner puts all robots of a second fleet where the only robot of the first one is:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> robot, imagined = mrs.Fleet(grid, [(1.0, 2.0, 0.0)]), mrs.Fleet(grid, np.zeros((3, 3)))
            >>> imagined.restore(robot.save(), [True, True, False])
            >>> imagined.poses
            array([[1., 2., 0.],
                   [1., 2., 0.],
                   [0., 0., 0.]])
        """
    def rollout(
        self, commands: ArrayLike, duration: float, *, robot: int = 0, threads: int | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Returns what would happen to one robot under many sequences of commands, for planners such as MPPI. The fleet stays as it is.

        Each sequence begins with the present state of the robot. It moves as by `step(..., scan=False)` with one command after
        another. The other robots of its world go on at their last commands.

        Args:
            commands: (K, T, 3), T commands (vx, vy, wz) for each of K rollouts [m/s, m/s, rad/s], each at most 1000. For an
                Ackermann drive also (K, T, 2), speeds and steering angles [m/s, rad]. Anything that NumPy can convert to
                float64 without loss. An array in C order is read in place, so no other thread may write to it during the call.
            duration: Duration of a command [s], at most 1e6.
            robot: Index of the robot.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.

        Returns:
            The poses (K, T, 3) float64 in the map frame after each command [m, m, rad], and (K, T) bool, whether the robot
            touched something at each command.

        Raises:
            ValueError: A shape is wrong, a command is not finite or too large, the duration is not positive, or there is no such
                robot.
            TypeError: An argument has the wrong type or dtype.
            RuntimeError: Another thread uses the fleet.
            OSError: The threads could not be started.

        Examples:
            The only wall covers x from 2 m to 3 m. Which of two sequences of two commands touches it?

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0)], footprint=mrs.Shape.disc(0.2))
            >>> slow, fast = (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)
            >>> poses, contacts = fleet.rollout([[slow, slow], [fast, fast]], 1.0)
            >>> poses[:, :, 0].round(3), contacts
            (array([[1. , 1.5],
                   [1.5, 1.8]]), array([[False, False],
                   [False,  True]]))
        """
    def relative(
        self, goals: ArrayLike, mask: ArrayLike | None = None, *, out: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """Returns the goals of robots as seen from them.

        Args:
            goals: (N, 2), the goal (x, y) of each robot in the map frame [m].
            mask: (N,) bool, which robots to look at. None means all. Goals of the other robots are ignored.
            out: (M, 2) float64, an array for the result. None means a new array.

        Returns:
            (M, 2) float64, which is `out` if it was given: for each of the M chosen robots the distance [m], and the bearing in
            (-π, π] [rad], 0 straight ahead and positive to the left.

        Raises:
            ValueError: A shape is wrong, a goal is not finite, or `out` cannot be used.
            TypeError: An argument has the wrong type or dtype.
            RuntimeError: Another thread uses the fleet.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> mrs.Fleet(grid, [(1.0, 1.0, 0.0)]).relative([(1.0, 3.0)]).round(4)
            array([[2.    , 1.5708]])
        """
    @property
    def poses(self) -> NDArray[np.float64]:
        """Poses of the robots now: (N, 3) float64, rows (x, y, yaw) in the map frame [m, m, rad], a new array."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities of the robots now: (N, 3) float64, rows (vx, vy, wz) in their own frames [m/s, m/s, rad/s], a new array."""
    def joints(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns what the joints of the robots do now.

        The joints are the wheels in the order of `Drive`, then the steering of the left and of the right front wheel.

        Returns:
            Positions (N, J) float64 [rad], those of wheels since the last reset, and rates (N, J) float64 [rad/s]. J is 2 for a
            differential, 4 for an omni and 6 for an Ackermann drive, and 0 without a drive.

        Raises:
            ValueError: A rate is too large for a number.
            RuntimeError: Another thread uses the fleet.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> fleet = mrs.Fleet(grid, [(1.0, 1.0, 0.0)], drive=drive)
            >>> step = fleet.step([(1.0, 0.0, 1.0)], 2.0)
            >>> fleet.joints()
            (array([[15., 25.]]), array([[ 7.5, 12.5]]))
        """
    @property
    def steering(self) -> NDArray[np.float64]:
        """Steering angle of each robot now: (N,) float64 [rad], a new array; 0 for robots that do not steer."""
    @property
    def times(self) -> NDArray[np.float64]:
        """Time of the world of each robot: (N,) float64 [s], a new array."""
    @property
    def seeds(self) -> NDArray[np.uint64]:
        """Seed of each robot: (N,) uint64, a new array."""
    @property
    def grid_of(self) -> NDArray[np.int64]:
        """Index of the map of each robot: (N,) int64, a new array."""
    @property
    def grids(self) -> list[OccupancyGrid]:
        """The maps."""
    @property
    def scanner(self) -> LaserScanner | None:
        """The scanner on each robot; None without one."""
    @property
    def footprint(self) -> Shape | None:
        """Outline of the robots; None if they touch nothing."""
    @property
    def contact(self) -> str:
        """What a contact does to the motion: "stop", "slide" or "report"."""
    @property
    def limits(self) -> list[Limits] | None:
        """Limits on the velocity and its change: one for all robots, or one for each; None for no limits."""
    @property
    def drive(self) -> list[Drive] | None:
        """The wheels: one drive for all robots, or one for each; None for robots that move in any direction."""
    @property
    def slip(self) -> list[float] | None:
        """Share of the commanded motion that slipping wheels lose, for each robot; None for none."""
    @property
    def noise(self) -> list[BeamModel] | None:
        """Noise of the ranges: one for all robots, or one for each; None for true ranges."""
    @property
    def surfaces(self) -> list[SurfaceModel] | None:
        """How what a beam meets changes its reading: one for all robots, or one for each; None for not at all."""
    @property
    def odometry_noise(self) -> list[MotionNoise] | None:
        """Noise of the odometry: one for all robots, or one for each; None for exact odometry."""
    @property
    def world_of(self) -> NDArray[np.uint64]:
        """Number of the world of each robot: (N,) uint64, a new array."""
    @property
    def obstacles(self) -> list[tuple[Shape, NDArray[np.float64] | None, int | None]]:
        """The obstacles: a list of (Shape, waypoints, world).

        The waypoints are (K, 4) float64, or None if the obstacle is not there; the world is its number, or None for all.
        """
    @property
    def clearance_limit(self) -> float | None:
        """Distance up to which the clearance of the robots is measured after each step [m]; None to not measure it."""
    @property
    def clearance(self) -> float:
        """Least free distance around the footprint of a robot at a pose that is drawn [m]."""
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __setstate__(self, state: FleetState) -> None: ...

@final
class FleetState:
    """The state of some robots of a `Fleet`, as `Fleet.save` returns it.

    Args:
        words: (M, K) uint64, the words of an earlier state.

    Raises:
        ValueError: The words are not those of a state.
        TypeError: The words are no array of integers.

    Examples:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
        >>> mrs.Fleet(grid, [(1.0, 1.0, 0.0), (2.0, 2.0, 0.0)]).save([False, True]).robots
        array([1])
    """

    def __new__(cls, words: ArrayLike) -> Self: ...
    @property
    def words(self) -> NDArray[np.uint64]:
        """The state as words, to store it: (M, K) uint64. Their meaning can change with the version of this package."""
    """The state of some robots of a `Fleet`, as `Fleet.save` returns it.

    Examples:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
        >>> mrs.Fleet(grid, [(1.0, 1.0, 0.0), (2.0, 2.0, 0.0)]).save([False, True]).robots
        array([1])
    """

    @property
    def robots(self) -> NDArray[np.int64]:
        """Indices of the saved robots in their fleet: (M,) int64."""
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class FleetStep:
    """What `Fleet.step` returns: one row for each robot. Pass it as `out=` to a later step to use its arrays again.

    `Fleet.step` makes one. With arrays of your own, for example in shared memory, a step writes its results there.

    Args:
        poses: (N, 3) float64 in C order.
        velocities: (N, 3) float64 in C order.
        contacts: (N,) bool.
        contact_points: (N, 2) float64 in C order.
        contact_obstacles: (N,) int64.
        contact_robots: (N,) int64.
        odometry: (N, 3) float64 in C order.
        ranges: (N, beam_count) float32 in C order; None for steps without scans.
        clearances: (N,) float64; None for a fleet without `clearance_limit`.

    Raises:
        ValueError: An array has another shape, or is not in C order.
        TypeError: An argument is no array, or has another dtype.

    Examples:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
        >>> fleet, commands = mrs.Fleet(grid, [(1.0, 1.0, 0.0)]), [(0.5, 0.0, 0.0)]
        >>> step = fleet.step(commands, 1.0)
        >>> fleet.step(commands, 1.0, out=step) is step
        True
        >>> step.poses
        array([[2., 1., 0.]])
    """

    def __new__(
        cls,
        *,
        poses: NDArray[np.float64],
        velocities: NDArray[np.float64],
        contacts: NDArray[np.bool_],
        contact_points: NDArray[np.float64],
        contact_obstacles: NDArray[np.int64],
        contact_robots: NDArray[np.int64],
        odometry: NDArray[np.float64],
        ranges: NDArray[np.float32] | None = None,
        clearances: NDArray[np.float64] | None = None,
    ) -> Self: ...
    @property
    def poses(self) -> NDArray[np.float64]:
        """Pose of each robot: (N, 3) float64, rows (x, y, yaw) in the map frame [m, m, rad], with yaws in (-π, π]."""
    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocity of each robot: (N, 3) float64, rows (vx, vy, wz) in its own frame [m/s, m/s, rad/s]."""
    @property
    def contacts(self) -> NDArray[np.bool_]:
        """Whether each robot touched something during the step: (N,) bool."""
    @property
    def contact_points(self) -> NDArray[np.float64]:
        """Points that the robots touched first in the step: (N, 2) float64, rows (x, y) in the map frame [m]; NaN for none."""
    @property
    def contact_obstacles(self) -> NDArray[np.int64]:
        """Index of the obstacle that each robot touched first in the step: (N,) int64, -1 for none."""
    @property
    def contact_robots(self) -> NDArray[np.int64]:
        """Index of the other robot that each robot touched first in the step: (N,) int64, -1 for none.

        A contact with neither an obstacle nor a robot is one with a wall.
        """
    @property
    def odometry(self) -> NDArray[np.float64]:
        """Pose that the odometry of each robot reports after the step: (N, 3) float64, rows (x, y, yaw) [m, m, rad].

        It is in the robot's odometry frame, which is that of its first pose. Without noise and slip, it is where the robot is.
        """
    @property
    def clearances(self) -> NDArray[np.float64] | None:
        """Distance of each footprint to the nearest wall, obstacle or robot after the step: (N,) float64 [m].

        It is `clearance_limit` of the fleet if there is nothing nearer. None without that limit, or without a footprint.
        """
    @property
    def ranges(self) -> NDArray[np.float32] | None:
        """Scan of each robot after the step: (N, beam_count) float32 [m]; None without a scanner or with `scan=False`."""
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class LaserScanner:
    """A planar laser scanner with evenly spaced beams.

    Beam i points at `angle_min + i * angle_increment` in the scanner's frame. A field of view `fov` is centred on the x axis,
    with a beam at both ends: `angle_increment = fov / (beam_count - 1)`. A full turn (within 2e-5) has no second end:
    `angle_increment = fov / beam_count`. A single beam points along the x axis. The defaults are those of a SICK S300.

    Instead of `fov`, the field can be given by `angle_min` and `angle_max`, with the same rules, or by `angle_min` and
    `angle_increment`. If `angle_max` is less than `angle_min`, or the increment is negative, the beams turn clockwise.

    A scanner may be mounted upside down or tilted. A tilted one measures the distance in space to walls and obstacles, which
    have any height, and to the floor if z is positive. A tilt of at most 1e-5 rad counts as level or upside down.

    Args:
        fov: Field of view [rad], above 0 and at most 2π. None means the default, or the field given by the angles.
        angle_min: Angle of the first beam [rad], -2π to 2π.
        angle_max: Angle of the last beam [rad], -2π to 2π; in a full turn, the angle at which the turn is complete.
        angle_increment: Angle from one beam to the next [rad]. All beams together must turn by at most 2π.
        beam_count: Number of beams and of ranges in a scan, 1 to 1000000. None means the default.
        min_range: Smallest valid range [m]. It does not change scans; `mark_invalid` and `end_points` use it.
        max_range: Range of a beam that hits nothing [m], greater than `min_range`.
        mount: Pose of the scanner in the robot's frame: (x, y, yaw) [m, m, rad], or in space (x, y, z, roll, pitch, yaw) with
            the angles of URDF, or (x, y, z, qx, qy, qz, qw) with a quaternion.

    Raises:
        ValueError: A value is outside its range or not finite.
        TypeError: An argument has the wrong type.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> mrs.LaserScanner(fov=2.0, beam_count=5).angles
        array([-1. , -0.5,  0. ,  0.5,  1. ])

        0.5 m above the floor, and looking down by 30°:

        >>> import math
        >>> import numpy as np
        >>> free = mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
        >>> down = mrs.LaserScanner(beam_count=1, mount=(0.0, 0.0, 0.5, 0.0, math.radians(30), 0.0))
        >>> down.scan(free, (0.5, 0.5, 0.0))
        array([1.], dtype=float32)
    """

    def __new__(
        cls,
        *,
        fov: float | None = 4.71,
        angle_min: float | None = None,
        angle_max: float | None = None,
        angle_increment: float | None = None,
        beam_count: int | None = 541,
        min_range: float = 0.05,
        max_range: float = 30.0,
        mount: _PoseLike = (0.0, 0.0, 0.0),
    ) -> Self: ...
    @staticmethod
    def preset(name: str, *, mount: _PoseLike = (0.0, 0.0, 0.0)) -> LaserScanner:
        """Returns a scanner that is sold, with the field, the beams and the ranges of its data sheet.

        What is not known of it has the default. `laser_presets` lists all presets, and `BeamModel.preset` gives the noise.

        Args:
            name: Name of the preset, such as hokuyo_utm30lx.
            mount: Pose of the scanner in the robot's frame, as in the constructor.

        Raises:
            ValueError: There is no such preset.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> laser = mrs.LaserScanner.preset("hokuyo_utm30lx")
            >>> laser.beam_count, laser.max_range
            (1081, 30.0)
        """
    @property
    def fov(self) -> float:
        """Field of view [rad]: the one given, or the angle between the ends of the field."""
    @property
    def beam_count(self) -> int:
        """Number of beams and of ranges in a scan."""
    @property
    def min_range(self) -> float:
        """Smallest valid range [m]."""
    @property
    def max_range(self) -> float:
        """Range of a beam that hits nothing [m]."""
    @property
    def mount(self) -> Pose:
        """Pose of the scanner in the robot's frame, seen from above."""
    @property
    def mount_in_space(self) -> tuple[float, float, float, float, float, float]:
        """Pose (x, y, z, roll, pitch, yaw) of the scanner in the robot's frame, in space [m, m, m, rad, rad, rad]."""
    @property
    def mount_quaternion(self) -> tuple[float, float, float, float]:
        """Rotation of the scanner in the robot's frame, as a unit quaternion (x, y, z, w)."""
    @property
    def angle_min(self) -> float:
        """Angle of the first beam in the scanner's frame [rad]."""
    @property
    def angle_max(self) -> float:
        """Angle of the last beam in the scanner's frame [rad]."""
    @property
    def angle_increment(self) -> float:
        """Angle from one beam to the next [rad]: negative if they turn clockwise."""
    @property
    def angles(self) -> NDArray[np.float64]:
        """Angles of the beams in the scanner's frame, (beam_count,) float64 [rad]."""
    def scan(self, grid: OccupancyGrid, pose: _PoseLike, *, obstacles: _Obstacles = ()) -> NDArray[np.float32]:
        """Returns the true ranges of one scan, without noise.

        Ranges are exact: the grid traversal follows Amanatides & Woo (1987), section 2.

        Args:
            grid: Map to scan.
            pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad]. It may lie outside the grid.
            obstacles: Pairs (Shape, pose) that beams also hit, with poses in the map frame.

        Returns:
            (beam_count,) float32 [m], the distance at which each beam enters the first blocking cell or obstacle. A beam
                that starts inside one has range 0. A beam that hits nothing within `max_range` has exactly `max_range`.

        Raises:
            ValueError: A pose is not finite.

        Examples:
            The only wall covers x from 2 m to 3 m:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> mrs.LaserScanner(beam_count=1).scan(grid, (0.5, 0.5, 0.0))
            array([1.5], dtype=float32)
        """
    def scan_batch(
        self,
        grid: OccupancyGrid,
        poses: ArrayLike,
        *,
        twists: ArrayLike | None = None,
        scan_duration: float | None = None,
        obstacles: _MovingObstacles = (),
        noise: BeamModel | None = None,
        surfaces: SurfaceModel | None = None,
        seed: int | RandomStream | None = None,
        first_index: int | None = None,
        threads: int | None = None,
        out: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]:
        """Returns one scan from each pose of a batch, with or without noise.

        True ranges are those of `scan`. Scan i draws its noise from the random stream (seed, first_index + i), so a long
        batch may be split into chunks: the readings are the same bytes for any split, number of threads and machine.

        With `scan_duration`, the scans take time, as those of a head that turns. Beam j is then taken
        `j * time_increment(scan_duration)` seconds after beam 0, from where its robot is at that time, past obstacles where
        they are at that time: the range of `scan` from there, to the last bit.

        Args:
            grid: Map to scan.
            poses: (N, 3), one row (x, y, yaw) per scan: the robot in the map frame [m, m, rad], at the time of beam 0. Poses
                may lie outside the grid. Anything that NumPy can convert to float64 without loss, such as a list of poses.
                Or (N, beam_count, 3): the robot at the time of each beam.
            twists: (N, 3), one row (vx, vy, wz) per scan: the constant velocity in the robot's frame at which it moves while
                the scan is taken [m/s, m/s, rad/s]. None means that robots stand.
            scan_duration: Time in which the head turns through the field of the beams [s]. None means that all beams are taken
                in one instant.
            obstacles: Pairs (Shape, pose) that the beams of all scans also hit, with poses in the map frame. An obstacle may
                move during each scan: (Shape, pose, twist) from its pose at the time of beam 0 on, or (Shape, poses) with a
                (beam_count, 3) array of its poses at the time of each beam.
            noise: Beam model to draw the readings from. None means no noise.
            surfaces: How what a beam meets changes the noise of its reading, such as by the angle of incidence. None means not at
                all. It needs `noise`, and a scanner that is not tilted.
            seed: Seed of the noise, 0 to 2**64 - 1, or a `RandomStream`, which counts the scans of all calls. Noise needs one.
            first_index: Index of the first scan in the random stream, 0 to 2**64 - 1. None means 0, or that of the
                `RandomStream`.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (N, beam_count) float32 in C order, an array for the result. None means a new array.

        Returns:
            (N, beam_count) float32 [m], which is `out` if it was given. Row i is the scan from `poses[i]`, column j the beam
                at `angle_min + j * angle_increment`. Exactly `max_range` means no return.

        Raises:
            ValueError: A shape is wrong, a number is not finite, an integer is out of range, `scan_duration` is negative or
                missing where something moves, noise has no seed, surfaces have no noise or a tilted scanner, or `out` is read-only, in use or not in C order.
            TypeError: An argument has the wrong type or dtype.
            OSError: The threads could not be started.

        Examples:
            The only wall covers x from 2 m to 3 m:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> poses = np.array([[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]])
            >>> mrs.LaserScanner(beam_count=1).scan_batch(grid, poses)
            array([[1.5],
                   [0.5]], dtype=float32)

            Three beams, nearly all ahead, of a robot that drives towards the wall at 1 m/s:

            >>> ahead = mrs.LaserScanner(fov=1e-9, beam_count=3)
            >>> ahead.scan_batch(grid, poses[:1], twists=[(1.0, 0.0, 0.0)], scan_duration=0.5)
            array([[1.5 , 1.25, 1.  ]], dtype=float32)
        """

    def intensities(
        self,
        grid: OccupancyGrid,
        poses: ArrayLike,
        *,
        twists: ArrayLike | None = None,
        scan_duration: float | None = None,
        obstacles: _MovingObstacles = (),
        seed: int | RandomStream | None = None,
        first_index: int | None = None,
        threads: int | None = None,
        out: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]:
        """Returns how much light comes back to each beam, without noise.

        The intensity is `reflectivity * cos(incidence) / range**2` of the surface at which the range ends, times the share of the
        light that mirrors and glass leave on the way there and back. So a white wall at a right angle and a distance of 1 m has 1.
        The normal of a cell is that of the side through which the beam enters it.

        Args:
            grid: Map to scan.
            poses: As in `scan_batch`.
            twists: As in `scan_batch`.
            scan_duration: As in `scan_batch`.
            obstacles: As in `scan_batch`.
            seed: The seed of the noise, which also says which panes of glass return a beam. None means that beams take the
                likelier way, as in scans without noise.
            first_index: The index of the first scan in the random stream, as in `scan_batch`.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (N, beam_count) float32 in C order, an array for the result. None means a new array.

        Returns:
            (N, beam_count) float32, which is `out` if it was given; 0 for a beam without a return, or inside something.

        Raises:
            ValueError: The scanner is tilted, or as in `scan_batch`.
            TypeError: An argument has the wrong type or dtype.

        Examples:
            A wall at a distance of 2 m, at a right angle:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 0, 100]], np.int8), resolution=1.0)
            >>> mrs.LaserScanner(beam_count=1).intensities(grid, [(1.0, 0.5, 0.0)])
            array([[0.25]], dtype=float32)
        """
    def log_likelihood(
        self,
        grid: OccupancyGrid,
        poses: ArrayLike,
        ranges: NDArray[np.float32],
        *,
        noise: BeamModel | LikelihoodField,
        beams: int | Sequence[int] | None = None,
        temper: float = 1.0,
        twists: ArrayLike | None = None,
        scan_duration: float | None = None,
        obstacles: _MovingObstacles = (),
        threads: int | None = None,
        out: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Returns the log-likelihood of a scan, given each pose from which it may have been taken.

        With a `BeamModel`, it is `temper * sum(log(noise.likelihood(ranges, true_ranges, max_range, min_range=min_range)))`, with
        the true ranges of `scan` from each pose, to within 1e-9 for each beam. No array of true ranges is made. Readings may have
        the marks of `mark_invalid`.

        The beam model takes the errors of all beams as independent. They are not: what the map or the pose gets wrong, many
        beams get wrong in the same way. So the likelihood of all beams is far too sure. Two things help: few `beams`, and a
        `temper` below 1, such as 10 divided by the number of beams, which makes the scan count like ten independent beams.

        Args:
            grid: Map.
            poses: (N, 3), one row (x, y, yaw) per pose of the robot in the map frame [m, m, rad]; at the time of beam 0 if the
                scan takes time. Anything that NumPy can convert to float64 without loss.
            ranges: (beam_count,) float32, the readings of one scan [m]; or (N, beam_count), a scan for each pose. NaN does not
                count.
            noise: Beam model of the readings; or a `LikelihoodField`, which casts no beams, and takes no obstacles and no
                `scan_duration`.
            beams: Beams that count: a number k for every k-th beam from beam 0 on, or a sequence of their numbers. None means
                all.
            temper: Factor of the log-likelihood, above 0.
            twists: (N, 3), the velocity (vx, vy, wz) of the robot while the scan is taken [m/s, m/s, rad/s], as for `scan_batch`.
            scan_duration: Time in which the head turns through the field of the beams [s]. None means that all beams are taken
                in one instant.
            obstacles: Obstacles, as for `scan_batch`.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
            out: (N,) float64, an array for the result. None means a new array.

        Returns:
            (N,) float64, which is `out` if it was given. -inf if a reading is impossible from a pose.

        Raises:
            ValueError: A shape is wrong, a number is not finite, a beam does not exist, `temper` is not positive, or a
                `LikelihoodField` was given obstacles, `scan_duration` or a `max_distance` of more than 255 cells.
            TypeError: An argument has the wrong type or dtype.
            OSError: The threads could not be started.

        Examples:
            Which of 10,000 poses is right?

            >>> import mobile_robot_simulator as mrs
            >>> grid, laser = mrs.floor_plan("office", seed=1), mrs.LaserScanner(beam_count=61)
            >>> noise = mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1)
            >>> poses = grid.draw_free_poses(10_000, radius=0.3, seed=1)
            >>> scan = laser.scan_batch(grid, poses[7:8], noise=noise, seed=1)[0]
            >>> laser.log_likelihood(grid, poses, scan, noise=noise).argmax()
            np.int64(7)
        """

    def time_increment(self, scan_duration: float) -> float:
        """Returns the time from one beam to the next of a scan that takes time [s]; 0 with a single beam.

        It is the `time_increment` of a `LaserScan` message.

        Args:
            scan_duration: Time in which the head turns through the field of the beams [s]. A head that turns at a rate f
                takes `fov / (2 * pi * f)`. In a full turn, the last beam is taken one time increment before its end.

        Raises:
            ValueError: `scan_duration` is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> mrs.LaserScanner(fov=3.0, beam_count=101).time_increment(0.05)
            0.0005
        """

    def beam_poses(self, poses: ArrayLike, twists: ArrayLike, scan_duration: float) -> NDArray[np.float64]:
        """Returns where each robot of a batch is at the time of each beam of its scan.

        These are the poses from which `scan_batch` takes the beams of a scan that takes time: those of `Pose.integrate`. Who
        knows them can undo the distortion of the scan.

        Args:
            poses: (N, 3), one row (x, y, yaw) per robot at the time of beam 0, in any frame [m, m, rad].
            twists: (N, 3), one row (vx, vy, wz) per robot: its constant velocity in its own frame [m/s, m/s, rad/s].
            scan_duration: Time in which the head turns through the field of the beams [s].

        Returns:
            (N, beam_count, 3) float64, rows (x, y, yaw) in the frame of `poses` [m, m, rad]. Yaws are not wrapped.

        Raises:
            ValueError: A shape is wrong, a number is not finite, or `scan_duration` is negative.
            TypeError: An array cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> laser = mrs.LaserScanner(fov=1.0, beam_count=3)
            >>> laser.beam_poses([(0.0, 0.0, 0.0)], [(1.0, 0.0, 0.0)], 0.5)
            array([[[0.  , 0.  , 0.  ],
                    [0.25, 0.  , 0.  ],
                    [0.5 , 0.  , 0.  ]]])
        """

    def mark_invalid(
        self, readings: ArrayLike, *, no_return: Literal["inf", "max", "below_max"] = "inf"
    ) -> NDArray[np.float32]:
        """Returns a copy of readings in which invalid ones are marked as in a `LaserScan` message (REP-117).

        Readings below `min_range` become -inf. Readings of `max_range` and above are beams without a return; `no_return` says
        what they become. NaN stays NaN.

        Args:
            readings: float32 of any shape [m].
            no_return: Mark of a beam without a return: "inf" for +inf, "max" for `max_range`, or "below_max" for 0.1 m less
                than `max_range` (but at least `min_range`).

        Returns:
            float32 of the same shape [m], a new array.

        Raises:
            ValueError: `no_return` is none of these.
            TypeError: The array is not float32.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> laser = mrs.LaserScanner(min_range=0.05, max_range=30.0)
            >>> laser.mark_invalid(np.array([0.01, 2.0, 30.0], np.float32)).tolist()
            [-inf, 2.0, inf]
        """
    def hits(
        self,
        grid: OccupancyGrid,
        poses: ArrayLike,
        *,
        obstacles: _Obstacles = (),
        threads: int | None = None,
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Returns what each beam of a batch of scans meets, and at which angle.

        It is the surface whose distance is the range of `scan_batch` without noise. The normal of a blocking cell is that of the
        side through which the beam enters it, so a slanting wall has the normals of its steps. A beam takes some hundred
        nanoseconds, longer than a range.

        Args:
            grid: Map.
            poses: (N, 3), one row (x, y, yaw) per scan: the robot in the map frame [m, m, rad]. Or (N, beam_count, 3): the robot at
                the time of each beam, such as `beam_poses` returns.
            obstacles: Pairs (Shape, pose) that the beams also hit, with poses in the map frame.
            threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.

        Returns:
            Two arrays (N, beam_count): the surfaces, int32, which are -1 without a return, 0 for a wall and k + 1 for obstacle k;
                and the angles between the beams and the normals of the surfaces, float32, 0 to π/2 [rad], NaN if there is no
                surface or the laser is inside of it.

        Raises:
            ValueError: The scanner is tilted, a shape is wrong, a pose is not finite, or `threads` is out of range.
            TypeError: An argument has the wrong type or dtype.
            OSError: The threads could not be started.

        Examples:
            The only wall covers x from 2 m to 3 m:

            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
            >>> mrs.LaserScanner(beam_count=1).hits(grid, [(0.5, 0.5, 0.25), (0.5, 0.5, 3.0)])
            (array([[ 0],
                   [-1]], dtype=int32), array([[0.25],
                   [ nan]], dtype=float32))
        """

    def quantize(
        self, readings: NDArray[np.float32], step: float, *, out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Returns readings rounded to multiples of a power of two, so that they compress well.

        The readings become multiples of the largest power of two that is at most `step`, which float32 holds exactly: with a step
        of 0.001, multiples of 1/1024 m. So a reading changes by at most half of `step`. Readings of `max_range` and above,
        infinities and NaN stay as they are. A reading below `max_range` stays below it: where its nearest multiple would not, it
        becomes the largest multiple that is, and changes by less than `step`.

        Args:
            readings: float32 of any shape [m].
            step: Largest step between two readings [m], 1e-6 to 1.
            out: Array to write the result to, float32 of the same shape, C-contiguous. It may be `readings` itself.

        Returns:
            float32 of the same shape [m]: `out`, or a new array.

        Raises:
            ValueError: `step` is out of range, or `out` has the wrong shape or order, is read-only, or shares memory with
                `readings` without being the same array.
            TypeError: The array or `out` is not float32.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> laser = mrs.LaserScanner(max_range=8.1)
            >>> laser.quantize(np.array([1.1, 8.05, 8.1], np.float32), 0.3).tolist()
            [1.0, 8.0, 8.100000381469727]
        """

    def end_points(self, pose: _PoseLike, readings: ArrayLike) -> NDArray[np.float64]:
        """Returns the points in the map frame, seen from above, where the valid beams of one scan ended.

        A reading is valid if it is at least `min_range` and below `max_range`.

        Args:
            pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
            readings: (beam_count,) float32 [m], with or without the marks of `mark_invalid`. The mark "below_max" counts as a
                return.

        Returns:
            (M, 2) float64, one row (x, y) per valid reading [m], in the order of the beams.

        Raises:
            ValueError: There is not exactly one reading per beam, or the pose is not finite.
            TypeError: The array is not float32.

        Examples:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> mrs.LaserScanner(beam_count=1).end_points((1.0, 2.0, 0.0), np.array([3.0], np.float32))
            array([[4., 2.]])
        """
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Shape:
    """Outline of a robot or an obstacle in its own frame: a disc around the origin, or a simple polygon.

    Create one with `Shape.disc`, `Shape.rectangle` or `Shape.polygon`. Lengths are in metres. A pose places the origin of
    the shape in the map; the origin may lie outside a polygon.

    Examples:
        >>> from mobile_robot_simulator import Shape
        >>> Shape.rectangle(0.6, 0.4).area
        0.24
    """

    @staticmethod
    def disc(radius: float) -> Shape:
        """Returns a disc around the origin.

        Args:
            radius: Radius [m], at most 1e6.

        Raises:
            ValueError: The radius is not positive, or is larger than 1e6.

        Examples:
            >>> from mobile_robot_simulator import Shape
            >>> Shape.disc(0.3)
            Shape.disc(0.3)
        """
    @staticmethod
    def rectangle(length: float, width: float) -> Shape:
        """Returns a rectangle with its centre at the origin.

        Args:
            length: Side along x, the forward direction [m], at most 1e6.
            width: Side along y [m], at most 1e6.

        Raises:
            ValueError: A side is not positive, or is larger than 1e6.

        Examples:
            >>> from mobile_robot_simulator import Shape
            >>> Shape.rectangle(2.0, 1.0).points.tolist()
            [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]
        """
    @staticmethod
    def polygon(points: Sequence[Sequence[float]] | NDArray[np.float64]) -> Shape:
        """Returns a polygon with the given corners, convex or not.

        An edge joins the last corner to the first.

        Args:
            points: Corners (x, y) [m], 3 to 1000 of them, clockwise or counter-clockwise: an (N, 2) array or a sequence of
                pairs. Coordinates lie between -1e6 and 1e6.

        Raises:
            ValueError: The array has another shape, there are fewer than 3 or more than 1000 corners, a coordinate is not
                finite or beyond 1e6, two consecutive corners are equal, or two edges meet anywhere but at a shared corner.
            TypeError: `points` does not consist of pairs of numbers.

        Examples:
            >>> from mobile_robot_simulator import Shape
            >>> Shape.polygon([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]).area
            1.0
        """
    def with_material(self, material: _MaterialLike) -> Shape:
        """Returns the same shape of another material. Beams pass glass, and mirrors reflect them.

        Args:
            material: A `Material`, or the name of one: "wall", "glass", "mirror" or "dark".

        Raises:
            ValueError: There is no material with this name.
            TypeError: `material` is neither a `Material` nor a name.

        Examples:
            >>> from mobile_robot_simulator import Shape
            >>> Shape.rectangle(2.0, 0.1).with_material("mirror").material.kind
            'mirror'
        """
    @property
    def material(self) -> Material:
        """What the shape is made of."""
    @property
    def radius(self) -> float | None:
        """Radius of a disc [m]; None for a polygon."""
    @property
    def points(self) -> NDArray[np.float64]:
        """Corners of a polygon, counter-clockwise: (N, 2) float64 [m]. For a disc, an empty (0, 2) array."""
    @property
    def reach(self) -> float:
        """Distance from the origin to the farthest point [m]: the radius of the circle that the shape needs to turn in place."""
    @property
    def area(self) -> float:
        """Area [m²]."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Contact:
    """Where and when a robot touched a wall or an obstacle. `advance` returns it.

    Args:
        point: Point of contact (x, y) in the map frame [m], on the surface of the wall or obstacle.
        normal: Unit vector (x, y) in the map frame that points from the wall or obstacle to the robot; (0, 0) if the robot's
            origin is inside.
        fraction: Time of the contact as a fraction of the step, from 0 to 1.
        obstacle: Index in `obstacles` of the obstacle that was touched; None for a wall of the grid.

    Raises:
        ValueError: A number is not finite, the normal is longer than 1, the fraction is not in 0..1, or the index is
            negative.

    Examples:
        >>> from mobile_robot_simulator import Contact
        >>> Contact(point=(2.0, 0.5), normal=(-1.0, 0.0), fraction=0.5)
        Contact(point=(2.0, 0.5), normal=(-1.0, 0.0), fraction=0.5, obstacle=None)
    """

    def __new__(
        cls,
        *,
        point: tuple[float, float],
        normal: tuple[float, float],
        fraction: float,
        obstacle: int | None = None,
    ) -> Self: ...
    @property
    def point(self) -> tuple[float, float]:
        """Point of contact (x, y) in the map frame [m], on the surface of the wall or obstacle."""
    @property
    def normal(self) -> tuple[float, float]:
        """Unit vector (x, y) in the map frame that points from the wall or obstacle to the robot.

        It is (0, 0) if the robot's origin is inside the wall or obstacle.
        """
    @property
    def fraction(self) -> float:
        """Time of the contact as a fraction of the step, from 0 to 1."""
    @property
    def obstacle(self) -> int | None:
        """Index in `obstacles` of the obstacle that was touched; None for a wall of the grid."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class RandomStream:
    """A seed that counts what has been drawn with it, so that no two calls draw the same noise.

    It can be passed as `seed=` wherever a function takes a seed and an index. Each call then takes as many indices as it
    draws scans, poses or steps, and the next call continues after them. The results are the same bytes as with `seed=` and
    `first_index=` written out. Threads may share it: each call takes indices of its own, in the order of the calls.

    Args:
        seed: The seed, 0 to 2**64 - 1.
        next_index: Index of the first draw, 0 to 2**64 - 1.

    Raises:
        ValueError: A number is out of range.
        TypeError: A number is not an integer.

    Examples:
        Two batches of noisy scans, each with noise of its own:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> laser, noise, stream = mrs.LaserScanner(beam_count=1), mrs.BeamModel(), mrs.RandomStream(7)
        >>> poses = [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0)]
        >>> first = laser.scan_batch(grid, poses, noise=noise, seed=stream)
        >>> second = laser.scan_batch(grid, poses, noise=noise, seed=stream)
        >>> stream, bool((first != second).all())
        (RandomStream(7, next_index=4), True)
    """

    def __new__(cls, seed: int, *, next_index: int = 0) -> Self: ...
    @property
    def seed(self) -> int:
        """The seed."""
    @property
    def next_index(self) -> int:
        """Index of the next draw."""
    def take(self, count: int) -> int:
        """Takes indices for draws of your own.

        Args:
            count: Number of indices, at least 0.

        Returns:
            The first of the indices taken. `next_index` grows by `count`.

        Raises:
            ValueError: The count is negative, or fewer than `count` indices are left.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> stream = mrs.RandomStream(7)
            >>> stream.take(10), stream.take(5), stream.next_index
            (0, 10, 15)
        """
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Limits:
    """Limits on velocity and acceleration along each axis (vx, vy, wz) of a robot.

    A limit holds in both directions, and `inf` means no limit. The axes are independent. As in the `diff_drive_controller`
    of ros2_controllers, the acceleration limits are applied first, then the velocity limits.

    Args:
        velocity: Largest speeds [m/s, m/s, rad/s]. No limits by default. 0 holds an axis still.
        acceleration: Largest increases of speed [m/s², m/s², rad/s²]. No limits by default.
        deceleration: Largest decreases of speed [m/s², m/s², rad/s²]. No limits by default. With 0, a moving axis never
            stops.

    Raises:
        ValueError: A limit is negative or NaN.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 2.0))
        >>> limits.acceleration
        (0.5, 0.5, 2.0)
        >>> limits.velocity
        (inf, inf, inf)
    """

    def __new__(
        cls,
        *,
        velocity: _TwistLike = (inf, inf, inf),
        acceleration: _TwistLike = (inf, inf, inf),
        deceleration: _TwistLike = (inf, inf, inf),
    ) -> Self: ...
    @property
    def velocity(self) -> tuple[float, float, float]:
        """Largest speeds along (vx, vy, wz) [m/s, m/s, rad/s]."""
    @property
    def acceleration(self) -> tuple[float, float, float]:
        """Largest increases of speed along (vx, vy, wz) [m/s², m/s², rad/s²]."""
    @property
    def deceleration(self) -> tuple[float, float, float]:
        """Largest decreases of speed along (vx, vy, wz) [m/s², m/s², rad/s²]."""
    def apply(self, wanted: _TwistLike, current: _TwistLike, dt: float) -> tuple[float, float, float]:
        """Returns the velocity that a robot reaches in `dt` seconds.

        An axis that reverses its direction first slows down to zero, then speeds up in the remaining time.

        Args:
            wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            current: Velocity at the start, in the same form.
            dt: Duration [s]. With 0, only the velocity limits apply, to the current velocity.

        Returns:
            The velocity (vx, vy, wz) after `dt` seconds [m/s, m/s, rad/s].

        Raises:
            ValueError: A velocity or `dt` is not finite, or `dt` is negative.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 2.0))
            >>> limits.apply((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt=0.5)
            (0.25, 0.0, 0.0)
        """
    def integrate(self, pose: _PoseLike, wanted: _TwistLike, current: _TwistLike, dt: float, *, grip: float = 1.0) -> Pose:
        """Returns the pose that a robot reaches in `dt` seconds while its velocity follows `apply`.

        Args:
            pose: Pose at the start.
            wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            current: Velocity of the wheels at the start, in the same form.
            dt: Duration [s].
            grip: Share of the motion of the wheels that the robot makes; 1 without slip.

        Returns:
            The pose after `dt` seconds. Its yaw is not wrapped.

        Raises:
            ValueError: A number or the resulting pose is not finite, or `dt` is negative.

        Examples:
            From 1 m/s to a stop at 1 m/s² takes half a metre:

            >>> import mobile_robot_simulator as mrs
            >>> limits = mrs.Limits(deceleration=(1.0, 1.0, 1.0))
            >>> limits.integrate(mrs.Pose(), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), dt=5.0)
            Pose(0.5, 0.0, 0.0)
        """
    def trace(
        self, pose: _PoseLike, wanted: _TwistLike, current: _TwistLike, times: ArrayLike, *, grip: float = 1.0
    ) -> NDArray[np.float64]:
        """Returns the poses that a robot reaches at several times while its velocity follows `apply`: those of `integrate`.

        Args:
            pose: Pose at the start.
            wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            current: Velocity of the wheels at the start, in the same form.
            times: (N,) times from the start on [s]. Anything that NumPy can convert to float64 without loss.
            grip: Share of the motion of the wheels that the robot makes; 1 without slip.

        Returns:
            (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.

        Raises:
            ValueError: `times` is not one-dimensional, a time is negative, or a number or a pose reached is not finite.
            TypeError: `times` cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> limits = mrs.Limits(deceleration=(1.0, 1.0, 1.0))
            >>> limits.trace(mrs.Pose(), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), times=[0.0, 1.0, 5.0])
            array([[0. , 0. , 0. ],
                   [0.5, 0. , 0. ],
                   [0.5, 0. , 0. ]])
        """

    def distance(self, wanted: _TwistLike, current: _TwistLike, dt: float) -> float:
        """Returns the length of the path that a robot drives in `dt` seconds while its velocity follows `apply`.

        Args:
            wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            current: Velocity at the start, in the same form.
            dt: Duration [s].

        Returns:
            The length of the path [m]. Turning in place adds nothing.

        Raises:
            ValueError: A velocity or `dt` is not finite, or `dt` is negative.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> limits = mrs.Limits(velocity=(1.0, 1.0, 2.0), acceleration=(0.5, 0.5, 2.0))
            >>> limits.distance((2.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt=4.0)
            3.0
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Drive:
    """The wheels of a robot: how they move it, and their limits.

    Make one with `Drive.differential`, `Drive.omni` or `Drive.ackermann`.

    Wheels are listed as (left, right) for a differential drive, and as (front left, front right, rear left, rear right) for the
    others. A wheel turns at a positive rate when it rolls forward. Steering angles are positive to the left. The steering angle
    of the robot is that of a wheel in the middle of the front axle (the bicycle model).

    With the wheel base L, the track T, the radius r and k = (L + T) / 2:

    - differential: the wheels turn at (vx ∓ wz·T/2) / r, left and right.
    - omni: (vx ∓ vy ∓ k·wz) / r in front, (vx ± vy ∓ k·wz) / r at the rear, left and right.
    - ackermann: wz = vx · tan(steering) / L; the rear wheels are those of a differential drive, and the axes of all wheels meet
      in one point.

    Source of the formulas: `diff_drive_controller`, `mecanum_drive_controller` and `steering_controllers_library` of
    ros2_controllers.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
        >>> drive.wheels_of_twist([(1.0, 0.0, 1.0)])
        array([[ 7.5, 12.5]])
        >>> drive.twist_of_wheels([(7.5, 12.5)])
        array([[1., 0., 1.]])
    """

    @staticmethod
    def differential(*, track: float, wheel_radius: float | Sequence[float], wheel_speed_limit: float = inf) -> Drive:
        """Returns a drive with two driven wheels on one axle.

        The origin of the robot is the middle of the axle.

        Args:
            track: Distance between the wheels [m].
            wheel_radius: Radius of the wheels, or of the (left, right) wheel [m].
            wheel_speed_limit: Largest speed of a wheel [rad/s]. A faster velocity is scaled down, so that the robot stays on its
                path. No limit by default.

        Raises:
            ValueError: A number is not positive, or `wheel_radius` has another count of numbers.
            TypeError: `wheel_radius` is neither a number nor two.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> mrs.Drive.differential(track=0.5, wheel_radius=0.1).wheel_count
            2
        """
    @staticmethod
    def omni(
        *, wheelbase: float, track: float, wheel_radius: float | Sequence[float], wheel_speed_limit: float = inf
    ) -> Drive:
        """Returns a drive with four mecanum wheels, whose rollers form an X seen from above.

        The robot can move sideways. Its origin is the middle of the wheels.

        Args:
            wheelbase: Distance between the axles [m].
            track: Distance between the wheels of one axle [m].
            wheel_radius: Radius of the wheels, or of the (left, right) wheels [m].
            wheel_speed_limit: Largest speed of a wheel [rad/s]. A faster velocity is scaled down, so that the robot stays on its
                path. No limit by default.

        Raises:
            ValueError: A number is not positive, or `wheel_radius` has another count of numbers.
            TypeError: `wheel_radius` is neither a number nor two.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1).wheel_count
            4
        """
    @staticmethod
    def ackermann(
        *,
        wheelbase: float,
        track: float,
        wheel_radius: float | Sequence[float],
        steering_limit: float,
        steering_rate: float = inf,
        wheel_speed_limit: float = inf,
    ) -> Drive:
        """Returns a drive like that of a car: the front wheels steer, the rear wheels drive.

        The origin of the robot is the middle of the rear axle.

        Args:
            wheelbase: Distance between the axles [m].
            track: Distance between the wheels of one axle [m].
            wheel_radius: Radius of the wheels, or of the (left, right) wheels [m].
            steering_limit: Largest steering angle of the robot [rad], at most 1.5.
            steering_rate: Largest change of the steering angle per second [rad/s]. No limit by default.
            wheel_speed_limit: Largest mean speed of the two rear wheels [rad/s], which a differential gear joins. No limit by
                default.

        Raises:
            ValueError: A number is not positive, or the steering limit is above 1.5.
            TypeError: `wheel_radius` is neither a number nor two.

        Examples:
            The front wheels of a car on a circle to the left: the left one is nearer to the centre, so it steers more.

            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6)
            >>> car.steering_angles([0.5]).round(3)
            array([[0.579, 0.439]])
        """
    @property
    def kind(self) -> Literal["differential", "omni", "ackermann"]:
        """Kind of the drive: `differential`, `omni` or `ackermann`."""
    @property
    def wheelbase(self) -> float:
        """Distance between the axles [m]; 0 for a differential drive."""
    @property
    def track(self) -> float:
        """Distance between the wheels of one axle [m]."""
    @property
    def wheel_radius(self) -> tuple[float, float]:
        """Radius of the (left, right) wheels [m]."""
    @property
    def wheel_speed_limit(self) -> float:
        """Largest speed of a wheel [rad/s]; of an Ackermann drive, largest mean speed of the rear wheels."""
    @property
    def steering_limit(self) -> float:
        """Largest steering angle of the robot [rad]; 0 if it does not steer."""
    @property
    def steering_rate(self) -> float:
        """Largest change of the steering angle per second [rad/s]."""
    @property
    def wheel_count(self) -> int:
        """Number of wheels: 2 or 4."""
    def with_multipliers(self, *, left_radius: float = 1.0, right_radius: float = 1.0, track: float = 1.0) -> Drive:
        """Returns the drive with its radii and its track multiplied: what a robot believes whose calibration is wrong.

        Args:
            left_radius: Factor of the radius of the left wheels.
            right_radius: Factor of the radius of the right wheels.
            track: Factor of the track.

        Raises:
            ValueError: A factor or a product is not positive.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> drive.with_multipliers(track=1.5).track
            0.75
        """
    def wheels_of_twist(self, twists: ArrayLike, steering: ArrayLike | None = None) -> NDArray[np.float64]:
        """Returns the rates of the wheels of robots that move at these velocities.

        A wheel does not feel motion across its rolling direction, such as vy on a differential drive.

        Args:
            twists: (N, 3), one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s]. Anything that NumPy can
                convert to float64 without loss.
            steering: (N,) steering angles in -1.5..1.5 [rad]; 0 for drives that do not steer. By default those of
                `steering_of_twist`.

        Returns:
            (N, wheel_count) float64, rate of each wheel [rad/s].

        Raises:
            ValueError: An array has the wrong shape, a number or a result is not finite, or a steering angle is too large or
                not 0 for a drive that does not steer.
            TypeError: An array cannot be converted to float64 without loss.

        Examples:
            A robot with mecanum wheels that moves to the left:

            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1)
            >>> drive.wheels_of_twist([(0.0, 1.0, 0.0)])
            array([[-10.,  10.,  10., -10.]])
        """
    def twist_of_wheels(self, wheels: ArrayLike, steering: ArrayLike | None = None) -> NDArray[np.float64]:
        """Returns the velocities of robots whose wheels turn at these rates and do not slip: the inverse of `wheels_of_twist`.

        An omni drive has more wheels than it needs; the result is the mean of what they say. On an Ackermann drive, only the
        rear wheels count.

        Args:
            wheels: (N, wheel_count) rate of each wheel [rad/s]. Anything that NumPy can convert to float64 without loss.
            steering: (N,) steering angles of Ackermann drives in -1.5..1.5 [rad]. If they are given, the turn rate follows from them. The
                speed is then the mean of what the rear wheels say, without a wheel that has less than half the speed of the
                robot because it is too near to the centre of the turn. By default, the turn rate follows from the difference of
                the rear wheels.

        Returns:
            (N, 3) float64, one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s].

        Raises:
            ValueError: An array has the wrong shape, a number or a result is not finite, or a steering angle is too large or
                not 0 for a drive that does not steer.
            TypeError: An array cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1)
            >>> drive.twist_of_wheels([(-10.0, 10.0, 10.0, -10.0)])
            array([[0., 1., 0.]])
        """
    def steering_of_twist(self, twists: ArrayLike) -> NDArray[np.float64]:
        """Returns the steering angles of Ackermann drives that move at these velocities: `atan(wheelbase * wz / vx)`.

        Args:
            twists: (N, 3), one row (vx, vy, wz) per robot [m/s, m/s, rad/s]. vy is ignored.

        Returns:
            (N,) float64 [rad], within the steering limit; 0 where vx is 0, and for drives that do not steer.

        Raises:
            ValueError: The array has the wrong shape, or a number is not finite.
            TypeError: The array cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.0, track=1.5, wheel_radius=0.3, steering_limit=0.6)
            >>> car.steering_of_twist([(2.0, 0.0, 0.5), (-2.0, 0.0, 0.5), (1.0, 0.0, 9.0)]).round(4)
            array([ 0.4636, -0.4636,  0.6   ])
        """
    def steering_angles(self, steering: ArrayLike) -> NDArray[np.float64]:
        """Returns the angles of the front wheels, whose axes meet that of the rear axle in one point.

        Args:
            steering: (N,) steering angles of robots in -1.5..1.5 [rad]; 0 for drives that do not steer.

        Returns:
            (N, 2) float64, one row (left, right) per robot [rad]; 0 for drives that do not steer.

        Raises:
            ValueError: The array has the wrong shape, or an angle is out of range.
            TypeError: The array cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> car.steering_angles([0.0, 0.5]).round(3)
            array([[0.   , 0.   ],
                   [0.579, 0.439]])
        """
    def steering_angle_rates(self, steering: ArrayLike, rates: ArrayLike) -> NDArray[np.float64]:
        """Returns the rates at which the front wheels steer.

        Args:
            steering: (N,) steering angles of robots in -1.5..1.5 [rad]; 0 for drives that do not steer.
            rates: (N,) rates at which these angles change [rad/s].

        Returns:
            (N, 2) float64, one row (left, right) per robot [rad/s]; 0 for drives that do not steer.

        Raises:
            ValueError: An array has the wrong shape, the lengths differ, an angle is out of range, or a rate is not finite.
            TypeError: An array cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> car.steering_angle_rates([0.0, 0.5], [0.25, 0.25]).round(3)
            array([[0.25 , 0.25 ],
                   [0.325, 0.196]])
        """
    def command(self, twist: _TwistLike, steering_angle: float = 0.0) -> tuple[tuple[float, float, float], float]:
        """Returns what the wheels can do of a commanded velocity, before any limit on speeds.

        Only an omni drive can move sideways; the others ignore vy. An Ackermann drive steers so that its path has the curvature
        of the command, up to its limit. If vx is 0 it cannot turn: it stands still, and steers as before.

        Args:
            twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            steering_angle: Steering angle of the robot if the command does not say how to steer [rad]; 0 for drives that do not
                steer.

        Returns:
            The velocity, and the steering angle to aim at [rad]. The velocity of an Ackermann drive is (vx, 0, 0).

        Raises:
            ValueError: A number is not finite, or there is a steering angle for a drive that does not steer.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> car.command((2.0, 0.5, 0.0))
            ((2.0, 0.0, 0.0), 0.0)
            >>> car.command((1.0, 0.0, 3.0))
            ((1.0, 0.0, 0.0), 0.6)
        """
    def step(
        self, poses: ArrayLike, states: ArrayLike, commands: ArrayLike, dt: float, *, limits: Limits | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Moves many robots with this drive for `dt` seconds, exactly.

        The motion of each robot is that of `WheelMotion`, on all cores. One long step ends where several short ones do, except
        while acceleration limits hold and wheels are at their limit.

        Args:
            poses: (N, 3), one row (x, y, yaw) per robot [m, m, rad]. Anything that NumPy can convert to float64 without loss.
            states: (N, 4), one row (vx, vy, wz, steering) per robot: velocity in the robot's frame and steering angle [m/s, m/s,
                rad/s, rad]. On an Ackermann drive, only vx and steering count. Steering is in -1.5..1.5, and 0 for drives that
                do not steer.
            commands: (N, 3), one row (vx, vy, wz) per robot; see `command`. For an Ackermann drive also (N, 2), one row (speed,
                steering angle) per robot [m/s, rad].
            dt: Duration [s].
            limits: Limits on the velocity and its change; of an Ackermann drive, only those of vx count. None for no limits.

        Returns:
            Poses (N, 3) float64 and states (N, 4) float64 after the step. Yaws are not wrapped.

        Raises:
            ValueError: A shape is wrong, a number or a result is not finite, a steering angle is out of range, or `dt` is
                negative.
            TypeError: An array cannot be converted to float64 without loss.

        Examples:
            A quarter of a circle of 2 m radius, backwards:

            >>> import math
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.0, track=1.5, wheel_radius=0.3, steering_limit=0.8)
            >>> turn = math.pi / 4
            >>> poses, states = car.step([(0, 0, 0)], [(0, 0, 0, turn)], [(-1.0, turn)], dt=math.pi)
            >>> poses.round(3)
            array([[-2.   ,  2.   , -1.571]])
        """
    def odometry(
        self, before: ArrayLike, after: ArrayLike, *, steering_angle: float | None = None, ticks: float = 0.0
    ) -> tuple[float, float, float]:
        """Returns the motion that a robot with this drive computes from the angles of its wheels before and after it.

        Each wheel has an encoder that shows whole counts, so its error is less than one count and does not grow.

        Args:
            before: Angle of each wheel before the motion [rad].
            after: Angle of each wheel after the motion [rad].
            steering_angle: Mean steering angle during the motion in -1.5..1.5 [rad]; see `twist_of_wheels`. None if it is not
                measured.
            ticks: Counts of an encoder per turn of its wheel; 0 for exact encoders.

        Returns:
            Distances forward and to the left [m] and turn [rad] of an arc: `pose.integrate(arc, 1.0)` moves a pose along it.

        Raises:
            ValueError: There is not one angle for each wheel, a number or the result is not finite, the steering angle is out of
                range or not 0 for a drive that does not steer, or `ticks` is negative.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> drive.odometry((0.0, 0.0), (10.0, 10.0))
            (1.0, 0.0, 0.0)
        """
    __hash__: None  # type: ignore[assignment]
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class SurfaceModel:
    """How the surface that a beam meets changes its reading: by angle, light and place, and by the width of the beam.

    It changes the hit part of a `BeamModel`, and which beams have a return: give both to `scan_batch` or a `Fleet`, as `noise` and
    `surfaces`.
    By default all is off.

    The incidence is the angle between the beam and the normal of the surface, 0 for a beam perpendicular to it. It is exact at
    an obstacle. At a blocking cell, the normal is that of the wall around it (`OccupancyGrid.wall_directions`), or of the side
    of the cell where the direction of the wall is unknown.

    Args:
        incidence_sigma: Exponent p, 0 to 4: the standard deviation of a hit is multiplied by `cos(incidence)**-p`. 0.5 is the
            noise of a receiver that counts photons from a matt surface; 1 is the form of Soudarissanane et al. 2009.
        incidence_limit: Incidence from which on nothing grows any further [rad], at least 0 and below π/2.
        incidence_bias: Distance by which hits at a grazing incidence lie behind those at a perpendicular one [m]:
            `incidence_bias * (1 - cos(incidence))` is added.
        correlation: Part of the variance of a hit that is fixed for each beam and cell, 0 to 1. The rest is drawn for each
            scan. So a robot that stands sees a constant part of the error. It depends on the seed, not on the index of the scan.
        reference_range: Distance R at which a surface of reflectivity 1, met at a right angle, returns every second beam [m]. The
            chance of no return at a distance r is `q**4 / (1 + q**4)`, with `q = r**2 / (R**2 * reflectivity * cos(incidence))`.
            A beam without a return reads as one that meets nothing: the maximum range. 0 is off: all beams return.
        beam_divergence: Angle over which a beam is spread [rad], 0 to 0.2. A beam that meets an edge reads one of the two surfaces, or
            a range between them. 0 is off: a beam has no width.
        edge_depth: Smallest difference between the ranges of the two surfaces at an edge [m]. A beam at a smaller step has the
            range of its middle.
        mixing_length: Two surfaces at an edge whose ranges differ by at most this much can be mixed [m]. If the near one has a share s
            of the beam, the beam reads the near one with the probability `s**2`, the far one with `(1 - s)**2`, else a range
            between them. If they are farther apart, these are s, 1 - s and 0.

    Raises:
        ValueError: A number is out of its range or not finite.

    Examples:
        Readings of a wall that the beam meets at 60°: cos(60°) = 0.5.

        >>> import math
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> cells = np.zeros((100, 100), np.int8)
        >>> cells[:, 80] = 100
        >>> grid = mrs.OccupancyGrid(cells, resolution=0.05)
        >>> laser, poses = mrs.LaserScanner(beam_count=1), np.tile([3.0, 1.0, math.radians(60)], (10_000, 1))
        >>> noise = mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0)
        >>> surfaces = mrs.SurfaceModel(incidence_sigma=1.0)
        >>> laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=1).std().round(3)
        np.float32(0.02)
    """

    def __new__(
        cls,
        *,
        incidence_sigma: float = 0.0,
        incidence_limit: float = 1.5,
        incidence_bias: float = 0.0,
        correlation: float = 0.0,
        reference_range: float = 0.0,
        beam_divergence: float = 0.0,
        edge_depth: float = 0.1,
        mixing_length: float = 0.75,
    ) -> Self: ...
    @property
    def incidence_sigma(self) -> float:
        """Exponent of the standard deviation of a hit by incidence."""
    @property
    def incidence_limit(self) -> float:
        """Incidence from which on nothing grows any further [rad]."""
    @property
    def incidence_bias(self) -> float:
        """Distance by which hits at a grazing incidence lie behind those at a perpendicular one [m]."""
    @property
    def correlation(self) -> float:
        """Part of the variance of a hit that is fixed for each beam and cell."""
    @property
    def reference_range(self) -> float:
        """Distance at which a surface of reflectivity 1, met at a right angle, returns every second beam [m]; 0 is off."""
    @property
    def beam_divergence(self) -> float:
        """Angle over which a beam is spread [rad]; 0 is off."""
    @property
    def edge_depth(self) -> float:
        """Smallest difference between the ranges of the two surfaces at an edge [m]."""
    @property
    def mixing_length(self) -> float:
        """Largest difference of two ranges that become one reading between them [m]."""

@final
class WheelMotion:
    """The motion of a robot from the time on at which its wheels begin to follow a command.

    The velocity changes under limits as in `Limits.apply`, and the steering angle at its rate. No wheel turns faster than its
    limit: the velocity is scaled down at each moment, so that the robot stays on its path.

    The motion is exact up to rounding at a constant steering angle, where the path of an Ackermann drive is an arc. While the
    steering angle changes, and while limits on acceleration and on the wheels act together, the pose is an integral by
    Gauss-Legendre quadrature with an error below 1e-9 m, for a path of up to 1 km.

    Args:
        drive: Wheels of the robot.
        current: Velocity (vx, vy, wz) at the start, in the robot's frame [m/s, m/s, rad/s].
        wanted: Commanded velocity, as `Drive.command` returns it. Of an Ackermann drive, only vx counts, here and in `current`.
        limits: Limits on the velocity and its change; of an Ackermann drive, only those of vx count. None for no limits.
        steering_angle: Steering angle at the start, in -1.5..1.5 [rad]; limited to what the drive can do.
        steering_goal: Steering angle to aim at [rad]; limited to what the drive can do. Default: `steering_angle`.
        steering_rate: Largest change of the steering angle per second [rad/s], beside that of the drive.

    Raises:
        ValueError: A number is not finite, the angle at the start is out of range, the rate is not positive, or a drive that
            does not steer has an angle other than 0 or a finite rate. The rate can be infinite.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
        >>> motion = mrs.WheelMotion(car, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), steering_goal=0.5)
        >>> motion.steering(1.0), motion.steering(3.0)
        (0.25, 0.5)
    """

    def __new__(
        cls,
        drive: Drive,
        current: _TwistLike,
        wanted: _TwistLike,
        *,
        limits: Limits | None = None,
        steering_angle: float = 0.0,
        steering_goal: float | None = None,
        steering_rate: float = inf,
    ) -> Self: ...
    @property
    def drive(self) -> Drive:
        """Wheels of the robot."""
    def velocity(self, time: float) -> tuple[float, float, float]:
        """Returns the velocity of the robot if its wheels do not slip.

        Args:
            time: Time from the start on [s].

        Returns:
            (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 0.5))
            >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (1.5, 0.0, 0.0), limits=limits)
            >>> motion.velocity(2.0)
            (1.0, 0.0, 0.0)
        """
    def ramp_velocity(self, time: float) -> tuple[float, float, float]:
        """Returns the velocity from which another motion goes on, as the argument `current`.

        Args:
            time: Time from the start on [s].

        Returns:
            (vx, vy, wz) before the limit of the wheels; only the speed of an Ackermann drive [m/s, m/s, rad/s].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1, wheel_speed_limit=10.0)
            >>> motion = mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
            >>> motion.velocity(0.0), motion.ramp_velocity(0.0)
            ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))
        """
    def steering(self, time: float) -> float:
        """Returns the steering angle of the robot.

        Args:
            time: Time from the start on [s].

        Returns:
            Steering angle [rad].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), steering_goal=-0.5)
            >>> motion.steering(1.0)
            -0.25
        """
    def steering_rate(self, time: float) -> float:
        """Returns the rate of change of the steering angle.

        Args:
            time: Time from the start on [s].

        Returns:
            Rate of change [rad/s].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
            >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), steering_goal=-0.5)
            >>> motion.steering_rate(1.0), motion.steering_rate(3.0)
            (-0.25, 0.0)
        """
    def wheels(self, time: float) -> NDArray[np.float64]:
        """Returns the rate of each wheel.

        Args:
            time: Time from the start on [s].

        Returns:
            (wheel_count,) float64 [rad/s].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 1.0)).wheels(0.0)
            array([ 7.5, 12.5])
        """
    def rolled(self, time: float) -> NDArray[np.float64]:
        """Returns the angle by which each wheel has turned.

        Args:
            time: Time from the start on [s].

        Returns:
            (wheel_count,) float64 [rad].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 1.0)).rolled(2.0)
            array([15., 25.])
        """
    def integrate(self, pose: _PoseLike, time: float, *, grip: float = 1.0) -> Pose:
        """Returns the pose that the robot reaches.

        Args:
            pose: Pose at the start.
            time: Duration [s].
            grip: Share of the motion of the wheels that the robot makes, in 0..1; 1 without slip.

        Returns:
            The pose after the time. Its yaw is not wrapped.

        Raises:
            ValueError: A number or the resulting pose is not finite, the grip is not in 0..1, or the time is negative.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6)
            >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (1.5, 0.0, 0.0))
            >>> motion.integrate(mrs.Pose(), 2.0)
            Pose(3.0, 0.0, 0.0)
        """
    def trace(self, pose: _PoseLike, times: ArrayLike, *, grip: float = 1.0) -> NDArray[np.float64]:
        """Returns the poses that the robot reaches at several times: those of `integrate`.

        Args:
            pose: Pose at the start.
            times: (N,) times from the start on [s]. Anything that NumPy can convert to float64 without loss.
            grip: Share of the motion of the wheels that the robot makes, in 0..1; 1 without slip.

        Returns:
            (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.

        Raises:
            ValueError: `times` is not one-dimensional, a time is negative, the grip is not in 0..1, or a number or a pose reached
                is not finite.
            TypeError: `times` cannot be converted to float64 without loss.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)).trace(mrs.Pose(), [0.0, 0.5])
            array([[0. , 0. , 0. ],
                   [0.5, 0. , 0. ]])
        """
    def distance(self, time: float) -> float:
        """Returns the length of the path that the robot has driven without slip. Turning in place adds nothing.

        Args:
            time: Time from the start on [s].

        Returns:
            The length [m].

        Raises:
            ValueError: The time is negative or not finite.

        Examples:
            >>> import mobile_robot_simulator as mrs
            >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
            >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (-1.0, 0.0, 0.5)).distance(2.0)
            2.0
        """
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class MotionNoise:
    """Odometry noise: the velocity motion model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 5.3.

    At speed v and turn rate ω, a step has three independent normal errors: of the speed, with variance alpha1·v² +
    alpha2·ω²; of the turn rate, with variance alpha3·v² + alpha4·ω²; and of an extra turn rate, with variance alpha5·v² +
    alpha6·ω², that turns the robot at the end of the step. As in the book, each step draws new errors, which hold for the
    whole step. The error of a drive therefore depends on the length of its steps, unless a reference step is given: the
    variances then hold for a step of this duration, and those of a step of `dt` seconds are larger by `reference_step / dt`,
    so that the errors of a drive do not depend on its division into steps. All parameters are 0 by default: no noise.

    Args:
        alpha1: Variance of the speed per v² [1].
        alpha2: Variance of the speed per ω² [m²/rad²].
        alpha3: Variance of the turn rate per v² [rad²/m²].
        alpha4: Variance of the turn rate per ω² [1].
        alpha5: Variance of the extra turn rate per v² [rad²/m²].
        alpha6: Variance of the extra turn rate per ω² [1].
        reference_step: Duration of the step for which the variances hold [s]; None: they hold for every step.

    Raises:
        ValueError: A parameter is negative or not finite, or the reference step is not positive.

    Examples:
        >>> from mobile_robot_simulator import MotionNoise
        >>> MotionNoise(alpha1=0.01, alpha4=0.02).alpha
        (0.01, 0.0, 0.0, 0.02, 0.0, 0.0)
    """

    def __new__(
        cls,
        *,
        alpha1: float = 0.0,
        alpha2: float = 0.0,
        alpha3: float = 0.0,
        alpha4: float = 0.0,
        alpha5: float = 0.0,
        alpha6: float = 0.0,
        reference_step: float | None = None,
    ) -> Self: ...
    @property
    def alpha(self) -> tuple[float, float, float, float, float, float]:
        """The parameters (alpha1, ..., alpha6)."""
    @property
    def reference_step(self) -> float | None:
        """Duration of the step for which the variances hold [s]; None if they hold for every step."""
    def sample(
        self, pose: _PoseLike, twist: _TwistLike, dt: float, *, seed: int | RandomStream, index: int | None = None
    ) -> Pose:
        """Returns a random pose that a robot may reach in `dt` seconds when it is commanded to move at a twist.

        This is `sample_motion_model_velocity` of Probabilistic Robotics, table 5.3, with an arc that is exact at every turn
        rate. The speed error points along the direction of travel, or forward if the robot turns in place.

        Args:
            pose: Pose (x, y, yaw) at the start of the step [m, m, rad].
            twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            dt: Duration of the step [s].
            seed: Seed of the random stream, 0 to 2**64 - 1, or a `RandomStream`, which counts the steps of all calls.
            index: Index of the step, 0 to 2**64 - 1. The same seed and index give the same errors on every machine. Must be
                given with a number as seed.

        Returns:
            The pose reached. Its yaw is not wrapped.

        Raises:
            ValueError: An argument or the pose reached is not finite, or the seed or index is out of range.
            TypeError: The seed or index is not an integer.

        Examples:
            Without noise, the pose is exact:

            >>> from mobile_robot_simulator import MotionNoise
            >>> MotionNoise().sample((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2.0, seed=1, index=0)
            Pose(2.0, 0.0, 0.0)
        """
    def propagate(self, covariance: ArrayLike, pose: _PoseLike, twist: _TwistLike, dt: float) -> NDArray[np.float64]:
        """Returns the covariance of (x, y, yaw) after a step, given the covariance before it.

        The result is F·P·Fᵀ + V·M·Vᵀ, to first order in the errors (Probabilistic Robotics, table 7.2, lines 3 to 7). F and
        V are the exact derivatives of the arc with respect to the pose and to the three errors; M holds the variances of the
        errors (table 5.3). First order is accurate while the standard deviation of the yaw is below about 0.2 rad.

        Args:
            covariance: (3, 3), covariance of (x, y, yaw) before the step [m², m·rad, rad²].
            pose: True or estimated pose (x, y, yaw) at the start of the step [m, m, rad].
            twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            dt: Duration of the step [s].

        Returns:
            (3, 3) float64, the covariance after the step. It is exactly symmetric.

        Raises:
            ValueError: The covariance has another shape, or an argument or the result is not finite.
            TypeError: The covariance cannot be converted to float64 without loss.

        Examples:
            At 2 m/s, the variance of the speed is 0.01 · 2²:

            >>> import numpy as np
            >>> from mobile_robot_simulator import MotionNoise
            >>> MotionNoise(alpha1=0.01).propagate(np.zeros((3, 3)), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), dt=1.0)
            array([[0.04, 0.  , 0.  ],
                   [0.  , 0.  , 0.  ],
                   [0.  , 0.  , 0.  ]])
        """
    def twist_covariance(self, twist: _TwistLike, dt: float) -> NDArray[np.float64]:
        """Returns the covariance of the mean velocity (vx, vy, wz) in a step.

        The mean velocity is the constant twist between the poses at the start and at the end of the step; see
        `Pose.twist_to`. The covariance is to first order in the errors and in the turn during the step.

        Args:
            twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
            dt: Duration of the step [s].

        Returns:
            (3, 3) float64 [m²/s², m·rad/s², rad²/s²].

        Raises:
            ValueError: An argument or the result is not finite.

        Examples:
            >>> from mobile_robot_simulator import MotionNoise
            >>> noise = MotionNoise(alpha1=0.01, alpha4=0.02, reference_step=0.1)
            >>> noise.twist_covariance((2.0, 0.0, 1.0), dt=0.1).diagonal().tolist()
            [0.04, 0.0, 0.02]
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

def touches(grid: OccupancyGrid, footprint: Shape, pose: _PoseLike, *, obstacles: _Obstacles = ()) -> bool:
    """Returns True if a footprint shares a point with a blocking cell or an obstacle.

    Edges belong to footprints, cells and obstacles, so a shared edge or corner is a contact.

    Args:
        grid: Map that the robot moves in. Outside the grid is free.
        footprint: Outline of the robot in its own frame.
        pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
        obstacles: Pairs (Shape, pose), with poses in the map frame.

    Raises:
        ValueError: A pose is not finite.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> robot = mrs.Shape.disc(0.5)
        >>> mrs.touches(grid, robot, (1.4, 0.5, 0.0)), mrs.touches(grid, robot, (1.6, 0.5, 0.0))
        (False, True)
    """

def clearance(grid: OccupancyGrid, footprint: Shape, pose: _PoseLike, *, limit: float, obstacles: _Obstacles = ()) -> float:
    """Returns the exact distance [m] from a footprint to the nearest blocking cell or obstacle.

    Args:
        grid: Map that the robot moves in. Outside the grid is free.
        footprint: Outline of the robot in its own frame.
        pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
        limit: Distance up to which to search [m]. In empty space, the cost grows with its square.
        obstacles: Pairs (Shape, pose), with poses in the map frame.

    Returns:
        The distance [m]: 0 if the footprint touches something, `limit` if there is nothing within `limit`.

    Raises:
        ValueError: A pose is not finite, or `limit` is not positive and finite.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> mrs.clearance(grid, mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), limit=9.0)
        1.0
    """

def clearance_batch(
    grid: OccupancyGrid,
    footprint: Shape,
    poses: ArrayLike,
    *,
    limit: float,
    obstacles: _Obstacles = (),
    threads: int | None = None,
) -> NDArray[np.float64]:
    """Returns the clearance of a footprint at each of many poses: `clearance` of each row.

    Args:
        grid: Map that the robot moves in. Outside the grid is free.
        footprint: Outline of the robot in its own frame.
        poses: (N, 3), one row (x, y, yaw) per pose of the robot in the map frame [m, m, rad]. Anything that NumPy can convert
            to float64 without loss. More than 5,000 poses are read in place, without a copy, so no other thread may write
            to them during the call.
        limit: Distance up to which to search [m]. In empty space, the cost grows with its square.
        obstacles: Pairs (Shape, pose), with poses in the map frame.
        threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.

    Returns:
        (N,) float64, the distances [m]: 0 where the footprint touches something, `limit` where there is nothing within
            `limit`.

    Raises:
        ValueError: A shape is wrong, a pose is not finite, `limit` is not positive and finite, or `threads` is out of range.
        TypeError: An argument has the wrong type or dtype.
        OSError: The threads could not be started.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> mrs.clearance_batch(grid, mrs.Shape.disc(0.5), [(0.5, 0.5, 0.0), (1.0, 0.5, 0.0)], limit=9.0)
        array([1. , 0.5])
    """

def scan_each(
    scans: Iterable[
        tuple[
            LaserScanner,
            OccupancyGrid,
            _PoseLike,
            _Obstacles,
            BeamModel | None,
            SurfaceModel | None,
            int,
            int,
        ]
    ],
    *,
    threads: int | None = None,
) -> list[NDArray[np.float32]]:
    """Returns scans in one instant, each of a scanner, of a map and among obstacles of its own: the scans of `scan_batch`.

    Args:
        scans: Tuples (scanner, grid, pose, obstacles, noise, surfaces, seed, index), one for each scan: a `LaserScanner`, and
            the arguments of its `scan_batch` for one pose; `index` stands for `first_index`. Surfaces, seed and index have
            an effect only with noise. Scans of equal scanners in one map are the fastest side by side.
        threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.

    Returns:
        A list with the readings of each scan, (beam_count,) float32 [m].

    Raises:
        ValueError: As for `scan_batch`, or a tuple has another length.
        TypeError: An argument has the wrong type.
        OSError: The threads could not be started.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> from mobile_robot_simulator._core import scan_each
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> scanner, pose = mrs.LaserScanner(beam_count=1), (0.5, 0.5, 0.0)
        >>> scan_each([(scanner, grid, pose, (), None, None, 0, 0)])
        [array([1.5], dtype=float32)]
    """

def stays_clear(
    grid: OccupancyGrid,
    footprint: Shape,
    pose: _PoseLike,
    velocity: _TwistLike,
    command: _TwistLike,
    dt: float,
    *,
    obstacles: _Obstacles = (),
) -> bool:
    """Returns True if a quick look shows that a robot touches nothing for some time. False means that it may touch something.

    The cost grows with the number of obstacles and with the cells that the robot could reach.

    Args:
        grid: Map that the robot moves in. Outside the grid is free.
        footprint: Outline of the robot in its own frame.
        pose: Pose (x, y, yaw) of the robot in the map frame at the start [m, m, rad].
        velocity: Velocity (vx, vy, wz) in the robot's frame at the start [m/s, m/s, rad/s].
        command: Velocity (vx, vy, wz) that it approaches. Each component stays between the two, or between zero and one of
            them.
        dt: The time [s].
        obstacles: Pairs (Shape, pose), with poses in the map frame. They stand still.

    Raises:
        ValueError: The pose is not finite.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> from mobile_robot_simulator._core import stays_clear
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> robot, pose, standing = mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), (0.0, 0.0, 0.0)
        >>> [stays_clear(grid, robot, pose, standing, (1.0, 0.0, 0.0), dt) for dt in (0.2, 2.0)]
        [True, False]
    """

def advance(
    grid: OccupancyGrid,
    footprint: Shape,
    pose: _PoseLike,
    twist: _TwistLike,
    dt: float,
    *,
    mode: Literal["stop", "slide", "report"] = "stop",
    obstacles: _Obstacles = (),
) -> tuple[Pose, Contact | None]:
    """Returns the pose of a robot after `dt` seconds at a constant twist, and its first contact on the way.

    The robot follows the exact arc of `Pose.integrate`. Contacts are found by conservative advancement (Mirtich 1996,
    section 2.3) with second-order bounds. `mode` says what a contact does:

    - "stop": The robot stops at most 1e-6 m before the wall or obstacle, never inside it.
    - "slide": The robot continues for the rest of the step. Its linear velocity loses the part that would push a point of
      contact into the wall or obstacle.
    - "report": The robot passes through everything; the contact is only reported.

    A robot that overlaps something at the start has a contact with fraction 0. It then moves with a smaller footprint: the
    largest copy, scaled about its origin, that overlaps nothing. It can move out or along the wall or obstacle, but not
    deeper. A robot whose origin is inside a wall or obstacle moves freely.

    Args:
        grid: Map that the robot moves in. Outside the grid is free.
        footprint: Outline of the robot in its own frame.
        pose: Pose (x, y, yaw) of the robot in the map frame at the start [m, m, rad].
        twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
        dt: Duration of the step [s].
        mode: What a contact does: "stop", "slide" or "report".
        obstacles: Pairs (Shape, pose), with poses in the map frame. They stand still during the step.

    Returns:
        The pose reached, and the first contact or None. Without a contact, the pose equals `pose.integrate(twist, dt)`.

    Raises:
        ValueError: An argument or the pose reached is not finite, `dt` is negative or so long that the robot would move
            more than 100000 times its own size, or the mode is unknown.

    Examples:
        The only wall covers x from 2 m to 3 m. The robot stops half way, when its edge reaches the wall:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> pose, contact = mrs.advance(grid, mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), (1.0, 0.0, 0.0), dt=2.0)
        >>> round(pose.x, 3), round(contact.fraction, 3), contact.obstacle
        (1.5, 0.5, None)
    """

def cast_rays(
    grid: OccupancyGrid,
    rays: ArrayLike,
    max_range: float,
    *,
    obstacles: _Obstacles = (),
    threads: int | None = None,
    out: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """Returns the range of each ray: the distance at which it enters the first blocking cell or obstacle.

    The rays are independent; for the beams of a scanner, use `LaserScanner.scan_batch`. Ranges are exact: the grid traversal
    follows Amanatides & Woo (1987), section 2. More than 5,000 rays are read in place, without a copy, so no other thread
    may write to them during the call.

    Args:
        grid: Map to cast the rays in.
        rays: (N, 3), one row (x, y, direction) per ray in the map frame [m, m, rad]. Rays may start outside the grid.
            Anything that NumPy can convert to float64 without loss.
        max_range: Range of a ray that hits nothing [m].
        obstacles: Pairs (Shape, pose) that also stop rays, with poses in the map frame.
        threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
        out: (N,) float32 in C order, an array for the result. None means a new array.

    Returns:
        (N,) float32 [m], which is `out` if it was given. A ray that starts inside a blocking cell or an obstacle has range
            0. A ray that hits nothing within `max_range` has exactly `max_range`.

    Raises:
        ValueError: A shape is wrong, a number is not finite, `max_range` is not positive, `threads` is out of range, or
            `out` is read-only, in use or not in C order.
        TypeError: An argument has the wrong type or dtype.
        OSError: The threads could not be started.

    Examples:
        The only wall covers x from 2 m to 3 m:

        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
        >>> rays = np.array([[0.5, 0.5, 0.0], [0.5, 0.5, np.pi]])
        >>> mrs.cast_rays(grid, rays, max_range=9.0)
        array([1.5, 9. ], dtype=float32)
    """

def laser_presets() -> dict[str, dict[str, float]]:
    """Returns the parameters of laser scanners that are sold, as their makers or their users published them.

    `docs/reference/sensors.md` gives the source of each number. A parameter without a source is missing.

    Returns:
        Parameters of the laser node by name, for each preset by name.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> sensor = mrs.laser_presets().get("hokuyo_utm30lx")
        >>> sensor.get("laser_beam_count")
        1081
    """

def integrate_twist(poses: ArrayLike, twists: ArrayLike, dt: float) -> NDArray[np.float64]:
    """Returns the pose that each robot of a batch reaches after `dt` seconds at a constant twist.

    The arcs are exact, not Euler steps: the exponential map of SE(2). `Pose.integrate` gives the formula.

    Args:
        poses: (N, 3), one row (x, y, yaw) per robot [m, m, rad]. Anything that NumPy can convert to float64 without loss.
        twists: (N, 3), one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s], as for `poses`.
        dt: Duration [s]. A negative one goes backwards in time.

    Returns:
        (N, 3) float64, one row (x, y, yaw) per robot. The yaw is not wrapped.

    Raises:
        ValueError: A shape is wrong, the lengths differ, or an argument or a pose reached is not finite.
        TypeError: An array cannot be converted to float64 without loss.

    Examples:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> mrs.integrate_twist(np.array([[1.0, 2.0, 0.0]]), np.array([[0.5, 0.0, 0.0]]), dt=4.0)
        array([[3., 2., 0.]])
    """

def commands_from_actions(
    actions: NDArray[np.float64],
    max_velocity: NDArray[np.float64],
    *,
    out: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Returns the command of each robot: the shares of the largest velocity that its action asks for, cut to [-1, 1].

    Args:
        actions: (N, 2), shares along x and in rotation, or (N, 3), along x, along y and in rotation.
        max_velocity: As many largest velocities [m/s, rad/s].
        out: (N, 3) float64 in C order to write the commands to; None for a new array.

    Returns:
        (N, 3) float64, rows (vx, vy, wz) [m/s, m/s, rad/s].

    Raises:
        ValueError: A shape is wrong, an action is not finite, or a velocity is not positive and finite.
        TypeError: An argument has the wrong type or dtype.

    Examples:
        >>> import numpy as np
        >>> from mobile_robot_simulator._core import commands_from_actions
        >>> commands_from_actions(np.array([[0.5, -2.0]]), (0.6, 1.5))
        array([[ 0.3,  0. , -1.5]])
    """

def judge_steps(
    *,
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    contacts: NDArray[np.bool_],
    velocities: NDArray[np.float64],
    elapsed: NDArray[np.int64],
    duration: float,
    weights: Sequence[float],
    goal_radius: float,
    step_limit: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Returns what a step of each of some robots on their ways to goals is worth.

    Args:
        before: (N, 2), distance [m] and bearing [rad] of each robot's goal before the step, as from `Fleet.relative`.
        after: (N, 2), the same after the step.
        contacts: (N,) bool, whether each robot touched something.
        velocities: (N, 3), rows (vx, vy, wz) after the step [m/s, m/s, rad/s].
        elapsed: (N,) int64, number of steps of the episode of each robot, with this one.
        duration: Duration of the step [s].
        weights: Five weights: for each metre of progress, for the goal, for a contact, for each second, and for each radian turned.
        goal_radius: Distance at which a robot is at its goal, unless it touches something [m].
        step_limit: Number of steps after which the time of an episode is over.

    Returns:
        The rewards, (N,) float64; their parts in the order of the weights, (5, N) float64; whether each robot is at its goal, (N,)
        bool; and whether its time is over, (N,) bool, false for episodes that have ended otherwise.

    Raises:
        ValueError: A shape is wrong, a weight is not finite, or the duration or the radius is not positive.
        TypeError: An argument has the wrong type or dtype.
        OverflowError: `step_limit` is too large.

    Examples:
        >>> import numpy as np
        >>> from mobile_robot_simulator._core import judge_steps
        >>> rewards, parts, reached, truncated = judge_steps(
        ...     before=np.array([[1.0, 0.0]]),
        ...     after=np.array([[0.25, 0.0]]),
        ...     contacts=np.array([False]),
        ...     velocities=np.zeros((1, 3)),
        ...     elapsed=np.array([7]),
        ...     duration=0.5,
        ...     weights=(1.0, 10.0, -10.0, -0.5, 0.0),
        ...     goal_radius=0.3,
        ...     step_limit=600,
        ... )
        >>> rewards, parts[:, 0], reached, truncated
        (array([10.5]), array([ 0.75, 10.  ,  0.  , -0.25,  0.  ]), array([ True]), array([False]))
    """
