//! Whether the sensors, and the pairs that they make, are what the method of estimation needs.

use super::findings::Findings;
use super::sensor::Sensors;
use super::settings::{Method, Settings};
use super::source::Place;
use crate::direction::Direction;
use crate::estimator::suits::{self, FieldLack};
use crate::head::{Head, Sensor};

/// Checks the head against its method; `said` is where that was chosen.
pub fn check(settings: &Settings, sensors: &Sensors<'_>, said: Option<Place>, findings: &Findings<'_>) {
    let head = settings.head();
    match settings.method() {
        Method::Field => field(&head, sensors, said, findings),
        method => pairs(&head, method, sensors, findings),
    }
}

/// `field` needs enough sensors that look all ways. Without a choice the first of them is blamed.
fn field(head: &Head, sensors: &Sensors<'_>, said: Option<Place>, findings: &Findings<'_>) {
    let (Err(lack), Some(first)) = (suits::field(head), sensors.good.first()) else { return };
    let (place, subject) = match said {
        Some(place) => (place, "estimator.method = \"field\""),
        None => (first.place(""), "sensor: field"),
    };
    let count = head.sensors.len();
    let what = match lack {
        FieldLack::TooFew { needed } => format!("needs {needed} sensors or more, and there are {count}"),
        FieldLack::TooMany { most } => format!("takes {most} sensors at most, and there are {count}"),
        FieldLack::Flat => "cannot tell a tilt from a warmer ground by where these sensors look".into(),
    };
    let next = match lack {
        FieldLack::TooMany { .. } => "leave some out".into(),
        _ => one_more(head).unwrap_or_else(|| "add some that look other ways".into()),
    };
    findings.add(place, format!("{subject} {what}: {next}{}", would_do(head)));
}

/// The one sensor that would make the head good for `field`, if one is enough.
fn one_more(head: &Head) -> Option<String> {
    let kind = head.sensors.first()?.kind;
    let names = ["up", "down", "nose", "tail", "left", "right"];
    names.into_iter().filter_map(|n| Some((n, Direction::named(n)?))).find_map(|(name, direction)| {
        let looked_at = head.sensors.iter().any(|s| s.direction.dot(direction.components()) > 0.9);
        let mut sensors = head.sensors.clone();
        sensors.push(Sensor { name: name.to_owned(), direction, kind, bus: None });
        let good = !looked_at && suits::field(&Head::new(sensors, Vec::new())).is_ok();
        good.then(|| format!("add a [[sensor]] that looks {name}"))
    })
}

/// The best method that works on `head` as it is.
fn would_do(head: &Head) -> String {
    let other = Method::NAMED.iter().rev().find(|(_, m)| m.suits(head));
    other.map_or(String::new(), |(name, _)| format!("; method = \"{name}\" would do"))
}

/// `inverse-sine` needs a pair along the vertical, and both it and `profile` pairs that together see
/// all three axes.
fn pairs(head: &Head, method: Method, sensors: &Sensors<'_>, findings: &Findings<'_>) {
    let name = method.as_str();
    let singles: Vec<usize> = (0..head.sensors.len()).filter(|i| !head.pairs.iter().any(|p| p.uses(*i))).collect();
    let Some(blamed) = sensors.good.get(singles.first().copied().unwrap_or(0)) else { return };
    let add = |lack: &str| {
        findings.add(
            blamed.place(""),
            format!("sensor: {name} {lack}{}{}", without_partner(head, &singles), would_do(head)),
        )
    };

    let basis = basis(head);
    let unseen = |axis: &Direction| reject(axis.components(), &basis).1 > 0.2;
    let mut missing: Vec<Direction> = [Direction::NOSE, Direction::LEFT].into_iter().filter(unseen).collect();
    let vertical = match method {
        Method::InverseSine => head.vertical_pair().is_some(),
        _ => !unseen(&Direction::UP),
    };
    if !vertical {
        missing.push(Direction::UP);
    }
    // Pairs aslant to the axes see some of each: what they lack is not a matter of axes.
    if basis.len() + missing.len() > 3 && missing.iter().any(|d| *d != Direction::UP) {
        missing.retain(|d| *d == Direction::UP && method == Method::InverseSine);
        let seen = basis.len();
        let more = if seen + missing.len() < 2 { "two" } else { "one" };
        add(&format!("needs pairs in three directions, and those here make {seen}: add {more} across"));
    } else if missing.is_empty() && !method.suits(head) {
        add("needs pairs in three directions, and those here lie nearly in one plane: turn one out of it");
    }
    for axis in missing {
        let pair =
            if axis == Direction::UP { "vertical pair".into() } else { format!("pair {axis}-{}", axis.opposite()) };
        add(&format!("needs a {pair}: {}", advice(head, axis)));
    }
}

/// What to add for a pair along `axis`.
fn advice(head: &Head, axis: Direction) -> String {
    let absolute = |s: &&crate::head::Sensor| s.is_absolute();
    let looks = |d: Direction| head.sensors.iter().filter(absolute).any(|s| s.direction.dot(d.components()) > 0.999);
    let other = axis.opposite();
    match (looks(axis), looks(other)) {
        (true, _) => format!("add a [[sensor]] that looks {other}"),
        (_, true) => format!("add a [[sensor]] that looks {axis}"),
        _ if head.sensors.iter().any(|s| absolute(&s)) => {
            format!("add a [[sensor]] that looks {axis} and one that looks {other}")
        }
        _ => format!("add a [[sensor]] with direction = \"{axis}\""),
    }
}

fn without_partner(head: &Head, singles: &[usize]) -> String {
    let names: Vec<String> = singles
        .iter()
        .filter_map(|i| head.sensors.get(*i))
        .map(|s| match s.direction.to_string() {
            direction if direction == s.name => format!("\"{}\"", s.name),
            direction => format!("\"{}\" (looks {direction})", s.name),
        })
        .collect();
    if names.is_empty() { String::new() } else { format!("; nothing looks opposite to {}", names.join(", ")) }
}

/// Orthogonal unit vectors that span the pairs' directions.
fn basis(head: &Head) -> Vec<[f64; 3]> {
    let mut basis: Vec<[f64; 3]> = Vec::new();
    for pair in &head.pairs {
        let (rest, length) = reject(pair.direction.components(), &basis);
        if length > 0.2 {
            basis.push(rest.map(|c| c / length));
        }
    }
    basis
}

/// What is left of `v` across `basis`, and its length.
fn reject(v: [f64; 3], basis: &[[f64; 3]]) -> ([f64; 3], f64) {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let rest = basis.iter().fold(v, |r, b| {
        let along = dot(v, *b);
        [r[0] - along * b[0], r[1] - along * b[1], r[2] - along * b[2]]
    });
    (rest, dot(rest, rest).sqrt())
}
