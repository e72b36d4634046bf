//! Texts compared whole with what a file holds; `UPDATE_GOLDEN=1` writes the files anew.

use std::fs;
use std::path::Path;

/// What differs from the file `path`, below the crate's root; `None` where nothing does.
pub fn difference(path: impl AsRef<Path>, text: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&path, text).unwrap();
    }
    let before = fs::read_to_string(&path).unwrap_or_default();
    (before != text).then(|| format!("{} was\n{before}\nand is now\n{text}", path.display()))
}
