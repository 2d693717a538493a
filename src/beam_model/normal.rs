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

/// A draw of the ziggurat method (Marsaglia & Tsang 2000, sec. 2): a layer, and how far out in it, as part of its width.
#[derive(Debug, Clone, Copy)]
pub struct Draw {
    layer: u8,
    uniform: f64,
}

impl Draw {
    /// The draw that the lowest byte and the upper half of a word stand for.
    #[inline(always)]
    pub fn from_bits(bits: u64) -> Self {
        // The middle of one of 2³² parts of (-1, 1).
        let uniform = (f64::from((bits >> 32) as i32) + 0.5) * (1.0 / (1u64 << 31) as f64);
        Self { layer: bits as u8, uniform }
    }
}

/// The layers, made at the first call.
pub fn layers() -> &'static Layers {
    &ZIGGURAT
}

impl Layers {
    /// The place of a draw, and whether it surely lies under the density, as 98.8 % do: then it is a standard normal number.
    #[inline(always)]
    pub fn place(&self, draw: Draw) -> (f64, bool) {
        let layer = usize::from(draw.layer);
        let place = draw.uniform * self.edge[layer];
        (place, place.abs() < self.edge[layer + 1])
    }

    /// A standard normal number from a first draw and more of them from the stream.
    pub fn sample(&self, mut draw: Draw, stream: &mut impl Rng) -> f64 {
        loop {
            let (x, is_inside) = self.place(draw);
            if is_inside {
                return x;
            }
            let layer = usize::from(draw.layer);
            if layer == 0 {
                return sample_tail(stream).copysign(x);
            }
            let (low, high) = (self.density[layer], self.density[layer + 1]);
            if low + (high - low) * stream.random::<f64>() < libm::exp(-0.5 * x * x) {
                return x;
            }
            draw = Draw::from_bits(stream.next_u64());
        }
    }
}

/// A standard normal number.
pub fn sample(stream: &mut impl Rng) -> f64 {
    layers().sample(Draw::from_bits(stream.next_u64()), stream)
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
