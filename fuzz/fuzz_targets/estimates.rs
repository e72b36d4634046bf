//! Any bytes as the estimates of another program: no panic, and an end.
#![no_main]

use irhorizon::recording::Estimates;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut estimates) = Estimates::new(bytes, "fuzz.csv".into()) else { return };
    while let Ok(Some(_)) = estimates.next_row() {}
});
