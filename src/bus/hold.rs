//! Who drives a bus: one program at a time. Two that read one ADS1115 would take each other's channels for their own.

use super::BusError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What this process holds. A lock belongs to an open file, so that a second one of the same process would be locked out.
static HELD: Mutex<Vec<Held>> = Mutex::new(Vec::new());

struct Held {
    node: (u64, u64),
    /// Open, and so locked.
    _file: File,
    holds: usize,
}

/// A bus held against other programs, by an advisory lock on its device file, until all of this process's holds of it are
/// dropped.
#[derive(Debug)]
pub struct Hold {
    node: (u64, u64),
}

impl Hold {
    /// Holds `bus`, by whichever of its names. Fails at once with [`BusError::InUse`] where another program holds it.
    pub fn take(bus: &Path) -> Result<Self, BusError> {
        let other = |e: io::Error| BusError::Other(e.raw_os_error().unwrap_or(0));
        let file = OpenOptions::new().read(true).write(true).open(bus).map_err(other)?;
        let data = file.metadata().map_err(other)?;
        let node = (data.dev(), data.ino());
        let mut held = held();
        if let Some(held) = held.iter_mut().find(|h| h.node == node) {
            held.holds += 1;
            return Ok(Self { node });
        }
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(BusError::InUse),
            // A kernel without locks is no reason not to fly.
            Ok(()) | Err(TryLockError::Error(_)) => held.push(Held { node, _file: file, holds: 1 }),
        }
        Ok(Self { node })
    }
}

impl Drop for Hold {
    fn drop(&mut self) {
        held().retain_mut(|h| {
            h.holds -= usize::from(h.node == self.node);
            h.holds > 0
        });
    }
}

fn held() -> MutexGuard<'static, Vec<Held>> {
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn one_program_holds_a_bus_as_often_as_it_likes_and_no_other() {
        let folder = std::env::temp_dir().join(format!("irhorizon-hold-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let [bus, alias, beside] = ["i2c-1", "i2c-head", "i2c-2"].map(|name| folder.join(name));
        fs::write(&bus, "").unwrap();
        fs::write(&beside, "").unwrap();
        symlink("i2c-1", &alias).unwrap();
        // What another program has: an open file that is not of this list.
        let other = OpenOptions::new().write(true).open(&bus).unwrap();
        let locked_out = || matches!(other.try_lock(), Err(TryLockError::WouldBlock));

        let first = Hold::take(&bus).unwrap();
        let second = Hold::take(&alias).unwrap();
        assert!(locked_out());
        drop(first);
        assert!(locked_out(), "one hold is left");
        drop(second);
        assert!(!locked_out());

        assert_eq!(Hold::take(&bus).err(), Some(BusError::InUse));
        assert_eq!(Hold::take(&alias).err(), Some(BusError::InUse));
        drop(Hold::take(&beside).unwrap());
        other.unlock().unwrap();
        let again = Hold::take(&bus).unwrap();
        assert!(locked_out());
        drop(again);

        // Unplugged and plugged in again while it is held: another node of the same name.
        let old = Hold::take(&bus).unwrap();
        fs::rename(&bus, folder.join("gone")).unwrap();
        fs::write(&bus, "").unwrap();
        let new = OpenOptions::new().write(true).open(&bus).unwrap();
        new.try_lock().unwrap();
        assert_eq!(Hold::take(&bus).err(), Some(BusError::InUse));
        drop(old);
        fs::remove_dir_all(folder).unwrap();
    }
}
