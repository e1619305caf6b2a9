//! Random numbers that depend on what they are for and on nothing else.

use crate::ride::Start;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};

/// A source of random numbers for one purpose in one ride: seed and start are the generator's key,
/// the purpose is its stream, so neither lane nor thread nor another purpose's draws change them.
#[derive(Debug)]
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// The numbers of `purpose` in the ride from `start`.
    pub fn new(seed: u64, start: &Start, purpose: u64) -> Self {
        let Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s } = *start;
        let words = [seed, speed_m_s.to_bits(), steer_rate_rad_s.to_bits(), roll_rate_rad_s.to_bits()];
        let mut key = [0; 32];
        for (bytes, word) in key.chunks_exact_mut(8).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(purpose);
        Self(rng)
    }

    /// A draw from the normal distribution of mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// True with a probability of `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        let u: f64 = StandardUniform.sample(&mut self.0);
        u < p
    }
}
