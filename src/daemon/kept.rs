//! Settings that were changed in operation and are kept: the last drop-in, the daemon's own.

use crate::config::{self, ConfigErrors, Loaded};
use crate::mavlink::service::{Change, drop_in};
use crate::save::{FileSystem, replace, state_folder};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The most bytes of it that are read.
const LARGEST: u64 = 64 * 1024;

/// Why nothing of what was kept can be had.
#[derive(Debug, Error)]
enum Unread {
    /// The system does not give it.
    #[error("{0}; see who may read it (ls -l), or remove it and set them anew")]
    Io(#[from] io::Error),
    /// It holds something else, or was damaged.
    #[error("there is no setting in it, or too much to be of irhorizond; remove it and set them anew")]
    Foreign,
}

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
        read(&self.path).unwrap_or_else(|e| {
            log::error!("{}: settings kept from MAVLink parameters are left out: {e}", self.path.display());
            String::new()
        })
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
        let lay = |text| config::load_with(&self.configuration, &self.path, text);
        let (loaded, some_hold) = lay(text.clone()).map_or_else(|_| one_by_one(plain, &text, lay), |l| (l, true));
        if some_hold && self.is_written() {
            log::info!(
                "settings kept from MAVLink parameters hold: {} (remove it to be rid of them)",
                self.path.display()
            );
        }
        Ok(loaded)
    }

    /// Keeps `changes`, and gives what was kept before. They hold even where they cannot be written: until the next start
    /// then.
    pub fn keep(&mut self, changes: &[Change]) -> String {
        let before = self.text();
        self.put(drop_in::with(&before, changes));
        before
    }

    /// Keeps `text` in place of all that is kept.
    pub fn put(&mut self, text: String) {
        self.unwritten = None;
        if let Err(e) = replace(&mut FileSystem, &self.path, text.as_bytes()) {
            log::error!("{} cannot be written: {e}; the settings hold until the next start", self.path.display());
            self.unwritten = Some(text);
        }
    }

    /// Whether what holds will hold after the next start, too.
    pub const fn is_written(&self) -> bool {
        self.unwritten.is_none()
    }
}

/// What is in the file; one that is not there is empty.
fn read(path: &Path) -> Result<String, Unread> {
    let meta = match fs::metadata(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(String::new()),
        meta => meta?,
    };
    if !meta.is_file() || meta.len() > LARGEST {
        return Err(Unread::Foreign);
    }
    let mut text = fs::read_to_string(path)?;
    let nothing = text.lines().map(str::trim).all(|line| line.is_empty() || line.starts_with('#'));
    // What is left of a number is another number.
    let whole = text.rfind('\n').map_or(0, |end| end + 1);
    if whole < text.len() {
        log::error!("{}: its last line, {:?}, is cut off and left out", path.display(), &text[whole..]);
        text.truncate(whole);
    }
    if nothing || !drop_in::single(&text).is_empty() { Ok(text) } else { Err(Unread::Foreign) }
}

/// `plain` with those settings of `text` that `lay` takes, and whether there are any.
fn one_by_one(plain: Loaded, text: &str, lay: impl Fn(String) -> Result<Loaded, ConfigErrors>) -> (Loaded, bool) {
    let (mut loaded, mut fitting) = (plain, String::new());
    for setting in drop_in::single(text) {
        let more = drop_in::laid(&fitting, &setting);
        match lay(more.clone()) {
            Ok(l) => (loaded, fitting) = (l, more),
            Err(e) => log::error!("a setting kept from MAVLink parameters does not fit and is left out:\n{e}"),
        }
    }
    (loaded, !fitting.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_longer_fits_is_left_out_alone() {
        let configuration = std::env::temp_dir().join(format!("irhorizon-kept-{}.toml", std::process::id()));
        let path = configuration.with_extension("kept");
        let main = "[daemon]\nrate-hz = 25\n[simulation]\nenabled = true\n[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:1\"\n";
        let kept = "[[mavlink.endpoint]]\naddress = \"udpout:127.0.0.1:1\"\nattitude-hz = 40\nvalues-hz = 5\n\n\
                    [head]\nroll-trim = 1\nroll-trim-deg = 12\n";
        fs::write(&configuration, main).unwrap();
        fs::write(&path, kept).unwrap();
        let settings =
            Kept { configuration: configuration.clone(), path: path.clone(), unwritten: None }.load().unwrap().settings;
        let streams = &settings.mavlink.endpoints[0].streams;
        assert_eq!((settings.head.roll_trim_deg, streams.values_hz, streams.attitude_hz), (12.0, 5.0, None));
        for file in [configuration, path] {
            fs::remove_file(file).unwrap();
        }
    }

    #[test]
    fn what_cannot_be_read_is_not_taken_for_nothing() {
        let path = std::env::temp_dir().join(format!("irhorizon-unread-{}", std::process::id()));
        assert_eq!(read(&path).unwrap(), "");
        let long = "#".repeat(LARGEST as usize + 1);
        for damaged in
            [&b"\0\0\0\0"[..], b"[head]\nroll-trim-d", b"[head]\nroll-trim-deg = 2\n# \xff\n", long.as_bytes()]
        {
            fs::write(&path, damaged).unwrap();
            assert!(read(&path).is_err(), "{:?}", String::from_utf8_lossy(&damaged[..damaged.len().min(40)]));
        }
        for sound in ["", "# nothing\n\n", "[head]\nroll-trim-deg = 2\n"] {
            fs::write(&path, sound).unwrap();
            assert_eq!(read(&path).unwrap(), sound);
        }
        fs::write(&path, "[head]\nroll-trim-deg = 2\npitch-trim-deg = 1").unwrap();
        assert_eq!(read(&path).unwrap(), "[head]\nroll-trim-deg = 2\n", "it was 12");
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn where_nothing_fits_nothing_holds() {
        let configuration = std::env::temp_dir().join(format!("irhorizon-unkept-{}.toml", std::process::id()));
        fs::write(&configuration, "[simulation]\nenabled = true\n").unwrap();
        let holds = |text: &str| {
            let lay = |text| config::load_with(&configuration, &configuration.with_extension("kept"), text);
            one_by_one(config::load(&configuration).unwrap(), text, lay).1
        };
        assert!(!holds("[head]\nroll-trim-deg = 900\n"));
        assert!(holds("[head]\nroll-trim-deg = 900\npitch-trim-deg = 2\n"));
        fs::remove_file(&configuration).unwrap();
    }
}
