//! Materials, and the layer of a map that says which cell is of which material.

use std::f64::consts::FRAC_PI_2;

use crate::error::{Error, check_number};

/// What a surface does to a beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MaterialKind {
    /// It returns the beam.
    #[default]
    Opaque,
    /// It lets the beam pass, and returns some that meet it nearly at a right angle.
    Glass,
    /// It reflects the beam.
    Mirror,
}

/// A material of walls and obstacles.
///
/// | name | kind | reflectivity | source |
/// |---|---|---|---|
/// | wall | opaque | 1 | white plaster returns about 100 % (SICK, *`LMS5xx` operating instructions*, 8013796, sec. 3.6.4) |
/// | dark | opaque | 0.024 | black foam rubber returns about 2.4 % (the same) |
/// | glass | glass | 0.08 | two faces of 4 % each, for a refractive index of 1.5 (Fresnel's equations at a right angle) |
/// | mirror | mirror | 0.9 | chosen for an ordinary mirror; no source |
///
/// Glass returns a beam with the probability `return_chance` if its angle of incidence is at most `return_angle`. Without noise,
/// a beam takes the likelier way: it returns if `return_chance` is at least a half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// What it does to a beam.
    pub kind: MaterialKind,
    /// Share of the light that it returns, 0 to 1. A mirror reflects this share; glass lets the rest pass.
    pub reflectivity: f64,
    /// Probability that glass returns a beam which is nearly at a right angle to it.
    pub return_chance: f64,
    /// Largest angle of incidence at which glass returns a beam \[rad\], 0 to π/2.
    pub return_angle: f64,
}

impl Material {
    /// An ordinary wall: the material of all cells and obstacles for which none is given.
    pub const WALL: Self = Self { kind: MaterialKind::Opaque, reflectivity: 1.0, return_chance: 0.9, return_angle: 0.1 };
    /// A wall that returns little light.
    pub const DARK: Self = Self { reflectivity: 0.024, ..Self::WALL };
    /// A pane of glass.
    pub const GLASS: Self = Self { kind: MaterialKind::Glass, reflectivity: 0.08, ..Self::WALL };
    /// A mirror.
    pub const MIRROR: Self = Self { kind: MaterialKind::Mirror, reflectivity: 0.9, ..Self::WALL };

    /// The materials that have a name, in the order of the table that a layer has by default.
    pub const NAMED: [(&'static str, Self); 4] =
        [("wall", Self::WALL), ("glass", Self::GLASS), ("mirror", Self::MIRROR), ("dark", Self::DARK)];

    /// Returns the usual material of a kind: that of an ordinary wall, a pane of glass or a mirror.
    #[must_use]
    pub fn of_kind(kind: MaterialKind) -> Self {
        match kind {
            MaterialKind::Opaque => Self::WALL,
            MaterialKind::Glass => Self::GLASS,
            MaterialKind::Mirror => Self::MIRROR,
        }
    }

    /// Returns the material with this name.
    ///
    /// # Errors
    /// [`Error::Name`]: there is none.
    pub fn named(name: &str) -> Result<Self, Error> {
        let found = Self::NAMED.iter().find(|(known, _)| *known == name);
        let known = || Self::NAMED.iter().map(|(known, _)| *known).collect();
        found.map(|(_, material)| *material).ok_or_else(|| Error::unknown("the material", name, known()))
    }

    /// Returns the material after a check of its numbers.
    ///
    /// # Errors
    /// [`Error::Number`]: the reflectivity or the chance is not in 0..1, or the angle is not in 0..π/2.
    pub fn checked(self) -> Result<Self, Error> {
        check_number("reflectivity", self.reflectivity, "in 0..1", |value| (0.0..=1.0).contains(&value))?;
        check_number("return_chance", self.return_chance, "in 0..1", |value| (0.0..=1.0).contains(&value))?;
        check_number("return_angle", self.return_angle, "in 0..π/2 rad", |value| (0.0..=FRAC_PI_2).contains(&value))?;
        Ok(self)
    }

    /// Returns true if a beam may go on behind the surface or from it.
    #[inline(always)]
    #[must_use]
    pub fn leads_on(&self) -> bool {
        self.kind != MaterialKind::Opaque
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::WALL
    }
}

/// The materials of the cells of a map: a number for each cell, and the material that each number stands for.
///
/// Only the materials of blocking cells matter.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials {
    numbers: Vec<u8>,
    width: usize,
    table: Vec<Material>,
    /// True for the numbers of glass and mirrors.
    leads_on: [bool; 256],
    has_ways_on: bool,
}

impl Materials {
    /// Largest number of materials in a table.
    pub const MAX: usize = 255;

    /// Returns the layer with these numbers, row by row from row 0 on, with `width` of them in each row.
    ///
    /// # Errors
    /// - [`Error::Count`]: the table is empty or has more than [`MAX`](Self::MAX) materials, or there are no cells.
    /// - [`Error::Length`]: the number of cells is not a multiple of `width`.
    /// - [`Error::Number`]: a number of a material in the table is out of range.
    /// - [`Error::Material`]: a cell has a number that is not in the table.
    pub fn new(numbers: Vec<u8>, width: usize, table: Vec<Material>) -> Result<Self, Error> {
        if table.is_empty() || table.len() > Self::MAX {
            return Err(Error::Count { name: "the number of materials", value: table.len(), needed: "in 1..255" });
        }
        if numbers.is_empty() || width == 0 {
            return Err(Error::Count { name: "the number of cells", value: 0, needed: "at least 1" });
        }
        if !numbers.len().is_multiple_of(width) {
            let needed = numbers.len().next_multiple_of(width);
            return Err(Error::Length { name: "materials", value: numbers.len(), needed });
        }
        let mut leads_on = [false; 256];
        for (entry, material) in leads_on.iter_mut().zip(&table) {
            *entry = material.checked()?.leads_on();
        }
        if let Some(index) = numbers.iter().position(|&number| usize::from(number) >= table.len()) {
            let (row, col, value) = (index / width, index % width, numbers[index]);
            return Err(Error::Material { row, col, value, count: table.len() });
        }
        let has_ways_on = numbers.iter().any(|&number| leads_on[usize::from(number)]);
        Ok(Self { numbers, width, table, leads_on, has_ways_on })
    }

    /// Returns the numbers of the cells, row by row from row 0 on.
    #[must_use]
    pub fn numbers(&self) -> &[u8] {
        &self.numbers
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the material of each number.
    #[must_use]
    pub fn table(&self) -> &[Material] {
        &self.table
    }

    /// Returns the material of a cell, given by its index row by row.
    #[must_use]
    pub fn of(&self, index: usize) -> &Material {
        &self.table[usize::from(self.numbers[index])]
    }

    /// Returns true if a beam may go on behind this cell or from it.
    #[inline(always)]
    pub(crate) fn leads_on(&self, index: usize) -> bool {
        self.leads_on[usize::from(self.numbers[index])]
    }

    /// Returns true if a cell is of glass or a mirror.
    pub(crate) fn has_ways_on(&self) -> bool {
        self.has_ways_on
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_for_materials() {
        assert_eq!(Material::named("mirror"), Ok(Material::MIRROR));
        let error = Material::named("wood").expect_err("no such material").to_string();
        assert_eq!(error, "the material must be one of wall, glass, mirror, dark, got \"wood\"");
    }

    #[test]
    fn numbers_must_be_in_the_table() {
        let error = Materials::new(vec![0, 1, 0, 2], 2, vec![Material::WALL, Material::GLASS]).expect_err("no material 2");
        assert_eq!(error.to_string(), "materials must be numbers of the 2 in the table, got 2 in row 1, column 1");
        assert!(Materials::new(vec![0; 4], 2, Vec::new()).is_err());
        assert!(Materials::new(vec![0; 4], 2, vec![Material::WALL; 256]).is_err());
        assert!(Materials::new(vec![0; 5], 2, vec![Material::WALL]).is_err());
        let odd = Material { reflectivity: 1.5, ..Material::WALL };
        assert_eq!(
            Materials::new(vec![0; 4], 2, vec![odd]).expect_err("too bright").to_string(),
            "reflectivity must be in 0..1, got 1.5"
        );
    }

    #[test]
    fn only_cells_that_are_used_count() {
        let table = || vec![Material::WALL, Material::GLASS];
        assert!(!Materials::new(vec![0; 4], 2, table()).expect("valid").has_ways_on());
        assert!(Materials::new(vec![0, 0, 1, 0], 2, table()).expect("valid").has_ways_on());
    }
}
