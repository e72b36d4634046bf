//! Any text as a fault of a simulated flight: no panic; what is accepted is written as it is read, has a share of 0 to 1
//! at any time, and is of a sensor that there is or is told so.
#![no_main]

use irhorizon::simulation::Fault;
use irhorizon::simulation::fault::Kind;
use libfuzzer_sys::fuzz_target;

#[path = "../seeds.rs"]
mod seeds;

fuzz_target!(init: seeds::plant(&Kind::ALL.map(|about| about.kind.example())), |text: &str| {
    match text.parse::<Fault>() {
        Ok(fault) => {
            assert_eq!(fault.to_string().parse(), Ok(fault.clone()));
            assert!([0.0, fault.from_s, fault.to_s, 1e300].iter().all(|s| (0.0..=1.0).contains(&fault.share(*s))));
            let _ = fault.check(&["nose", "tail"]).map_err(|e| assert!(!e.to_string().is_empty()));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
