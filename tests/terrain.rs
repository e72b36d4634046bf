//! The report's terrain (section V.1): a ridge beside and a far horizon, below the rim, a valley whose walls are higher
//! than half the field of view.

use irhorizon::attitude::{Attitude, Estimate, Mode};
use irhorizon::config::Settings;
use irhorizon::config::settings::{Method, SimulationSettings};
use irhorizon::direction::Direction;
use irhorizon::estimator::profile::solve::Solver;
use irhorizon::frame::{Frame, Value};
use irhorizon::head::Head;
use irhorizon::horizon::Horizon;
use irhorizon::simulation::{Flight, SimulatedSource, Waypoint};
use irhorizon::sky::{Averaging, FieldOfView, Response, Sky};
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

const METHODS: [Method; 3] = [Method::InverseSine, Method::Profile, Method::Field];
const SECONDS: u32 = 30;

/// What is said at the end of a flight at a constant attitude beside `terrain`, averaged over the last ten seconds.
#[derive(Debug, Default)]
struct Said {
    roll_deg: f64,
    pitch_deg: f64,
    /// Frames with an attitude, and those of them whose error is within twice its standard deviation.
    given: u32,
    covered: u32,
    /// A fault was active.
    faults: Vec<String>,
    /// The pairs of the last frame: nose less tail, left less right, up less down, K.
    pairs_k: [f64; 3],
}

fn fly(method: Method, terrain: &str, roll_deg: f64, pitch_deg: f64) -> Said {
    let head = Head::six();
    let mut settings = Settings::default();
    settings.estimator.method = Some(method);
    settings.head.learn_trim = false;
    let hold = [0.0, f64::from(SECONDS)].map(|time_s| Waypoint { time_s, roll_deg, pitch_deg });
    let fault = format!("{terrain}@0..{}", 2 * SECONDS);
    let mut source = SimulatedSource::new(
        &SimulationSettings::default(),
        &head,
        FieldOfView::Gaussian { fwhm_deg: settings.head.field_of_view_deg },
    )
    .with_flight(Flight::scripted(hold.to_vec()))
    .with_faults(vec![fault.parse().unwrap()]);
    let mut horizon = Horizon::new(&settings, head.clone());
    let (mut frame, mut estimate, mut said) = (Frame::new(6), Estimate::default(), Said::default());
    let truth = Attitude::from_degrees(roll_deg, pitch_deg);
    for i in 0..SECONDS * 50 {
        source.scan(Time::from_nanos(u64::from(i) * 20_000_000), &mut frame);
        horizon.update(&frame, &[], &mut estimate);
        said.faults.extend(estimate.faults.iter().map(|f| f.kind.display(&head).to_string()));
        if let (Some(a), true) = (estimate.attitude, i >= (SECONDS - 10) * 50) {
            said.given += 1;
            said.roll_deg += a.roll.to_degrees();
            said.pitch_deg += a.pitch.to_degrees();
            let within = |a: f64, b: f64, sigma: f64| (a - b).abs() <= 2.0 * sigma;
            let covered =
                within(a.roll, truth.roll, estimate.sigma.roll) && within(a.pitch, truth.pitch, estimate.sigma.pitch);
            said.covered += u32::from(covered);
        }
        assert!(estimate.mode != Mode::Faulted || estimate.attitude.is_none());
    }
    said.faults.sort();
    said.faults.dedup();
    said.roll_deg /= f64::from(said.given);
    said.pitch_deg /= f64::from(said.given);
    let c = |i: usize| match frame.readings[i].unwrap().value {
        Value::Absolute { object_c, .. } => object_c,
        Value::Volts(_) => unreachable!(),
    };
    said.pairs_k = [c(0) - c(1), c(2) - c(3), c(5) - c(4)];
    said
}

/// "Parallel to a ridge": it is at 1000 m and the other horizon is not hidden, some 150 km away. Between the two lies a
/// line 0.4° off the level, and an aircraft banked away from the ridge by that has it as its horizon.
#[test]
fn a_far_ridge_costs_less_than_half_a_degree_and_is_no_fault() {
    let line_deg = (1.0_f64 / 150.0).atan().to_degrees();
    for method in METHODS {
        for roll_deg in [0.0, -line_deg, line_deg] {
            let said = fly(method, &format!("ridge={}:right", 2.0 * line_deg), roll_deg, 0.0);
            println!("{} at {roll_deg:.2}°: {said:?}", method.as_str());
            assert!((said.roll_deg - roll_deg).abs() < line_deg + 0.05, "{}: {said:?}", method.as_str());
            assert_eq!(said.faults, [""; 0], "{}", method.as_str());
        }
    }
}

/// "Below the rim" roll is underestimated by a scheme that knows of no rim. What is said of it must not be believed
/// beyond its standard deviation.
#[test]
fn below_the_rim_the_error_is_owned_up_to() {
    for (terrain, roll_deg) in
        [("valley=25:right", 20.0), ("valley=25:right", -20.0), ("ridge=25:right", 20.0), ("ridge=25:right", -20.0)]
    {
        let said = fly(Method::Field, terrain, roll_deg, 0.0);
        println!("{terrain} at {roll_deg}°: {said:?}");
        assert!(f64::from(said.covered) >= 0.95 * f64::from(said.given), "{terrain} at {roll_deg}°: {said:?}");
        assert_ne!(said.faults, [""; 0], "{terrain} at {roll_deg}°");
    }
    let pairs_k = fly(Method::Field, "valley=25:right", 20.0, 0.0).pairs_k.map(Some);
    let Sky { shape, ground_c, sky_max_k } = Sky::NAMIBIA;
    let response = Response::new(shape, FieldOfView::Gaussian { fwhm_deg: 90.0 }, Averaging::Temperature);
    let solver =
        Solver::new(&[Direction::NOSE, Direction::LEFT, Direction::UP], response.pair_curve(ground_c, sky_max_k));
    let up = solver.unwrap().solve(&pairs_k).unwrap().vertical;
    let roll_deg = up[1].atan2(up[2]).to_degrees();
    assert!(roll_deg.abs() < 19.0, "the report's underestimate is in this valley: {roll_deg} from {pairs_k:?}");
}

/// "Walls rising at an angle greater than half the field of view": level there is no roll indication, and what scales
/// pitch shrinks. Nothing is said then, or the error is owned up to.
#[test]
fn in_a_deep_valley_nothing_is_believed() {
    let open = fly(Method::InverseSine, "ridge=0:right", 0.0, 10.0);
    for (roll_deg, pitch_deg) in [(0.0, 0.0), (15.0, 0.0), (-15.0, 0.0), (0.0, 10.0)] {
        let said = fly(Method::Field, "valley=60:right", roll_deg, pitch_deg);
        println!("{roll_deg}°, {pitch_deg}°: {said:?}");
        assert_eq!(said.covered, said.given, "{roll_deg}°, {pitch_deg}°: {said:?}");
        assert_ne!(said.faults, [""; 0], "{roll_deg}°, {pitch_deg}°");
        let [_, across_k, vertical_k] = said.pairs_k;
        assert!(vertical_k < 0.7 * open.pairs_k[2], "the range shrinks: {said:?}, in the open {open:?}");
        assert!(across_k.abs() < 0.25 * vertical_k, "next to no roll indication: {said:?}");
    }
}
