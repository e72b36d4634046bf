//! The schemes that benchmarks compare with are the published ones: their formulas in tables, and
//! their errors on a real flight as another program reckoned them.

#[path = "../benches/baselines/replayed.rs"]
mod replayed;
#[path = "../benches/baselines/schemes/mod.rs"]
mod schemes;

use irhorizon::attitude::{Attitude, Estimate};
use irhorizon::config;
use irhorizon::ctl::replay::replay;
use irhorizon::frame::Frame;
use irhorizon::head::Head;
use irhorizon::recording::Recording;
use schemes::{ArduPilot, Baseline, FullVector, Paparazzi, Report, Uavx};
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;

/// Seconds, the signals x, y, z, and the roll and pitch that the formula gives for them.
type Row = (f64, [f64; 3], Option<(f64, f64)>);

fn check(baseline: &mut dyn Baseline, rows: &[Row]) {
    for (time_s, signals, expected) in rows {
        let given = baseline.update(*time_s, *signals);
        let close = match (given, expected) {
            (Some(g), Some(e)) => (g.0 - e.0).abs() < 0.005 && (g.1 - e.1).abs() < 0.005,
            (g, e) => g.is_none() && e.is_none(),
        };
        assert!(close, "{time_s} s, {signals:?}: {given:?}, not {expected:?}");
    }
}

#[test]
fn report() {
    let rows = [
        (0.0, [0.0; 3], None),
        // Time that goes back or stands still leaves the range as it is.
        (0.0, [1.0, 2.0, 30.0], None),
    ];
    check(&mut Report::default(), &rows);
    let rows = [
        (1.0, [0.0, 10.0, 20.0], Some((30.0, 0.0))),
        // After 3 s, 1 − 1/e of the way from 20 K to 40 K: 32.642 K; asin(10/32.642), asin(−20/32.642).
        (4.0, [-20.0, 10.0, 40.0], Some((17.839, -37.785))),
        // The vertical pair's sign is not asked for: after 6 s more, 39.004 K.
        (10.0, [0.0, 10.0, -40.0], Some((14.856, 0.0))),
        (10.0, [99.0, -99.0, 40.0], Some((-45.0, 90.0))),
    ];
    check(&mut Report::default(), &rows);
}

#[test]
fn paparazzi() {
    let rows = [
        (0.0, [0.0; 3], None),
        (0.0, [10.0, 10.0, 10.0], Some((45.0, 45.0))),
        (0.0, [-17.320_508, 17.320_508, 10.0], Some((60.0, -60.0))),
        (0.0, [10.0, 0.0, 0.0], Some((0.0, 90.0))),
        // On its back, 135° and −150° of pitch are −45° and 30°.
        (0.0, [10.0, -10.0, -10.0], Some((-135.0, -45.0))),
        (0.0, [-10.0, 0.0, -17.320_508], Some((180.0, 30.0))),
    ];
    check(&mut Paparazzi, &rows);
}

#[test]
fn full_vector() {
    let rows = [
        (0.0, [0.0; 3], None),
        // Roll 30°, pitch 20° and roll −150°, pitch −20°, at 30 K.
        (0.0, [10.260_6, 14.095_4, 24.414_0], Some((30.0, 20.0))),
        (0.0, [-10.260_6, -14.095_4, -24.414_0], Some((-150.0, -20.0))),
        (0.0, [0.1, 0.0, 0.0], Some((0.0, 90.0))),
    ];
    check(&mut FullVector, &rows);
}

#[test]
fn uavx() {
    let mut uavx = Uavx::default();
    // 1e-5 of 100 K for each of three axes: 3 mK a sample.
    check(
        &mut uavx,
        &[
            (0.0, [0.0; 3], None),
            (0.0, [0.0, 10.0, 20.003], Some((30.0, 0.0))),
            (0.0, [20.0, -10.0, 1.0], Some((-30.005, 90.0))),
        ],
    );
    for _ in 0..3331 {
        assert!(uavx.update(0.0, [0.0; 3]).is_some());
    }
    // With this sample the 20 K have become 10.001 K.
    check(&mut uavx, &[(0.0, [0.0, 5.000_5, 0.0], Some((30.0, 0.0))), (0.0, [0.0, -40.0, 0.0], Some((-90.0, 0.0)))]);
}

#[test]
fn ardupilot() {
    let rows = [
        (0.0, [0.0; 3], None),
        // A tenth of 250 K is 25 K; 0.88 of it 22 K.
        (0.0, [-11.0, 0.0, 250.0], Some((0.0, -45.0))),
        // 0.1·0 + 0.9·25 = 22.5 K; then 20.25 K; the roll of 20.2° stops it there, and so does −60°.
        (0.0, [0.0, 3.0, 0.0], Some((13.636, 0.0))),
        (0.0, [0.0, 4.0, 0.0], Some((20.202, 0.0))),
        (0.0, [0.0, -99.0, -99.0], Some((-60.0, 0.0))),
        (0.0, [17.82, 0.0, 50.0], Some((0.0, 60.0))),
        // Level again, but by a sample too late: 0.1·50 + 0.9·20.25 = 23.225 K.
        (0.0, [0.0, 2.0, 50.0], Some((8.807, 0.0))),
    ];
    check(&mut ArduPilot::default(), &rows);
}

#[test]
fn whatever_comes_what_goes_out_is_finite_and_in_range() {
    let values = [0.0, -0.0, 1e-300, -1.0, 35.0, -1e6, 1e300, f64::MAX, f64::MIN_POSITIVE];
    for (name, mut baseline) in schemes::named() {
        for i in 0..values.len().pow(3) {
            let signals = [i, i / values.len(), i / values.len().pow(2)].map(|n| values[n % values.len()]);
            if let Some((roll, pitch)) = baseline.update((i % 7) as f64, signals) {
                assert!((-180.0..=180.0).contains(&roll), "{name}: roll {roll} from {signals:?}");
                assert!((-90.0..=90.0).contains(&pitch), "{name}: pitch {pitch} from {signals:?}");
            }
        }
    }
}

/// Every frame gets its line, and every line its angles.
#[test]
fn a_replay_gives_each_frame_its_attitude() {
    let mut recording = String::from("time_s,nose_obj_c,tail_obj_c,left_obj_c,right_obj_c,up_obj_c,down_obj_c\n");
    for i in 0..50 {
        let _ = writeln!(recording, "{:.2},1,0,5,-4,-20,15", f64::from(i) * 0.02);
    }
    let head = Head::six();
    for (name, mut baseline) in schemes::named() {
        let mut reader =
            Recording::new(Cursor::new(&recording), "level".into()).unwrap().frames(Some(head.clone())).unwrap();
        let trim = Attitude::from_degrees(1.0, 0.0);
        let mut update = |frame: &Frame, estimate: &mut Estimate| {
            *estimate = replayed::estimate(baseline.as_mut(), &head, frame, trim);
        };
        let mut out = Vec::new();
        replay(&mut reader, false, &mut update, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let rolls: Vec<f64> = text.lines().skip(1).filter_map(|l| l.split(',').nth(1)?.parse().ok()).collect();
        assert_eq!(rolls.len(), 50, "{name}: {text}");
        if name == "full-vector" {
            // The left side is the warmer: it is down.
            assert!((rolls[0] - ((-9.0_f64).atan2(35.0).to_degrees() - 1.0)).abs() < 1e-3, "{}", rolls[0]);
        }
    }
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// The report's and the full vector's errors were reckoned by another program.
#[test]
fn a_real_flight() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/flights/flight-b.csv");
    if !path.exists() {
        eprintln!("SKIPPED: there is no recording at {}", path.display());
        return;
    }
    let head = config::parse(&[("head.toml".into(), include_str!("heads/diagonal.toml").into())]);
    let head = head.unwrap().settings.head();
    for (name, mut baseline) in schemes::named() {
        let mut reader = Recording::open(&path).unwrap().frames(Some(head.clone())).unwrap();
        let mut frame = Frame::new(3);
        let (mut roll, mut pitch) = (Vec::new(), Vec::new());
        while reader.next_frame(&mut frame).unwrap() {
            let angles = schemes::update(baseline.as_mut(), &head, &frame);
            let flying = frame.aiding.ground_speed_m_s.is_some_and(|v| v > 8.0);
            let reference = reader.reference();
            if let (Some(a), true, Some(r), Some(p)) = (angles, flying, reference.roll_deg, reference.pitch_deg) {
                roll.push(a.0 - r);
                pitch.push(a.1 - p);
            }
        }
        let bias = pitch.iter().sum::<f64>() / pitch.len() as f64;
        let (r, p) = (rms(&roll), rms(&pitch));
        println!("{name}: {} frames in flight, roll rms {r:.2}°, pitch rms {p:.2}°, bias {bias:.2}°", roll.len());
        assert!(roll.len() > 400);
        let expected = match name {
            "report" => Some((8.8, 13.5)),
            "full-vector" => Some((7.4, 11.6)),
            _ => None,
        };
        if let Some((roll_rms, pitch_rms)) = expected {
            assert!((r - roll_rms).abs() < 0.1 && (p - pitch_rms).abs() < 0.1, "{name}: {r} {p}");
        }
        if name == "full-vector" {
            assert!((bias - 8.6).abs() < 0.1, "{bias}");
        }
    }
}
