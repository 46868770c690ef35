//! Where pictures go and in which format: decided and tried before anything is rendered, and written so that a file is there
//! as a whole or not at all, and never in the place of one that was read.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use lookfrom::develop::{srgb8_before, srgba8};
use lookfrom::film::Picture;
use lookfrom_scene::image::{
    encode_exr, encode_hdr, encode_pfm, encode_png, encode_png_with_alpha, encode_ppm,
};
use lookfrom_scene::settings::{Background, ImageSettings};
use lookfrom_scene::{Disk, Inputs};

use crate::exit::Failure;

/// What lies behind a picture with alpha, where nothing has room for alpha: its background, or black.
pub(crate) fn behind(image: &ImageSettings) -> [f32; 3] {
    match image.background {
        Background::Color(color) => color,
        Background::Transparent | Background::Environment => [0.0; 3],
    }
}

/// The formats of pictures, by extension.
pub(crate) const FORMATS: [(&str, Format); 5] = [
    ("png", Format::Png),
    ("exr", Format::Exr),
    ("hdr", Format::Hdr),
    ("pfm", Format::Pfm),
    ("ppm", Format::Ppm),
];

/// A format of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    Png,
    Exr,
    Hdr,
    Pfm,
    Ppm,
}

/// Where a picture goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A PNG to stdout.
    Stdout,
    /// A file.
    File(PathBuf, Format),
}

impl Target {
    /// What it is called.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Stdout => "-".to_owned(),
            Self::File(path, _) => path.display().to_string(),
        }
    }

    /// Where the picture of this number goes, of `count` of the same scene: NAME-000.png for NAME.png.
    pub(crate) fn numbered(&self, number: u32, count: u32) -> Self {
        let Self::File(path, format) = self else { return self.clone() };
        let digits = (count - 1).to_string().len().max(3);
        let mut name = path.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{number:0digits$}."));
        name.push(path.extension().unwrap_or_default());
        Self::File(path.with_file_name(name), *format)
    }

    /// Whether a file there has room for layers.
    pub(crate) fn has_layers(&self) -> bool {
        matches!(self, Self::File(_, Format::Exr))
    }

    /// The bytes of a picture in the target's format; `layers` and `attributes` are for a format that has room for them.
    ///
    /// # Errors
    /// `Output` where the format cannot hold the picture.
    pub(crate) fn encode(
        &self,
        picture: &Picture,
        layers: &[(String, Vec<f32>)],
        image: &ImageSettings,
        attributes: &[(String, String)],
    ) -> Result<Vec<u8>, Failure> {
        let (width, height) = (picture.width, picture.height);
        let format = match self {
            Self::Stdout => Format::Png,
            Self::File(_, format) => *format,
        };
        // Behind a picture with alpha lies its background; where the format has no room for alpha, black.
        let is_transparent = image.background == Background::Transparent;
        let background = behind(image);
        let developed = || srgb8_before(picture, background, image.exposure, image.tonemap);
        let linear = || picture.clone().before(background).pixels;
        let bytes = match format {
            Format::Png if is_transparent => {
                encode_png_with_alpha(width, height, &srgba8(picture, image.exposure, image.tonemap))
            }
            Format::Png => encode_png(width, height, &developed()),
            Format::Ppm => encode_ppm(width, height, &developed()),
            Format::Hdr => encode_hdr(width, height, &linear()),
            Format::Pfm => encode_pfm(width, height, &linear()),
            Format::Exr => {
                let pixels = linear();
                let channel = |index: usize| pixels.iter().map(|pixel| pixel[index]).collect::<Vec<f32>>();
                let [r, g, b] = [channel(0), channel(1), channel(2)];
                let channels = [("R", &r), ("G", &g), ("B", &b)];
                let channels = channels.map(|(name, values)| (name.to_owned(), values.as_slice()));
                let alpha: Vec<f32> = picture.alpha.iter().map(|alpha| alpha.clamp(0.0, 1.0)).collect();
                let alpha = is_transparent.then(|| ("A".to_owned(), alpha.as_slice()));
                let layers = layers.iter().map(|(name, values)| (name.clone(), values.as_slice()));
                let channels: Vec<_> = channels.into_iter().chain(alpha).chain(layers).collect();
                encode_exr(width, height, &channels, attributes)
            }
        };
        bytes.map_err(|error| Failure::Output(format!("{}: {}", self.name(), error.message)))
    }

    /// Whether something is there already.
    pub(crate) fn exists(&self) -> bool {
        matches!(self, Self::File(path, _) if path.exists())
    }

    /// Refuses to write over a file that was read.
    ///
    /// # Errors
    /// `Output` where this target is such a file.
    pub(crate) fn keep_inputs(&self, inputs: &Inputs) -> Result<(), Failure> {
        match self {
            Self::Stdout => Ok(()),
            Self::File(path, _) => keep_inputs(path, inputs, "-o"),
        }
    }

    /// Puts bytes there.
    ///
    /// # Errors
    /// `Output` where that is not possible or would overwrite an input; what was there before is then still there.
    pub(crate) fn write(&self, bytes: &[u8], inputs: &Inputs) -> Result<(), Failure> {
        match self {
            Self::Stdout => std::io::stdout()
                .write_all(bytes)
                .and_then(|()| std::io::stdout().flush())
                .map_err(|error| Failure::Output(format!("cannot write -: {error}"))),
            Self::File(path, _) => replace_file(path, bytes, inputs, "-o"),
        }
    }

    /// Whether it seems that the picture can be put there. Folders that are missing are made when there is a picture.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let Self::File(path, _) = self else { return Ok(()) };
        let wrong = |message: String| Err(Failure::Output(message));
        if path.is_dir() {
            return wrong(format!("cannot write {}: it is a folder", path.display()));
        }
        let mut folders = path.ancestors().skip(1).map(|folder| folder_or_here(Some(folder)));
        let folder = folders.find(|folder| folder.exists()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return wrong(format!("cannot write {}: {} is not a folder", path.display(), folder.display()));
        }
        // Permissions, full disks, read-only disks: trying is the only way to know.
        let trial = folder.join(partial());
        if let Err(error) = File::create(&trial).and_then(|_| fs::remove_file(&trial)) {
            return wrong(format!("cannot write into the folder {}: {error}", folder.display()));
        }
        Ok(())
    }
}

/// Refuses to write over a file that was read; `option` says where another name can be given.
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
    let spelled = if input.path == path { String::new() } else { format!(", by the name {name}") };
    let extension = path.extension().unwrap_or_default().display();
    Err(Failure::Output(format!(
        "cannot write {}: it is {what}{spelled}\n  help: give the output another name: {option} other.{extension}",
        path.display(),
    )))
}

/// Writes a file beside the one that is meant, then lets it take its place. Folders that are missing are made.
///
/// # Errors
/// `Output` where it cannot be written, or would take the place of an input; `option` as for [`keep_inputs`].
pub(crate) fn replace_file(path: &Path, bytes: &[u8], inputs: &Inputs, option: &str) -> Result<(), Failure> {
    keep_inputs(path, inputs, option)?;
    let folder = folder_or_here(path.parent());
    let partial = folder.join(partial());
    let written = fs::create_dir_all(folder)
        .and_then(|()| OpenOptions::new().write(true).create(true).truncate(true).open(&partial))
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&partial, path));
    if let Err(error) = written {
        // The first error is the one to tell of.
        let _ = fs::remove_file(&partial);
        return Err(Failure::Output(format!("cannot write {}: {error}", path.display())));
    }
    inputs.note_output(path, &Disk);
    Ok(())
}

/// A name for a file that no other process uses.
fn partial() -> String {
    format!(".lookfrom-{}.partial", std::process::id())
}

/// The folder of a file by the path's parent.
pub(crate) fn folder_or_here(parent: Option<&Path>) -> &Path {
    parent.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
