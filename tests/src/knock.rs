//! Recordings of a gyro after a knock, computed with the linear model, so that their weave mode is known.

use nalgebra::{Complex, DVector};
use sim_host::bicycle::Parameters;
use sim_host::eigen::{Feedback, LinearActuator, Model, roots};
use sim_host::exponential::exponential;
use sim_host::weave::record::{Axis, Record};

/// Pseudo-random numbers, the same in every run (SplitMix64).
#[derive(Clone, Copy, Debug)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// From 0 to 1, both excluded.
    pub fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((x ^ (x >> 31)) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Of the normal distribution with deviation 1.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.even().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.even()).cos()
    }
}

/// A riderless bicycle that is pushed.
#[derive(Clone, Debug)]
pub struct Knocked {
    /// The bicycle.
    pub bicycle: Parameters,
    /// Its assist.
    pub feedback: Feedback,
    /// The motor.
    pub actuator: LinearActuator,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
}

/// Properties of a recording.
#[derive(Clone, Copy, Debug)]
pub struct Recording {
    /// Rest before the push \[s\].
    pub before_s: f64,
    /// Duration of the push \[s\].
    pub push_s: f64,
    /// Duration after the push \[s\].
    pub after_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Standard deviation of the noise, one half of its variance white, the other correlated in time \[rad/s\].
    pub noise_rad_s: f64,
    /// Correlation time \[s\].
    pub memory_s: f64,
}

impl Knocked {
    /// The weave's eigenvalue \[1/s\].
    pub fn weave(&self) -> Complex<f64> {
        let all = roots(&self.model().at(self.speed_m_s), 6);
        all.into_iter().find(|root| root.im > 0.0).expect("a pair")
    }

    fn model(&self) -> Model {
        let model = Model::new(&self.bicycle, self.feedback.clone(), None);
        model.with_actuator(self.actuator).expect("in range")
    }

    /// Pushes it and records roll and yaw rate; time stamps jitter by a hundredth of their distance. The roll rate is
    /// 0.7 rad/s at the end of the push.
    pub fn record(&self, how: &Recording, random: &mut SplitMix64) -> Record {
        let system = self.model().at(self.speed_m_s);
        assert!(system.delay_s == 0.0, "no delay");
        let a = system.undelayed();
        const FINE: usize = 20;
        let step_s = 1.0 / (how.rate_hz * FINE as f64);
        let whole = exponential(&(&a * step_s));
        let mut pushed = DVector::zeros(a.nrows());
        // Roll and, depending on the push, some steer.
        (pushed[2], pushed[3]) = (1.0, random.normal());
        let all = ((how.before_s + how.push_s + how.after_s) * how.rate_hz) as usize;
        let end = ((how.before_s + how.push_s) * how.rate_hz) as usize;
        let (mut state, mut clean) = (DVector::zeros(a.nrows()), Vec::new());
        let (w, cos) = (self.bicycle.w, self.bicycle.lam.cos());
        for i in 0..all * FINE {
            let t = i as f64 * step_s - how.before_s;
            if (0.0..how.push_s).contains(&t) {
                state += &pushed * (step_s * (std::f64::consts::PI * t / how.push_s).sin().powi(2));
            }
            if i % FINE == 0 {
                let yaw = (self.speed_m_s * state[1] + self.bicycle.c * state[3]) * cos / w;
                clean.push([state[2], yaw]);
            }
            state = &whole * state;
        }
        let scale = 0.7 / clean[end][0].abs();
        let mut noise = [0; 2].map(|_| self.noise(how, all, random));
        for (i, sample) in clean.iter().enumerate() {
            (0..2).for_each(|axis| noise[axis][i] += scale * sample[axis]);
        }
        let times_s: Vec<f64> = (0..all).map(|i| i as f64 / how.rate_hz).collect();
        let jitter = 0.01 / how.rate_hz;
        let times_s = times_s
            .iter()
            .map(|t| t + if *t > 0.0 { jitter * random.normal().clamp(-3.0, 3.0) } else { 0.0 });
        let axes = ["gyro_x", "gyro_z"].into_iter().zip(noise);
        let axes = axes.map(|(column, rates_rad_s)| Axis { column: column.into(), rates_rad_s });
        Record { times_s: times_s.collect(), axes: axes.collect(), notes: Vec::new() }
    }

    fn noise(&self, how: &Recording, samples: usize, random: &mut SplitMix64) -> Vec<f64> {
        let each = how.noise_rad_s / 2.0_f64.sqrt();
        let decay = (-1.0 / (how.rate_hz * how.memory_s)).exp();
        let mut slow = random.normal();
        let next = |_| {
            slow = decay * slow + (1.0 - decay * decay).sqrt() * random.normal();
            each * (slow + random.normal())
        };
        (0..samples).map(next).collect()
    }
}

/// The record as a CSV file, its time stamps as dates with a time.
pub fn csv(record: &Record) -> String {
    let mut text = String::from("Time,gyro_accuracy,gyro_z,gyro_x\n");
    for (i, t) in record.times_s.iter().enumerate() {
        let [x, z] = [0, 1].map(|axis| record.axes[axis].rates_rad_s[i]);
        text += &format!("2023-05-12 10:54:{:012.9},0,{z:.5},{x:.5}\n", 10.0 + t);
    }
    text
}
