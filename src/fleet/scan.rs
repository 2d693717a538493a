//! Scans of the robots of a fleet, each in its own world.

use super::member::Member;
use super::options::of_robot;
use super::{CHUNK, Fleet, ROBOTS, WEIGHT, scene};
use crate::batch::for_each_heavy_chunk_watched;
use crate::error::Error;
use crate::interrupt::Watch;
use crate::memory;
use crate::scanner::{Shot, ShotNoise, scan_each};

impl Fleet {
    /// Writes a scan of each chosen robot, as `members` stand, to `readings`, in the order of the robots: the next one, or if the
    /// scans are counted already, the last one.
    ///
    /// # Errors
    /// - [`Error::Length`]: `readings` does not have room for just these scans.
    /// - Those of [`LaserScanner::scan_batch`](crate::LaserScanner::scan_batch).
    ///
    /// # Panics
    /// If the fleet has no scanner.
    pub(super) fn scan_members(
        &self,
        (members, are_counted): (&[Member], bool),
        is_chosen: impl Fn(usize) -> bool,
        threads: Option<usize>,
        readings: &mut [f32],
    ) -> Result<(), Error> {
        let Self { grids, options, worlds, .. } = self;
        let scanner = options.scanner.as_ref().expect("a scanner");
        let beam_count = scanner.options().beam_count;
        let places = worlds.place_of.iter().enumerate().filter(|(robot, _)| is_chosen(*robot));
        let mut chosen = Vec::new();
        for (rank, (_, &place)) in places.enumerate() {
            memory::push(ROBOTS, &mut chosen, (members[place].grid, place, rank))?;
        }
        if readings.len() != chosen.len() * beam_count {
            return Err(Error::Length { name: "out", value: readings.len(), needed: chosen.len() * beam_count });
        }
        // Scans on one grid are the fastest together. The robots of a world stay together, too.
        chosen.sort_unstable();
        let watch = Watch::new();
        let mut scenes = memory::with_room(ROBOTS, chosen.len())?;
        for together in chosen.chunk_by(|&(_, place, _), &(_, other, _)| worlds.world_at[place] == worlds.world_at[other]) {
            let (grid, place, _) = together[0];
            scenes.push((scene(grids, &[], options, worlds, &worlds.all[worlds.world_at[place]], grid, &watch), None));
        }
        let weight = if scenes.iter().all(|(scene, _)| scene.stands()) { 1 } else { WEIGHT };
        for_each_heavy_chunk_watched(&watch, threads, &mut scenes, weight, CHUNK, |_, scenes| {
            for (scene, around) in scenes {
                *around = Some(scene.around(&members[scene.world.robots.clone()])?);
            }
            Ok(())
        })?;
        let mut rows: Vec<_> = memory::collected(ROBOTS, readings.chunks_exact_mut(beam_count).map(Some))?;
        let mut rows_in_order = memory::with_room(ROBOTS, chosen.len())?;
        let mut shots = memory::with_room(ROBOTS, chosen.len())?;
        let mut scenes = scenes.iter().filter_map(|(scene, around)| Some((scene, around.as_ref()?))).peekable();
        for (_, place, rank) in chosen {
            while scenes.next_if(|(scene, _)| !scene.world.robots.contains(&place)).is_some() {}
            let (Some((scene, around)), Some(row)) = (scenes.peek(), rows[rank].take()) else { continue };
            let (robot, member) = (worlds.order[place], &members[place]);
            let surface = of_robot(&options.surfaces, robot);
            let noise = of_robot(&options.noise, robot);
            let noise = noise.map(|model| ShotNoise {
                model,
                surface,
                seed: member.seed,
                index: member.scans.wrapping_sub(u64::from(are_counted)),
            });
            shots.push(Shot { scanner, world: scene.world_of(robot, around), map_from_base: member.pose, noise });
            rows_in_order.push(row);
        }
        scan_each(&shots, threads, &mut rows_in_order)
    }
}
