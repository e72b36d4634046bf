//! What to do about a fault, in a line: the short of docs/faults.md.

/// Each fault's name, without its sensor or bus, and what to do about it.
const ADVICE: [(&str, &str); 11] = [
    ("low-contrast", "fly by something else; in clear weather: is a sensor covered, wet or dirty?"),
    ("inverted-contrast", "fly by something else; on the ground: are up and down exchanged, or a pair's sign?"),
    ("wet-sensor", "water dries in the wind; dirt must be wiped off on the ground"),
    ("obstructed", "fly by something else, and away from what is beside: a ridge, a cloud bank"),
    ("roll-disagrees", "fly by something else; on the ground: the sensors' directions, up and down, the roll trim"),
    ("pitch-disagrees", "fly by something else; on the ground: the directions of the sensors, the pitch trim"),
    ("sensor-stuck", "power-cycle it; if that does not help, replace it"),
    ("sensor-lost", "irhorizonctl sensors says what to look at"),
    ("sensor-saturated", "a larger gain-v; look at the pair's supply"),
    ("bus-down", "the daemon's log has the next step: journalctl -u irhorizond"),
    ("stale", "is irhorizond running, and is the bus up? journalctl -u irhorizond"),
];

/// What to do about the fault `name` (`sensor-lost:nose`), in a line; empty for one that is not known.
pub fn of(name: &str) -> &'static str {
    let kind = name.split_once(':').map_or(name, |(kind, _)| kind);
    ADVICE.iter().find(|(k, _)| *k == kind).map_or("", |(_, advice)| advice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::FaultKind;
    use crate::head::Head;

    #[test]
    fn every_fault_has_its_advice_in_a_line() {
        use FaultKind as K;
        let head = Head::new(Head::six().sensors, vec!["/dev/i2c-1".into()]);
        let sky = [K::LowContrast, K::InvertedContrast, K::WetSensor(0), K::Obstructed, K::RollDisagrees];
        let rest = [K::PitchDisagrees, K::SensorStuck(1), K::SensorLost(2), K::SensorSaturated(3), K::BusDown(0)];
        let all: Vec<_> =
            sky.into_iter().chain(rest).chain([K::Stale]).map(|k| of(&k.display(&head).to_string())).collect();
        assert!(all.iter().all(|a| !a.is_empty() && a.chars().count() <= 90), "{all:?}");
        assert_eq!((all.len(), of("sensor-lost:a:b"), of("nonsense"), of("")), (ADVICE.len(), all[7], "", ""));
    }
}
