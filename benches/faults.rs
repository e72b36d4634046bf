//! The table of docs/faults.md: how soon what goes wrong is seen, and how often: `cargo bench --bench faults`, or
//! `-- --flights` for every flight that misses something too. About half a minute.

#[path = "../tests/events/mod.rs"]
mod events;

use clap::Parser;
use events::event::{Event, FOG, HAIL, LOST, RIDGE, STUCK, VALLEY, WET, WET_ALL};
use events::flown::AIDING;
use events::outcome::{Outcome, run};
use events::quiet::{Alarm, lively, straight};
use events::report;

/// In the order of the table.
const EVENTS: [Event; 8] = [HAIL, FOG, WET, WET_ALL, STUCK, LOST, RIDGE, VALLEY];
/// An error that matters where nothing is said in time, °.
const MATTERS_DEG: f64 = 5.0;

/// Prints the table.
#[derive(Debug, Parser)]
struct Args {
    /// Every flight that misses something, too
    #[arg(long)]
    flights: bool,
    /// The first seed, a multiple of 6; the table's is 0
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What `cargo bench` adds by itself
    #[arg(long, hide = true)]
    bench: bool,
}

/// A line of the table.
fn line(event: &Event, aided: usize, outcomes: &[Outcome]) -> String {
    let all = report::reached(event, outcomes);
    let share =
        |what| all.iter().find(|a| a.what == what).map_or("–".to_owned(), |a| format!("{} of {}", a.reached, a.of));
    let late = |o: &&Outcome| o.delay_s().is_none_or(|d| d > event.within_s) && o.worst[0] > MATTERS_DEG;
    let late = outcomes.iter().filter(late).count();
    let others = outcomes.iter().filter(|o| !o.others.is_empty()).count();
    let [delay, error, covered] = report::cells(outcomes);
    let limit = event.error_deg[aided].map_or(String::new(), |e| format!("; ≤ {e}: {}", share("error")));
    let (name, aiding, seen, within_s) = (event.name, AIDING[aided], share("seen in time"), event.within_s);
    let withheld = share("withheld");
    format!(
        "| {name} | {aiding} | {seen} in {within_s} s | {delay} | {error}{limit} | {covered} | {withheld} | {late} | {others} |"
    )
}

/// A line for flights in which nothing goes wrong.
fn silence(name: &str, (flights, alarms): &(u32, Vec<Alarm>)) -> String {
    let mut line = format!("{name}: {} false alarms in {flights} flights, each heard in both ways.", alarms.len());
    for (i, alarm) in alarms.iter().enumerate() {
        line += &format!("{}- {alarm}", if i == 0 { "\n\n" } else { "\n" });
    }
    line
}

fn main() {
    let args = Args::parse();
    std::thread::scope(|scope| {
        let rows = EVENTS.map(|event| scope.spawn(move || (event, run(&event, args.seed))));
        let quiet = [
            ("Turns of 60°, loops and rolls, 120 s", scope.spawn(|| lively(args.seed))),
            ("Straight ahead, 10 min", scope.spawn(|| straight(args.seed))),
        ];
        println!(
            "| event | heard | seen | delay, s | worst error, ° | in 2σ | withheld | late, over 5° | other names |"
        );
        println!("|---|---|---|---|---|---|---|---|---|");
        let rows: Vec<_> = rows.into_iter().filter_map(|row| row.join().ok()).collect();
        for (event, both) in &rows {
            for (aided, outcomes) in both.iter().enumerate() {
                println!("{}", line(event, aided, outcomes));
            }
        }
        for (name, flights) in quiet {
            if let Ok(flights) = flights.join() {
                println!("\n{}", silence(name, &flights));
            }
        }
        if args.flights {
            for (event, outcomes) in rows.iter().flat_map(|(event, both)| both.iter().map(move |o| (event, o))) {
                report::print(event, outcomes);
            }
        }
    });
}
