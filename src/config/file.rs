//! Reads the configuration's files: bounded, and only text.

use super::error::{ConfigError, ConfigErrors};
use super::source::{Place, Source};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// The largest file that is read, bytes.
const LARGEST: u64 = 1024 * 1024;
/// Where the commented example is installed.
pub const EXAMPLE: &str = "/usr/share/irhorizon/irhorizon.toml";

/// Reads `path` and the drop-ins `<path>.d/*.toml`, in the order of their names.
pub fn read_all(path: &Path) -> Result<Vec<Source>, ConfigErrors> {
    let main = read(path)?;
    let mut sources = vec![main];
    let mut errors = Vec::new();
    match drop_ins(path) {
        Err(e) => errors.push(e),
        Ok(paths) => {
            for path in paths {
                match read(&path) {
                    Ok(source) => sources.push(source),
                    Err(e) => errors.push(e),
                }
            }
        }
    }
    if errors.is_empty() { Ok(sources) } else { Err(ConfigErrors { errors, more: 0 }) }
}

fn drop_ins(path: &Path) -> Result<Vec<PathBuf>, ConfigError> {
    let mut folder = path.as_os_str().to_owned();
    folder.push(".d");
    let folder = PathBuf::from(folder);
    let failed = |e: std::io::Error| {
        let next =
            if e.kind() == ErrorKind::PermissionDenied { "; see its permissions (ls -ld, chmod 755)" } else { "" };
        ConfigError::whole(&folder, format!("cannot list the drop-ins: {e}{next}"))
    };
    let entries = match std::fs::read_dir(&folder) {
        Ok(entries) => entries,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(failed(e)),
    };
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        let hidden = path.file_name().is_some_and(|n| n.as_encoded_bytes().starts_with(b"."));
        if !hidden && path.extension().is_some_and(|e| e == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<Source, ConfigError> {
    let failed = |e: std::io::Error| {
        ConfigError::whole(
            path,
            match e.kind() {
                ErrorKind::NotFound => format!(
                    "there is no such file. Copy the example {EXAMPLE} there and fit it to your sensors, or name \
                     another file with --config"
                ),
                ErrorKind::PermissionDenied => {
                    "may not be read by this user: see its permissions (ls -l), or name another file with --config"
                        .into()
                }
                _ => format!("cannot be read: {e}"),
            },
        )
    };
    // A pipe would block where it is opened, so look first.
    let kind = std::fs::metadata(path).map_err(failed)?;
    if kind.is_dir() {
        return Err(ConfigError::whole(path, "is a directory: name the file in it"));
    }
    if !kind.is_file() {
        return Err(ConfigError::whole(path, "is not a regular file"));
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|f| f.take(LARGEST + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > LARGEST {
        return Err(ConfigError::whole(path, "is larger than 1 MiB: is it a configuration at all?"));
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Source { name: path.into(), text }),
        Err(e) => {
            let start = e.utf8_error().valid_up_to();
            let byte = e.as_bytes().get(start).copied().unwrap_or_default();
            let text = String::from_utf8_lossy(e.as_bytes()).into_owned();
            let message = format!("this is not UTF-8 text: it holds a byte {byte:#04x}. Save the file as UTF-8");
            Err(ConfigError::at(&Source { name: path.into(), text }, Place { file: 0, start, end: start }, message))
        }
    }
}
