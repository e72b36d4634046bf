use super::super::change::apply;
use super::*;
use crate::config::settings::{EndpointAddress, Streams};
use proptest::prelude::*;

fn settings(endpoints: u16) -> Settings {
    let mut settings = Settings::default();
    for i in 0..endpoints {
        let address = EndpointAddress::UdpOut(([127, 0, 0, 1], 14550 + i).into());
        settings.mavlink.endpoints.push(EndpointSettings { address, streams: Streams::default(), tlog: None });
    }
    settings
}

fn index(settings: &Settings, name: &str) -> usize {
    find(settings, name.as_bytes()).unwrap_or_else(|| panic!("{name}"))
}

#[test]
fn names_are_short_and_each_is_there_once() {
    let settings = settings(16);
    let names: Vec<String> = (0..count(&settings)).map(|i| name(&settings, i).unwrap()).collect();
    assert_eq!(names.len(), 21 + 16 * 5);
    for (i, name) in names.iter().enumerate() {
        assert!(name.len() <= 16 && name.starts_with("IRH_"), "{name}");
        assert_eq!(index(&settings, name), i);
    }
    assert_eq!(name(&settings, names.len()), None);
    assert_eq!(find(&settings, b"IRH_ROLL"), None);
    assert_eq!(find(&settings, b""), None);
}

#[test]
fn every_parameter_can_be_set_to_what_it_is() {
    let settings = settings(2);
    for i in 0..count(&settings) {
        let now = value(&settings, i).unwrap();
        let changed = apply(&settings, &[change(&settings, i, now).unwrap()]).unwrap();
        assert_eq!(value(&changed, i), Some(now), "{:?}", name(&settings, i));
        assert_eq!(changed.mavlink.endpoints.len(), 2);
    }
}

#[test]
fn ranges_are_the_configuration_s() {
    let settings = settings(1);
    let set = |name: &str, to: f32| {
        let i = index(&settings, name);
        let new = change(&settings, i, to).and_then(|c| apply(&settings, &[c]))?;
        value(&new, i).ok_or_else(String::new)
    };
    for (name, good, bad) in [
        ("IRH_ROLL_TRIM", -44.5, 45.5),
        ("IRH_LEARN_TRIM", 0.0, 0.5),
        ("IRH_ON_FAULT", 2.0, 3.0),
        ("IRH_SIGMA_LIM", 10.0, 1.0),
        ("IRH_ROLL_LIMIT", 0.0, 5.0),
        ("IRH_RANGE_TC", 0.1, 61.0),
        ("IRH_AIDING", 0.0, -1.0),
        ("IRH_E1_ATT_HZ", 10.0, 51.0),
        ("IRH_E1_TEXTS", 0.0, 2.0),
    ] {
        assert_eq!(set(name, good), Ok(good), "{name}");
        for bad in [bad, f32::NAN, f32::INFINITY, -1e30] {
            assert!(!set(name, bad).unwrap_err().is_empty(), "{name} = {bad}");
        }
    }
    assert_eq!(set("IRH_ON_FAULT", 1.5), Err("0 (withhold), 1 (hold), 2 (level)".into()));
}

#[test]
fn trims_are_rounded_and_have_no_negative_zero() {
    let toml: String = trims(-0.000_1, 12.345_678).iter().map(|c| format!("{} = {}\n", c.key, c.value)).collect();
    assert_eq!(toml, "roll-trim-deg = 0\npitch-trim-deg = 12.346\n");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_value_panics_and_what_is_taken_is_kept(index in 0_usize..40, bits: u32, small in -200.0_f32..200.0) {
        let settings = settings(3);
        for wanted in [f32::from_bits(bits), small] {
            if let Ok(new) = change(&settings, index, wanted).and_then(|c| apply(&settings, &[c])) {
                prop_assert_eq!(value(&new, index), Some(wanted));
            }
        }
    }
}
