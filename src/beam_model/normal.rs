//! The standard normal distribution, with the same bytes on every machine.
//!
//! Ready-made samplers call the platform's `exp` and `ln`, which differ from one C library to the next.

use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::LazyLock;

use rand::{Rng, RngExt};

/// Number of layers of equal area that the density is cut into.
const LAYERS: usize = 256;

/// Where the lowest layer's tail begins, for 256 layers (Marsaglia & Tsang 2000, sec. 3).
const TAIL: f64 = 3.654_152_885_361_009;

/// The layers that the density is cut into: right edges, and the (unnormalised) density there; layer 0 is the lowest.
#[derive(Debug)]
pub struct Layers {
    edge: [f64; LAYERS + 1],
    density: [f64; LAYERS + 1],
}

static ZIGGURAT: LazyLock<Layers> = LazyLock::new(|| {
    let bell = |x: f64| libm::exp(-0.5 * x * x);
    // The area of the lowest layer: a rectangle and the tail, which is sqrt(π/2)·erfc(r/√2).
    let area = TAIL * bell(TAIL) + libm::sqrt(0.5 * PI) * libm::erfc(TAIL * FRAC_1_SQRT_2);
    let mut edge = [0.0; LAYERS + 1];
    // The lowest layer as if it were a rectangle of that area.
    edge[0] = area / bell(TAIL);
    edge[1] = TAIL;
    for layer in 2..LAYERS {
        edge[layer] = libm::sqrt(-2.0 * libm::log(area / edge[layer - 1] + bell(edge[layer - 1])));
    }
    Layers { edge, density: edge.map(bell) }
});

/// How far out a draw is in its layer, as part of the layer's width: by the upper half of its bits, the middle of one of 2³² parts
/// of (-1, 1).
#[inline(always)]
pub fn uniform(bits: u64) -> f64 {
    (f64::from((bits >> 32) as i32) + 0.5) * (1.0 / (1u64 << 31) as f64)
}

/// The layers, made at the first call.
pub fn layers() -> &'static Layers {
    &ZIGGURAT
}

impl Layers {
    /// Right edges of a draw's layer, by its lowest byte, and of the layer above.
    ///
    /// A draw that is not as far out as the latter surely lies under the density, as 98.8 % do: then it is a normal number.
    #[inline(always)]
    pub fn edges(&self, bits: u64) -> [f64; 2] {
        let layer = (bits & 0xff) as usize;
        [self.edge[layer], self.edge[layer + 1]]
    }

    /// A standard normal number, by the ziggurat method (Marsaglia & Tsang 2000, sec. 2), from a first draw and more of them from
    /// the stream.
    pub fn sample(&self, mut bits: u64, stream: &mut impl Rng) -> f64 {
        loop {
            let layer = (bits & 0xff) as usize;
            let x = uniform(bits) * self.edge[layer];
            if x.abs() < self.edge[layer + 1] {
                return x;
            }
            if layer == 0 {
                return sample_tail(stream).copysign(x);
            }
            let (low, high) = (self.density[layer], self.density[layer + 1]);
            if low + (high - low) * stream.random::<f64>() < libm::exp(-0.5 * x * x) {
                return x;
            }
            bits = stream.next_u64();
        }
    }
}

/// A standard normal number.
pub fn sample(stream: &mut impl Rng) -> f64 {
    layers().sample(stream.next_u64(), stream)
}

/// A normal number beyond `TAIL`, by rejection from an exponential (Marsaglia 1964).
fn sample_tail(stream: &mut impl Rng) -> f64 {
    loop {
        // log1p(-u) and not log(u), which u = 0 would send to infinity.
        let beyond = -libm::log1p(-stream.random::<f64>()) / TAIL;
        let height = -libm::log1p(-stream.random::<f64>());
        if 2.0 * height > beyond * beyond {
            return TAIL + beyond;
        }
    }
}

/// The probability between `below` under the mean and `above` over it, Φ(above) - Φ(-below), without cancellation.
pub fn mass_around_mean(below: f64, above: f64) -> f64 {
    0.5 * (libm::erf(below * FRAC_1_SQRT_2) + libm::erf(above * FRAC_1_SQRT_2))
}

/// The density φ.
pub fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / libm::sqrt(2.0 * PI)
}
