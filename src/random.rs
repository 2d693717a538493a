//! Random numbers that depend only on a seed and an index, and are the same on every machine.
//!
//! [`stream`] gives a stream of numbers for one scan or one odometry step. [`BeamBits`] gives each beam of a scan its own 64
//! bits, which can be computed in any order and on any thread.

use rand_xoshiro::rand_core::SeedableRng;
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

/// A stream of random numbers: xoshiro256++ (Blackman & Vigna 2021).
pub type Stream = Xoshiro256PlusPlus;

/// Returns the stream named by `seed` and `index`.
///
/// Both numbers are hashed into the 256 bits of the state, so streams with neighbouring seeds or indices are unrelated. The
/// values must not change between versions.
///
/// ```
/// use mobile_robot_simulator::random::stream;
/// use rand::Rng;
///
/// assert_eq!(stream(7, 0).next_u64(), stream(7, 0).next_u64());
/// assert_ne!(stream(7, 0).next_u64(), stream(7, 1).next_u64());
/// ```
#[must_use]
pub fn stream(seed: u64, index: u64) -> Stream {
    let mut state = [0; 32];
    for (hash, bytes) in hashes(seed, index).into_iter().zip(state.chunks_exact_mut(8)) {
        bytes.copy_from_slice(&hash.to_le_bytes());
    }
    Stream::from_seed(state)
}

/// Returns four hashes of (seed, index).
fn hashes(seed: u64, index: u64) -> [u64; 4] {
    [1, 2, 3, 4].map(|word| {
        let step = GOLDEN_GAMMA.wrapping_mul(word);
        mix(mix(seed.wrapping_add(step)).wrapping_add(mix(index.wrapping_sub(step)).rotate_left(32)))
    })
}

/// Random bits for the beams of one scan. The bits of a beam are computed directly, without those of the beams before it.
///
/// Method: the `SplitMix64` generator (Steele, Lea & Flood 2014), with state and increment hashed from (seed, index).
#[derive(Debug, Clone, Copy)]
pub struct BeamBits {
    state: u64,
    increment: u64,
}

impl BeamBits {
    /// Returns the random bits of the scan named by `seed` and `index`.
    #[must_use]
    pub fn new(seed: u64, index: u64) -> Self {
        let [state, increment, ..] = hashes(seed, index);
        Self { state, increment: increment | 1 }
    }

    /// Returns the random bits of places, which do not depend on the index of a scan.
    #[must_use]
    pub fn of_places(seed: u64) -> Self {
        Self::new(!seed, PLACES)
    }

    /// Returns the 64 random bits of a beam.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, beam: u64) -> u64 {
        mix(self.state.wrapping_add(self.increment.wrapping_mul(beam)))
    }

    /// Returns a stream of random bits for a beam that needs more than the 64 bits from [`of`](Self::of). The stream is
    /// independent of those 64 bits.
    #[must_use]
    pub fn stream(&self, beam: u64) -> SplitMix64 {
        SplitMix64::from_seed(self.of(!beam).to_le_bytes())
    }
}

/// Index of the bits of places.
const PLACES: u64 = 0x5eed_0f91_ace5_0001;

/// 2⁶⁴ divided by the golden ratio, rounded to an odd number.
const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Hashes a word: a bijection that maps neighbouring words to unrelated ones.
///
/// The output function of `SplitMix64` (Steele, Lea & Flood 2014), with the constants of Stafford's variant 13.
#[inline(always)]
fn mix(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use std::collections::HashSet;

    #[test]
    fn each_seed_and_index_has_its_own_stream() {
        let first = |seed, index| stream(seed, index).next_u64();
        assert_eq!(first(7, 3), first(7, 3));
        let names: HashSet<u64> = (0..100).flat_map(|seed| (0..100).map(move |index| first(seed, index))).collect();
        assert_eq!(names.len(), 10_000);
    }

    #[test]
    fn the_values_of_a_stream_never_change() {
        let mut stream = stream(7, 0);
        assert_eq!([stream.next_u64(), stream.next_u64()], [16_289_738_856_705_336_736, 14_129_060_576_366_663_060]);
    }

    #[test]
    fn the_bits_of_a_beam_never_change() {
        let bits = BeamBits::new(7, 0);
        assert_eq!([bits.of(0), bits.of(1)], [15_664_605_630_004_186_478, 8_877_590_085_255_707_112]);
        assert_eq!(bits.stream(1).next_u64(), 2_251_059_855_669_539_826);
    }

    #[test]
    fn bits_of_beams_are_balanced_and_differ_between_neighbours() {
        let words: Vec<u64> = (0..64).flat_map(|index| (0..64).map(move |beam| BeamBits::new(1, index).of(beam))).collect();
        let ones: u32 = words.iter().map(|word| word.count_ones()).sum();
        let changes: u32 = words.windows(2).map(|pair| (pair[0] ^ pair[1]).count_ones()).sum();
        // 262,144 fair bits: mean 131,072, standard deviation 256.
        assert!((130_000..132_200).contains(&ones), "{ones}");
        assert!((130_000..132_200).contains(&changes), "{changes}");
    }

    #[test]
    fn bits_of_neighbouring_streams_are_balanced() {
        let ones: u32 = (0..4096).map(|index| stream(1, index).next_u64().count_ones()).sum();
        // 262,144 fair bits: mean 131,072, standard deviation 256.
        assert!((130_000..132_200).contains(&ones), "{ones}");
    }
}
