use super::*;
use crate::config::settings::{AdcInput, Mlx90614Settings, PecPolicy};
use crate::head::{Sensor, SensorKind};
use proptest::prelude::*;

fn mlx(name: &str, bus: &str, address: u8, direction: Direction) -> SensorSettings {
    let device = Mlx90614Settings { bus: bus.into(), address, object: 1, pec: PecPolicy::Auto, offset_c: 0.0 };
    SensorSettings { name: name.into(), direction, device: DeviceSettings::Mlx90614(device), power: None }
}

fn ads(name: &str, bus: &str, address: u8, sps: u16, input: AdcInput) -> SensorSettings {
    let device = Ads1115Settings {
        bus: bus.into(),
        address,
        input,
        gain_v: 2.048,
        data_rate_sps: sps,
        continuous: false,
        neutral_v: 0.0,
        kelvin_per_v: 40.0,
        data_ready: None,
    };
    SensorSettings {
        name: name.into(),
        direction: Direction::NOSE,
        device: DeviceSettings::Ads1115(device),
        power: None,
    }
}

fn head(sensors: &[SensorSettings]) -> Head {
    let mut buses: Vec<String> = Vec::new();
    let nouns = sensors.iter().map(|s| {
        let path = s.device.bus().to_string_lossy().into_owned();
        let bus = buses.iter().position(|b| *b == path).unwrap_or_else(|| {
            buses.push(path);
            buses.len() - 1
        });
        Sensor { name: s.name.clone(), direction: s.direction, kind: SensorKind::ABSOLUTE, bus: Some(bus) }
    });
    let nouns = nouns.collect();
    Head::new(nouns, buses)
}

fn plan(sensors: &[SensorSettings], rate_hz: f64, quiet_us: u64) -> Result<Schedule, DoesNotFit> {
    Schedule::plan(sensors, &head(sensors), rate_hz, Duration::from_micros(quiet_us))
}

fn six(bus: &str) -> Vec<SensorSettings> {
    use Direction as D;
    [("up", D::UP), ("nose", D::NOSE), ("left", D::LEFT), ("down", D::DOWN), ("tail", D::TAIL), ("right", D::RIGHT)]
        .iter()
        .zip(0x5a..)
        .map(|((name, direction), address)| mlx(name, bus, address, *direction))
        .collect()
}

#[test]
fn opposed_sensors_are_read_next_to_each_other() {
    let schedule = plan(&six("/dev/i2c-1"), 50.0, 1000).unwrap();
    let order: Vec<usize> = schedule.slots.iter().map(|s| s.sensor).collect();
    assert_eq!(order, [0, 3, 1, 4, 2, 5]);
}

#[test]
fn six_sensors_take_their_words_and_their_quiet() {
    // 6 reads and a die temperature of 0.57 ms, each with 1 ms of quiet before it.
    let schedule = plan(&six("/dev/i2c-1"), 50.0, 1000).unwrap();
    assert_eq!(schedule.needed, Duration::from_micros(7 * (570 + 1000)));
    assert_eq!(schedule.slots[1].offset, Duration::from_micros(1570));
    // 200 scans a second are possible without quiet: 3.99 ms of 5 ms.
    assert_eq!(plan(&six("/dev/i2c-1"), 200.0, 0).unwrap().needed, Duration::from_micros(7 * 570));
}

#[test]
fn what_does_not_fit_says_what_would() {
    let sensors = six("/dev/i2c-1");
    let error = plan(&sensors, 100.0, 2000).unwrap_err();
    assert_eq!(error.highest_rate_hz, 50.0); // 0.9 / (7 × 2.57 ms) = 50.03
    assert!(plan(&sensors, error.highest_rate_hz, 2000).is_ok());
    let quiet = error.longest_quiet.unwrap();
    assert!(plan(&sensors, 100.0, quiet.as_micros() as u64).is_ok());
    assert_eq!(
        error.to_string(),
        "a scan of 6 sensors needs 18.0 ms, and rate-hz = 100 leaves it 9.0 ms: set [daemon] rate-hz to 50 or less, \
         or quiet-ms from 2 to 0.62 or less"
    );
}

#[test]
fn a_slow_converter_is_named() {
    let sensors = [ads("long", "/dev/i2c-1", 0x48, 8, AdcInput::Ain0Ain1)];
    let error = plan(&sensors, 50.0, 0).unwrap_err();
    assert!(error.to_string().ends_with("or raise the ADS1115's data-rate-sps"), "{error}");
    assert!((6.0..8.0).contains(&error.highest_rate_hz));
    assert_eq!(error.longest_quiet, None);
}

#[test]
fn channels_of_one_converter_follow_each_other_and_converters_run_side_by_side() {
    use AdcInput::{Ain0Ain1, Ain2Ain3};
    let one = [ads("a", "/dev/i2c-1", 0x48, 128, Ain0Ain1), ads("b", "/dev/i2c-1", 0x48, 128, Ain2Ain3)];
    assert!(plan(&one, 50.0, 0).is_err(), "two conversions of 8.6 ms and their words are more than 18 ms");
    let two = [ads("a", "/dev/i2c-1", 0x48, 128, Ain0Ain1), ads("b", "/dev/i2c-1", 0x49, 128, Ain0Ain1)];
    let schedule = plan(&two, 50.0, 0).unwrap();
    assert!(schedule.needed < Duration::from_millis(14), "{schedule}");
    assert_eq!(schedule.housekeeping, None, "no MLX90614, no die temperature");
}

#[test]
fn while_one_bus_is_quiet_the_other_is_read() {
    let one = plan(&six("/dev/i2c-1"), 50.0, 1500).unwrap();
    let mut sensors = six("/dev/i2c-1");
    for s in sensors.iter_mut().skip(3) {
        let DeviceSettings::Mlx90614(m) = &mut s.device else { panic!() };
        m.bus = "/dev/i2c-3".into();
    }
    let two = plan(&sensors, 50.0, 1500).unwrap();
    assert!(two.needed.as_secs_f64() < 0.75 * one.needed.as_secs_f64(), "{two}");
}

#[test]
fn two_objects_share_a_chip() {
    let mut sensors = vec![mlx("nose", "/dev/i2c-1", 0x5a, Direction::NOSE)];
    let mut second = mlx("tail", "/dev/i2c-1", 0x5a, Direction::TAIL);
    let DeviceSettings::Mlx90614(m) = &mut second.device else { panic!() };
    m.object = 2;
    sensors.push(second);
    let schedule = plan(&sensors, 50.0, 0).unwrap();
    assert_eq!(schedule.chips, [ChipPlan { bus: 0, address: 0x5a, sensors: vec![0, 1] }]);
    assert_eq!(schedule.slots.iter().map(|s| s.slot).collect::<Vec<_>>(), [0, 1]);
    assert_eq!(schedule.chip_name(0), "nose, tail");
}

#[test]
fn a_rate_that_is_advised_fits_to_the_last_digit() {
    // With 2555 µs it is 144 Hz, of whose period 2 × (570 + 2555) µs are 0.9 exactly.
    for quiet_us in 0..20_000 {
        if let Err(error) = plan(&six("/dev/i2c-1")[..1], 199.5, quiet_us) {
            assert!(plan(&six("/dev/i2c-1")[..1], error.highest_rate_hz, quiet_us).is_ok(), "{quiet_us} µs: {error}");
        }
    }
}

#[test]
fn it_is_printed_for_people() {
    let text = plan(&six("/dev/i2c-1")[..2], 50.0, 1000).unwrap().to_string();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}");
    assert_eq!(lines[0], "a scan of 2 sensors every 20.00 ms, 4.71 ms of it used, quiet for 1.00 ms before each read");
    assert_eq!(lines[2].trim(), "1.57 to   2.14 ms  nose         0x5b on /dev/i2c-1");
}

proptest! {
    #[test]
    fn every_sensor_once_nothing_overlaps_and_every_bus_is_quiet_before_each_read(
        kinds in prop::collection::vec((0_u8..3, 0_usize..3), 1..12), rate_hz in 1.0_f64..200.0, quiet_us in 0_u64..50_000,
    ) {
        let directions: Vec<Direction> = Direction::NAMED.iter().map(|(_, d)| *d).collect();
        let sensors: Vec<SensorSettings> = kinds.iter().enumerate().map(|(i, (kind, bus))| {
            let bus = format!("/dev/i2c-{bus}");
            match kind {
                0 => ads(&format!("s{i}"), &bus, 0x48 + (i % 4) as u8, 860, AdcInput::NAMED[i % 8].1),
                _ => mlx(&format!("s{i}"), &bus, 0x10 + i as u8, directions[i % 6]),
            }
        }).collect();
        let schedule = match plan(&sensors, rate_hz, quiet_us) {
            Ok(schedule) => schedule,
            Err(error) => {
                // What is advised fits.
                prop_assert!(error.highest_rate_hz < rate_hz);
                prop_assert!(plan(&sensors, error.highest_rate_hz, quiet_us).is_ok());
                if let Some(quiet) = error.longest_quiet {
                    prop_assert!(plan(&sensors, rate_hz, quiet.as_micros() as u64).is_ok());
                }
                return Ok(());
            }
        };
        let mut seen: Vec<usize> = schedule.slots.iter().map(|s| s.sensor).collect();
        seen.sort_unstable();
        prop_assert_eq!(seen, (0..sensors.len()).collect::<Vec<_>>());
        prop_assert!(schedule.slots.windows(2).all(|w| w[0].end <= w[1].offset));
        prop_assert!(schedule.needed <= schedule.period);
        let quiet = Duration::from_micros(quiet_us);
        for bus in 0..schedule.buses().len() {
            let on_bus: Vec<&Slot> = schedule.slots.iter().filter(|s| schedule.chips[s.chip].bus == bus).collect();
            prop_assert!(on_bus.windows(2).all(|w| w[1].offset >= w[0].end + quiet));
            // And from one scan to the next.
            if let (Some(first), Some(last)) = (on_bus.first(), on_bus.last()) {
                prop_assert!(first.offset + schedule.period >= last.end + quiet);
            }
        }
    }
}
