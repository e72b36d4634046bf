//! Scenes that differ all around, against integrals taken here.

use irhorizon::attitude::Attitude;
use irhorizon::direction::Direction;
use irhorizon::simulation::Weather;
use irhorizon::simulation::feature::{Cloud, Clouds, Ridge, Round, WarmSide};
use irhorizon::simulation::ground::Patchwork;
use irhorizon::simulation::orientation::Orientation;
use irhorizon::simulation::scene::Scene;
use irhorizon::sky::{Averaging, FieldOfView, Response, Shape, Sky};

const FIELD: FieldOfView = FieldOfView::Gaussian { fwhm_deg: 90.0 };
const SKY: Sky = Sky { ground_c: 15.0, sky_max_k: 40.0, shape: Shape::Grey { depth: 0.3 } };
const WEATHER: Weather = Weather { time_s: 0.0, ground_c: 15.0, sky_max_k: 40.0 };
const WARM: WarmSide = WarmSide { azimuth_deg: 90.0, amplitude_k: 5.0, round: Round::Cosine, sky: true, ground: true };

fn scene() -> Scene {
    Scene::new(SKY, FIELD, Averaging::Temperature)
}

/// What the sensor in `direction` sees at roll, pitch and yaw in degrees.
fn seen(scene: &Scene, direction: Direction, [roll, pitch, yaw]: [f64; 3]) -> f64 {
    let orientation = Orientation::new(Attitude::from_degrees(roll, pitch), yaw.to_radians());
    scene.view(orientation, &WEATHER).sensor_c(direction)
}

/// The mean of a temperature by azimuth and elevation, °, over a bell of 90° about a level axis to
/// `axis_deg`: by squares of 1° over the sphere.
fn mean(axis_deg: f64, temperature_c: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut sum, mut shares) = (0.0, 0.0);
    for elevation in (-90..90).map(|e| f64::from(e) + 0.5) {
        for azimuth in (0..360).map(|a| f64::from(a) + 0.5) {
            let cos = elevation.to_radians().cos();
            let off = (cos * (azimuth - axis_deg).to_radians().cos()).clamp(-1.0, 1.0).acos().to_degrees();
            if off < 90.0 {
                let share = cos * 0.5_f64.powf((off / 45.0).powi(2));
                sum += share * temperature_c(azimuth, elevation);
                shares += share;
            }
        }
    }
    sum / shares
}

#[test]
fn without_anything_in_it_a_scene_is_the_sky_s_response() {
    for averaging in [Averaging::Temperature, Averaging::Radiance] {
        let response = Response::new(SKY.shape, FIELD, averaging);
        let scene = Scene::new(SKY, FIELD, averaging);
        for angles in [[0.0; 3], [33.0, -12.0, 200.0], [170.0, 60.0, 5.0]] {
            let up = Attitude::from_degrees(angles[0], angles[1]).vertical();
            for (_, direction) in Direction::NAMED {
                assert_eq!(seen(&scene, direction, angles), response.sensor_c(direction.dot(up), 15.0, 40.0));
            }
        }
    }
}

#[test]
fn a_warm_side_looks_like_a_bank_toward_it() {
    let scene = scene().with_warm_side(WARM);
    let y = |yaw| seen(&scene, Direction::RIGHT, [0.0, 0.0, yaw]) - seen(&scene, Direction::LEFT, [0.0, 0.0, yaw]);
    // Heading north the warm east is to the right: warm as the ground is with the right wing down.
    assert!(y(0.0) > 1.0 && (y(180.0) + y(0.0)).abs() < 0.05);
    assert!(y(90.0).abs() < 0.05);
    let x = seen(&scene, Direction::TAIL, [0.0, 0.0, 90.0]) - seen(&scene, Direction::NOSE, [0.0, 0.0, 90.0]);
    assert!((x + y(0.0)).abs() < 0.1, "toward the warm side the nose seems down");
    let up = [Direction::UP, Direction::DOWN].map(|d| seen(&scene, d, [0.0; 3]) - seen(&self::scene(), d, [0.0; 3]));
    assert!(up.iter().all(|k| (k - 2.5).abs() < 0.02), "{up:?}");
}

#[test]
fn what_differs_is_averaged_over_the_field_of_view() {
    let warmth = |azimuth: f64| 5.0 * 0.5 * (1.0 + (azimuth - 90.0).to_radians().cos());
    let half = |azimuth: f64| if (0.0..180.0).contains(&azimuth) { 5.0 } else { 0.0 };
    let clear = |elevation: f64| SKY.temperature_c(elevation);
    let hill = |azimuth: f64| {
        if (azimuth - 40.0_f64).abs() < 30.0 {
            10.0 * (0.5 + 0.5 * ((azimuth - 40.0) * 6.0).to_radians().cos())
        } else {
            0.0
        }
    };
    type Temperature<'a> = Box<dyn Fn(f64, f64) -> f64 + 'a>;
    let sky_only = WarmSide { ground: false, ..WARM };
    let cases: [(Scene, Temperature<'_>); 5] = [
        (scene().with_warm_side(WARM), Box::new(|a, e| clear(e) + warmth(a))),
        (scene().with_warm_side(sky_only), Box::new(|a, e| clear(e) + if e > 0.0 { warmth(a) } else { 0.0 })),
        (scene().with_warm_side(WarmSide { round: Round::Half, ..WARM }), Box::new(|a, e| clear(e) + half(a))),
        (
            scene().with_ridge(Ridge { azimuth_deg: 40.0, width_deg: 60.0, height_deg: 10.0 }),
            Box::new(|a, e| if e < hill(a) { 15.0 } else { clear(e) }),
        ),
        (
            scene().with_ridge(Ridge { azimuth_deg: 0.0, width_deg: 1e6, height_deg: 30.0 }),
            Box::new(|_, e| if e < 30.0 { 15.0 } else { clear(e) }),
        ),
    ];
    for (i, (scene, temperature_c)) in cases.iter().enumerate() {
        for (yaw, axis) in [(0.0, 0.0), (50.0, 50.0), (220.0, 220.0)] {
            let (got, expected) = (seen(scene, Direction::NOSE, [0.0, 0.0, yaw]), mean(axis, temperature_c));
            assert!((got - expected).abs() < 0.1, "{i} to {axis}°: {got} {expected}");
        }
    }
}

#[test]
fn a_ridge_all_around_hides_the_sky_and_a_cloud_all_over_hides_it_all() {
    for averaging in [Averaging::Temperature, Averaging::Radiance] {
        let scene = || Scene::new(SKY, FIELD, averaging);
        let walls = scene().with_ridge(Ridge { azimuth_deg: 0.0, width_deg: 1e6, height_deg: 30.0 });
        let lid = Cloud { azimuth_deg: 0.0, elevation_deg: 90.0, radius_deg: 180.0, opacity: 1.0, edge_deg: 1.0 };
        let closed = scene().with_clouds(Clouds::new(&[lid], 0.1, 0.0));
        for (_, direction) in Direction::NAMED {
            let (bare, walled) = (seen(&scene(), direction, [10.0; 3]), seen(&walls, direction, [10.0; 3]));
            assert!(walled >= bare - 1e-9 && walled < 15.01, "{direction}: {bare} {walled}");
            assert!((seen(&closed, direction, [10.0; 3]) - 15.0).abs() < 0.15, "{direction}");
        }
        assert!(seen(&walls, Direction::NOSE, [0.0; 3]) > seen(&scene(), Direction::NOSE, [0.0; 3]) + 3.0);
    }
}

#[test]
fn patches_are_seen_from_where_the_aircraft_is_and_only_below() {
    let scene = scene().with_patchwork(Patchwork { rms_k: 3.0, cell_m: 400.0, seed: 2 });
    let from = |place_m, direction| {
        let orientation = Orientation::new(Attitude::default(), 0.0);
        scene.view(orientation, &WEATHER).from(place_m).sensor_c(direction)
    };
    let low: Vec<f64> = (0..50).map(|i| from([f64::from(i) * 100.0, 0.0, 100.0], Direction::DOWN) - 15.0).collect();
    let rms = (low.iter().map(|k| k * k).sum::<f64>() / 50.0).sqrt();
    assert!((1.0..3.0).contains(&rms), "{rms}");
    let high = (0..50).map(|i| from([f64::from(i) * 1000.0, 0.0, 3000.0], Direction::DOWN) - 15.0);
    assert!(high.map(f64::abs).fold(0.0, f64::max) < 0.5, "from high up they blur");
    let bare = seen(&self::scene(), Direction::UP, [0.0; 3]);
    assert!((from([0.0, 0.0, 100.0], Direction::UP) - bare).abs() < 1e-9);
}

#[test]
fn hostile_features_and_directions_do_not_panic() {
    for x in [f64::NAN, f64::INFINITY, -1e300, 0.0] {
        let cloud = Cloud { azimuth_deg: x, elevation_deg: x, radius_deg: x, opacity: x, edge_deg: x };
        let scene = scene()
            .with_warm_side(WarmSide { azimuth_deg: x, amplitude_k: x, ..WARM })
            .with_ridge(Ridge { azimuth_deg: x, width_deg: x, height_deg: x })
            .with_clouds(Clouds::new(&[cloud], x, x))
            .with_patchwork(Patchwork { rms_k: x, cell_m: x, seed: 1 });
        for (_, direction) in Direction::NAMED {
            seen(&scene, direction, [x, 0.0, x]);
        }
    }
}
