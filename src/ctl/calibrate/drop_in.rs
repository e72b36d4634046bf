//! What was measured, as a drop-in of the configuration: checked before it is saved, brought back on request.

use super::error::CalibrateError;
use crate::config::{self, Loaded};
use crate::ctl::error::CtlError;
use crate::ctl::setup_args::Quantity;
use crate::save::{FileSystem, Undone, drop_in_can_be_saved, make_drop_ins, replace_and_keep, undo};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A drop-in that this program writes.
pub(super) struct DropIn {
    path: PathBuf,
}

impl DropIn {
    /// Of `what`, beside the configuration.
    pub fn new(config: &Path, what: Quantity) -> Self {
        let mut folder = config.as_os_str().to_owned();
        folder.push(".d");
        let name = match what {
            Quantity::Level => "50-trim.toml",
            Quantity::Neutral => "50-neutral.toml",
        };
        Self { path: PathBuf::from(folder).join(name) }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the configuration is good with `lines` in this place, and holds what they say.
    pub fn check(&self, loaded: &Loaded, lines: &str) -> Result<(), CtlError> {
        let mut files: Vec<(PathBuf, String)> = Vec::new();
        for file in loaded.files.iter().filter(|f| **f != self.path) {
            let text = fs::read_to_string(file).map_err(|e| CtlError::Config(e.into()))?;
            files.push((file.clone(), text));
        }
        // The first is the configuration; drop-ins come in the order of their names.
        let behind = |f: &(PathBuf, String)| f.0.file_name() < self.path.file_name();
        let at = 1 + files.iter().skip(1).take_while(|f| behind(f)).count();
        let whole = |with: &[(PathBuf, String)]| config::parse(with).map_err(|e| CtlError::Config(e.into()));
        files.insert(at.min(files.len()), (self.path.clone(), lines.to_owned()));
        let result = whole(&files)?;
        // Said once more as the last word: nothing must change by that.
        files.push((self.path.clone(), lines.to_owned()));
        if whole(&files)?.text != result.text {
            return Err(CalibrateError::Overruled(self.path.clone()).into());
        }
        Ok(())
    }

    /// Whether it can be saved.
    pub fn prepare(&self) -> Result<(), CtlError> {
        drop_in_can_be_saved(&mut FileSystem, &self.path).map_err(|e| self.failed(e))
    }

    /// Saves it.
    pub fn save(&self, lines: &str) -> Result<(), CtlError> {
        let text = format!("# Written by irhorizonctl calibrate; --undo brings back what was before.\n{lines}");
        make_drop_ins(&self.path)
            .and_then(|_| replace_and_keep(&mut FileSystem, &self.path, text.as_bytes()))
            .map_err(|e| self.failed(e))
    }

    /// Brings back what was there before.
    pub fn undo(&self) -> Result<Undone, CtlError> {
        match undo(&mut FileSystem, &self.path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(Undone::Nothing),
            other => other.map_err(|e| self.failed(e)),
        }
    }

    fn failed(&self, source: io::Error) -> CtlError {
        CtlError::Write { path: self.path.clone(), rows: None, source }
    }
}
