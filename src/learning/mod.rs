//! What a step of robots that learn to drive to goals needs: commands from actions, and rewards.

mod action;
mod reward;

pub use action::commands_from_actions;
pub use reward::{Reward, Steps, Verdicts};
