//! Flight cards: what the estimator makes of a nonlinear bicycle's sensors.

use control::estimate::{EstimateConfig, EstimateState, Motion, Source, step};
use sim_host::bicycle::onboard::estimator_parameters;
use sim_host::ride::Start;
use tests::basins::H;
use tests::basins::assisted;
use tests::felt::{Noise, Truth, ridden};

#[test]
fn scratch() {
    let conditions = assisted(H);
    let config = EstimateConfig { roll_rate: Source::Estimate, ..estimator_parameters(&conditions.bicycle) };
    println!("{config:?}");
    for speed in [2.0, 3.0, 5.0, 7.0] {
        for kick in [0.5, 3.0, 7.0] {
            let truths = ridden(
                &conditions,
                Start { speed_m_s: speed, steer_rate_rad_s: kick, roll_rate_rad_s: 0.0 },
                &config.imu,
            );
            for accel in [true, false] {
                for (bias, noisy) in [(0.0, false), (0.05, false), (0.0, true), (0.05, true)] {
                    let mut noise = Noise::new(1);
                    let mut state = EstimateState::default();
                    let mut worst = [0.0_f64; 6];
                    let mut late = 0.0_f64;
                    let mut uncovered = 0;
                    let mut last = Motion::default();
                    for (i, pair) in truths.windows(2).enumerate() {
                        let mut felt = Truth::between(&pair[0], &pair[1]).felt(1000);
                        if noisy {
                            noise.on(&mut felt);
                        }
                        felt.gyro_rad_s[0] += bias;
                        if !accel {
                            felt.accel_m_s2 = None;
                        }
                        let m = step(&config, &mut state, &felt);
                        let t = &pair[1];
                        let e = (f64::from(m.roll_rad) - t.roll).abs();
                        worst[0] = worst[0].max(e);
                        if i > 2000 {
                            late = late.max(e);
                        }
                        worst[1] = worst[1].max((f64::from(m.roll_rate_rad_s) - t.roll_rate).abs());
                        worst[2] = worst[2].max((f64::from(m.yaw_rate_rad_s) - t.yaw_rate).abs());
                        worst[3] = worst[3].max((f64::from(m.pitch_rad) - t.pitch).abs());
                        worst[4] = worst[4].max((f64::from(m.roll_accel_rad_s2) - t.roll_accel).abs());
                        worst[5] = worst[5].max(t.roll.abs());
                        if e > f64::from(m.roll_bound_rad) {
                            uncovered += 1;
                        }
                        last = m;
                    }
                    println!(
                        "v {speed} kick {kick} accel {accel} bias {bias} noisy {noisy}: roll {:.3} late {late:.4} rate {:.3} yaw {:.3} pitch {:.4} acc {:.1} peak roll {:.2} bound end {:.3} bias end {:.4} uncovered {uncovered}",
                        worst[0],
                        worst[1],
                        worst[2],
                        worst[3],
                        worst[4],
                        worst[5],
                        last.roll_bound_rad,
                        last.gyro_bias_rad_s[0]
                    );
                }
            }
        }
    }
}
