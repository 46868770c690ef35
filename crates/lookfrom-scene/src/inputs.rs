//! A record of the files that were read for each scene, so that no output overwrites an input.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::Result;
use crate::files::{FileId, Files};

/// A requested file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its path, as it was requested.
    pub path: PathBuf,
    /// The first reader: a scene, by the name of its file, or another input.
    pub reader: String,
}

/// All requested files, and the files that were written meanwhile.
#[derive(Debug, Default)]
pub struct Inputs(Mutex<Register>);

#[derive(Debug, Default)]
struct Register {
    read: HashMap<FileId, Input>,
    written: HashSet<FileId>,
    /// Files that were read after they had been written.
    own_outputs: Vec<Input>,
}

impl Inputs {
    /// Wraps `files` so that every file requested by `reader` is recorded, found or not.
    pub fn record<'a>(&'a self, files: &'a dyn Files, reader: impl Into<String>) -> Recorded<'a> {
        Recorded { files, reader: reader.into(), inputs: self }
    }

    /// The paths of all requested files, found or not, as they were requested; sorted.
    pub fn paths(&self) -> Vec<PathBuf> {
        let paths: BTreeSet<PathBuf> =
            self.register().read.values().map(|input| input.path.clone()).collect();
        paths.into_iter().collect()
    }

    /// The input that would be overwritten by writing to `path`, whatever path it was read from.
    pub fn at(&self, path: &Path, files: &dyn Files) -> Option<Input> {
        let identities = files.identities(path);
        let register = self.register();
        identities.iter().find_map(|identity| {
            let input = register.read.get(identity)?;
            // Inode numbers of deleted files are reused.
            let is_still =
                matches!(identity, FileId::Path(_)) || files.identities(&input.path).contains(identity);
            is_still.then(|| input.clone())
        })
    }

    /// Records that `path` was written to.
    pub fn note_output(&self, path: &Path, files: &dyn Files) {
        // Not by its inode number: the next output replaces the file, and another file may get the number.
        let identities = files.identities(path).into_iter();
        let paths = identities.filter(|identity| matches!(identity, FileId::Path(_)));
        self.register().written.extend(paths);
    }

    /// A file read by `reader` that had been written before.
    pub fn own_output(&self, reader: &str) -> Option<Input> {
        self.register().own_outputs.iter().find(|input| input.reader == reader).cloned()
    }

    /// Adds a file that `reader` will read, before it does.
    pub fn note_input(&self, path: &Path, reader: &str, files: &dyn Files) {
        let identities = files.identities(path);
        let mut register = self.register();
        let input = || Input { path: path.to_owned(), reader: reader.to_owned() };
        if identities.iter().any(|identity| register.written.contains(identity)) {
            register.own_outputs.push(input());
        }
        for identity in identities {
            register.read.entry(identity).or_insert_with(input);
        }
    }

    fn register(&self) -> MutexGuard<'_, Register> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Files whose requests are recorded.
pub struct Recorded<'a> {
    files: &'a dyn Files,
    reader: String,
    inputs: &'a Inputs,
}

impl Files for Recorded<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        self.inputs.note_input(path, &self.reader, self.files);
        self.files.read(path, limit)
    }

    fn length(&self, path: &Path) -> Option<u64> {
        self.files.length(path)
    }

    fn identities(&self, path: &Path) -> Vec<FileId> {
        self.files.identities(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Memory;
    use crate::{Disk, LoadContext};

    #[test]
    fn what_is_asked_for_is_on_record_with_the_first_who_asked() {
        let memory = Memory([(PathBuf::from("a"), vec![1])].into());
        let inputs = Inputs::default();
        for reader in ["first", "second"] {
            let files = inputs.record(&memory, reader);
            let context = LoadContext::new(&files);
            assert_eq!(*context.read(Path::new("a")).expect("it is there"), [1]);
            assert!(context.read(Path::new("missing")).is_err());
        }
        let reader = |path: &str| inputs.at(Path::new(path), &memory).map(|input| input.reader);
        assert_eq!((reader("a"), reader("missing")), (Some("first".into()), Some("first".into())));
        assert_eq!(reader("other"), None);
        assert_eq!(inputs.paths(), [PathBuf::from("a"), "missing".into()]);
    }

    #[test]
    fn own_outputs_are_told_from_others() {
        let memory = Memory::default();
        let inputs = Inputs::default();
        let read = |path: &str, reader: &str| {
            // The file does not exist, which does not matter.
            let _ = LoadContext::new(&inputs.record(&memory, reader)).read(Path::new(path));
        };
        read("p", "before");
        inputs.note_output(Path::new("p"), &memory);
        read("q", "other");
        assert_eq!((inputs.own_output("before"), inputs.own_output("other")), (None, None));
        read("p", "other");
        assert_eq!(inputs.own_output("other").map(|input| input.path), Some("p".into()));
    }

    /// Files with the inode numbers that the test sets.
    struct Numbers(Mutex<HashMap<PathBuf, u64>>);

    impl Files for Numbers {
        fn read(&self, _: &Path, _: u64) -> Result<Vec<u8>> {
            Ok(Vec::new())
        }

        fn identities(&self, path: &Path) -> Vec<FileId> {
            let numbers = self.0.lock().expect("nobody panics");
            let number = numbers.get(path).map(|&file| FileId::Number { device: 0, file });
            [FileId::Path(path.to_owned())].into_iter().chain(number).collect()
        }
    }

    #[test]
    fn a_number_that_was_given_to_another_file_is_no_identity() {
        let files = Numbers(Mutex::new([("a".into(), 1), ("hard".into(), 1)].into()));
        let inputs = Inputs::default();
        assert!(LoadContext::new(&inputs.record(&files, "scene")).read(Path::new("a")).is_ok());
        assert!(inputs.at(Path::new("hard"), &files).is_some());
        // `a` is replaced by an editor, and its old number is reused for the next file.
        *files.0.lock().expect("nobody panics") = [("a".into(), 2), ("p".into(), 1)].into();
        assert!(inputs.at(Path::new("p"), &files).is_none() && inputs.at(Path::new("a"), &files).is_some());
    }

    #[test]
    fn a_file_has_one_identity_by_any_path() {
        let folder = std::env::temp_dir().join(format!("lookfrom-inputs-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("sub")).expect("a temporary folder");
        std::fs::write(folder.join("a.png"), b"a").expect("a temporary file");
        let mut same = vec!["a.png", "./a.png", "sub/../a.png", "sub/./.././a.png"];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../a.png", folder.join("sub/link.png")).expect("a link");
            std::os::unix::fs::symlink("sub", folder.join("folder")).expect("a link");
            std::fs::hard_link(folder.join("a.png"), folder.join("hard.png")).expect("a link");
            same.extend(["sub/link.png", "folder/link.png", "folder/../a.png", "hard.png"]);
        }
        let share = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|path| Disk.identities(&folder.join(path)));
            a.iter().any(|identity| b.contains(identity))
        };
        for other in same {
            assert!(share("a.png", other), "{other}");
        }
        for other in ["b.png", "sub", "sub/a.png"] {
            assert!(!share("a.png", other), "{other}");
        }
        // Files that do not exist have identities, too.
        assert!(share("new/b.png", "sub/../new/x/../b.png") && !share("new/b.png", "b.png"));
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }
}
