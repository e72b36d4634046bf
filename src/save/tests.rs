use super::*;
use std::collections::BTreeMap;

type Names = BTreeMap<PathBuf, usize>;

/// A disk that forgets what was not made to last, when its power is cut. Names are kept in the order in which
/// they were changed, and any number of the last changes may be lost.
#[derive(Clone, Default)]
struct Frail {
    /// The bytes of each file, and whether they last.
    files: Vec<(Vec<u8>, bool)>,
    /// The folder now, and all its states since it was last made to last.
    states: Vec<Names>,
    /// So many steps more until the power is cut.
    left: usize,
}

impl Frail {
    fn with(path: &Path, bytes: &[u8]) -> Self {
        let names = Names::from([(path.to_owned(), 0)]);
        Self { files: vec![(bytes.to_vec(), true)], states: vec![names], left: usize::MAX }
    }

    fn empty() -> Self {
        Self { states: vec![Names::new()], left: usize::MAX, ..Self::default() }
    }

    fn step(&mut self) -> io::Result<()> {
        self.left = self.left.checked_sub(1).ok_or_else(|| io::Error::other("power cut"))?;
        Ok(())
    }

    fn names(&self) -> Names {
        self.states.last().cloned().unwrap_or_default()
    }

    /// What a reader may find under `path` after a power cut now: bytes that were not made to last are torn.
    fn after_a_cut(&self, path: &Path) -> Vec<Option<Vec<u8>>> {
        let torn = |i: &usize| match &self.files[*i] {
            (bytes, true) => bytes.clone(),
            (bytes, false) => bytes[..bytes.len() / 2].to_vec(),
        };
        self.states.iter().map(|names| names.get(path).map(torn)).collect()
    }
}

impl Disk for Frail {
    fn read(&mut self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        self.step()?;
        Ok(self.names().get(path).map(|i| self.files[*i].0.clone()))
    }

    fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        // In two steps: there, and filled.
        self.step()?;
        self.files.push((Vec::new(), false));
        let mut names = self.names();
        names.insert(path.to_owned(), self.files.len() - 1);
        self.states.push(names);
        self.step()?;
        if let Some(file) = self.files.last_mut() {
            file.0 = bytes.to_vec();
        }
        Ok(())
    }

    fn sync(&mut self, path: &Path) -> io::Result<()> {
        self.step()?;
        let index = self.names()[path];
        self.files[index].1 = true;
        Ok(())
    }

    fn rename(&mut self, from: &Path, to: &Path) -> io::Result<()> {
        self.step()?;
        let mut names = self.names();
        let file = names.remove(from).ok_or(ErrorKind::NotFound)?;
        names.insert(to.to_owned(), file);
        self.states.push(names);
        Ok(())
    }

    fn remove(&mut self, path: &Path) -> io::Result<()> {
        self.step()?;
        let mut names = self.names();
        names.remove(path);
        self.states.push(names);
        Ok(())
    }

    fn sync_folder(&mut self, _: &Path) -> io::Result<()> {
        self.step()?;
        self.states = vec![self.names()];
        Ok(())
    }
}

/// Cuts the power before each step of `act`, and asks that only `allowed` is ever found under `path`.
fn cut_everywhere(start: &Frail, act: fn(&mut dyn Disk, &Path) -> io::Result<()>, allowed: &[Option<&[u8]>]) {
    let path = Path::new("d/50-trim.toml");
    let mut steps = 0;
    loop {
        let mut disk = Frail { left: steps, ..start.clone() };
        let outcome = act(&mut disk, path);
        for found in disk.after_a_cut(path) {
            assert!(allowed.contains(&found.as_deref()), "after {steps} steps: {found:?}");
        }
        if outcome.is_ok() {
            assert!(steps >= 3, "{steps}");
            assert_eq!(disk.after_a_cut(path).len(), 1, "it lasts");
            return;
        }
        steps += 1;
    }
}

const OLD: &[u8] = b"[head]\nroll-trim-deg = 1.00\n";
const NEW: &[u8] = b"[head]\nroll-trim-deg = -2.50\n";

fn path() -> &'static Path {
    Path::new("d/50-trim.toml")
}

#[test]
fn a_power_cut_leaves_the_old_or_the_new_one_whole() {
    let save = |disk: &mut dyn Disk, path: &Path| replace_and_keep(disk, path, NEW);
    cut_everywhere(&Frail::with(path(), OLD), save, &[Some(OLD), Some(NEW)]);
    cut_everywhere(&Frail::empty(), save, &[None, Some(NEW)]);
}

#[test]
fn a_power_cut_while_undoing_leaves_one_of_them_whole() {
    let undo = |disk: &mut dyn Disk, path: &Path| undo(disk, path).map(drop);
    let mut disk = Frail::with(path(), OLD);
    replace_and_keep(&mut disk, path(), NEW).unwrap();
    cut_everywhere(&disk, undo, &[Some(OLD), Some(NEW)]);
    let mut disk = Frail::empty();
    replace_and_keep(&mut disk, path(), NEW).unwrap();
    cut_everywhere(&disk, undo, &[None, Some(NEW)]);
}

/// The test has teeth: without making bytes last first, torn ones are found.
#[test]
#[should_panic(expected = "after")]
fn a_careless_save_is_caught() {
    let careless = |disk: &mut dyn Disk, path: &Path| {
        disk.write(&beside(path, "new"), NEW)?;
        disk.rename(&beside(path, "new"), path)?;
        disk.sync_folder(folder(path))
    };
    cut_everywhere(&Frail::with(path(), OLD), careless, &[Some(OLD), Some(NEW)]);
}

#[test]
fn undoing_brings_back_what_was_there() {
    for start in [Frail::with(path(), OLD), Frail::empty()] {
        let mut disk = start;
        let before = disk.read(path()).unwrap();
        assert_eq!(undo(&mut disk, path()).unwrap(), Undone::Nothing);
        replace_and_keep(&mut disk, path(), NEW).unwrap();
        assert_eq!(disk.read(path()).unwrap().as_deref(), Some(NEW));
        let expected = if before.is_some() { Undone::Restored } else { Undone::Removed };
        assert_eq!(undo(&mut disk, path()).unwrap(), expected);
        assert_eq!(disk.read(path()).unwrap(), before);
        assert_eq!(undo(&mut disk, path()).unwrap(), Undone::Nothing);
        assert_eq!(disk.read(path()).unwrap(), before);
    }
}

#[test]
fn real_files_are_saved_and_brought_back() {
    let folder = std::env::temp_dir().join(format!("irhorizon-save-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (path, mut disk) = (folder.join("50-trim.toml"), FileSystem);
    replace_and_keep(&mut disk, &path, OLD).unwrap();
    replace_and_keep(&mut disk, &path, NEW).unwrap();
    assert_eq!(fs::read(&path).unwrap(), NEW);
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o644);
    assert_eq!(undo(&mut disk, &path).unwrap(), Undone::Restored);
    assert_eq!(fs::read(&path).unwrap(), OLD);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing is left beside it");
    disk.remove(&path).unwrap();
    disk.remove(&path).unwrap();
    assert!(replace(&mut disk, &folder.join("none/a.toml"), NEW).is_err());
    fs::remove_dir_all(folder).unwrap();
}

/// A daemon that may not list its drop-ins does not start.
#[test]
fn a_folder_of_drop_ins_is_for_everybody_to_read() {
    let folder = std::env::temp_dir().join(format!("irhorizon-drop-ins-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("irhorizon.toml.d/50-trim.toml");
    let mask = rustix::process::umask(rustix::fs::Mode::from_raw_mode(0o077));
    let made = make_drop_ins(&path);
    rustix::process::umask(mask);
    assert!(made.unwrap());
    let mode = || fs::metadata(path.parent().unwrap()).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(), 0o755);
    drop_in_can_be_saved(&mut FileSystem, &path).unwrap();
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 0, "nothing is left");
    // One that is there is somebody's own, and no other is made.
    fs::set_permissions(path.parent().unwrap(), Permissions::from_mode(0o750)).unwrap();
    assert!(!make_drop_ins(&path).unwrap());
    assert_eq!(mode(), 0o750);
    fs::remove_dir(path.parent().unwrap()).unwrap();
    drop_in_can_be_saved(&mut FileSystem, &path).unwrap();
    assert!(!path.parent().unwrap().exists(), "nothing is left");
    let other = folder.join("mistyped/50-trim.toml");
    assert!(drop_in_can_be_saved(&mut FileSystem, &other).is_err());
    fs::remove_dir_all(folder).unwrap();
}
