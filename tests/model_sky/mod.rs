//! Skies that are the same all around, seen without noise by heads of any shape; and flights under them.

use irhorizon::attitude::Attitude;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::estimator::{Estimator, Solution};
use irhorizon::frame::{Frame, Sample, Value};
use irhorizon::head::Head;
use irhorizon::simulation::{Flight, SimulatedSource};
use irhorizon::sky::{Averaging, FieldOfView, Response, Shape};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use std::sync::LazyLock;

/// Between two frames, ns: 50 Hz.
pub const TICK_NS: u64 = 20_000_000;
const GROUND_C: f64 = 14.0;

/// The shapes: the report's exponentials and grey atmospheres from dry to overcast.
static RESPONSES: LazyLock<[Response; SHAPES]> = LazyLock::new(|| {
    let [a, b, c] = [2.0, 5.5, 12.0].map(|k| Shape::Exponential { k });
    let [d, e, f, g] = [0.1, 0.3, 1.5, 3.0].map(|depth| Shape::Grey { depth });
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    [a, b, c, d, e, f, g].map(|shape| Response::new(shape, field, Averaging::Temperature))
});

/// How many shapes there are.
pub const SHAPES: usize = 7;

/// A sky of one of the shapes, under which a vertical pair shows so many kelvin.
#[derive(Clone, Copy, Debug)]
pub struct ModelSky {
    /// Which of the shapes.
    pub shape: usize,
    /// A vertical pair's signal, K.
    pub contrast_k: f64,
}

/// The report's shape at its contrast.
pub const CLEAR: ModelSky = ModelSky { shape: 1, contrast_k: 35.0 };

impl ModelSky {
    /// What `head` shows at rest at `attitude`, in a frame stamped `ns`.
    pub fn frame(self, head: &Head, attitude: Attitude, ns: u64) -> Frame {
        let response = &RESPONSES[self.shape];
        let sky_max_k = self.contrast_k / response.pair_k(1.0, GROUND_C, 1.0);
        let time = Time::from_nanos(ns);
        let mut frame = Frame::new(head.sensors.len());
        frame.time = time;
        for (reading, sensor) in frame.readings.iter_mut().zip(&head.sensors) {
            let sine = sensor.direction.dot(attitude.vertical());
            let object_c = response.sensor_c(sine, GROUND_C, sky_max_k);
            *reading = Ok(Sample { value: Value::Absolute { object_c, ambient_c: None }, time });
        }
        frame
    }

    /// What `estimator` says after `seconds` at `attitude` from `begin_ns` on.
    pub fn rest(
        self,
        estimator: &mut dyn Estimator,
        head: &Head,
        attitude: Attitude,
        begin_ns: u64,
        seconds: u64,
    ) -> Solution {
        let frames = (0..seconds * 50).map(|i| self.frame(head, attitude, begin_ns + i * TICK_NS));
        frames.map(|f| estimator.update(&f)).last().unwrap_or_default()
    }
}

/// The first `seconds` of a flight under the report's Namibian sky, with noise and lag, and its truth.
pub fn fly(flight: Flight, seconds: u64) -> Vec<(Frame, Attitude)> {
    let head = Head::six();
    let field = FieldOfView::Gaussian { fwhm_deg: 90.0 };
    let mut source = SimulatedSource::new(&SimulationSettings::default(), &head, field).with_flight(flight);
    let mut frame = Frame::new(head.sensors.len());
    let scan = |i| {
        let tick = Time::from_nanos(i * TICK_NS);
        source.scan(tick, &mut frame);
        (frame.clone(), source.truth_at(tick))
    };
    (0..seconds * 50).map(scan).collect()
}

/// The angle between the verticals of `solution` and `truth`, °; NaN without an attitude.
pub fn off_deg(solution: &Solution, truth: Attitude) -> f64 {
    let Some(said) = solution.attitude else { return f64::NAN };
    let (a, b) = (said.vertical(), truth.vertical());
    let chord = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    2.0 * (chord / 2.0).min(1.0).asin().to_degrees()
}
