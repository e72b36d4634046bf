//! What one `Estimator::update` costs, each method in one process on the same frames of a simulated
//! flight; and what the tables of a sky cost, once: `cargo bench --bench update`. With `--updates N` it times nothing and makes N updates of
//! one method, for `benches/instructions` to count.

#[path = "../tests/methods/mod.rs"]
mod methods;

use clap::Parser;
use irhorizon::config::settings::{Method, SimulationSettings};
use irhorizon::estimator::Estimator;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::simulation::SimulatedSource;
use irhorizon::sky::{Averaging, Family, FieldOfView, Response, Sky};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// The frames: the whole demonstration flight, 80 s at 50 Hz.
const FRAMES: usize = 4000;
/// Runs over all frames; the median of them is given.
const RUNS: usize = 15;

/// Times an update of each method.
#[derive(Debug, Parser)]
struct Args {
    /// Make this many updates and time nothing
    #[arg(long, requires = "method", value_parser = clap::value_parser!(u16).range(..=FRAMES as i64))]
    updates: Option<u16>,
    /// Only this method
    #[arg(long)]
    method: Option<String>,
    /// Give the frames body rates
    #[arg(long)]
    rates: bool,
    /// List the methods' names
    #[arg(long)]
    list: bool,
    /// What `cargo bench` adds by itself
    #[arg(long, hide = true)]
    bench: bool,
}

/// The flight's frames; with body rates from its true attitude, as if it never turned its nose.
fn frames(head: &Head, rates: bool) -> Vec<Frame> {
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), head, field);
    let mut next = |i: usize| {
        let (time, later) =
            (Time::from_nanos(i as u64 * 20_000_000), Time::from_nanos(i as u64 * 20_000_000 + 1_000_000));
        let mut frame = Frame::new(head.sensors.len());
        source.scan(time, &mut frame);
        if rates {
            let (now, then) = (source.truth_at(time), source.truth_at(later));
            let [roll_rate, pitch_rate] =
                [then.roll - now.roll, then.pitch - now.pitch].map(|a| a.to_degrees() / later.since(time));
            let (sin, cos) = now.roll.sin_cos();
            frame.aiding.gyro_deg_s = [roll_rate, pitch_rate * cos, -pitch_rate * sin].map(Some);
        }
        frame
    };
    (0..FRAMES).map(&mut next).collect()
}

fn run(estimator: &mut dyn Estimator, frames: &[Frame]) {
    for frame in frames {
        black_box(estimator.update(black_box(frame)));
    }
}

/// The median time of an update by each of `methods`, ns. They take turns, so that a slow minute of the
/// machine is everybody's.
fn nanoseconds(methods: &[(&str, Method)], head: &Head, frames: &[Frame]) -> Vec<f64> {
    let mut times = vec![Vec::new(); methods.len()];
    for _ in 0..RUNS {
        for ((_, method), times) in methods.iter().zip(&mut times) {
            let mut estimator = methods::estimator(*method, head);
            let start = Instant::now();
            run(estimator.as_mut(), frames);
            times.push(start.elapsed().as_secs_f64() * 1e9 / frames.len() as f64);
        }
    }
    times.into_iter().map(median).collect()
}

/// The median time of `make`, ms.
fn milliseconds<T>(make: impl Fn() -> T) -> f64 {
    let once = || {
        let start = Instant::now();
        black_box(make());
        start.elapsed().as_secs_f64() * 1e3
    };
    median((0..RUNS).map(|_| once()).collect())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// What is made once, when a method begins.
fn tables() {
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let family = milliseconds(|| Family::new(black_box(field)));
    let sky = Sky::NAMIBIA;
    let curve = milliseconds(|| {
        Response::new(sky.shape, black_box(field), Averaging::Temperature).pair_curve(sky.ground_c, sky.sky_max_k)
    });
    println!("tables of a family of skies: {family:.1} ms");
    println!("tables of one sky and a pair's curve: {curve:.1} ms");
}

fn main() -> ExitCode {
    let args = Args::parse();
    let wanted = |name: &str| args.method.as_ref().is_none_or(|m| m == name);
    let methods: Vec<_> = Method::NAMED.into_iter().filter(|(name, _)| wanted(name)).collect();
    let (Some((_, first)), head) = (methods.first(), Head::six()) else {
        eprintln!("update: there is no such method; --list names them");
        return ExitCode::FAILURE;
    };
    if args.list {
        for (name, _) in methods {
            println!("{name}");
        }
    } else if let Some(updates) = args.updates {
        let frames = frames(&head, args.rates);
        run(methods::estimator(*first, &head).as_mut(), &frames[..usize::from(updates)]);
    } else {
        tables();
        for (rates, said) in [(false, "without body rates"), (true, "with body rates")] {
            let frames = frames(&head, rates);
            let times = nanoseconds(&methods, &head, &frames);
            for ((name, _), ns) in methods.iter().zip(&times) {
                println!("update of {name} {said}: {ns:.0} ns, {:.2} times {}", ns / times[0], methods[0].0);
            }
        }
    }
    ExitCode::SUCCESS
}
