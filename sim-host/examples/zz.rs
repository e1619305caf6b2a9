//! x
#![allow(warnings)]
use sim_host::basin::*;
use sim_host::bicycle::*;
use sim_host::ride::*;
fn main() {
    let bicycle = catalogue::load("rigid_jason").unwrap();
    let plan = control::Config::thesis(control::Law::H { cut: false }).plan().unwrap();
    let c = Conditions::thesis(Geometry::new(&bicycle.parameters), Assist::Firmware(Box::new(plan)));
    for name in ["fw", "ideal", "none"] {
        let law = if name == "none" { control::Law::None } else { control::Law::H { cut: false } };
        let exact = if name == "fw" {
            c.clone()
        } else {
            Conditions { assist: Assist::Ideal(Box::new(law.clone().into())), ..c.clone() }
        };
        for delay in [0.0, 0.5e-3] {
            let mut cc = exact.clone();
            if delay > 0.0 {
                continue;
            };
            let mut starts = vec![];
            for v in [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0] {
                for i in 1..=120 {
                    starts.push(Start {
                        speed_m_s: v,
                        steer_rate_rad_s: 0.25 * i as f64,
                        ..Start::default()
                    });
                }
            }
            let t = std::time::Instant::now();
            let a = if std::env::var("Q").is_ok() { vec![] } else { rides(&exact, &starts) };
            let ela = t.elapsed().as_secs_f64();
            let t = std::time::Instant::now();
            let b = Quick::new(&cc).unwrap().rides(&starts);
            let el = t.elapsed().as_secs_f64();
            let steps: u32 = b.iter().map(|q| q.steps).sum();
            let mx = b.iter().map(|q| q.steps).max().unwrap();
            let un = b.iter().filter(|q| q.outcome.is_none()).count();
            let surv: u32 = b
                .iter()
                .filter(|q| q.outcome.is_some_and(|o| o.time_to_fall_s().is_none()))
                .map(|q| q.steps)
                .sum();
            let mut d: Vec<(f64, f64, f64)> = vec![];
            let (mut other, mut rec) = (0, 0);
            for (x, y) in a.iter().zip(&b) {
                let Some(yo) = y.outcome else { continue };
                match (x.outcome.time_to_fall_s(), yo.time_to_fall_s()) {
                    (Some(p), Some(q)) => {
                        d.push(((p - q).abs(), x.start.speed_m_s, x.start.steer_rate_rad_s))
                    }
                    (None, None) => {
                        if x.outcome != yo {
                            rec += 1;
                            if delay == 0.0 {
                                if false {
                                    println!(
                                        "{} {} exact {:?} quick {:?} steps {} end {:?} peak {:?}",
                                        x.start.speed_m_s,
                                        x.start.steer_rate_rad_s,
                                        x.outcome,
                                        yo,
                                        y.steps,
                                        x.end,
                                        (x.effort.peak_roll_rad, x.effort.peak_steer_rad)
                                    )
                                }
                            }
                        }
                    }
                    _ => other += 1,
                }
            }
            d.sort_by(|a, b| a.0.total_cmp(&b.0));
            let n = d.len();
            if n == 0 {
                println!("{el}");
                continue;
            }
            println!(
                "{name} {delay} n {n} median {:.1e} 99% {:.1e} worst {:?} other {other} rec {rec} undecided {un} steps {steps} max {mx} survivors' {surv} time {el:.3} exact {ela:.3}",
                d[n / 2].0,
                d[n * 99 / 100].0,
                &d[n - 6..]
            );
        }
    }
}
