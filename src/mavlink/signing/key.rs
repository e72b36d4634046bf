//! The signing key, out of its file: 32 bytes as they are, or 64 hexadecimal digits.

use std::fmt;
use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Bytes of a key.
const LEN: usize = 32;

/// A key that both sides hold. It never shows itself.
#[derive(Clone, PartialEq, Eq)]
pub struct Key([u8; LEN]);

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(…)")
    }
}

/// Why there is no key.
#[derive(Debug, Error)]
pub enum KeyError {
    /// The file cannot be read.
    #[error("the signing key {path} cannot be read: {source}; make one with: head -c 32 /dev/urandom > {path}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// It is a directory, a pipe or the like.
    #[error("the signing key {path} is not a regular file; name the file that holds it")]
    NoFile {
        /// The file.
        path: PathBuf,
    },
    /// Others may read it.
    #[error(
        "the signing key {path} is open to other users (mode {mode:03o}): chmod 600 {path}, and make a new key if \
         anybody may have read it"
    )]
    Open {
        /// The file.
        path: PathBuf,
        /// Its permissions.
        mode: u32,
    },
    /// It holds something else.
    #[error(
        "the signing key {path} holds neither 32 bytes nor 64 hexadecimal digits ({len} bytes); make one with: head -c \
         32 /dev/urandom > {path}"
    )]
    NoKey {
        /// The file.
        path: PathBuf,
        /// Its length, 66 for anything longer.
        len: usize,
    },
    /// It holds nothing but zeros.
    #[error(
        "the signing key {path} is all zeros, which anybody would guess; make one with: head -c 32 /dev/urandom > {path}"
    )]
    Zeros {
        /// The file.
        path: PathBuf,
    },
}

impl Key {
    /// The key of these bytes.
    pub const fn new(bytes: [u8; LEN]) -> Self {
        Self(bytes)
    }

    pub(super) const fn bytes(&self) -> &[u8; LEN] {
        &self.0
    }

    /// The key in the file `path`, which nobody but its owner may read.
    pub fn load(path: &Path) -> Result<Self, KeyError> {
        let read = |source| KeyError::Read { path: path.into(), source };
        // A pipe would block where it is opened, so look first, and again at what was opened.
        regular(path, &std::fs::metadata(path).map_err(read)?)?;
        let file = File::open(path).map_err(read)?;
        let meta = file.metadata().map_err(read)?;
        regular(path, &meta)?;
        let mode = meta.permissions().mode() & 0o777;
        if mode & 0o077 != 0 {
            return Err(KeyError::Open { path: path.into(), mode });
        }
        let mut bytes = Vec::with_capacity(2 * LEN + 2);
        // Enough to see that there is more than a key and the end of its line.
        file.take(2 * LEN as u64 + 2).read_to_end(&mut bytes).map_err(read)?;
        let key = parse(&bytes).ok_or_else(|| KeyError::NoKey { path: path.into(), len: bytes.len() })?;
        if key.0 == [0; LEN] { Err(KeyError::Zeros { path: path.into() }) } else { Ok(key) }
    }
}

fn regular(path: &Path, meta: &Metadata) -> Result<(), KeyError> {
    if meta.is_file() { Ok(()) } else { Err(KeyError::NoFile { path: path.into() }) }
}

fn parse(bytes: &[u8]) -> Option<Key> {
    if let Ok(key) = bytes.try_into() {
        return Some(Key(key));
    }
    let digits = bytes.strip_suffix(b"\n").unwrap_or(bytes);
    if digits.len() != 2 * LEN {
        return None;
    }
    let mut key = [0; LEN];
    for (byte, pair) in key.iter_mut().zip(digits.chunks_exact(2)) {
        let digit = |b: u8| char::from(b).to_digit(16);
        *byte = u8::try_from(digit(pair[0])? * 16 + digit(pair[1])?).ok()?;
    }
    Some(Key(key))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn load(name: &str, content: &[u8], mode: u32) -> Result<Key, KeyError> {
        let folder = std::env::temp_dir().join(format!("irhorizon-key-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("key");
        fs::write(&path, content).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        let key = Key::load(&path);
        fs::remove_dir_all(&folder).unwrap();
        key
    }

    #[test]
    fn bytes_and_digits_are_the_same_key() {
        let bytes: Vec<u8> = (1..=32).collect();
        let hex: String = bytes.iter().map(|b| format!("{b:02X}")).collect();
        let key = load("raw", &bytes, 0o600).unwrap();
        assert_eq!(key.bytes().as_slice(), bytes);
        assert_eq!(load("hex", hex.as_bytes(), 0o400).unwrap(), key);
        assert_eq!(load("line", format!("{}\n", hex.to_lowercase()).as_bytes(), 0o600).unwrap(), key);
        // 32 bytes are a key even if the last of them ends a line.
        let mut bytes = [b'a'; 32];
        bytes[31] = b'\n';
        assert_eq!(load("newline", &bytes, 0o600).unwrap(), Key(bytes));
    }

    #[test]
    fn a_key_that_others_may_read_is_none() {
        for mode in [0o640, 0o604, 0o660, 0o610] {
            let error = load(&format!("mode{mode:o}"), &[7; 32], mode).unwrap_err();
            assert!(error.to_string().contains(&format!("mode {mode:o}): chmod 600")), "{error}");
        }
    }

    #[test]
    fn what_is_no_key_is_told_with_the_next_step() {
        for (name, content) in [("empty", &[][..]), ("short", &[1; 31]), ("long", &[1; 80]), ("nohex", &[b'g'; 64])] {
            assert!(matches!(load(name, content, 0o600), Err(KeyError::NoKey { .. })), "{name}");
        }
        assert!(matches!(load("zeros", &[0; 32], 0o600), Err(KeyError::Zeros { .. })));
        assert!(matches!(load("zerohex", &[b'0'; 64], 0o600), Err(KeyError::Zeros { .. })));
        assert!(matches!(Key::load(Path::new("/nonexistent/key")), Err(KeyError::Read { .. })));
        assert!(matches!(Key::load(Path::new("/tmp")), Err(KeyError::NoFile { .. })));
        assert!(matches!(Key::load(Path::new("/dev/zero")), Err(KeyError::NoFile { .. })));
    }

    #[test]
    fn a_key_does_not_show_itself() {
        assert_eq!(format!("{:?}", Key([0x5a; 32])), "Key(…)");
    }
}
