//! What a fuzzer begins with, as files: `fuzz/run` names their folder.

use std::path::PathBuf;

/// Writes `seeds` to the folder that `IRHORIZON_SEEDS` names, if it does.
pub fn plant(seeds: &[impl AsRef<[u8]>]) {
    let Some(folder) = std::env::var_os("IRHORIZON_SEEDS").map(PathBuf::from) else { return };
    for (i, seed) in seeds.iter().enumerate() {
        std::fs::write(folder.join(format!("{i:03}")), seed).expect("the folder of the seeds can be written");
    }
}
