//! Output files and their formats. Targets are checked before anything is rendered; files are replaced atomically, and input
//! files are never overwritten.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Cursor, ErrorKind, Seek, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use lookfrom::session::{Format, Series};
use lookfrom_scene::{Disk, Inputs};

use crate::exit::Failure;

/// A writer of pictures.
pub(crate) trait Out: Write + Seek {}

impl<T: Write + Seek> Out for T {}

/// Target of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// Stdout.
    Stdout(Format),
    /// A file.
    File(PathBuf, Format),
}

impl Target {
    /// Its name in messages and summaries.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Stdout(_) => "-".to_owned(),
            Self::File(path, _) => path.display().to_string(),
        }
    }

    /// The folder of the file; the current one for stdout.
    pub(crate) fn folder(&self) -> &Path {
        match self {
            Self::Stdout(_) => Path::new("."),
            Self::File(path, _) => folder_or_here(path.parent()),
        }
    }

    /// Target of a picture of several of the same scene: its number in place of `###`, or else NAME-LABEL.png for NAME.png.
    pub(crate) fn of_series(&self, series: &Series, index: usize) -> Self {
        let (Self::File(path, format), Some(label)) = (self, series.label(index)) else {
            return self.clone();
        };
        if let Some((name, marks, least)) = number_marks(path) {
            let [number, last] = series.number(index);
            let digits = least.max(last.to_string().len());
            let name = format!("{}{number:0digits$}{}", &name[..marks.start], &name[marks.end..]);
            return Self::File(path.with_file_name(name), *format);
        }
        let mut name = path.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{label}."));
        name.push(path.extension().unwrap_or_default());
        Self::File(path.with_file_name(name), *format)
    }

    /// Whether its name has a place for a number, `###`.
    pub(crate) fn has_number(&self) -> bool {
        matches!(self, Self::File(path, _) if number_marks(path).is_some())
    }

    /// Whether it is the file at a path.
    pub(crate) fn is(&self, other: &Path) -> bool {
        matches!(self, Self::File(path, _) if path == other)
    }

    /// The failure that its format cannot hold the picture.
    pub(crate) fn cannot_encode(&self, error: &lookfrom_scene::Error) -> Failure {
        Failure::Output(format!("{}: {}", self.name(), error.message))
    }

    /// The format of the picture.
    pub(crate) fn format(&self) -> Format {
        match self {
            Self::Stdout(format) | Self::File(_, format) => *format,
        }
    }

    /// Whether it is stdout.
    pub(crate) fn is_stdout(&self) -> bool {
        matches!(self, Self::Stdout(_))
    }

    /// The target with a picture of another format.
    pub(crate) fn of_format(self, format: Format) -> Self {
        match self {
            Self::Stdout(_) => Self::Stdout(format),
            Self::File(path, _) => Self::File(path, format),
        }
    }

    /// Whether the file already exists.
    pub(crate) fn exists(&self) -> bool {
        matches!(self, Self::File(path, _) if path.exists())
    }

    /// Refuses to overwrite a file that was read.
    ///
    /// # Errors
    /// `Output` where this target is such a file.
    pub(crate) fn keep_inputs(&self, inputs: &Inputs) -> Result<(), Failure> {
        match self {
            Self::Stdout(_) => Ok(()),
            Self::File(path, _) => keep_inputs(path, inputs, "-o"),
        }
    }

    /// Writes the bytes of a picture.
    ///
    /// # Errors
    /// `Output` where that fails or would overwrite an input; an existing file then stays as it was.
    pub(crate) fn write(&self, bytes: &[u8], inputs: &Inputs) -> Result<(), Failure> {
        match self {
            Self::Stdout(_) => write_stdout(bytes).map_err(|error| unwritten(&error)),
            Self::File(path, _) => replace_file(path, bytes, inputs, "-o"),
        }
    }

    /// As [`write`](Self::write), of a finished picture: where it cannot be written, it is kept elsewhere, as the error says.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn write_finished(&self, bytes: &[u8], inputs: &Inputs) -> Result<(), Failure> {
        let written = match self {
            // Who reads no further does not want it.
            Self::Stdout(_) => match write_stdout(bytes) {
                Err(error) if error.kind() == ErrorKind::BrokenPipe => return Err(unwritten(&error)),
                written => written.map_err(|error| unwritten(&error)),
            },
            Self::File(..) => self.write(bytes, inputs),
        };
        written.or_else(|failure| {
            rescue(self, failure, |file| file.write_all(bytes).map_err(|error| error.to_string()))
        })
    }

    /// Writes a picture by a function: a finished one is kept elsewhere where it cannot be written, as [`write_finished`](Self::write_finished)
    /// does.
    ///
    /// # Errors
    /// As [`write`](Self::write), and where the format cannot hold the picture.
    pub(crate) fn write_by(
        &self,
        inputs: &Inputs,
        write: &dyn Fn(&mut dyn Out) -> lookfrom_scene::Result<()>,
    ) -> Result<(), Failure> {
        let Self::File(path, _) = self else {
            let mut bytes = Cursor::new(Vec::new());
            write(&mut bytes).map_err(|error| self.cannot_encode(&error))?;
            return self.write_finished(bytes.get_ref(), inputs);
        };
        let refusal = RefCell::new(None);
        let write = |file: &mut BufWriter<File>| {
            write(file).map_err(|error| {
                let message = error.message.clone();
                if error.kind != lookfrom_scene::ErrorKind::Io {
                    refusal.replace(Some(error));
                }
                message
            })
        };
        let written = replace_file_by(path, inputs, "-o", write);
        match (written, refusal.take()) {
            (Ok(()), _) => Ok(()),
            (Err(_), Some(error)) => Err(self.cannot_encode(&error)),
            (Err(failure), None) => rescue(self, failure, write),
        }
    }

    /// Checks, as far as possible, that the picture can be written. Missing folders are created only when there is a picture.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let Self::File(path, _) = self else { return Ok(()) };
        let wrong = |message: String| Err(Failure::Output(message));
        if path.is_dir() {
            return wrong(format!("cannot write {}: it is a folder", path.display()));
        }
        if is_stream(path) {
            return Ok(());
        }
        let mut folders = path.ancestors().skip(1).map(|folder| folder_or_here(Some(folder)));
        let folder = folders.find(|folder| folder.exists()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return wrong(format!("cannot write {}: {} is not a folder", path.display(), folder.display()));
        }
        // Permissions, full disks, read-only disks: trying is the only way to know.
        let trial = folder.join(partial(path));
        if let Err(error) = File::create(&trial).and_then(|_| fs::remove_file(&trial)) {
            return wrong(format!("cannot write into the folder {}: {error}", folder.display()));
        }
        tidy(folder);
        Ok(())
    }
}

fn write_stdout(bytes: &[u8]) -> io::Result<()> {
    io::stdout().write_all(bytes).and_then(|()| io::stdout().flush())
}

/// The failure of stdout.
fn unwritten(error: &io::Error) -> Failure {
    Failure::Output(format!("cannot write -: {error}"))
}

/// The name of a file, where the number of a picture goes in it, and its digits at least: the first `#` and those that follow, or `%04d`, as
/// video encoders name the same pictures.
fn number_marks(path: &Path) -> Option<(&str, Range<usize>, usize)> {
    let name = path.file_name()?.to_str()?;
    if let Some(start) = name.find('#') {
        let end = name[start..].find(|c| c != '#').map_or(name.len(), |length| start + length);
        return Some((name, start..end, end - start));
    }
    name.match_indices("%0").find_map(|(start, _)| match name.as_bytes()[start + 2..] {
        [digit @ b'1'..=b'9', b'd', ..] => Some((name, start..start + 4, usize::from(digit - b'0'))),
        _ => None,
    })
}

/// Refuses to overwrite a file that was read. The error names `option` as the way to give another name.
///
/// # Errors
/// `Output` where `path` leads to such a file.
pub(crate) fn keep_inputs(path: &Path, inputs: &Inputs, option: &str) -> Result<(), Failure> {
    let Some(input) = inputs.at(path, &Disk) else { return Ok(()) };
    let name = input.path.display().to_string();
    let what = match input.reader {
        reader if reader == name => "the scene itself".to_owned(),
        reader => format!("an input of {reader}"),
    };
    let spelled = if input.path == path { String::new() } else { format!(", under the name {name}") };
    let extension = path.extension().unwrap_or_default().display();
    Err(Failure::Output(format!(
        "cannot write {}: it is {what}{spelled}\n  help: give the output another name: {option} other.{extension}",
        path.display(),
    )))
}

/// Writes a temporary file beside `path` and renames it to `path`. Missing folders are created. A symbolic link to a file stays,
/// and so do the permissions of what is replaced. A pipe or a device gets the bytes.
///
/// # Errors
/// `Output` where it cannot be written or would overwrite an input; `option` as for [`keep_inputs`].
pub(crate) fn replace_file(path: &Path, bytes: &[u8], inputs: &Inputs, option: &str) -> Result<(), Failure> {
    replace_file_by(path, inputs, option, |file| {
        file.write_all(bytes).map_err(|error| error.to_string())?;
        Ok(())
    })
}

/// As [`replace_file`], with a function that writes the temporary file; its error is text. At any moment, the file at
/// `path` is the old one or the new one, whole.
///
/// # Errors
/// As [`replace_file`].
pub(crate) fn replace_file_by(
    path: &Path,
    inputs: &Inputs,
    option: &str,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), String>,
) -> Result<(), Failure> {
    keep_inputs(path, inputs, option)?;
    let linked = fs::canonicalize(path).ok().filter(|target| target.is_file());
    let target = linked.as_deref().unwrap_or(path);
    let is_stream = is_stream(path);
    let temporary = std::env::temp_dir();
    let folder = if is_stream { &temporary } else { folder_or_here(target.parent()) };
    let partial = folder.join(partial(target));
    let text = |error: io::Error| error.to_string();
    let written = || {
        fs::create_dir_all(folder).map_err(text)?;
        let file = OpenOptions::new().write(true).create(true).truncate(true).open(&partial).map_err(text)?;
        // Some file systems have no locks.
        let _ = file.try_lock();
        if let Some(old) = linked.as_ref().and_then(|target| fs::metadata(target).ok()) {
            // Some have no permissions.
            let _ = file.set_permissions(old.permissions());
        }
        let mut file = BufWriter::with_capacity(1 << 20, file);
        write(&mut file)?;
        let file = file.into_inner().map_err(|error| error.to_string())?;
        if is_stream {
            // Formats that go back to their heads could not be written into it.
            let mut stream = OpenOptions::new().write(true).open(target).map_err(text)?;
            io::copy(&mut File::open(&partial).map_err(text)?, &mut stream).map_err(text)?;
            return fs::remove_file(&partial).map_err(text);
        }
        file.sync_all().map_err(text)?;
        fs::rename(&partial, target).map_err(text)?;
        // The new name is on disk only when the folder is; systems that cannot sync folders need not.
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        tidy(folder);
        Ok(())
    };
    let written: Result<(), String> = written();
    if let Err(error) = written {
        // The first error is reported; one of the clean-up is not.
        let _ = fs::remove_file(&partial);
        return Err(Failure::Output(format!("cannot write {}: {error}", path.display())));
    }
    inputs.note_output(path, &Disk);
    Ok(())
}

/// Keeps what could not be written to its target: in the current folder, or in that for temporary files.
///
/// # Errors
/// The `failure`, which also says where the picture is.
pub(crate) fn rescue(
    target: &Target,
    failure: Failure,
    write: impl Fn(&mut BufWriter<File>) -> Result<(), String>,
) -> Result<(), Failure> {
    let Failure::Output(message) = failure else { return Err(failure) };
    let name = match target {
        Target::Stdout(format) => format!("stdout.{}", format.extension()),
        Target::File(path, format) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            format!("{}.{}", stem.chars().take(50).collect::<String>(), format.extension())
        }
    };
    let attempt = |folder: PathBuf| {
        let path = folder.join(format!("lookfrom-{}-{name}", std::process::id()));
        let file = OpenOptions::new().write(true).create_new(true).open(&path).ok()?;
        let mut file = BufWriter::with_capacity(1 << 20, file);
        let is_written =
            write(&mut file).is_ok() && file.into_inner().is_ok_and(|file| file.sync_all().is_ok());
        if !is_written {
            let _ = fs::remove_file(&path);
        }
        is_written.then_some(path)
    };
    let kept = [PathBuf::from("."), std::env::temp_dir()].into_iter().find_map(attempt);
    Err(Failure::Output(match kept {
        Some(path) => format!("{message}\n  help: the finished picture is kept in {}", path.display()),
        None => message,
    }))
}

/// Name of the temporary file of a file, unique to this process and moment, also where machines share a folder.
fn partial(path: &Path) -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("{}{}-{}{PARTIAL}", partial_prefix(path), std::process::id(), now.as_nanos())
}

const PARTIAL: &str = ".partial";

/// The begin of that name; file systems limit the length of the whole.
fn partial_prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}-", name.chars().take(50).collect::<String>())
}

/// [`remove_left_partials`], once for each folder: to read one takes as long as it has files.
fn tidy(folder: &Path) {
    static DONE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if DONE.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        remove_left_partials(folder);
    }
}

/// Removes what processes that were killed while they wrote into this folder have left: temporary files that nobody holds
/// a lock on, which ends with its process, and that were not made at this moment; or, where the file system has no locks,
/// that nobody has written to for ten minutes.
fn remove_left_partials(folder: &Path) {
    const MADE: Duration = Duration::from_secs(2);
    const LEFT: Duration = Duration::from_secs(600);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if !is_partial(&entry.file_name().to_string_lossy()) {
            continue;
        }
        let modified = entry.metadata().and_then(|metadata| metadata.modified());
        let Some(age) = modified.ok().and_then(|at| at.elapsed().ok()) else { continue };
        let Ok(file) = OpenOptions::new().write(true).open(entry.path()) else { continue };
        let is_left = match file.try_lock() {
            Ok(()) => age > MADE,
            Err(TryLockError::WouldBlock) => false,
            Err(TryLockError::Error(_)) => age > LEFT,
        };
        if is_left {
            // Whoever else removes it at the same time has done so.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether a name is one that [`partial`] gives: `.NAME-PROCESS-TIME.partial`.
fn is_partial(name: &str) -> bool {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let mut parts = name.strip_suffix(PARTIAL).unwrap_or_default().rsplitn(3, '-');
    let numbers = [parts.next(), parts.next()];
    name.starts_with('.') && numbers.iter().all(|part| part.is_some_and(is_number)) && parts.next().is_some()
}

/// Whether there is something else than a file, which keeps its place: a pipe, a device.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// The folder of a file, from the parent of its path: `.` where that is empty.
pub(crate) fn folder_or_here(parent: Option<&Path>) -> &Path {
    parent.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_killed_have_left_is_removed_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("lookfrom-partials-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a temporary folder");
        let files = [".a.exr-1-2.partial", ".b.exr-3-4.partial", ".c.exr-5-6.partial", ".a.partial", "a.exr"];
        let mut held = None;
        for (index, name) in files.iter().enumerate() {
            let file = File::create(folder.join(name)).expect("a temporary file");
            let age = Duration::from_secs(if index == 1 { 0 } else { 60 });
            file.set_modified(SystemTime::now() - age).expect("a time");
            if index == 2 {
                file.try_lock().expect("nobody else has it");
                held = Some(file);
            }
        }
        remove_left_partials(&folder);
        let left: Vec<bool> = files.iter().map(|name| folder.join(name).exists()).collect();
        assert_eq!(left, [false, true, true, true, true]);
        drop(held);
        remove_left_partials(&folder);
        assert!(!folder.join(files[2]).exists());
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
