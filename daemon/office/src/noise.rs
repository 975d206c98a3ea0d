//! The office's random draws: one stream for each use, all from the one seed.
//!
//! Separate streams keep the world and its sensors apart: reading the sonar twice as often changes
//! what the sonar says, never where people walk. PCG32 (O'Neill 2014, HMC-CS-2014-0905), with the
//! logarithm and cosine of `libm`, gives the same bits on every machine.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

/// Which use a stream serves; the number is the generator's stream.
#[derive(Clone, Copy)]
pub(crate) enum Use {
    /// Noise of the sonar readings.
    Sonar = 1,
    /// Errors of wheels and compass.
    Odometry = 2,
    /// Where people go and how fast.
    People = 3,
    /// When doors open and close, where chairs are put.
    Fittings = 4,
    /// What a generated layout looks like.
    Layout = 6,
    /// Noise of the range camera.
    Camera = 5,
}

/// How many uses there may be for each robot: its streams begin at a multiple of this.
const USES_MAX: u64 = 16;

/// One stream of random draws.
#[derive(Clone)]
pub(crate) struct Noise(Pcg32);

impl Noise {
    pub(crate) fn new(seed: u64, purpose: Use) -> Self {
        Noise::of(seed, purpose, 0)
    }

    /// The stream of the `robot`-th robot.
    pub(crate) fn of(seed: u64, purpose: Use, robot: usize) -> Self {
        // A multiplication by an odd constant (2^64 divided by the golden ratio) parts small seeds.
        Noise(Pcg32::new(
            seed.wrapping_mul(0x9E37_79B9_7F4A_7C15),
            purpose as u64 + USES_MAX * robot as u64,
        ))
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    /// Uniform in [low, high).
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..count; `count` is at least 1.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        assert!(count > 0, "a choice needs something to choose from");
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    /// Gaussian with mean 0 and sigma 1 (Box and Muller 1958, the cosine branch only).
    pub(crate) fn gauss(&mut self) -> f64 {
        let radius = 1.0 - self.unit();
        let angle = core::f64::consts::TAU * self.unit();
        libm::sqrt(-2.0 * libm::log(radius)) * libm::cos(angle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_depends_on_seed_and_use_only() {
        let draw = |seed, purpose| Noise::new(seed, purpose).unit();
        assert_eq!(draw(7, Use::Sonar), draw(7, Use::Sonar));
        assert_ne!(draw(7, Use::Sonar), draw(8, Use::Sonar));
        assert_ne!(draw(7, Use::Sonar), draw(7, Use::People));
    }

    #[test]
    fn gauss_has_mean_zero_and_sigma_one() {
        let mut noise = Noise::new(3, Use::Sonar);
        let draws: Vec<f64> = (0..20_000).map(|_| noise.gauss()).collect();
        let mean = draws.iter().sum::<f64>() / 20_000.0;
        let variance = draws.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / 20_000.0;
        assert!(
            mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05,
            "mean {mean}, variance {variance}"
        );
    }
}
