//! Any text as a configuration, a drop-in after each NUL: no panic, and what is accepted reads back
//! as itself.
#![no_main]

use irhorizon::config::parse;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let files: Vec<_> = text.split('\0').map(|t| ("a.toml".into(), t.to_owned())).collect();
    match parse(&files) {
        Ok(loaded) => {
            let again = parse(&[("shown".into(), loaded.text.clone())]).expect("what is shown is right");
            assert_eq!(again.text, loaded.text);
        }
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
});
