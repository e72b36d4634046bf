//! The table of docs/faults.md: how often a wrong horizon is given with confidence, in flights of two minutes in which
//! anything goes wrong: `cargo bench --bench integrity`. About eight minutes on two cores.
//!
//! - `drawn`: a flight by chance: scene, pilot, sensors, faults;
//! - `flown`: what is said of it; `heard`: a flight heard in several ways, as tests/faults.rs has it.

mod drawn;
mod flown;
#[path = "../../tests/events/heard.rs"]
mod heard;

use clap::Parser;
use drawn::Drawn;
use flown::{Flown, HEARD, SECONDS, WRONG_DEG, WRONG_SIGMAS, fly};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{available_parallelism, scope};

/// Prints the table.
#[derive(Debug, Parser)]
struct Args {
    /// How many flights
    #[arg(long, default_value_t = 500)]
    flights: u64,
    /// The first seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Tells every wrong horizon, too
    #[arg(long)]
    each: bool,
    /// What `cargo bench` adds by itself
    #[arg(long, hide = true)]
    bench: bool,
}

/// A line of the table: flights with so many faults.
fn line(name: &str, flights: &[&Flown]) -> String {
    let mut line = format!("| {name} | {} |", flights.len());
    for heard in 0..HEARD.len() {
        let given_s: f64 = flights.iter().map(|f| f.given_s[heard]).sum();
        let wrong_s: f64 = flights.iter().map(|f| f.wrong_s[heard]).sum();
        let misled = flights.iter().filter(|f| f.wrong_s[heard] > 0.0).count();
        let share = 100.0 * wrong_s / given_s.max(1e-9);
        let given = 100.0 * given_s / (SECONDS * flights.len().max(1) as f64);
        line += &format!(" {share:.2} %, {misled} ({given:.0} %) |");
    }
    line
}

fn main() {
    let args = Args::parse();
    let (first, last) = (args.seed, args.seed + args.flights);
    let next = AtomicU64::new(first);
    let fly_all = || {
        let seed = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|seed| *seed < last);
        std::iter::from_fn(seed).map(|seed| fly(Drawn::new(seed))).collect::<Vec<_>>()
    };
    let mut flights: Vec<Flown> = scope(|scope| {
        let threads = available_parallelism().map_or(1, |n| n.get());
        let all: Vec<_> = (0..threads).map(|_| scope.spawn(fly_all)).collect();
        all.into_iter().filter_map(|thread| thread.join().ok()).flatten().collect()
    });
    flights.sort_by_key(|f| f.seed);
    if args.each {
        flights.iter().flat_map(|f| &f.told).for_each(|told| println!("{told}"));
    }
    println!("| faults | flights | {} |", HEARD.join(" | "));
    println!("|---|---|---|---|---|---|");
    for (count, name) in ["none", "one", "two"].into_iter().enumerate() {
        let so_many: Vec<&Flown> = flights.iter().filter(|f| f.faults == count).collect();
        println!("{}", line(name, &so_many));
    }
    println!("\nWrong by more than {WRONG_DEG}° and {WRONG_SIGMAS} times the standard deviation.");
}
