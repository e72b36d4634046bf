//! Configuration in three steps: raw files, merged with their drop-ins, validated.
//!
//! - `file`, `source`: reading the files, bounded; their text and places in it.
//! - `raw`: a file's TOML with the place of every key and value.
//! - `merge`: drop-ins laid upon the file.
//! - `section`, `validate`, `sensor`, `endpoint`, `check`, `axes`: the settings out of the tables, every
//!   mistake noted in `findings`; `nearest`: what was probably meant.
//! - `error`: mistakes as the user reads them.
//! - `method`: the methods of estimation, and which suits a head.
//! - [`settings`]: what comes out at the end, every value in range; `default`: what holds unsaid.
//! - `show`: settings written out again; `change`: what differs between two.

mod axes;
mod change;
mod check;
mod default;
mod endpoint;
mod error;
mod file;
mod findings;
mod merge;
mod method;
mod nearest;
mod raw;
mod section;
mod sensor;
pub mod settings;
mod show;
mod source;
mod validate;

pub use change::{Change, changes};
pub use error::{ConfigError, ConfigErrors};
pub use settings::Settings;

pub(crate) use nearest::nearest;
pub(crate) use source::{printable, quoted};

use source::{Place, Source};
use std::path::{Path, PathBuf};

/// A configuration that is right.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// What it says.
    pub settings: Settings,
    /// The files it came from: the configuration, then its drop-ins.
    pub files: Vec<PathBuf>,
    /// What is allowed but hardly meant, a sentence each.
    pub warnings: Vec<String>,
    /// All of it as TOML, defaults and drop-ins included; reading it gives the same settings.
    pub text: String,
}

/// Loads `path` and its drop-ins `<path>.d/*.toml`. The errors are all there are.
pub fn load(path: &Path) -> Result<Loaded, ConfigErrors> {
    build(&file::read_all(path)?, true)
}

/// Loads `path` and its drop-ins, and `text` as the last one of them, called `name`.
pub fn load_with(path: &Path, name: &Path, text: String) -> Result<Loaded, ConfigErrors> {
    let mut sources = file::read_all(path)?;
    sources.push(Source { name: name.into(), text });
    build(&sources, true)
}

/// Loads `path` for the replay of a recording: one without any `[[sensor]]` is right as well, and
/// means the six named ones.
pub fn load_for_replay(path: &Path) -> Result<Loaded, ConfigErrors> {
    build(&file::read_all(path)?, false)
}

/// What [`load`] does, given the files' names and texts: the configuration first, then its drop-ins.
pub fn parse(files: &[(PathBuf, String)]) -> Result<Loaded, ConfigErrors> {
    let sources: Vec<Source> =
        files.iter().map(|(name, text)| Source { name: name.clone(), text: text.clone() }).collect();
    build(&sources, true)
}

/// `settings` with `change` laid upon them as a drop-in: one that was right before is judged by the same rules. The
/// sensors stay as they are.
pub fn amend(settings: &Settings, change: &str) -> Result<Settings, ConfigErrors> {
    let source = |name: &str, text: String| Source { name: name.into(), text };
    let sources = [source("the settings in force", show::show(settings)), source("the change", change.to_owned())];
    // Written out, directions lose their last digits.
    let Settings { sensors, simulation, .. } = settings.clone();
    Ok(Settings { sensors, simulation, ..build(&sources, false)?.settings })
}

fn build(sources: &[Source], needs_sensors: bool) -> Result<Loaded, ConfigErrors> {
    let mut found = Vec::new();
    let mut root = raw::Table::new();
    for (i, source) in sources.iter().enumerate() {
        merge::merge(&mut root, raw::parse(source, i, &mut found));
    }
    error::check(found, sources)?;

    let findings = findings::Findings::new(sources);
    let (settings, sensors) = validate::validate(&root, &findings);
    if needs_sensors && sensors.complete && sensors.good.is_empty() && settings.simulation.is_none() {
        findings.add(
            Place::whole(0),
            format!(
                "no sensor is configured: add a [[sensor]] for each (the example {} has six), or try without any: \
                 enabled = true under [simulation]",
                file::EXAMPLE
            ),
        );
    }
    let lamp = raw::place(&root, &["faults", "lamp"]).unwrap_or_default();
    check::check(&settings, &sensors, lamp, &findings);
    if sensors.complete && !sensors.good.is_empty() {
        let said = raw::place(&root, &["estimator", "method"]);
        axes::check(&settings, &sensors, said, &findings);
    }
    error::check(findings.finish(), sources)?;
    let files = sources.iter().map(|s| s.name.clone()).collect();
    let warnings = check::warnings(&settings);
    Ok(Loaded { text: show::show(&settings), settings, files, warnings })
}
