//! Places: the cells at whose sides the beams of a scan end, found from their ranges.

use crate::grid::OccupancyGrid;
use crate::motion::PoseColumns;
use crate::numeric::sincos::{Last, sincos};
use crate::numeric::{GROUP, Group};
use crate::pose::Pose;

/// Greatest distance \[cells\] between the end of a beam and the side of the cell that it meets: more than rounding errors.
const ON_SIDE: f64 = 1e-6;

/// Number that is added to another, and subtracted again, to round it to a whole number.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// From here on, float64 numbers are whole.
const UNIT: f64 = (1_u64 << 52) as f64;

/// Index for a beam that does not end on the side of a cell.
pub const NOWHERE: u32 = u32::MAX;

/// Where the beams of a group end.
pub struct Places {
    /// Index of the cell of each beam, row by row; [`NOWHERE`] if it does not end on the side of a cell.
    pub cells: [u32; GROUP],
    /// True, as a number, for beams that end somewhere else.
    pub is_other: [u32; GROUP],
    /// True, as a number, for beams that end so near to the corner of a cell that they may meet another one.
    pub is_corner: [u32; GROUP],
    /// True, as a number, for beams that meet the side of a column.
    pub at_column: [u32; GROUP],
}

impl Places {
    /// Returns the places of beams with these origins \[cells\] and directions in the frame of the grid, and these ranges \[m\]:
    /// infinite without a return.
    #[inline(always)]
    pub fn new(grid: &OccupancyGrid, [x, y, dx, dy]: &[Group; 4], ranges: &Group) -> Self {
        let (width, height) = (grid.width() as f64, grid.height() as f64);
        let per_cell = 1.0 / grid.resolution();
        let zero = [0_u32; GROUP];
        let mut places = Self { cells: zero, is_other: zero, is_corner: zero, at_column: zero };
        for slot in 0..GROUP {
            let distance = ranges[slot] * per_cell;
            let (px, py) = (x[slot] + dx[slot] * distance, y[slot] + dy[slot] * distance);
            let (line_x, line_y) = ((px + WHOLE) - WHOLE, (py + WHOLE) - WHOLE);
            let (off_x, off_y) = ((px - line_x).abs(), (py - line_y).abs());
            // The beam enters the cell through the side on the nearer line.
            let at_column = off_x < off_y;
            let before = |line: f64, direction: f64| if direction < 0.0 { line - 1.0 } else { line };
            let floor = |value: f64, line: f64| if line > value { line - 1.0 } else { line };
            let col = if at_column { before(line_x, dx[slot]) } else { floor(px, line_x) };
            let row = if at_column { floor(py, line_y) } else { before(line_y, dy[slot]) };
            let (off, other) = if at_column { (off_x, off_y) } else { (off_y, off_x) };
            let is_hit = (ranges[slot] > 0.0) & (ranges[slot] < f64::INFINITY);
            let is_on_grid = (col >= 0.0) & (col < width) & (row >= 0.0) & (row < height);
            let has_place = is_hit & is_on_grid & (off < ON_SIDE);
            places.is_other[slot] = u32::from(is_hit & !has_place);
            // A whole number is in the low bits of its sum with 2⁵².
            places.cells[slot] = if has_place { (row * width + col + UNIT).to_bits() as u32 } else { NOWHERE };
            places.is_corner[slot] = u32::from(other < ON_SIDE);
            places.at_column[slot] = u32::from(at_column);
        }
        places
    }
}

/// Returns x and y of the origins \[cells\] of beams that spread from these poses in the map, and of their directions, in the frame of
/// the grid.
#[inline(always)]
pub fn rays_from(grid: &OccupancyGrid, map_from_fan: &PoseColumns, (cos, sin): (&Group, &Group)) -> [Group; 4] {
    let [mut x, mut y, mut yaw] = [[0.0; GROUP]; 3];
    for slot in 0..GROUP {
        let pose = Pose::new(map_from_fan.x[slot], map_from_fan.y[slot], map_from_fan.yaw[slot]);
        let pose = grid.pose_in_grid(pose);
        (x[slot], y[slot]) = grid.in_cells(pose.position).into();
        yaw[slot] = pose.yaw;
    }
    let [dx, dy] = turned_by(&yaw, (cos, sin));
    [x, y, dx, dy]
}

/// Returns directions turned by angles \[rad\].
#[inline(always)]
pub fn turned_by(yaw: &Group, (cos, sin): (&Group, &Group)) -> [Group; 2] {
    let [mut sin_yaw, mut cos_yaw, mut dx, mut dy] = [[0.0; GROUP]; 4];
    sincos(yaw, &mut sin_yaw, &mut cos_yaw, &mut Last::default());
    for slot in 0..GROUP {
        dx[slot] = cos_yaw[slot] * cos[slot] - sin_yaw[slot] * sin[slot];
        dy[slot] = sin_yaw[slot] * cos[slot] + cos_yaw[slot] * sin[slot];
    }
    [dx, dy]
}
