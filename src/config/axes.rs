//! Whether the sensors make the pairs that the method of estimation needs.

use super::section::Findings;
use super::sensor::Sensors;
use super::settings::Settings;
use crate::direction::Direction;
use crate::head::{Head, SensorKind};

/// `inverse-sine` needs a pair along the vertical, and pairs that together see all three axes.
pub fn check(settings: &Settings, sensors: &Sensors<'_>, findings: &Findings<'_>) {
    let head = settings.head();
    let method = settings.estimator.method.as_str();
    let singles: Vec<usize> = (0..head.sensors.len()).filter(|i| !head.pairs.iter().any(|p| p.uses(*i))).collect();
    let Some(blamed) = sensors.good.get(singles.first().copied().unwrap_or(0)) else { return };
    let add =
        |message: String| findings.add(blamed.place(""), format!("{message}{}", without_partner(&head, &singles)));

    let basis = basis(&head);
    let unseen = |axis: &Direction| reject(axis.components(), &basis).1 > 0.2;
    let mut missing: Vec<Direction> = [Direction::NOSE, Direction::LEFT].into_iter().filter(unseen).collect();
    if head.vertical_pair().is_none() {
        missing.push(Direction::UP);
    }
    // Pairs aslant to the axes see some of each: what they lack is not a matter of axes.
    if basis.len() + missing.len() > 3 && missing.iter().any(|d| *d != Direction::UP) {
        missing.retain(|d| *d == Direction::UP);
        let seen = basis.len();
        add(format!("sensor: {method} needs pairs in three directions, and those here make {seen}: add one across"));
    }
    for axis in missing {
        let name =
            if axis == Direction::UP { "vertical pair".into() } else { format!("pair {axis}-{}", axis.opposite()) };
        add(format!("sensor: {method} needs a {name}: {}", advice(&head, axis)));
    }
}

/// What to add for a pair along `axis`.
fn advice(head: &Head, axis: Direction) -> String {
    let absolute = |s: &&crate::head::Sensor| s.kind == SensorKind::Absolute;
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
