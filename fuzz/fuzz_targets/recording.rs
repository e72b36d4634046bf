//! Any bytes as a recording: no panic, and what comes out is in order of time and in range.
#![no_main]

use irhorizon::frame::{Frame, Value};
use irhorizon::recording::Recording;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(recording) = Recording::new(bytes, "fuzz.csv".into()) else { return };
    let Ok(mut reader) = recording.frames(None) else { return };
    let mut frame = Frame::default();
    let mut last = None;
    while reader.next_frame(&mut frame).expect("bytes in memory can be read") {
        assert!(last.replace(frame.time).is_none_or(|t| t < frame.time));
        assert_eq!(frame.readings.len(), reader.head().sensors.len());
        for sample in frame.readings.iter().flatten() {
            let Value::Absolute { object_c, ambient_c } = sample.value else { panic!("no pair was configured") };
            assert!((-273.15..=1000.0).contains(&object_c));
            assert!(ambient_c.is_none_or(|c| (-273.15..=1000.0).contains(&c)));
        }
    }
    let _ = reader.tally().to_string();
});
