//! A recording opened for the daemon's pipeline: its settings, its frames, what is given of them.

use super::error::{CtlError, chain, printable};
use super::kit::Kit;
use super::recording_args::RecordingArgs;
use crate::attitude::{Attitude, Estimate};
use crate::config::Settings;
use crate::config::settings::Method;
use crate::head::Head;
use crate::recording::{Reader, Recording};
use crate::time::Time;
use std::fs::{self, File};
use std::io::{BufReader, Write};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

/// A recording with the settings that it is replayed by.
#[derive(Debug)]
pub struct Opened {
    /// The given configuration, or the carried one, or the defaults.
    pub settings: Settings,
    /// Its frames.
    pub reader: Reader<BufReader<File>>,
}

/// Opens what the command line names; notices go to `err`.
pub fn open(args: &RecordingArgs, kit: &Kit, err: &mut dyn Write) -> Result<Opened, CtlError> {
    let recording = Recording::open(&args.file)?;
    let settings = match (&args.config, recording.config()) {
        (Some(path), _) => (kit.load_for_replay)(path),
        (None, Some(text)) => (kit.parse)(text).or_else(|e| {
            let _ = writeln!(err, "notice: the recording's own configuration is not used: {}", chain(e.as_ref()));
            (kit.defaults)()
        }),
        (None, None) => (kit.defaults)(),
    }
    .map_err(CtlError::Config)?;
    let head = if settings.sensors.is_empty() { None } else { Some(settings.head()) };
    let reader = recording.frames(head)?;
    for notice in reader.notices() {
        let _ = writeln!(err, "notice: {}", printable(notice));
    }
    Ok(Opened { settings, reader })
}

/// A new file at `path`, but never over the recording.
pub fn create(path: &Path, recording: &Path) -> Result<File, CtlError> {
    not_over(path, recording)?;
    File::create(path).map_err(|source| CtlError::Write { path: path.to_owned(), rows: None, source })
}

/// Whether `path` is another file than the recording.
pub fn not_over(path: &Path, recording: &Path) -> Result<(), CtlError> {
    let same = |a: &fs::Metadata, b: &fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    match (fs::metadata(recording), fs::metadata(path)) {
        (Ok(a), Ok(b)) if same(&a, &b) => Err(CtlError::OverItself { path: path.to_owned() }),
        _ => Ok(()),
    }
}

/// Says on `err` what of the recording could not be used.
pub fn tell_tally(reader: &Reader<BufReader<File>>, err: &mut dyn Write) {
    if !reader.tally().is_clean() {
        let _ = writeln!(err, "notice: {}", reader.tally());
    }
    if reader.tally().is_other_unit() {
        let _ = writeln!(err, "notice: most rows are without time or far from the row before: is time_s in seconds?");
    }
    if reader.tally().is_in_kelvin() {
        let _ = writeln!(err, "notice: most rows see nothing below 150 °C: are they in kelvin? Subtract 273.15");
    }
}

/// The settings with another method. A limit of roll that was not chosen is the new method's.
pub fn with_method(settings: &Settings, method: Method) -> Settings {
    let mut settings = settings.clone();
    settings.estimator.method = Some(method);
    settings
}

/// `method`, where it works on `head`.
pub fn allowed(head: &Head, method: Method) -> Result<Method, CtlError> {
    let refusal = CtlError::MethodNotAllowed { method: method.as_str(), needs: method.needs() };
    if method.suits(head) { Ok(method) } else { Err(refusal) }
}

/// What a frame gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// An attitude of its own.
    New(Attitude),
    /// No attitude.
    Withheld,
    /// Nothing: the attitude is that of a frame before.
    Nothing,
}

impl Given {
    /// The attitude, if there is a new one.
    pub fn attitude(self) -> Option<Attitude> {
        if let Self::New(attitude) = self { Some(attitude) } else { None }
    }
}

/// Tells new estimates from those that a frame left as they were.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fresh {
    stamp: Option<Time>,
}

impl Fresh {
    /// What `estimate` gives anew. A frame that the pipeline makes nothing of leaves the estimate as
    /// it was: not to be shown under a new time.
    pub fn take(&mut self, estimate: &Estimate) -> Given {
        let fresh = self.stamp.replace(estimate.valid_at) != Some(estimate.valid_at);
        match estimate.attitude {
            None => Given::Withheld,
            Some(attitude) if fresh => Given::New(attitude),
            Some(_) => Given::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_attitude_is_given_once_for_each_stamp() {
        let mut fresh = Fresh::default();
        let attitude = Attitude::default();
        let mut estimate = Estimate { attitude: Some(attitude), ..Estimate::default() };
        assert_eq!(fresh.take(&estimate), Given::New(attitude));
        assert_eq!(fresh.take(&estimate), Given::Nothing);
        estimate.valid_at = Time::from_nanos(1);
        assert_eq!(fresh.take(&estimate), Given::New(attitude));
        estimate.attitude = None;
        assert_eq!(fresh.take(&estimate), Given::Withheld);
        estimate.valid_at = Time::from_nanos(2);
        assert_eq!(fresh.take(&estimate), Given::Withheld);
    }

    #[test]
    fn a_limit_that_was_chosen_stays_with_any_method() {
        let limit_deg = |chosen, method| {
            let mut settings = Settings::default();
            settings.estimator.roll_limit_deg = chosen;
            let changed = with_method(&settings, method);
            assert_eq!(changed.method(), method);
            changed.estimator.roll_limit_deg_for(changed.method())
        };
        for (name, method) in Method::NAMED {
            for chosen in [0.0, 45.0, 60.0] {
                assert_eq!(limit_deg(Some(chosen), method), chosen);
            }
            assert_eq!(limit_deg(None, method), if name == "inverse-sine" { 45.0 } else { 0.0 });
        }
    }

    #[test]
    fn a_method_needs_its_sensors() {
        let mut head = Head::six();
        for (_, method) in Method::NAMED {
            assert_eq!(allowed(&head, method).ok(), Some(method));
        }
        head = Head::new(head.sensors[..5].to_vec(), Vec::new());
        assert!(allowed(&head, Method::Field).is_ok() && allowed(&head, Method::Profile).is_err());
        let error = allowed(&head, Method::InverseSine).unwrap_err().to_string();
        assert!(error.contains("vertical pair"), "{error}");
    }
}
