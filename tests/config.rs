//! What a user reads about a configuration, compared whole: `tests/golden/config/NAME.toml` (with its
//! drop-ins) loads to what `NAME.txt` says. `UPDATE_GOLDEN=1 cargo test --test config` writes them anew.

mod golden_file;

use irhorizon::config::{ConfigErrors, Loaded, load};
use std::path::{Path, PathBuf};

const FOLDER: &str = "tests/golden/config";

fn told(result: Result<Loaded, ConfigErrors>) -> String {
    match result {
        Err(errors) => format!("{errors}\n"),
        Ok(loaded) => {
            let warnings: String = loaded.warnings.iter().map(|w| format!("warning: {w}\n")).collect();
            format!("{warnings}{}", loaded.text)
        }
    }
}

#[test]
fn every_configuration_is_told_as_it_was_before() {
    let mut cases: Vec<PathBuf> = std::fs::read_dir(FOLDER)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.is_file() && p.extension().is_some_and(|e| e == "toml"))
        .collect();
    cases.push(Path::new(FOLDER).join("missing-file.toml"));
    cases.push(Path::new(FOLDER).join("directory.toml"));
    cases.sort();
    let mut different = Vec::new();
    for case in cases {
        let golden = case.with_extension("txt");
        let now = told(load(&case));
        different.extend(golden_file::difference(golden, &now));
    }
    assert!(different.is_empty(), "{}", different.join("\n"));
}
