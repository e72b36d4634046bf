//! Faults on purpose: what each does, and that chance is the seed's.

mod calm;

use calm::CALM;
use irhorizon::config::settings::SimulationSettings;
use irhorizon::direction::Direction;
use irhorizon::frame::{Frame, Missing, Value};
use irhorizon::head::{Head, Sensor, SensorKind};
use irhorizon::simulation::{Fault, Flight, Scenario, SimulatedSource, Waypoint};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;

const FIELD: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };
const NOSE: usize = 0;
const LEFT: usize = 2;
const RIGHT: usize = 3;
const UP: usize = 4;
const DOWN: usize = 5;

fn faults(texts: &[&str]) -> Vec<Fault> {
    texts.iter().map(|t| t.parse().unwrap_or_else(|e| panic!("{t}: {e}"))).collect()
}

/// `seconds` at 50 Hz.
fn fly(source: &mut SimulatedSource, sensors: usize, seconds: f64) -> Vec<Frame> {
    let mut frame = Frame::new(sensors);
    let count = (seconds * 50.0).round() as u64;
    let scan = |i| {
        source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
        frame.clone()
    };
    (0..count).map(scan).collect()
}

/// Six sensors through a flight that rolls from side to side.
fn six(settings: &SimulationSettings, texts: &[&str], seconds: f64) -> Vec<Frame> {
    let rolling = (0..100).map(|i| Waypoint {
        time_s: f64::from(i) * 3.0,
        roll_deg: if i % 2 == 0 { -30.0 } else { 30.0 },
        pitch_deg: 0.0,
    });
    let mut source = SimulatedSource::new(settings, &Head::six(), FIELD)
        .with_flight(Flight::scripted(rolling.collect()))
        .with_faults(faults(texts));
    fly(&mut source, 6, seconds)
}

fn level(texts: &[&str], seconds: f64) -> Vec<Frame> {
    let mut source = SimulatedSource::new(&CALM, &Head::six(), FIELD)
        .with_flight(Flight::steady(0.0, 0.0))
        .with_faults(faults(texts));
    fly(&mut source, 6, seconds)
}

fn pairs(texts: &[&str], settings: &SimulationSettings, seconds: f64) -> Vec<Frame> {
    let head = Scenario::named("clear-dry").unwrap().differential().head();
    let mut source =
        SimulatedSource::new(settings, &head, FIELD).with_flight(Flight::steady(0.0, 20.0)).with_faults(faults(texts));
    fly(&mut source, 3, seconds)
}

fn object_c(frame: &Frame, sensor: usize) -> f64 {
    match frame.readings[sensor].expect("a reading").value {
        Value::Absolute { object_c, .. } => object_c,
        Value::Volts(v) => v,
    }
}

fn ambient_c(frame: &Frame, sensor: usize) -> f64 {
    match frame.readings[sensor].expect("a reading").value {
        Value::Absolute { ambient_c, .. } => ambient_c.expect("a die"),
        Value::Volts(_) => f64::NAN,
    }
}

fn at(frames: &[Frame], time_s: f64) -> &Frame {
    &frames[(time_s * 50.0).round() as usize]
}

#[test]
fn off_and_intermittent_leave_readings_out() {
    let frames = six(&CALM, &["off:nose@1..2", "intermittent=30:left@2..62"], 70.0);
    for (i, frame) in frames.iter().enumerate() {
        let off = (50..100).contains(&i);
        assert_eq!(frame.readings[NOSE].is_err(), off, "scan {i}");
        assert!(!off || frame.readings[NOSE] == Err(Missing::NoAnswer));
        assert!(frame.readings[LEFT].is_ok() || (100..3100).contains(&i));
        assert!([1, RIGHT, UP, DOWN].iter().all(|s| frame.readings[*s].is_ok()));
    }
    let missing = frames.iter().filter(|f| f.readings[LEFT].is_err()).count() as f64;
    // 3000 draws of 30 %: a standard deviation of 25.
    assert!((missing - 900.0).abs() < 100.0, "{missing}");
    let runs = frames.windows(2).filter(|w| w[0].readings[LEFT].is_err() && w[1].readings[LEFT].is_err()).count();
    assert!((runs as f64 - 270.0).abs() < 80.0, "no memory from one to the next: {runs}");
}

#[test]
fn stuck_repeats_with_fresh_stamps_and_delayed_tells_the_past_as_new() {
    let noisy = SimulationSettings { noise_c: 0.1, ..CALM };
    let plain = six(&noisy, &[], 6.0);
    let hurt = six(&noisy, &["stuck:left@1..3", "delayed=0.5:right@2..4", "delayed=5:up@1..2"], 6.0);
    for (i, (a, b)) in plain.iter().zip(&hurt).enumerate() {
        let told = b.readings[LEFT].unwrap();
        let expected = if (50..150).contains(&i) { 50 } else { i };
        assert_eq!(told.value, plain[expected].readings[LEFT].unwrap().value, "scan {i}");
        assert_eq!(told.time, a.time);
        let old = if (100..200).contains(&i) { i - 25 } else { i };
        assert_eq!(b.readings[RIGHT].unwrap().value, plain[old].readings[RIGHT].unwrap().value, "scan {i}");
        assert_eq!(b.readings[RIGHT].unwrap().time, a.time);
        // Before it began there is nothing: the first reading.
        let first = if (50..100).contains(&i) { 0 } else { i };
        assert_eq!(b.readings[UP].unwrap().value, plain[first].readings[UP].unwrap().value, "scan {i}");
        assert_eq!(b.readings[NOSE], a.readings[NOSE]);
    }
}

#[test]
fn garbage_is_anything_in_the_range_and_wrong_is_off_by_what_was_said() {
    let frames = six(&CALM, &["garbage:nose@0..", "wrong:left@1..2", "wrong=-2.5:right@1.."], 60.0);
    let plain = six(&CALM, &[], 60.0);
    let said: Vec<f64> = frames.iter().map(|f| object_c(f, NOSE)).collect();
    let mean = said.iter().sum::<f64>() / said.len() as f64;
    assert!(said.iter().all(|c| (-70.0..=380.0).contains(c)) && (mean - 155.0).abs() < 12.0, "{mean}");
    assert!(said.iter().any(|c| *c < -50.0) && said.iter().any(|c| *c > 360.0));
    assert!(said.iter().all(|c| (((c + 273.15) / 0.02).round() - (c + 273.15) / 0.02).abs() < 1e-6));
    for (i, (a, b)) in plain.iter().zip(&frames).enumerate() {
        let [left, right] = [LEFT, RIGHT].map(|s| object_c(b, s) - object_c(a, s));
        let expected = [if (50..100).contains(&i) { 8.0 } else { 0.0 }, if i >= 50 { -2.5 } else { 0.0 }];
        assert!((left - expected[0]).abs() < 0.021 && (right - expected[1]).abs() < 0.021, "scan {i}: {left} {right}");
    }
    let volts = pairs(&["garbage:lat@0..", "wrong=4:long@1.."], &CALM, 20.0);
    assert!(volts.iter().all(|f| object_c(f, 1).abs() < 2.048));
    assert!(volts.iter().any(|f| object_c(f, 1) > 1.9) && volts.iter().any(|f| object_c(f, 1) < -1.9));
    // 40 K for a volt.
    assert!((object_c(at(&volts, 5.0), 0) - object_c(at(&volts, 0.5), 0) - 0.1).abs() < 1e-3);
}

#[test]
fn slow_is_one_more_lag_that_begins_at_rest() {
    let tau = 0.8;
    let plain = six(&CALM, &[], 8.0);
    let slow = six(&CALM, &["slow=0.8:left@1..6"], 8.0);
    let mut expected = object_c(&plain[50], LEFT);
    for i in 50..300 {
        // The middle of the step for an input that changes in it.
        let input = 0.5 * (object_c(&plain[i], LEFT) + object_c(&plain[i - usize::from(i > 50)], LEFT));
        if i > 50 {
            expected += (input - expected) * (1.0 - (-0.02_f64 / tau).exp());
        }
        let got = object_c(&slow[i], LEFT);
        assert!((got - expected).abs() < 0.04, "scan {i}: {got} {expected}");
    }
    assert_eq!(plain[320].readings, slow[320].readings);
}

#[test]
fn a_wet_sensor_shows_its_own_temperature_through_the_film_as_it_comes_and_dries() {
    let (plain, wet) = (level(&[], 20.0), level(&["wet:up@5..10", "wet=50:nose@5..10"], 20.0));
    for (time_s, share) in [(4.9, 0.0), (6.5, 0.5), (8.0, 1.0), (9.98, 1.0), (11.5, 0.5), (13.0, 0.0), (19.0, 0.0)] {
        for (sensor, film) in [(UP, 0.92 * share), (NOSE, 0.5 * share)] {
            let dry = object_c(at(&plain, time_s), sensor);
            let expected = film * ambient_c(at(&plain, time_s), sensor) + (1.0 - film) * dry;
            let got = object_c(at(&wet, time_s), sensor);
            assert!((got - expected).abs() < 0.05, "{sensor} at {time_s} s: {got}, not {expected}");
        }
    }
    // Before the lag: a film that is there at once comes through it.
    let lagging = SimulationSettings { lag_s: 1.0, ..CALM };
    let (dry, wet) = (pairs(&[], &lagging, 20.0), pairs(&["wet:long@2..12"], &lagging, 20.0));
    let share = |time_s: f64| 1.0 - object_c(at(&wet, time_s), 0) / object_c(at(&dry, time_s), 0);
    // A ramp of 0.92 in 3 s through a lag of 1 s: behind it by 1 − e^(−t).
    let ramp = 0.92 / 3.0;
    assert!((share(4.0) - ramp * (2.0 - (1.0 - (-2.0_f64).exp()))).abs() < 0.003, "{}", share(4.0));
    assert!((share(11.9) - 0.92).abs() < 0.003);
    assert!(share(19.0).abs() < 0.03);
}

#[test]
fn hail_fog_and_rain_change_the_contrast_in_their_time() {
    let head = Head::six();
    let contrast = |frames: &[Frame], time_s: f64| head.signal_k(2, at(frames, time_s)).unwrap();
    let plain = level(&[], 1.0);
    let clear = contrast(&plain, 0.5);
    let hail = level(&["hail=3@5..15"], 30.0);
    for (time_s, expected) in [
        (4.0, clear),
        (6.0, 0.5 * (clear - 3.0)),
        (7.0, -3.0),
        (15.0, -3.0),
        (16.0, 0.5 * (clear - 3.0)),
        (17.0, clear),
    ] {
        let frame = at(&hail, time_s);
        assert!((contrast(&hail, time_s) - expected).abs() < 0.06, "{time_s} s: {}", contrast(&hail, time_s));
        assert!((object_c(frame, UP) - object_c(&plain[0], UP)).abs() < 0.03, "the sky stays as it was");
    }
    assert!(object_c(at(&hail, 10.0), DOWN) < -20.0);
    let fog = level(&["fog@5..15"], 30.0);
    for (time_s, expected) in [(6.0, 0.5 * (clear + 0.3)), (10.0, 0.3), (16.0, 0.5 * (clear + 0.3)), (18.0, clear)] {
        assert!((contrast(&fog, time_s) - expected).abs() < 0.06, "{time_s} s");
        assert!(
            (object_c(at(&fog, time_s), DOWN) - object_c(&plain[0], DOWN)).abs() < 0.2,
            "the ground stays as it was"
        );
    }
    let rain = level(&["rain@5..205"], 220.0);
    assert!((contrast(&rain, 4.0) - clear).abs() < 0.03 && (contrast(&rain, 210.0) - clear).abs() < 0.03);
    let falling = &rain[8 * 50..205 * 50];
    let mean = |f: &dyn Fn(&Frame) -> f64| falling.iter().map(f).sum::<f64>() / falling.len() as f64;
    let middle: Vec<f64> = (0..6).map(|s| mean(&|f| object_c(f, s))).collect();
    assert!((middle[DOWN] - middle[UP] - 0.6 * clear).abs() < 0.3, "{middle:?}");
    let of = |a: usize, b: usize, gap: usize| {
        let products =
            falling.windows(gap + 1).map(|w| (object_c(&w[0], a) - middle[a]) * (object_c(&w[gap], b) - middle[b]));
        products.sum::<f64>() / (falling.len() - gap) as f64
    };
    let rms = (0..6).map(|s| of(s, s, 0).sqrt()).sum::<f64>() / 6.0;
    let follow = (0..6).map(|s| of(s, s, 50) / of(s, s, 0)).sum::<f64>() / 6.0;
    assert!((rms - 0.5).abs() < 0.06, "{rms}");
    assert!((follow - (-1.0_f64).exp()).abs() < 0.12, "{follow}");
    assert!((of(0, 2, 0) / 0.25).abs() < 0.35, "each has its own drops");
}

/// Narrow sensors at (azimuth, elevation), °, in level flight to the north.
fn looking(at: &[(f64, f64)], texts: &[&str]) -> Vec<f64> {
    let sensor = |(azimuth_deg, elevation_deg): &(f64, f64)| Sensor {
        name: "s".into(),
        direction: Direction::from_angles(*azimuth_deg, *elevation_deg).unwrap(),
        kind: SensorKind::ABSOLUTE,
        bus: None,
    };
    let head = Head::new(at.iter().map(sensor).collect(), vec![]);
    let mut source = SimulatedSource::new(&CALM, &head, FieldOfView::Gaussian { fwhm_deg: 5.0 })
        .with_flight(Flight::steady(0.0, 0.0))
        .with_faults(faults(texts));
    let frames = fly(&mut source, at.len(), 8.0);
    (0..at.len()).map(|i| object_c(&frames[399], i)).collect()
}

#[test]
fn ridge_valley_and_cloud_stand_where_they_are_put_along_their_straight_outline() {
    for height_deg in [10.0, 25.0, 60.0_f64] {
        let outline = |off_deg: f64| (height_deg.to_radians().tan() * off_deg.to_radians().cos()).atan().to_degrees();
        let offs = [0.0, -40.0, 70.0];
        let below: Vec<_> = offs.map(|o| (90.0 + o, outline(o) - 13.0)).into();
        let above: Vec<_> = offs.map(|o| (90.0 + o, outline(o) + 13.0)).into();
        let behind: Vec<_> = offs.map(|o| (270.0 - o, outline(o) - 3.0)).into();
        let clear = |at: &[(f64, f64)]| looking(at, &[]);
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.3);
        for side in ["90", "right"] {
            let ridge = &[&*format!("ridge={height_deg}:{side}@1..")];
            let warm = looking(&below, ridge);
            assert!(warm.iter().all(|c| (c - 16.0).abs() < 0.3), "{height_deg}: {warm:?}");
            assert!(near(&looking(&above, ridge), &clear(&above)) && near(&looking(&behind, ridge), &clear(&behind)));
        }
        let valley = &[&*format!("valley={height_deg}:left@1..")];
        let both: Vec<_> = below.iter().map(|(a, e)| (a + 180.0, *e)).chain(below.clone()).collect();
        assert!(looking(&both, valley).iter().all(|c| (c - 16.0).abs() < 0.3));
        assert!(near(&looking(&above, valley), &clear(&above)));
    }
    // The ground is at 16 °C, a cloud's underside 8 K below it; its edge is soft.
    let bank = &["cloud=40:270@1.."];
    let seen = looking(&[(270.0, 25.0), (270.0, 55.0), (90.0, 25.0)], bank);
    let clear = looking(&[(270.0, 25.0), (270.0, 55.0), (90.0, 25.0)], &[]);
    assert!((seen[0] - 8.0).abs() < 0.1 && clear[0] < -4.0, "{seen:?} {clear:?}");
    assert!((seen[1] - clear[1]).abs() < 0.1 && (seen[2] - clear[2]).abs() < 0.1);
}

/// What a sensor of a 90° bell sees, °C, of a world of so many °C at north, east and up: the mean over
/// its field, whose axis has this azimuth and elevation, °.
fn mean_c(azimuth_deg: f64, elevation_deg: f64, world_c: impl Fn([f64; 3]) -> f64) -> f64 {
    let ((sa, ca), (se, ce)) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin_cos());
    let (axis, above, beside) = ([ce * ca, ce * sa, se], [-se * ca, -se * sa, ce], [-sa, ca, 0.0]);
    let (mut sum, mut whole) = (0.0, 0.0);
    for off_deg in (0..180).map(|i| 0.5 * f64::from(i) + 0.25) {
        let (sin, cos) = off_deg.to_radians().sin_cos();
        let weight = sin * 0.5_f64.powf((off_deg / 45.0).powi(2));
        for around_deg in 0..360 {
            let (up, side) = f64::from(around_deg).to_radians().sin_cos();
            let to = std::array::from_fn(|i| cos * axis[i] + sin * (up * above[i] + side * beside[i]));
            sum += weight * world_c(to);
            whole += weight;
        }
    }
    sum / whole
}

#[test]
fn a_whole_field_sees_as_much_of_a_ridge_a_valley_and_a_cloud_as_they_cover() {
    // The report's Namibian night: 16 °C, and a sky colder by 40 K (1 − exp(−5.5 E/90)).
    let sky_c = |up: f64| 16.0 - 40.0 * (1.0 - (-5.5 * up.max(0.0).asin().to_degrees() / 90.0).exp());
    let (sin, cos) = 300.0_f64.to_radians().sin_cos();
    let toward = |[north, east, up]: [f64; 3]| up.atan2(north * cos + east * sin).to_degrees();
    let ridge_c =
        |height_deg: f64, to: [f64; 3]| if to[2] <= 0.0 || toward(to) < height_deg { 16.0 } else { sky_c(to[2]) };
    let valley_c = |to: [f64; 3]| ridge_c(35.0, to).max(ridge_c(35.0, [-to[0], -to[1], to[2]]));
    let cloud_c = |to: [f64; 3]| {
        // Full 5° below the edge, nothing 5° above, and not a straight line between.
        let x = ((45.0 - toward(to)) / 10.0).clamp(0.0, 1.0);
        let cover = if toward(to).abs() < 90.0 { x * x * (3.0 - 2.0 * x) } else { 0.0 };
        sky_c(to[2]) + cover * (8.0 - sky_c(to[2])).max(0.0)
    };
    type World<'a> = &'a dyn Fn([f64; 3]) -> f64;
    let worlds: [(&str, World<'_>); 4] = [
        ("ridge:300@1..", &|to| ridge_c(25.0, to)),
        ("ridge=60:300@1..", &|to| ridge_c(60.0, to)),
        ("valley:300@1..", &valley_c),
        ("cloud:300@1..", &cloud_c),
    ];
    for (text, world_c) in worlds {
        let frames = level(&[text], 8.0);
        let looks = [(0.0, 0.0), (180.0, 0.0), (270.0, 0.0), (90.0, 0.0), (0.0, 90.0), (0.0, -90.0)];
        for (i, (azimuth_deg, elevation_deg)) in looks.into_iter().enumerate() {
            let (got, expected) = (object_c(&frames[399], i), mean_c(azimuth_deg, elevation_deg, world_c));
            assert!((got - expected).abs() < 0.25, "{text}: sensor {i} shows {got}, not {expected}");
        }
    }
}

#[test]
fn a_ridge_grows_beside_the_heading_of_its_beginning_and_goes() {
    let scenario = Scenario::named("clear-dry").unwrap().lasting(40.0).scripted(1);
    let run = |texts: &[&str]| {
        let mut source = scenario.source(3).with_faults(faults(texts));
        let frames = fly(&mut source, 6, 40.0);
        (source.yaw_at(Time::from_secs_f64(2.0)).to_degrees(), frames)
    };
    let (yaw_deg, left) = run(&["ridge=40:left@2..5"]);
    let (_, north) = run(&[&format!("ridge=40:{}@2..5", (yaw_deg - 90.0).rem_euclid(360.0))]);
    let (_, plain) = run(&[]);
    let warmer = |time_s: f64, sensor| object_c(at(&left, time_s), sensor) - object_c(at(&plain, time_s), sensor);
    assert!(north.iter().zip(&left).all(|(a, b)| (0..6).all(|s| (object_c(a, s) - object_c(b, s)).abs() < 0.021)));
    let grown = [2.0, 3.0, 4.0, 5.2].map(|t| warmer(t, LEFT));
    assert!(grown.is_sorted() && grown[0] == 0.0 && grown[3] > 4.0, "{grown:?}");
    assert!(warmer(5.0, RIGHT).abs() < 0.5 && warmer(5.0, LEFT) > 3.0 * warmer(5.0, NOSE));
    assert!(plain.iter().zip(&left).skip(420).all(|(a, b)| a == b), "gone");
}

const ALL: [&str; 14] = [
    "off:nose@1..2",
    "stuck:tail@1..2",
    "garbage:left@1..2",
    "wrong:right@1..2",
    "slow:up@1..2",
    "delayed:down@1..2",
    "intermittent:nose@2..3",
    "wet:tail@1..2",
    "hail@6..7",
    "fog@1..2",
    "rain@1..3",
    "ridge:20@1..2",
    "valley:left@2..3",
    "cloud:100@3..4",
];

#[test]
fn the_same_seed_gives_the_same_bytes_and_one_fault_changes_no_other() {
    let bytes = |seed| format!("{:?}", six(&SimulationSettings { noise_c: 0.1, lag_s: 0.1, seed, ..CALM }, &ALL, 10.0));
    assert_eq!(bytes(1), bytes(1));
    assert_ne!(bytes(1), bytes(2));
    let alone = six(&CALM, &["intermittent:nose@1..5"], 6.0);
    let with = six(&CALM, &["garbage:left@1..5", "intermittent:tail@1..5", "intermittent:nose@1..5"], 6.0);
    assert!(alone.iter().zip(&with).all(|(a, b)| a.readings[NOSE] == b.readings[NOSE]));
    assert!(with.iter().any(|f| f.readings[NOSE].is_err() != f.readings[1].is_err()), "each its own chance");
    // Ends and beginnings that never come, and sensors that are not there, change nothing.
    assert_eq!(
        six(&CALM, &["off:lat@1..", "hail@100..", "wet:all@9..10", "wrong:all@7..8"], 6.0),
        six(&CALM, &[], 6.0)
    );
}
