//! Settings that were changed in operation and are kept: the last drop-in, the daemon's own.

use crate::config::{self, ConfigErrors, Loaded};
use crate::mavlink::service::{Change, drop_in};
use crate::save::{FileSystem, replace, state_folder};
use std::fs;
use std::path::{Path, PathBuf};

/// The most bytes of it that are read.
const LARGEST: u64 = 64 * 1024;

/// The settings kept for one configuration.
#[derive(Clone, Debug)]
pub struct Kept {
    configuration: PathBuf,
    path: PathBuf,
    /// What could not be written.
    unwritten: Option<String>,
}

impl Kept {
    /// Those of the configuration `configuration`: `parameters.toml` in the daemon's folder, or
    /// `<configuration>.parameters` beside it.
    pub fn new(configuration: &Path) -> Self {
        let path = state_folder().map_or_else(
            || {
                let mut name = configuration.as_os_str().to_owned();
                name.push(".parameters");
                PathBuf::from(name)
            },
            |folder| folder.join("parameters.toml"),
        );
        Self { configuration: configuration.into(), path, unwritten: None }
    }

    fn text(&self) -> String {
        if let Some(text) = &self.unwritten {
            return text.clone();
        }
        let short = fs::metadata(&self.path).is_ok_and(|m| m.is_file() && m.len() <= LARGEST);
        if short { fs::read_to_string(&self.path).unwrap_or_default() } else { String::new() }
    }

    /// The configuration with what is kept laid upon it. What does not fit it any more (a range, an endpoint that is no
    /// longer there) is left out with a word in the log: it must not keep the daemon from starting.
    pub fn load(&self) -> Result<Loaded, ConfigErrors> {
        let plain = config::load(&self.configuration)?;
        let there = |address: &str| plain.settings.mavlink.endpoints.iter().any(|e| e.address.to_string() == address);
        let text = drop_in::fitting(&self.text(), there);
        if text.trim().is_empty() {
            return Ok(plain);
        }
        match config::load_with(&self.configuration, &self.path, text) {
            Ok(loaded) => {
                log::info!(
                    "settings kept from MAVLink parameters hold: {} (remove it to be rid of them)",
                    self.path.display()
                );
                Ok(loaded)
            }
            Err(e) => {
                log::error!("settings kept from MAVLink parameters do not fit and are left out; remove the file:\n{e}");
                Ok(plain)
            }
        }
    }

    /// Keeps `changes`. They hold even where they cannot be written: until the next start then.
    pub fn keep(&mut self, changes: &[Change]) {
        let text = drop_in::with(&self.text(), changes);
        self.unwritten = None;
        if let Err(e) = replace(&mut FileSystem, &self.path, text.as_bytes()) {
            log::error!("{} cannot be written: {e}; the settings hold until the next start", self.path.display());
            self.unwritten = Some(text);
        }
    }
}
