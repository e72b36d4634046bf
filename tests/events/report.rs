//! Distributions, and what is reached of what is asked.

use super::event::Event;
use super::flown::AIDING;
use super::outcome::Outcome;

/// Something asked, and in how many flights it is reached.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What.
    pub what: &'static str,
    /// In how many flights.
    pub reached: usize,
    /// Of how many.
    pub of: usize,
}

/// Something asked, with whether a flight reaches it.
type Demand = (&'static str, Box<dyn Fn(&Outcome) -> bool>);

/// Least, median, 90th percentile, most.
fn distribution(values: impl Iterator<Item = f64>) -> Option<[f64; 4]> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some([0.0, 0.5, 0.9, 1.0].map(|share| values[(share * last as f64).round() as usize]))
}

/// Everything asked of `event`, heard in one way, with whether a flight reaches it.
fn asked(event: &Event, aided: usize) -> Vec<Demand> {
    let within_s = event.within_s;
    let mut asked: Vec<Demand> = vec![
        ("seen in time", Box::new(move |o| o.delay_s().is_some_and(|d| d <= within_s))),
        ("nothing else said", Box::new(|o| o.others.is_empty())),
    ];
    if let Some(limit_deg) = event.error_deg[aided] {
        asked.push(("error", Box::new(move |o| o.worst[0] <= limit_deg)));
    }
    if let Some(percent) = event.covered_percent.filter(|_| aided == 0) {
        // Where none is given none is wrong.
        asked.push(("2 sigma", Box::new(move |o| o.covered_percent().is_none_or(|c| c >= percent))));
    }
    if event.withheld {
        asked.push(("withheld", Box::new(|o| o.late[1] == 0)));
    }
    asked
}

/// What is reached of what is asked.
pub fn reached(event: &Event, outcomes: &[Outcome]) -> Vec<Asked> {
    let Some(first) = outcomes.first() else { return Vec::new() };
    let count = |what, is: &dyn Fn(&Outcome) -> bool| Asked {
        what,
        reached: outcomes.iter().filter(|o| is(o)).count(),
        of: outcomes.len(),
    };
    asked(event, first.aided).into_iter().map(|(what, is)| count(what, &*is)).collect()
}

/// The flights that do not reach all that is asked.
pub fn missing<'a>(event: &Event, outcomes: &'a [Outcome]) -> Vec<&'a Outcome> {
    let Some(first) = outcomes.first() else { return Vec::new() };
    let asked = asked(event, first.aided);
    outcomes.iter().filter(|o| !asked.iter().all(|(_, is)| is(o))).collect()
}

fn spread(values: Option<[f64; 4]>) -> String {
    // Adding nothing takes the sign off a zero.
    let shown = |v: f64| format!("{:.1}", (10.0 * v).round() / 10.0 + 0.0).replace('-', "−");
    values.map_or("–".to_owned(), |v| v.map(shown).join(" / "))
}

/// Delays, errors and coverage.
pub fn cells(outcomes: &[Outcome]) -> [String; 3] {
    let given = || outcomes.iter().filter(|o| o.given[0] > 0);
    let sum = |i: usize| outcomes.iter().map(|o| f64::from(o.given[i])).sum::<f64>();
    let covered = if sum(0) > 0.0 { format!("{:.0} %", 100.0 * sum(1) / sum(0)) } else { "–".to_owned() };
    [
        spread(distribution(outcomes.iter().filter_map(Outcome::delay_s))),
        spread(distribution(given().map(|o| o.worst[0]))),
        covered,
    ]
}

/// Prints what was reached, and every flight that misses something.
pub fn print(event: &Event, outcomes: &[Outcome]) {
    let Some(first) = outcomes.first() else { return };
    let [delay, error, covered] = cells(outcomes);
    println!("{} {}:", event.name, AIDING[first.aided]);
    let after = spread(distribution(outcomes.iter().map(|o| o.after_deg)));
    println!("  delay {delay} s; in 2σ {covered} (least / median / 90 % / most)");
    println!("  worst error {error}°, {after}° after it was to be seen");
    for Asked { what, reached, of } in reached(event, outcomes) {
        println!("  {what}: {reached} of {of}");
    }
    for outcome in missing(event, outcomes) {
        println!("  - {outcome}");
    }
}
