//! Stamps of files, by which their changes are seen.
//!
//! Files are polled, not watched by the system: that works on network folders, too, and with editors that replace files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

/// The interval at which files are polled.
const POLL: Duration = Duration::from_millis(300);

/// The stamp of each file; `None` for one that is not there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stamps(BTreeMap<PathBuf, Option<Stamp>>);

/// The stamp of a file: length, time and identity, of which one is another after a change.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    /// The time of the last change.
    modified: SystemTime,
    length: u64,
    /// Device and number, which differ where a link leads elsewhere or a file has taken the place of another.
    file: [u64; 2],
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let found = std::fs::metadata(path).ok()?;
        #[cfg(unix)]
        let file = {
            use std::os::unix::fs::MetadataExt;
            [found.dev(), found.ino()]
        };
        #[cfg(not(unix))]
        let file = [0; 2];
        Some(Self { modified: found.modified().ok()?, length: found.len(), file })
    }
}

impl Stamps {
    /// Stamps of files as they are now.
    pub fn of<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        Self(paths.into_iter().map(|path| (path.clone(), Stamp::of(path))).collect())
    }

    /// Whether the files are no longer as they were.
    pub fn have_changed(&self) -> bool {
        *self != Self::of(self.0.keys())
    }

    /// Waits until a file has changed and whoever writes them seems to be done; returns the stamps as they are then. Returns
    /// `None` once `stopped`.
    pub fn wait(&self, stopped: &dyn Fn() -> bool) -> Option<Self> {
        loop {
            if stopped() {
                return None;
            }
            sleep(POLL);
            let mut now = Self::of(self.0.keys());
            if now == *self {
                continue;
            }
            loop {
                sleep(POLL / 3);
                let later = Self::of(self.0.keys());
                if later == now || stopped() {
                    return Some(later);
                }
                now = later;
            }
        }
    }

    /// The stamps of the files that were read: those that had one before keep it, so that a change while they were read
    /// counts.
    pub fn after_reading(mut self, paths: &[PathBuf]) -> Self {
        self.0.retain(|path, _| paths.contains(path));
        for (path, stamp) in Self::of(paths).0 {
            self.0.entry(path).or_insert(stamp);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_seen() {
        let folder = std::env::temp_dir().join(format!("lookfrom-stamps-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let [here, missing] = ["here", "missing"].map(|name| folder.join(name));
        std::fs::write(&here, "1").expect("a temporary file");
        let paths = [here.clone(), missing.clone()];
        let before = Stamps::of(&paths);
        assert!(!before.have_changed());
        std::fs::write(&missing, "2").expect("a temporary file");
        assert!(before.have_changed());
        let now = before.wait(&|| false).expect("nobody stops it");
        assert!(now != before && !now.have_changed());
        // A file that changes while the scene is read is read again.
        std::fs::write(&here, "longer").expect("a temporary file");
        assert!(now.after_reading(&paths).have_changed());
        assert_eq!(Stamps::of(&paths).wait(&|| true), None);

        // A link that leads to another file of the same length and time.
        #[cfg(unix)]
        {
            let link = folder.join("link");
            let moment = SystemTime::now();
            for path in &paths {
                std::fs::write(path, "same").expect("a temporary file");
                std::fs::File::options()
                    .write(true)
                    .open(path)
                    .unwrap()
                    .set_modified(moment)
                    .expect("a time");
            }
            std::os::unix::fs::symlink(&here, &link).expect("a link");
            let before = Stamps::of(std::slice::from_ref(&link));
            std::fs::remove_file(&link).expect("it is ours");
            std::os::unix::fs::symlink(&missing, &link).expect("a link");
            assert!(before.have_changed());
        }
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }
}
