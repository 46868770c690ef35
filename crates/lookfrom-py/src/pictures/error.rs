//! Errors of the library as exceptions.

use lookfrom::scene::excerpt::{Excerpt, Excerpts};
use lookfrom::scene::{Error, ErrorKind, Files, Remedy};
use pyo3::create_exception;
use pyo3::prelude::*;

create_exception!(
    lookfrom,
    SceneError,
    crate::error::Error,
    "A scene, film or picture cannot be read, rendered or written. Its text has the location, the line there and what would help.

kind: \"io\", \"syntax\", \"invalid\", \"unsupported\", \"limit\" or \"request\" (options do not suit the scene).
message: what was found and what was expected.
file, line, column: the location, from 1; line and column are 0 where only the file is known, file is \"\" where there is none.
hint: what would help, or None.
more: further errors of the same run, as exceptions."
);

/// Exceptions of errors, with the lines of `files` that they point at.
pub(super) fn raised(py: Python<'_>, error: &Error, files: &dyn Files) -> PyErr {
    let mut excerpts = Excerpts::new(files);
    let error = error.clone().worded(worded);
    let (few, left) = error.first_few();
    let mut text: Vec<String> = few.map(|error| told(error, excerpts.of(&error.at))).collect();
    if left > 0 {
        text.push(format!("… and {left} more"));
    }
    exception(py, &error, text.join("\n\n"))
}

fn exception(py: Python<'_>, error: &Error, text: String) -> PyErr {
    let kind = match error.kind {
        ErrorKind::Io => "io",
        ErrorKind::Syntax => "syntax",
        ErrorKind::Unsupported => "unsupported",
        ErrorKind::Limit => "limit",
        ErrorKind::Request => "request",
        _ => "invalid",
    };
    let exception = SceneError::new_err(text);
    let more: Vec<PyErr> = error.more.iter().map(|error| exception_of(py, error)).collect();
    let value = exception.value(py);
    let set = || -> PyResult<()> {
        value.setattr("kind", kind)?;
        value.setattr("message", &error.message)?;
        value.setattr("file", &*error.at.file)?;
        value.setattr("line", error.at.line)?;
        value.setattr("column", error.at.column)?;
        value.setattr("hint", error.hint.as_ref().map(ToString::to_string))?;
        value.setattr("more", more)
    };
    match set() {
        Ok(()) => exception,
        Err(other) => other,
    }
}

fn exception_of(py: Python<'_>, error: &Error) -> PyErr {
    exception(py, error, told(error, None))
}

/// An error as text: location, message, line, remedy.
fn told(error: &Error, excerpt: Option<Excerpt>) -> String {
    let mut text = match error.at.file.is_empty() {
        true => error.message.clone(),
        false => format!("{}: {}", error.at, error.message),
    };
    if let Some(Excerpt { text: line, mark }) = excerpt {
        let (space, carets) = (" ".repeat(mark.start), "^".repeat(mark.len()));
        text += &format!("\n    {}\n    {space}{carets}", line.trim_end());
    }
    if let Some(hint) = &error.hint {
        text += &format!("\n  help: {hint}");
    }
    text
}

/// A remedy in Python's words.
pub(super) fn worded(remedy: &Remedy) -> String {
    let words = match remedy {
        Remedy::Up(axis) => return format!("up={axis:?} shows it otherwise"),
        Remedy::Exposure(stops) => return format!("exposure={stops} repeats it"),
        Remedy::OpaqueBackground => {
            ".png, .webp and .exr hold transparency; background=\"white\", or any other colour, is for all formats"
        }
        Remedy::InstancedLights => "with instanced_lights=True each instance is a light",
        Remedy::MoreMemory => {
            "memory=\"16GiB\" sets another limit; if the size is not true, the file is damaged"
        }
        Remedy::SmallerPicture => {
            "a smaller size takes less; crops with film=True can be rendered one by one and merged; memory=\"16GiB\" sets \
             another limit"
        }
        Remedy::KeptFilm => "render it with film=True",
        Remedy::SamePicture => {
            "give size, crop, layers, light_path, spectral_buckets, background and denoise as when it was begun"
        }
        Remedy::SpectralLight => {
            "with color=\"spectral\" light has wavelengths; spectral_buckets=0 makes a picture of colours alone"
        }
        other => return other.to_string(),
    };
    words.to_owned()
}
