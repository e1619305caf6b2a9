//! Reproducible random numbers that depend only on seed, key and purpose.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// Random numbers for one purpose, for example one sensor of one ride. Seed and key (the ride's start) are the
/// generator's key, the purpose selects its stream; lane, thread and other purposes' draws have no effect.
#[derive(Debug)]
pub struct RandomStream(ChaCha8Rng);

impl RandomStream {
    /// The numbers of `purpose` for `seed` and `key`.
    pub fn new(seed: u64, key: [f64; 3], purpose: u64) -> Self {
        let [a, b, c] = key.map(f64::to_bits);
        let words = [seed, a, b, c];
        let mut key = [0; 32];
        for (bytes, word) in key.chunks_exact_mut(8).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        let mut rng = ChaCha8Rng::from_seed(key);
        rng.set_stream(purpose);
        Self(rng)
    }

    /// Draw from the uniform distribution over \[0, 1).
    pub fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.0.next_u64() >> 11) as f64 * STEP
    }

    /// Draw from the normal distribution of mean 0 and standard deviation 1: Marsaglia's polar method with
    /// [`libm`], so that the bits are the same on every machine.
    pub fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * libm::log(square) / square).sqrt();
            }
        }
    }

    /// Uniform whole number from 0 to `n - 1`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.uniform() * n as f64) as usize
    }

    /// True with a probability of `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.uniform() < p
    }
}
