//! Where pictures go and in which format: decided and tried before anything is rendered, and written so that a file is there
//! as a whole or not at all.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use lookfrom::develop::{srgb8_before, srgba8};
use lookfrom::film::Picture;
use lookfrom_scene::image::{
    encode_exr, encode_hdr, encode_pfm, encode_png, encode_png_with_alpha, encode_ppm,
};
use lookfrom_scene::settings::{Background, ImageSettings};

use crate::exit::Failure;

/// The stem of the scene in a pattern of names.
const NAME: &str = "{name}";

/// What lies behind a picture with alpha, where nothing has room for alpha: its background, or black.
pub(crate) fn behind(image: &ImageSettings) -> [f32; 3] {
    match image.background {
        Background::Color(color) => color,
        Background::Transparent | Background::Environment => [0.0; 3],
    }
}

/// The formats of pictures, by extension.
const FORMATS: [(&str, Format); 5] = [
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

    /// Puts bytes there.
    ///
    /// # Errors
    /// `Output` where that is not possible; what was there before is then still there.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        let written = match self {
            Self::Stdout => std::io::stdout().write_all(bytes).and_then(|()| std::io::stdout().flush()),
            Self::File(path, _) => replace_file(path, bytes),
        };
        written.map_err(|error| Failure::Output(format!("cannot write {}: {error}", self.name())))
    }

    /// Whether it seems that the picture can be put there.
    fn check(&self) -> Result<(), Failure> {
        let Self::File(path, _) = self else { return Ok(()) };
        let wrong = |message: String| Err(Failure::Output(message));
        if path.is_dir() {
            return wrong(format!("cannot write {}: it is a folder", path.display()));
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            return wrong(format!(
                "cannot write {}: there is no folder {}",
                path.display(),
                folder.display()
            ));
        }
        // Permissions, full disks, read-only disks: trying is the only way to know.
        let trial = partial(path);
        if let Err(error) = File::create(&trial).and_then(|_| fs::remove_file(&trial)) {
            return wrong(format!("cannot write into the folder {}: {error}", folder.display()));
        }
        Ok(())
    }
}

/// Where the pictures of scenes go, by what was typed after `-o`; everything that can be known before rendering is checked.
///
/// # Errors
/// `Usage` for an unknown format, several scenes for one file, or a picture to a terminal; `Output` where a folder is not there
/// or cannot be written to.
pub(crate) fn targets(scenes: &[PathBuf], output: Option<&Path>, json: bool) -> Result<Vec<Target>, Failure> {
    let targets =
        scenes.iter().map(|scene| target(scene, output, scenes.len())).collect::<Result<Vec<_>, _>>()?;
    if targets.contains(&Target::Stdout) {
        let usage = |message: &str| Err(Failure::Usage(message.to_owned()));
        if json {
            return usage("-o - and --json cannot both write to stdout; write the picture to a file");
        }
        if std::io::stdout().is_terminal() {
            return usage(
                "a picture is not written to a terminal; give -o a file, or send stdout to a pipe or file",
            );
        }
    }
    for (index, target) in targets.iter().enumerate() {
        if let Some(other) = targets[..index].iter().position(|earlier| earlier == target) {
            return Err(Failure::Usage(format!(
                "the pictures of {} and {} would both be {}; render them in two calls with different -o",
                scenes[other].display(),
                scenes[index].display(),
                target.name()
            )));
        }
        target.check()?;
    }
    Ok(targets)
}

/// Where the picture of one of `count` scenes goes.
fn target(scene: &Path, output: Option<&Path>, count: usize) -> Result<Target, Failure> {
    let stem = scene.file_stem().unwrap_or(OsStr::new("picture"));
    let mut default_name = stem.to_owned();
    default_name.push(".png");
    let file = |path: PathBuf| Ok(Target::File(path.clone(), format(&path)?));
    let Some(output) = output else { return file(default_name.into()) };
    if output == Path::new("-") {
        return match count {
            1 => Ok(Target::Stdout),
            _ => Err(Failure::Usage(
                "-o - is for one scene; give several a folder or a pattern with {name}".to_owned(),
            )),
        };
    }
    if let Some(pattern) = output.to_str().filter(|pattern| pattern.contains(NAME)) {
        return file(pattern.replace(NAME, &stem.to_string_lossy()).into());
    }
    // Several scenes go into a folder; one goes there if it is there or its name ends like a folder's.
    let ends_like_folder = output.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    if output.is_dir() || ends_like_folder {
        return file(output.join(default_name));
    }
    if count == 1 {
        return file(output.to_owned());
    }
    if output.exists()
        || FORMATS.iter().any(|(extension, _)| Some(OsStr::new(extension)) == output.extension())
    {
        return Err(Failure::Usage(format!(
            "{count} pictures do not fit into the one file {}; give -o a folder or a pattern with {NAME}",
            output.display()
        )));
    }
    file(output.join(default_name))
}

/// The format of a file by its extension.
fn format(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let known = FORMATS.iter().find(|(of_format, _)| *of_format == extension);
    known.map(|&(_, format)| format).ok_or_else(|| {
        let all = FORMATS.map(|(extension, _)| format!(".{extension}")).join(", ");
        let found = if extension.is_empty() {
            "no extension".to_owned()
        } else {
            format!("the extension .{extension}")
        };
        Failure::Usage(format!("{} has {found}; pictures are written as {all}", path.display()))
    })
}

/// Writes a file beside the one that is meant, then lets it take its place.
pub(crate) fn replace_file(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let partial = partial(path);
    let written = OpenOptions::new()
        .write(true)
        .create(true)
        .truncate(true)
        .open(&partial)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // The first error is the one to tell of.
        let _ = fs::remove_file(&partial);
    }
    written
}

/// A name beside a file that no other process uses.
fn partial(path: &Path) -> PathBuf {
    folder_of(path).join(format!(".lookfrom-{}.partial", std::process::id()))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(scenes: &[&str], output: Option<&str>) -> Result<Vec<String>, u8> {
        let scenes: Vec<PathBuf> = scenes.iter().map(PathBuf::from).collect();
        let targets = scenes.iter().map(|scene| target(scene, output.map(Path::new), scenes.len()));
        targets.map(|target| target.map(|target| target.name()).map_err(|failure| failure.code())).collect()
    }

    #[test]
    fn numbers_of_pictures() {
        let target = target(Path::new("a.b.toml"), Some(Path::new("x/")), 1).unwrap();
        assert_eq!(target.numbered(7, 36).name(), "x/a.b-007.png");
        assert_eq!(target.numbered(7, 10_001).name(), "x/a.b-00007.png");
    }

    #[test]
    fn names_of_pictures() {
        assert_eq!(of(&["a/b.toml"], None).unwrap(), ["b.png"]);
        assert_eq!(of(&["a/b.toml", "c.ply"], None).unwrap(), ["b.png", "c.png"]);
        assert_eq!(of(&["a/b.toml"], Some("x/y.EXR")).unwrap(), ["x/y.EXR"]);
        assert_eq!(
            of(&["a/b.toml", "c.ply"], Some("x/{name}/{name}.hdr")).unwrap(),
            ["x/b/b.hdr", "x/c/c.hdr"]
        );
        assert_eq!(of(&["b.toml"], Some("x/")).unwrap(), ["x/b.png"]);
        assert_eq!(of(&["b.toml", "c.ply"], Some("x")).unwrap(), ["x/b.png", "x/c.png"]);
        assert_eq!(of(&["b.toml"], Some("-")).unwrap(), ["-"]);
        for wrong in ["x", "x.toml", "x.jpg", ".png", "{name}"] {
            assert_eq!(of(&["b.toml"], Some(wrong)), Err(2), "{wrong}");
        }
        for wrong in ["-", "x.png"] {
            assert_eq!(of(&["b.toml", "c.ply"], Some(wrong)), Err(2), "{wrong}");
        }
    }
}
