//! The table of docs/estimation.md: every scenario through the schemes that others have published and
//! through our own: `cargo bench --bench table`, or `-- NAME…` for some scenarios, `-- --differential` for three pairs
//! instead of six temperatures. About four minutes.

#[path = "../tests/field/mod.rs"]
mod field;
#[path = "../tests/flights/mod.rs"]
mod flights;
#[path = "baselines/schemes/mod.rs"]
mod schemes;

use clap::Parser;
use flights::{Flown, hear, said, score};
use irhorizon::attitude::Attitude;
use irhorizon::ctl::score::statistics::{Said, Score};
use irhorizon::estimator::{Estimator, InverseSineEstimator, ProfileEstimator};
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::simulation::scenario::{LIST, Scenario};
use irhorizon::sky::FieldOfView;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Prints the table.
#[derive(Debug, Parser)]
struct Args {
    /// Only these scenarios
    scenarios: Vec<String>,
    /// Three pairs in volts
    #[arg(long)]
    differential: bool,
    /// What `cargo bench` adds by itself
    #[arg(long, hide = true)]
    bench: bool,
}

type Update = Box<dyn FnMut(&Frame) -> Option<Said>>;
/// Makes a method for a head under a scenario.
type Make = Box<dyn Fn(&Head, &str) -> Update>;

fn ours(estimator: impl Estimator + 'static) -> Update {
    Box::new(said(estimator))
}

/// The time constant that sensors are said to have, s: the scenario's own.
fn lag_s(scenario: &str) -> f64 {
    match scenario {
        "lag-0.3" => 0.3,
        "no-lag" => 0.0,
        _ => 0.1,
    }
}

/// A table's column: how the method is made, whether the instruments are heard, whether it tells its σ.
struct Column {
    name: &'static str,
    make: Make,
    aided: bool,
    sigma: bool,
}

/// The `i`th of the schemes that others have published.
fn published(i: usize, name: &'static str) -> Column {
    let make = move |head: &Head, _: &str| -> Update {
        let (head, mut scheme) = (head.clone(), schemes::named().into_iter().nth(i));
        Box::new(move |frame| {
            let (_, scheme) = scheme.as_mut()?;
            let (roll_deg, pitch_deg) = schemes::update(scheme.as_mut(), &head, frame)?;
            Some(Said::new(Attitude::from_degrees(roll_deg, pitch_deg), Attitude { roll: f64::NAN, pitch: f64::NAN }))
        })
    };
    Column { name, make: Box::new(make), aided: false, sigma: false }
}

fn columns() -> Vec<Column> {
    let mut columns: Vec<Column> =
        schemes::named().iter().enumerate().map(|(i, (name, _))| published(i, name)).collect();
    let mut own = |name, aided, make: fn(&Head, &str) -> Update| {
        columns.push(Column { name, make: Box::new(make), aided, sigma: true });
    };
    own("inverse-sine", false, |head, _| ours(InverseSineEstimator::new(head.clone(), 90.0, 3.0, 45.0)));
    own("profile", false, |head, scenario| {
        let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
        ours(ProfileEstimator::in_flight(head.clone(), field, lag_s(scenario), 3.0))
    });
    let make = |head: &Head, scenario: &str| ours(field::field(head, lag_s(scenario)));
    own("field", false, make);
    own("field, rates and GPS", true, make);
    columns
}

/// Two digits of a number, or a dash where there is none.
fn digits(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |v| match v {
        v if v >= 9.95 => format!("{v:.0}"),
        v if v >= 0.995 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    })
}

fn cell(score: &Score, sigma: bool) -> String {
    let [roll, pitch, p99, under] =
        [score.roll_rms_deg, score.pitch_rms_deg, score.error_p99_deg, score.underestimated_p99_deg].map(digits);
    let mut cell = format!("{roll} / {pitch} / {p99} / {under}");
    if let (true, Some(roll), Some(pitch)) = (sigma, score.roll_in_2_sigma_percent, score.pitch_in_2_sigma_percent) {
        cell += &format!(" ({roll:.0}, {pitch:.0} %)");
    }
    if let Some(withheld) = score.withheld_percent.filter(|w| *w >= 0.05) {
        cell += &format!(", {withheld:.1} % none");
    }
    cell
}

/// A line of the table.
fn line(name: &str, differential: bool) -> Option<String> {
    let scenario = Scenario::named(name)?;
    let scenario = if differential { scenario.differential() } else { scenario };
    let (flights, head) = (Flown::all(&scenario, 15), scenario.head());
    let mut line = format!("| {name} |");
    for column in columns() {
        let score = score(&flights, hear(column.aided), || (column.make)(&head, name));
        line += &format!(" {} |", cell(&score, column.sigma));
    }
    Some(line)
}

fn main() -> ExitCode {
    let args = Args::parse();
    let names: Vec<&str> = LIST
        .iter()
        .map(|(n, _)| *n)
        .filter(|n| args.scenarios.is_empty() || args.scenarios.iter().any(|w| w == n))
        .collect();
    if names.is_empty() {
        eprintln!("table: no such scenario; there are: {}", LIST.map(|(n, _)| n).join(" "));
        return ExitCode::FAILURE;
    }
    let next = AtomicUsize::new(0);
    let lines = Mutex::new(vec![None; names.len()]);
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((i, name)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, names.get(i)?)))
                {
                    let made = line(name, args.differential);
                    lines.lock().unwrap_or_else(PoisonError::into_inner)[i] = made;
                }
            });
        }
    });
    let columns: Vec<&str> = columns().iter().map(|c| c.name).collect();
    println!("| scenario | {} |", columns.join(" | "));
    println!("|---|{}", "---|".repeat(columns.len()));
    for line in lines.lock().unwrap_or_else(PoisonError::into_inner).iter().flatten() {
        println!("{line}");
    }
    ExitCode::SUCCESS
}
