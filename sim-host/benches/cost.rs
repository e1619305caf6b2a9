//! Computing time over the size of the work: number of rides, speeds and threads. Prints a table and writes a figure to
//! the file of its first argument: `cargo xtask cost`.

use control::{Config, Law};
use sim_host::basin::{Axis, Method, Search, basin};
use sim_host::bicycle::{Geometry, catalogue};
use sim_host::report::figure::{Axis as Scale, Chart, Line, Look, Marker, Plot, Series, chart};
use sim_host::ride::{Assist, Conditions, Start, rides};
use std::time::Instant;

/// Numbers of rides: lanes partly filled, all four, eight or sixteen filled, one more.
const RIDES: [u32; 10] = [1, 2, 4, 7, 8, 9, 16, 17, 32, 64];
/// Numbers of speeds from 0 to 10 m/s.
const SPEEDS: [u32; 7] = [2, 5, 9, 17, 33, 65, 101];
/// Runs of each size, of which the fastest counts.
const TIMES: u32 = 7;

fn main() {
    let file = std::env::args().nth(1).expect("the figure's file");
    let bicycle = catalogue::load("rigid_jason").expect("it ships").parameters;
    let plan = Config::thesis(Law::H { cut: false }).plan().expect("in range");
    let conditions = Conditions::thesis(Geometry::new(&bicycle), Assist::Firmware(Box::new(plan)));

    let of_rides: Vec<(u32, f64)> = RIDES.map(|count| (count, of_rides(&conditions, count))).into();
    let most = std::thread::available_parallelism().map_or(1, usize::from).min(2);
    let of_speeds: Vec<Vec<(u32, f64)>> = (1..=most)
        .map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| SPEEDS.map(|count| (count, of_speeds(&conditions, count))).into())
        })
        .collect();

    println!("| rides of 6 s, one thread | time \\[ms\\] | a ride \\[ms\\] |\n| --- | ---: | ---: |");
    for (count, seconds) in &of_rides {
        println!("| {count} | {:.1} | {:.2} |", 1e3 * seconds, 1e3 * seconds / f64::from(*count));
    }
    println!(
        "\n| speeds of the h basin | one thread \\[ms\\] | a speed \\[ms\\] | two threads \\[ms\\] | ratio |"
    );
    println!("| --- | ---: | ---: | ---: | ---: |");
    for (i, (count, one)) in of_speeds[0].iter().enumerate() {
        let two = of_speeds.get(1).map_or(f64::NAN, |times| times[i].1);
        let a_speed = 1e3 * one / f64::from(*count);
        println!("| {count} | {:.0} | {a_speed:.1} | {:.0} | {:.2} |", 1e3 * one, 1e3 * two, one / two);
    }

    let points = |times: &[(u32, f64)]| times.iter().map(|(n, s)| (f64::from(*n), 1e3 * s)).collect();
    let series = |name: &str, colour, times: &[(u32, f64)]| {
        let look = Look { colour, line: Line::Solid, marker: Some(Marker::Dot) };
        Series::new(name, look, points(times))
    };
    let plot = |title: &str, x: &str, series: Vec<Series>| Plot {
        title: title.into(),
        x: Scale::new(x).log(),
        y: Scale::new("time [ms]").log(),
        series,
        ..Plot::default()
    };
    let names = ["one thread", "two threads"];
    let basins = of_speeds.iter().enumerate().map(|(i, times)| series(names[i], i, times)).collect();
    let figure = chart(&Chart {
        title: "Computing time over the size of the work".into(),
        columns: 2,
        plots: vec![
            plot("rides of 6 s, law h", "number of rides", vec![series(names[0], 0, &of_rides)]),
            plot("h basin, 0 to 10 m/s", "number of speeds", basins),
        ],
        ..Chart::default()
    });
    std::fs::write(&file, figure.svg()).expect("the figure is written");
}

/// Seconds for rides that do not fall.
fn of_rides(conditions: &Conditions, count: u32) -> f64 {
    let starts: Vec<Start> =
        (0..count).map(|i| Axis::SteerRate.start(5.0, 0.1 * f64::from(1 + i % 64))).collect();
    least(|| rides(conditions, &starts))
}

/// Seconds for the basin at evenly spaced speeds.
fn of_speeds(conditions: &Conditions, count: u32) -> f64 {
    let search = Search {
        speeds: (0..count).map(|i| 10.0 * f64::from(i) / f64::from(count - 1)).collect(),
        axis: Axis::SteerRate,
        max_rate: 30.0,
        scan_step: 0.25,
        tolerance: 0.01,
        method: Method::Fast,
        efforts: false,
    };
    least(|| basin(conditions, &search, |_| (), || false).expect("in range"))
}

fn least<X>(run: impl Fn() -> X) -> f64 {
    let seconds = |_| {
        let begin = Instant::now();
        std::hint::black_box(run());
        begin.elapsed().as_secs_f64()
    };
    (0..TIMES).map(seconds).fold(f64::INFINITY, f64::min)
}
