//! Rides the virtual board beside the simulator: `ride IMAGE rides|causes|column`; `ride IMAGE SECONDS` rides it
//! alone, to measure the time it takes.

use std::path::{Path, PathBuf};
use virtual_board::Options;
use virtual_board::bicycle::OnBicycle;
use virtual_board::bicycle::border::{Border, border};
use virtual_board::bicycle::causes::Cause;
use virtual_board::bicycle::compare::{Difference, torques_nm};
use virtual_board::bicycle::rides::{BOARD_STEP_S, PERIOD_S, Preset, Reason, on_board, simulated};

use sim_host::ride::{Conditions, Ride, Start, rides_on, traced, traced_on};

/// Steer rate of the disturbance \[rad/s\].
const KNOCK_RAD_S: f64 = 1.5;
/// Duration of the comparison of a ride \[s\].
const COMPARED_S: f64 = 2.0;
/// Tolerance of a border \[rad/s\].
const TOLERANCE_RAD_S: f64 = 0.25;
/// Duration of a ride beside a border \[s\].
const BORDER_S: f64 = 4.0;

fn main() -> Result<(), Reason> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, image, what] = &arguments[..] else {
        return Err("usage: ride IMAGE rides|causes|column|SECONDS".into());
    };
    match &what[..] {
        "rides" => rides(Path::new(image)),
        "causes" => causes(Path::new(image)),
        "column" => column(Path::new(image)),
        seconds => alone(Path::new(image), seconds.parse()?),
    }
}

/// The product at 5 m/s, hands off, for the whole duration.
fn alone(image: &Path, seconds: f64) -> Result<(), Reason> {
    let conditions = on_board(Preset::Product, None, seconds)?;
    let mut board = OnBicycle::new(PathBuf::from(image), Options::default(), &conditions);
    let ride = &rides_on(&conditions, &[knocked(5.0)], &mut board)?[0];
    let powered_ms = board.bench().map_or(0.0, |bench| bench.now_ms());
    println!("{} after {:.3} s, {powered_ms:.0} ms after power-on", ride.outcome.name(), ride.end.t);
    Ok(())
}

/// A ride on the board: its torque in each control period \[N m\].
fn board(image: &Path, conditions: &Conditions, start: Start) -> Result<(Ride, Vec<f64>), Reason> {
    let mut board = OnBicycle::new(PathBuf::from(image), Options::default(), conditions);
    let (ride, trace) = traced_on(conditions, start, &mut board)?;
    Ok((ride, torques_nm(&trace, (PERIOD_S / BOARD_STEP_S).round() as usize)))
}

/// A ride in the simulator, as [`board`].
fn host(conditions: &Conditions, start: Start) -> (Ride, Vec<f64>) {
    let (ride, trace) = traced(conditions, start);
    (ride, torques_nm(&trace, 1))
}

fn knocked(speed_m_s: f64) -> Start {
    Start { speed_m_s, steer_rate_rad_s: KNOCK_RAD_S, roll_rate_rad_s: 0.0 }
}

fn rides(image: &Path) -> Result<(), Reason> {
    println!(
        "| preset | rider | m/s | board | simulator | peak N m: board, simulator | rms N m: board, simulator | largest roll rad: board, simulator | difference N m: largest, rms |"
    );
    println!("| --- | --- | ---: | --- | --- | ---: | ---: | ---: | ---: |");
    for preset in [Preset::H, Preset::Product] {
        for rider in [None, Some("smart")] {
            for speed_m_s in [3.0, 5.0] {
                let start = knocked(speed_m_s);
                let (rode, torque) = board(image, &on_board(preset, rider, COMPARED_S)?, start)?;
                let (simulated, exact) = host(&simulated(preset, rider, COMPARED_S)?, start);
                let (by, from) = (Difference::new(&torque, &exact), Difference::new(&exact, &exact));
                println!(
                    "| {} | {} | {speed_m_s} | {} | {} | {:.2}, {:.2} | {:.3}, {:.3} | {:.3}, {:.3} | {:.2}, {:.3} |",
                    preset.name(),
                    rider.unwrap_or("none"),
                    rode.outcome.name(),
                    simulated.outcome.name(),
                    by.peak_nm,
                    from.peak_nm,
                    by.rms_nm,
                    from.rms_nm,
                    rode.effort.peak_roll_rad,
                    simulated.effort.peak_roll_rad,
                    by.largest_nm,
                    by.rms_difference_nm
                );
            }
        }
    }
    Ok(())
}

fn causes(image: &Path) -> Result<(), Reason> {
    println!(
        "| preset | cause | peak N m | rms N m | from the exact simulator N m: largest, rms | from the board N m: largest, rms |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: |");
    let speed_m_s = 3.0;
    let start = knocked(speed_m_s);
    for preset in [Preset::H, Preset::Product] {
        let (_, exact) = host(&simulated(preset, None, COMPARED_S)?, start);
        let (_, rode) = board(image, &on_board(preset, None, COMPARED_S)?, start)?;
        let line = |name: &str, torque: &[f64]| {
            let (by, from_board) = (Difference::new(torque, &exact), Difference::new(torque, &rode));
            println!(
                "| {} | {name} | {:.2} | {:.3} | {:.2}, {:.3} | {:.2}, {:.3} |",
                preset.name(),
                by.peak_nm,
                by.rms_nm,
                by.largest_nm,
                by.rms_difference_nm,
                from_board.largest_nm,
                from_board.rms_difference_nm
            );
        };
        line("none: the exact simulator", &exact);
        for cause in Cause::ALL {
            let one = with(preset, COMPARED_S, speed_m_s, |other| other == cause)?;
            line(cause.name(), &host(&one, start).1);
        }
        let all = with(preset, COMPARED_S, speed_m_s, |_| true)?;
        line("all of them, in the simulator", &host(&all, start).1);
        line("the board", &rode);
    }
    Ok(())
}

/// The exact simulator with some of the board's parts.
fn with(
    preset: Preset,
    time_limit_s: f64,
    speed_m_s: f64,
    acts: impl Fn(Cause) -> bool,
) -> Result<Conditions, Reason> {
    let mut conditions = simulated(preset, None, time_limit_s)?;
    for cause in Cause::ALL.into_iter().filter(|cause| acts(*cause)) {
        cause.act(&mut conditions, speed_m_s)?;
    }
    Ok(conditions)
}

fn column(image: &Path) -> Result<(), Reason> {
    let speed_m_s = 3.0;
    let start = |steer_rate_rad_s: f64| Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let of = |conditions: &Conditions| {
        border(4.0, TOLERANCE_RAD_S, |knock| Ok::<_, Reason>(traced(conditions, start(knock)).0.fell()))
    };
    let words = |at: Border| format!("{:.2} to {:.2}", at.outlasted, at.fallen);
    println!("| at {speed_m_s} m/s, {BORDER_S} s, rad/s | h | product |");
    println!("| --- | ---: | ---: |");
    let row = |name: &str, each: &dyn Fn(Preset) -> Result<Border, Reason>| -> Result<(), Reason> {
        println!("| {name} | {} | {} |", words(each(Preset::H)?), words(each(Preset::Product)?));
        Ok(())
    };
    row("exact simulator", &|preset| of(&with(preset, BORDER_S, speed_m_s, |_| false)?))?;
    for cause in Cause::ALL {
        row(&format!("with {}", cause.name()), &|preset| {
            of(&with(preset, BORDER_S, speed_m_s, |other| other == cause)?)
        })?;
    }
    row("with all of them", &|preset| of(&with(preset, BORDER_S, speed_m_s, |_| true)?))?;
    for cause in [Cause::Rotor, Cause::Friction, Cause::Wheels] {
        row(&format!("with all but {}", cause.name()), &|preset| {
            of(&with(preset, BORDER_S, speed_m_s, |other| other != cause)?)
        })?;
    }
    row("the board", &|preset| {
        let near = of(&with(preset, BORDER_S, speed_m_s, |_| true)?)?.outlasted;
        let conditions = on_board(preset, None, BORDER_S)?;
        let mut board = OnBicycle::new(PathBuf::from(image), Options::default(), &conditions);
        border(near, TOLERANCE_RAD_S, |knock| {
            Ok(rides_on(&conditions, &[start(knock)], &mut board)?[0].fell())
        })
    })
}
