//! See fuzz/bodies/mavlink_service.rs; tests/fuzz_mavlink.rs runs it over some inputs without a fuzzer.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../bodies/mavlink_service.rs"]
mod body;
#[path = "../seeds.rs"]
mod seeds;

fuzz_target!(init: seeds::plant(&body::seeds()), |data: &[u8]| body::serve(data));
