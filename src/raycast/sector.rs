//! The eight sectors of 45° that directions fall into, and the symmetry that makes them one.

use glam::DVec2;

/// An eighth of all directions: which way a ray goes along each axis, and along which axis it goes farther.
///
/// Mirrored along the axes it goes down, and with its axes swapped if it goes farther along y, every ray goes up both axes and
/// farther along the first, its major one. Negation is exact, so distances keep all their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sector(u32);

impl Sector {
    /// The number of sectors.
    pub const COUNT: usize = 8;

    /// The sector of a direction; both zeros count as positive, and a diagonal goes along x.
    #[inline]
    #[must_use]
    pub fn of(direction: DVec2) -> Self {
        let (left, down) = (u32::from(direction.x < 0.0), u32::from(direction.y < 0.0));
        Self(left | down << 1 | u32::from(direction.y.abs() > direction.x.abs()) << 2)
    }

    /// All of them, by number.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT as u32).map(Self)
    }

    /// The sector of a number.
    ///
    /// # Panics
    /// If the number is not less than [`COUNT`](Self::COUNT).
    #[must_use]
    pub fn numbered(number: usize) -> Self {
        assert!(number < Self::COUNT, "there is no sector {number}");
        Self(number as u32)
    }

    /// The number of the sector, less than [`COUNT`](Self::COUNT).
    #[inline]
    #[must_use]
    pub fn number(self) -> u32 {
        self.0
    }

    /// Whether columns fall along the ray.
    #[inline]
    #[must_use]
    pub fn is_left(self) -> bool {
        self.0 & 1 != 0
    }

    /// Whether rows fall along the ray.
    #[inline]
    #[must_use]
    pub fn is_down(self) -> bool {
        self.0 & 2 != 0
    }

    /// Whether the major axis is y.
    #[inline]
    #[must_use]
    pub fn is_steep(self) -> bool {
        self.0 & 4 != 0
    }

    /// What belongs to (x, y), as (major, minor).
    #[inline]
    #[must_use]
    pub fn order<T>(self, x: T, y: T) -> (T, T) {
        if self.is_steep() { (y, x) } else { (x, y) }
    }
}
