//! A made-up flight as a source of frames.

use super::fault::{Fault, surroundings};
use super::flight::Flight;
use super::head::SimulatedHead;
use super::instruments::Instruments;
use super::noise::Noise;
use super::orientation::Orientation;
use super::scene::Scene;
use super::script::{Outage, Weather};
use super::straight::Straight;
use super::trajectory::Trajectory;
use crate::attitude::Attitude;
use crate::config::settings::{FlightName, SimulationSettings, SkyName};
use crate::frame::{Aiding, Frame, Missing, Sample};
use crate::head::Head;
use crate::sky::{Averaging, FieldOfView, Sky};
use crate::source::{FrameSource, Integrity, SensorHealth};
use crate::time::Time;
use std::f64::consts::TAU;

/// What is flown.
#[derive(Clone, Debug)]
enum Path {
    Flight(Flight),
    Trajectory(Trajectory),
}

impl Path {
    /// Where the nose points `time_s` after the flight began, rad; 0 for a flight without heading.
    fn yaw(&self, time_s: f64) -> f64 {
        match self {
            Self::Flight(_) => 0.0,
            Self::Trajectory(trajectory) => trajectory.at(time_s).yaw(),
        }
    }
}

/// Flies through a made-up sky. The same settings, seed and ticks give the same bytes.
#[derive(Clone, Debug)]
pub struct SimulatedSource {
    path: Path,
    instruments: Option<Instruments>,
    /// The chance of a scan without any word, and what decides.
    dropped: (f64, Noise),
    field: FieldOfView,
    scene: Scene,
    head: SimulatedHead,
    /// In order of time; empty: the sky's own values for ever.
    weather: Vec<Weather>,
    outages: Vec<Outage>,
    faults: Vec<Fault>,
    /// What runs past the flight now.
    beside: Vec<Straight>,
    /// When the flight began.
    origin: Option<Time>,
    last_tick: Option<Time>,
    health: Vec<SensorHealth>,
    /// Each sensor's bus.
    bus_of: Vec<Option<usize>>,
    buses_down: Vec<Option<Missing>>,
}

impl SimulatedSource {
    /// The flight and the sky of the settings, seen by `head`, whose sensors all have
    /// the same `field`. Averages temperature, as the report does. Takes a few milliseconds.
    pub fn new(settings: &SimulationSettings, head: &Head, field: FieldOfView) -> Self {
        let sky = match settings.sky {
            SkyName::Namibia => Sky::NAMIBIA,
            SkyName::Durham => Sky::DURHAM,
        };
        let flight = match settings.flight {
            FlightName::Demo => Flight::demo(settings.seed),
            FlightName::Parked => Flight::parked(),
        };
        let (integrity, lag_s) = (Integrity::None, settings.lag_s);
        let health = SensorHealth { integrity, settling_s: lag_s, lag_s, ..SensorHealth::default() };
        let source = Self {
            path: Path::Flight(flight),
            instruments: None,
            dropped: (0.0, Noise::new(settings.seed)),
            field,
            scene: Scene::new(sky, field, Averaging::Temperature),
            head: SimulatedHead::new(head, settings.lag_s, settings.noise_c, settings.seed),
            weather: Vec::new(),
            outages: Vec::new(),
            faults: Vec::new(),
            beside: Vec::new(),
            origin: None,
            last_tick: None,
            health: vec![health; head.sensors.len()],
            bus_of: head.sensors.iter().map(|s| s.bus).collect(),
            buses_down: vec![None; head.buses.len()],
        };
        source.with_faults(settings.faults.clone())
    }

    /// Another flight.
    pub fn with_flight(mut self, flight: Flight) -> Self {
        self.path = Path::Flight(flight);
        self
    }

    /// A flight with heading, speed and body rates.
    pub fn with_trajectory(mut self, trajectory: Trajectory) -> Self {
        self.path = Path::Trajectory(trajectory);
        self
    }

    /// Instruments beside the head; they tell of a trajectory alone.
    pub fn with_instruments(mut self, instruments: Instruments) -> Self {
        self.instruments = Some(instruments);
        self
    }

    /// Scans of which nothing arrives, by chance: 0..1 of all, chosen by `seed`.
    pub fn with_dropped(mut self, share: f64, seed: u64) -> Self {
        self.dropped = (share, Noise::new(seed));
        self
    }

    /// Another sky, or sensors that average radiance.
    pub fn with_sky(mut self, sky: Sky, averaging: Averaging) -> Self {
        self.scene = Scene::new(sky, self.field, averaging);
        self
    }

    /// Another scene, seen through its own field of view.
    pub fn with_scene(mut self, scene: Scene) -> Self {
        self.scene = scene;
        self
    }

    /// Weather that changes: in place of the sky's ground temperature and `SkyMax`.
    pub fn with_weather(mut self, mut weather: Vec<Weather>) -> Self {
        weather.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        self.weather = weather;
        self
    }

    /// Sensors that fail.
    pub fn with_outages(mut self, outages: Vec<Outage>) -> Self {
        self.outages = outages;
        self
    }

    /// What goes wrong on purpose, in place of what the settings say. A fault of a sensor that the head
    /// has not touches nothing: see [`Fault::check`].
    pub fn with_faults(mut self, faults: Vec<Fault>) -> Self {
        self.head.set_faults(&faults);
        // A valley has two sides.
        self.beside = Vec::with_capacity(2 * faults.len());
        self.faults = faults;
        self
    }

    /// The smallest step of a pair's channel, V; 0 for none. An ADS1115's at ±2.048 V when not said.
    pub fn with_volts_step(mut self, volts_step: f64) -> Self {
        self.head.set_volts_step(volts_step);
        self
    }

    /// When the flight begins; the first tick when not said.
    pub fn with_origin(mut self, origin: Time) -> Self {
        self.origin = Some(origin);
        self
    }

    /// The attitude truly flown at `time`. Before the first scan, with no origin given, the flight
    /// begins at the clock's zero.
    pub fn truth_at(&self, time: Time) -> Attitude {
        match &self.path {
            Path::Flight(flight) => flight.attitude(self.flown_s(time)),
            Path::Trajectory(trajectory) => trajectory.at(self.flown_s(time)).attitude(),
        }
    }

    /// Where the nose truly points at `time`, rad clockwise from north in 0..2π; 0 for a flight
    /// without heading.
    pub fn yaw_at(&self, time: Time) -> f64 {
        self.path.yaw(self.flown_s(time)).rem_euclid(TAU)
    }

    /// The weather at `time`.
    pub fn weather_at(&self, time: Time) -> Weather {
        let time_s = self.flown_s(time);
        let Sky { ground_c, sky_max_k, .. } = self.scene.sky();
        let weather = Weather::at(&self.weather, time_s).unwrap_or(Weather { time_s, ground_c, sky_max_k });
        let weather = Weather { time_s, ..weather };
        surroundings::weather(&self.faults, weather, self.scene.seen(weather.ground_c))
    }

    fn flown_s(&self, time: Time) -> f64 {
        time.since(self.origin.unwrap_or_default())
    }
}

impl FrameSource for SimulatedSource {
    fn scan(&mut self, tick: Time, frame: &mut Frame) {
        self.origin.get_or_insert(tick);
        let dt_s = self.last_tick.map_or(0.0, |last| tick.since(last));
        self.last_tick = Some(tick);
        let (flown_s, weather) = (self.flown_s(tick), self.weather_at(tick));
        let orientation = Orientation::new(self.truth_at(tick), self.yaw_at(tick));
        self.beside.clear();
        self.beside.extend(surroundings::beside(&self.faults, flown_s, |time_s| self.path.yaw(time_s)));
        let mut view = self.scene.view(orientation, &weather).beside(&self.beside);
        if let Path::Trajectory(trajectory) = &self.path {
            view = view.from(trajectory.at(flown_s).place_m);
        }
        frame.aiding = match (&mut self.instruments, &self.path) {
            (Some(instruments), Path::Trajectory(trajectory)) => instruments.read(trajectory, flown_s),
            _ => Aiding::default(),
        };
        self.head.advance(&weather, dt_s);
        self.buses_down.fill(None);
        for (i, (reading, health)) in frame.readings.iter_mut().zip(&mut self.health).enumerate() {
            // A sensor that does not answer goes on looking.
            let value = self.head.sense(i, &view, dt_s);
            *reading = match Outage::at(&self.outages, i, flown_s).map_or(value, Err) {
                Ok(value) => {
                    health.counters.reads += 1;
                    Ok(Sample { value, time: tick })
                }
                Err(reason) => {
                    let counter = match reason {
                        Missing::NoAnswer => &mut health.counters.no_answer,
                        Missing::BadPec => &mut health.counters.bad_pec,
                        Missing::BusHeld => &mut health.counters.held,
                        Missing::ErrorFlag => &mut health.counters.error_flag,
                        Missing::NotReady => &mut health.counters.not_ready,
                        Missing::Saturated | Missing::Impossible => &mut health.counters.out_of_range,
                        _ => &mut health.counters.other,
                    };
                    *counter += 1;
                    if let Some(bus) = self.bus_of[i].filter(|_| reason.is_of_the_bus())
                        && let Some(down) = self.buses_down.get_mut(bus)
                    {
                        *down = Some(reason);
                    }
                    Err(reason)
                }
            };
        }
        frame.time = tick;
        let (share, chance) = &mut self.dropped;
        if *share > 0.0 && chance.uniform() <= *share {
            frame.readings.fill(Err(Missing::Empty));
            frame.aiding = Aiding::default();
        }
    }

    fn health(&self) -> &[SensorHealth] {
        &self.health
    }

    fn buses_down(&self) -> &[Option<Missing>] {
        &self.buses_down
    }
}
