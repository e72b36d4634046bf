//! Small files saved so that at any moment, power cuts included, the old one or the new one is there whole;
//! what was there before is kept for one undo.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

/// The folder for what the daemon keeps: that of systemd's `StateDirectory=`, where it runs under systemd.
pub fn state_folder() -> Option<PathBuf> {
    std::env::var_os("STATE_DIRECTORY").filter(|f| !f.is_empty()).map(PathBuf::from)
}

/// The steps that saving is made of. A power cut may come between any two.
pub trait Disk {
    /// The whole file; `None` where there is none.
    fn read(&mut self, path: &Path) -> io::Result<Option<Vec<u8>>>;

    /// A file with these bytes, in place of any that is there. It does not last yet.
    fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Makes a file's bytes last.
    fn sync(&mut self, path: &Path) -> io::Result<()>;

    /// Gives a file another name, in place of any that has it. It does not last yet.
    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()>;

    /// Takes a file away; none is no error. It does not last yet.
    fn remove(&mut self, path: &Path) -> io::Result<()>;

    /// Makes a folder's names last.
    fn sync_folder(&mut self, folder: &Path) -> io::Result<()>;
}

/// What undoing has brought back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undone {
    /// The file that was there before.
    Restored,
    /// There was none before; it is gone.
    Removed,
    /// Nothing is kept to be brought back.
    Nothing,
}

/// Saves `bytes` as `path`.
pub fn replace(disk: &mut dyn Disk, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let new = beside(path, "new");
    disk.write(&new, bytes)?;
    disk.sync(&new)?;
    disk.rename(&new, path)?;
    disk.sync_folder(folder(path))
}

/// Saves `bytes` as `path` and keeps what was there; that there was none is kept as an empty file.
pub fn replace_and_keep(disk: &mut dyn Disk, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let before = disk.read(path)?.unwrap_or_default();
    replace(disk, &beside(path, "old"), &before)?;
    replace(disk, path, bytes)
}

/// Brings back what was there before.
pub fn undo(disk: &mut dyn Disk, path: &Path) -> io::Result<Undone> {
    let kept = beside(path, "old");
    let undone = match disk.read(&kept)? {
        None => return Ok(Undone::Nothing),
        Some(bytes) if bytes.is_empty() => {
            disk.remove(path)?;
            disk.sync_folder(folder(path))?;
            disk.remove(&kept)?;
            Undone::Removed
        }
        Some(_) => {
            disk.rename(&kept, path)?;
            Undone::Restored
        }
    };
    disk.sync_folder(folder(path))?;
    Ok(undone)
}

/// Makes the folder of drop-ins that `path` lies in, `FILE.toml.d`, where there is none: to be read by everybody, whatever
/// the mask of whoever makes it. Tells whether there was none.
pub fn make_drop_ins(path: &Path) -> io::Result<bool> {
    let folder = folder(path);
    if !folder.as_os_str().as_encoded_bytes().ends_with(b".toml.d") {
        return Ok(false);
    }
    match fs::create_dir(folder) {
        Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(false),
        made => made.and_then(|()| fs::set_permissions(folder, Permissions::from_mode(0o755))).map(|()| true),
    }
}

/// Whether a drop-in can be saved as `path`, whose folder may be missing yet. Leaves no folder that was not there.
pub fn drop_in_can_be_saved(disk: &mut dyn Disk, path: &Path) -> io::Result<()> {
    let made = make_drop_ins(path)?;
    let can = can_be_saved(disk, path);
    let gone = if made { fs::remove_dir(folder(path)) } else { Ok(()) };
    can.and(gone)
}

/// Whether a file can be saved as `path`: its folder may be written.
fn can_be_saved(disk: &mut dyn Disk, path: &Path) -> io::Result<()> {
    let new = beside(path, "new");
    disk.write(&new, b"")?;
    disk.remove(&new)
}

/// `.50-trim.toml.old` beside `50-trim.toml`: hidden, so that no configuration is read from it.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{ending}"))
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The real one. Files may be read by everybody, as the daemon has a user of its own.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileSystem;

impl Disk for FileSystem {
    fn read(&mut self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        match fs::read(path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
            Err(e) => Err(e),
        }
    }

    fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(path)?;
        file.set_permissions(Permissions::from_mode(0o644))?;
        file.write_all(bytes)
    }

    fn sync(&mut self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }

    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&mut self, path: &Path) -> io::Result<()> {
        match fs::remove_file(path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(e),
            _ => Ok(()),
        }
    }

    fn sync_folder(&mut self, folder: &Path) -> io::Result<()> {
        File::open(folder)?.sync_all()
    }
}

#[cfg(test)]
mod tests;
