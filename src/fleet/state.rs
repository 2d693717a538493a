//! The state of robots, to save it and to put robots back into it.

use super::member::Member;
use super::options::of_robot;
use super::words::{Reader, Writer};
use super::{Fleet, ROBOTS, check_crowd};
use crate::error::Error;
use crate::memory;
use crate::motion::Drive;

/// The state of some robots of a fleet.
#[derive(Debug, Clone)]
pub struct FleetState {
    /// Indices of the robots in their fleet.
    robots: Vec<usize>,
    members: Vec<Member>,
    /// The wheels of each robot.
    drives: Vec<Option<Drive>>,
}

impl FleetState {
    /// Returns the indices of the robots in their fleet.
    #[must_use]
    pub fn robots(&self) -> &[usize] {
        &self.robots
    }

    /// Returns the state as words of 64 bits, the same number for each robot, to store it. Their meaning may change with the
    /// version.
    #[must_use]
    pub fn to_words(&self) -> Vec<u64> {
        let mut words = Writer::default();
        for ((&robot, member), drive) in self.robots.iter().zip(&self.members).zip(&self.drives) {
            words.word(robot as u64);
            member.write(&mut words);
            words.drive(drive.as_ref());
        }
        words.0
    }

    /// Returns the state of these words.
    ///
    /// # Errors
    /// - [`Error::State`]: they are not those of a state.
    /// - [`Error::Number`]: a limit is negative.
    pub fn from_words(words: &[u64]) -> Result<Self, Error> {
        let (mut robots, mut members, mut drives) = (Vec::new(), Vec::new(), Vec::new());
        let mut words = Reader(words.iter());
        while !words.0.as_slice().is_empty() {
            memory::push(ROBOTS, &mut robots, words.at_most(u64::from(u32::MAX))? as usize)?;
            let member = Member::read(&mut words)?;
            let drive = words.drive()?;
            member.robot.check_drive(drive.as_ref())?;
            memory::push(ROBOTS, &mut members, member)?;
            memory::push(ROBOTS, &mut drives, drive)?;
        }
        Ok(Self { robots, members, drives })
    }
}

impl Fleet {
    /// Returns the state of the chosen robots.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Memory`].
    pub fn save(&self, mask: &[bool]) -> Result<FleetState, Error> {
        self.check_mask(mask)?;
        let (mut robots, mut members, mut drives) = (Vec::new(), Vec::new(), Vec::new());
        for (robot, member) in self.in_order().enumerate().filter(|(robot, _)| mask[*robot]) {
            memory::push(ROBOTS, &mut robots, robot)?;
            memory::push(ROBOTS, &mut members, *member)?;
            memory::push(ROBOTS, &mut drives, self.options.body(robot).drive.copied())?;
        }
        for member in &mut members {
            member.robot.look_again();
        }
        Ok(FleetState { robots, members, drives })
    }

    /// Puts robots into saved states: those that were saved, or those chosen by `mask`, in their order. One saved state can
    /// go to any number of robots.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is neither one state nor one for each of the robots.
    /// - [`Error::NoRobot`], [`Error::Index`]: a saved robot, or the grid of a state, does not exist here.
    /// - [`Error::OtherDrive`]: a robot here has another drive than the one that was saved.
    /// - [`Error::Clocks`], [`Error::Worlds`]: robots of one world would be at different times, or on different grids.
    pub fn restore(&mut self, state: &FleetState, mask: Option<&[bool]>) -> Result<(), Error> {
        let chosen: Vec<usize> = match mask {
            None => state.robots.clone(),
            Some(mask) => {
                self.check_mask(mask)?;
                (0..self.len()).filter(|&robot| mask[robot]).collect()
            }
        };
        if state.members.len() != 1 && state.members.len() != chosen.len() {
            return Err(Error::Length { name: "the state", value: state.members.len(), needed: chosen.len() });
        }
        let members = || (0..chosen.len()).filter_map(|nth| of_robot(&state.members, nth));
        let drives = (0..chosen.len()).filter_map(|nth| of_robot(&state.drives, nth));
        for ((&robot, member), drive) in chosen.iter().zip(members()).zip(drives) {
            if robot >= self.len() {
                return Err(Error::NoRobot { robot, count: self.len() });
            }
            if member.grid >= self.grids.len() {
                return Err(Error::Index { name: "grid", robot, value: member.grid, count: self.grids.len() });
            }
            if drive.as_ref() != self.options.body(robot).drive {
                return Err(Error::OtherDrive { robot });
            }
        }
        self.make_next()?;
        self.next.copy_from_slice(&self.members);
        for (&robot, member) in chosen.iter().zip(members()) {
            self.next[self.worlds.place_of[robot]] = *member;
        }
        for world in &self.worlds.all {
            check_crowd(&self.worlds.order[world.robots.clone()], self.next[world.robots.clone()].iter())?;
        }
        std::mem::swap(&mut self.members, &mut self.next);
        Ok(())
    }
}
