//! Weather that changes and sensors that fail, played at given times.

use crate::frame::Missing;

/// Ground and sky at a time; between two of them they change in a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// Seconds since the flight began.
    pub time_s: f64,
    /// The ground's temperature, °C.
    pub ground_c: f64,
    /// The sky's largest deficit, K: negative where the ground is the colder one.
    pub sky_max_k: f64,
}

impl Weather {
    /// The weather at `time_s` by `schedule`, which is in order of time: its first before it begins,
    /// its last after it ends; `None` when it is empty.
    pub fn at(schedule: &[Self], time_s: f64) -> Option<Self> {
        let next = schedule.partition_point(|w| w.time_s <= time_s);
        let Some(a) = next.checked_sub(1).map(|i| schedule[i]) else { return schedule.first().copied() };
        let Some(b) = schedule.get(next) else { return Some(a) };
        let x = (time_s - a.time_s) / (b.time_s - a.time_s);
        Some(Self {
            time_s,
            ground_c: a.ground_c + x * (b.ground_c - a.ground_c),
            sky_max_k: a.sky_max_k + x * (b.sky_max_k - a.sky_max_k),
        })
    }
}

/// A sensor that gives nothing for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outage {
    /// Which, in the head's order.
    pub sensor: usize,
    /// Seconds since the flight began: the first scan without it.
    pub from_s: f64,
    /// The first scan with it again.
    pub to_s: f64,
    /// Why there is nothing. [`Missing::BusGone`], [`Missing::BusHeld`], [`Missing::BusInUse`] and [`Missing::Denied`]
    /// take the sensor's bus down in what the source says of its buses.
    pub reason: Missing,
}

impl Outage {
    /// Why sensor `sensor` gives nothing at `time_s`, by the first of `outages` that says so.
    pub fn at(outages: &[Self], sensor: usize, time_s: f64) -> Option<Missing> {
        outages.iter().find(|o| o.sensor == sensor && (o.from_s..o.to_s).contains(&time_s)).map(|o| o.reason)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weather_changes_in_a_straight_line() {
        let w = |time_s, ground_c, sky_max_k| Weather { time_s, ground_c, sky_max_k };
        let cloud = [w(10.0, 16.0, 40.0), w(11.5, 16.0, 10.0)];
        for (t, sky_max_k) in [(0.0, 40.0), (10.0, 40.0), (10.75, 25.0), (11.5, 10.0), (60.0, 10.0)] {
            assert!((Weather::at(&cloud, t).unwrap().sky_max_k - sky_max_k).abs() < 1e-12, "{t} s");
        }
        assert_eq!(Weather::at(&[], 1.0), None);
        // Two at the same time are a jump.
        let jump = [w(1.0, 3.0, 5.0), w(1.0, -4.0, -2.0)];
        assert_eq!(Weather::at(&jump, 0.999).unwrap().ground_c, 3.0);
        assert_eq!(Weather::at(&jump, 1.0).unwrap().ground_c, -4.0);
    }

    #[test]
    fn an_outage_begins_and_ends() {
        let o = [Outage { sensor: 2, from_s: 1.0, to_s: 2.0, reason: Missing::BadPec }];
        assert_eq!(Outage::at(&o, 2, 0.99), None);
        assert_eq!(Outage::at(&o, 2, 1.0), Some(Missing::BadPec));
        assert_eq!(Outage::at(&o, 1, 1.5), None);
        assert_eq!(Outage::at(&o, 2, 2.0), None);
    }
}
