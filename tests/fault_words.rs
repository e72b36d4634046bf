//! Faults on purpose as they are written: on the command line and in a configuration, right and wrong.

use irhorizon::config::settings::SimulationSettings;
use irhorizon::config::{Loaded, parse};
use irhorizon::frame::{Frame, Value};
use irhorizon::head::Head;
use irhorizon::simulation::fault::{Kind, Who};
use irhorizon::simulation::{Fault, SimulatedSource};
use irhorizon::sky::FieldOfView;
use irhorizon::source::FrameSource;
use irhorizon::time::Time;
use proptest::prelude::*;

fn faults(texts: &[&str]) -> Vec<Fault> {
    texts.iter().map(|t| t.parse().unwrap_or_else(|e| panic!("{t}: {e}"))).collect()
}

fn read(text: &str) -> Result<Loaded, irhorizon::config::ConfigErrors> {
    parse(&[("a.toml".into(), text.into())])
}

/// The first frames of a flight with these settings.
fn fly(settings: &SimulationSettings, count: u64) -> Vec<Frame> {
    let mut source = SimulatedSource::new(settings, &Head::six(), FieldOfView::Gaussian { fwhm_deg: 90.0 });
    let mut frame = Frame::new(6);
    let scan = |i| {
        source.scan(Time::from_nanos(i * 20_000_000), &mut frame);
        frame.clone()
    };
    (0..count).map(scan).collect()
}

#[test]
fn faults_are_read_as_they_are_written() {
    let sensor = |name: &str| Who::Sensor(name.into());
    let none = f64::INFINITY;
    for (text, shown, kind, strength, who, from_s, to_s) in [
        ("off:nose@10..20", "off:nose@10..20", Kind::Off, 0.0, sensor("nose"), 10.0, 20.0),
        ("stuck:all@0..", "stuck:all@0..", Kind::Stuck, 0.0, Who::All, 0.0, none),
        ("garbage:up@1.5..2.5", "garbage:up@1.5..2.5", Kind::Garbage, 0.0, sensor("up"), 1.5, 2.5),
        ("wrong:left@1..2", "wrong=8:left@1..2", Kind::Wrong, 8.0, sensor("left"), 1.0, 2.0),
        ("wrong=-3.5:left@1..2", "wrong=-3.5:left@1..2", Kind::Wrong, -3.5, sensor("left"), 1.0, 2.0),
        ("slow:down@1..", "slow=2:down@1..", Kind::Slow, 2.0, sensor("down"), 1.0, none),
        ("delayed:long@1..", "delayed=0.5:long@1..", Kind::Delayed, 0.5, sensor("long"), 1.0, none),
        ("intermittent:tail@1..", "intermittent=50:tail@1..", Kind::Intermittent, 50.0, sensor("tail"), 1.0, none),
        ("wet:all@1..", "wet=92:all@1..", Kind::Wet, 92.0, Who::All, 1.0, none),
        ("hail@30..60", "hail=2@30..60", Kind::Hail, 2.0, Who::World, 30.0, 60.0),
        ("fog=1@30..60", "fog=1@30..60", Kind::Fog, 1.0, Who::World, 30.0, 60.0),
        ("rain@30..60", "rain=60@30..60", Kind::Rain, 60.0, Who::World, 30.0, 60.0),
        ("ridge:left@1..", "ridge=25:left@1..", Kind::Ridge, 25.0, Who::Left, 1.0, none),
        ("ridge=60:-90@1..", "ridge=60:-90@1..", Kind::Ridge, 60.0, Who::Azimuth(-90.0), 1.0, none),
        ("valley:right@1..", "valley=35:right@1..", Kind::Valley, 35.0, Who::Right, 1.0, none),
        ("cloud:270@1..", "cloud=40:270@1..", Kind::Cloud, 40.0, Who::Azimuth(270.0), 1.0, none),
    ] {
        let fault: Fault = text.parse().unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(fault, Fault { kind, strength, who, from_s, to_s }, "{text}");
        assert_eq!(fault.to_string(), shown);
        assert_eq!(shown.parse::<Fault>(), Ok(fault));
    }
}

#[test]
fn what_is_written_wrong_is_told_with_what_would_be_right() {
    for (text, told) in [
        ("", "\"\" does not say when"),
        ("off:nose", "\"off:nose\" does not say when: append @FROM..TO"),
        ("@1..2", "nothing is no kind of fault; there are off, stuck"),
        ("stcuk:nose@1..", "did you mean stuck?"),
        ("Wet:nose@1..", "did you mean wet?"),
        ("earthquake@1..", "there are off, stuck"),
        ("off=1:nose@1..", "off has no strength: leave out the ="),
        ("wet=101:nose@1..", "101 is no strength of wet: 0 to 100 %"),
        ("wet=:nose@1..", "is no strength of wet"),
        ("wet=nan:nose@1..", "nan is no strength"),
        ("ridge=90:left@1..", "0 to 89 °"),
        ("off@1..", "off befalls a sensor by its name, or all, as in off:nose@10..20"),
        ("off:@1..", "off befalls a sensor"),
        ("hail:nose@1..", "takes no name, as in hail@10..20; nose is none"),
        ("ridge@1..", "a side: left, right, or ° clockwise from north, as in ridge:left@10..20"),
        ("ridge:nose@1..", "nose is none"),
        ("ridge:1e9@1..", "1e9 is none"),
        ("off:nose@", "is no stretch of time"),
        (
            "off:nose@10",
            "\"10\" is no stretch of time: FROM..TO in seconds since the flight began, FROM 0 or more and TO later, as in 10..",
        ),
        ("off:nose@1.5", "as in 1.5.."),
        ("off:nose@..10", "\"..10\" is no stretch"),
        ("off:nose@20..10", "FROM 0 or more and TO later"),
        ("off:nose@10..10", "is no stretch"),
        ("off:nose@-1..10", "is no stretch"),
        ("off:nose@inf..", "is no stretch"),
        ("off:nose@1..2@3..4", "is no stretch"),
        ("off:nose@1 .. 2", "is no stretch"),
    ] {
        let error = text.parse::<Fault>().expect_err(text).to_string();
        assert!(error.contains(told), "{text}: {error}");
    }
    let late = faults(&["off:nose@30.."])[0].clone();
    assert!(late.check_time(30.5).is_ok());
    let error = late.check_time(30.0).unwrap_err().to_string();
    assert!(error.starts_with("off:nose@30.. begins when the flight of 30 s is over"), "{error}");
    let names = ["nose", "tail"];
    let [there, near, far, world] =
        ["off:nose@1..", "off:nosse@1..", "off:long@1..", "hail@1.."].map(|t| faults(&[t])[0].check(&names));
    assert!(there.is_ok() && world.is_ok());
    assert_eq!(near.unwrap_err().to_string(), "there is no sensor nosse; did you mean nose?");
    assert_eq!(far.unwrap_err().to_string(), "there is no sensor long; there are nose, tail");
}

#[test]
fn a_configuration_has_them_in_a_simulated_flight_alone() {
    let simulated = "[simulation]\nenabled = true\nfaults = [\"wet:nose@10..40\", \"ridge=60:left@5..\"]\n";
    let loaded = read(simulated).unwrap();
    assert_eq!(loaded.settings.simulation.as_ref().unwrap().faults, faults(&["wet:nose@10..40", "ridge=60:left@5.."]));
    assert!(loaded.text.contains("faults = [\"wet=92:nose@10..40\", \"ridge=60:left@5..\"]"), "{}", loaded.text);
    assert_eq!(read(&loaded.text).unwrap(), Loaded { files: loaded.files.clone(), ..loaded.clone() });
    // Before 10 s nothing is wet; a flight without faults is another one afterwards.
    let settings = loaded.settings.simulation.clone().unwrap();
    let [with, without] =
        [settings.clone(), SimulationSettings { faults: Vec::new(), ..settings }].map(|s| fly(&s, 700));
    assert_eq!(with[..250], without[..250]);
    assert_ne!(with[699].readings[0], without[699].readings[0]);

    let pair = "[[sensor]]\nname = \"long\"\nkind = \"ads1115\"\nbus = \"/dev/i2c-1\"\naddress = 0x48\n\
                input = \"ain0\"\nkelvin-per-v = 40.0\ndirection = \"nose\"\n";
    let pairs = [pair.to_owned(), pair.replace("long", "lat").replace("ain0", "ain1").replace("\"nose\"", "\"left\"")];
    let pairs = pairs.concat() + &pair.replace("long", "vert").replace("ain0", "ain2").replace("\"nose\"", "\"up\"");
    for (text, told) in [
        (
            "[simulation]\nenabled = true\nfaults = [\"wet:nsoe@1..\"]\n".to_owned(),
            "no sensor nsoe; did you mean nose?",
        ),
        (
            "[simulation]\nenabled = true\nfaults = [\"haill@1..\"]\n".to_owned(),
            "simulation.faults: haill is no kind of fault; did you mean hail?",
        ),
        (
            "[simulation]\nenabled = true\nfaults = \"hail@1..\"\n".to_owned(),
            "is a string, expected an array of strings",
        ),
        ("[simulation]\nenabled = true\nfaults = [1]\n".to_owned(), "holds an integer, expected strings"),
        (pairs.clone() + "[simulation]\nenabled = true\nfaults = [\"wet:nose@1..\"]\n", "there are long, lat, vert"),
        (pairs.clone() + "[simulation]\nfaults = [\"wet:long@1..\"]\n", "for a simulated flight alone"),
    ] {
        let error = read(&text).expect_err(&text).to_string();
        assert!(error.contains(told), "{text}\n{error}");
    }
    assert!(read(&(pairs.clone() + "[simulation]\nenabled = true\nfaults = [\"wet:vert@1..\"]\n")).is_ok());
    assert!(read(&(pairs + "[simulation]\nfaults = []\n")).is_ok());
}

proptest! {
    #[test]
    fn a_configuration_with_any_text_is_refused_or_reads_back(text in "[a-z]{2,5}(=[0-9]{1,3})?(:[a-z]{2,5})?@[0-9]{1,2}[.]{1,3}[0-9]{0,2}|[^\"\\\\\\p{Cc}]{0,80}") {
        let written = format!("[simulation]\nenabled = true\nfaults = [\"{text}\"]\n");
        match read(&written) {
            Ok(loaded) => prop_assert_eq!(read(&loaded.text).unwrap().settings, loaded.settings),
            Err(e) => prop_assert!(e.to_string().contains("simulation.faults"), "{e}"),
        }
    }

    #[test]
    fn no_text_brings_the_reader_down(text in "\\PC{0,60}") {
        let _ = text.parse::<Fault>().map_err(|e| e.to_string());
    }

    #[test]
    fn what_looks_like_a_fault_is_refused_in_words_or_read_back(
        kind in "[a-z]{0,4}|off|wet|ridge|hail|delayed|wrong",
        value in "|=|=-?[0-9.e]{0,6}|=nan|=inf",
        who in "|:|:nose|:all|:left|:-?[0-9.]{0,5}|:é\u{0}\n",
        from in "-?[0-9.e]{0,6}|nan",
        to in "-?[0-9.e]{0,6}|inf",
    ) {
        let text = format!("{kind}{value}{who}@{from}..{to}");
        match text.parse::<Fault>() {
            Ok(fault) => {
                prop_assert_eq!(fault.to_string().parse::<Fault>(), Ok(fault.clone()));
                prop_assert!([0.0, 1.0, 1e3, 1e12].iter().all(|t| (0.0..=1.0).contains(&fault.share(*t))));
                let frames = fly(&SimulationSettings { faults: vec![fault], ..SimulationSettings::default() }, 5);
                let finite = frames.iter().flat_map(|f| &f.readings).flatten().all(|r| match r.value {
                    Value::Absolute { object_c, .. } => object_c.is_finite(),
                    Value::Volts(v) => v.is_finite(),
                });
                prop_assert!(finite);
            }
            Err(e) => {
                let told = e.to_string();
                prop_assert!(!told.is_empty() && told.len() < 400 && !told.chars().any(char::is_control), "{told}");
            }
        }
    }
}
