//! The order in which the scans of a batch are cast: along a curve through the map, so that successive scans read the same memory.

use crate::error::Error;
use crate::grid::OccupancyGrid;
use crate::memory;

/// Grids with fewer cells than this have free boxes that the caches hold, so the order does not matter. Measured.
const MIN_CELLS: usize = 1 << 18;

/// Batches with fewer scans, or with fewer beams a scan, do not gain.
const MIN_SCANS: usize = 1000;
const MIN_BEAMS: usize = 100;

/// Returns the rows of a batch and their numbers, in the order in which to cast them.
///
/// The order is that of a curve (Morton 1966): it follows the bits of the column and of the row of the pose, in turns.
///
/// # Errors
/// [`Error::Memory`]: there is not enough memory.
pub fn along_curve<'a>(
    grid: &OccupancyGrid,
    poses: &[[f64; 3]],
    readings: &'a mut [f32],
    beam_count: usize,
) -> Result<Vec<(usize, &'a mut [f32])>, Error> {
    const WHAT: &str = "the order of the scans";
    // A cast from a negative or a large number saturates.
    let key = |pose: [f64; 3]| {
        let at = grid.in_cells(grid.pose_in_grid(pose.into()).position);
        u64::from(spread(at.x as u16) | spread(at.y as u16) << 1)
    };
    let mut order = memory::collected(WHAT, poses.iter().enumerate().map(|(scan, &pose)| key(pose) << 32 | scan as u64))?;
    order.sort_unstable();
    let mut rows = memory::collected(WHAT, readings.chunks_exact_mut(beam_count).map(Some))?;
    let mut ordered = memory::with_room(WHAT, rows.len())?;
    let scans = order.iter().map(|&entry| entry as u32 as usize);
    ordered.extend(scans.filter_map(|scan| Some((scan, rows[scan].take()?))));
    Ok(ordered)
}

/// Returns true if it is worth while to cast a batch in the order of [`along_curve`].
pub fn matters(grid: &OccupancyGrid, scans: usize, beam_count: usize) -> bool {
    grid.cells().len() >= MIN_CELLS && (MIN_SCANS..=u32::MAX as usize).contains(&scans) && beam_count >= MIN_BEAMS
}

/// Returns a number with a 0 after each bit of `bits`.
fn spread(bits: u16) -> u32 {
    let mut spread = u32::from(bits);
    for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
        spread = (spread | spread << shift) & mask;
    }
    spread
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GridOptions, OCCUPIED_THRESHOLD, Pose, Unknown};

    #[test]
    fn rows_follow_the_curve_and_keep_their_numbers() {
        let options = GridOptions {
            resolution: 0.5,
            origin: Pose::default(),
            occupied_threshold: OCCUPIED_THRESHOLD,
            unknown: Unknown::Free,
        };
        let grid = OccupancyGrid::new(vec![0; 16], 4, options).expect("a grid");
        // Cells (1, 1), (0, 0), (2, 0), (0, 1), off the grid on the lower left, (1, 0).
        let poses = [[0.7, 0.7, 0.0], [0.1, 0.1, 0.0], [1.2, 0.2, 0.0], [0.2, 0.9, 0.0], [-9.0, -3.0, 0.0], [0.9, 0.1, 0.0]];
        let mut readings: Vec<f32> = (0..12_u8).map(f32::from).collect();
        let rows = along_curve(&grid, &poses, &mut readings, 2).expect("enough memory");
        let found: Vec<(usize, f32)> = rows.iter().map(|(scan, row)| (*scan, row[0])).collect();
        assert_eq!(found, [(1, 2.0), (4, 8.0), (5, 10.0), (3, 6.0), (0, 0.0), (2, 4.0)]);
    }
}
