//! `lookfrom develop`: pictures of films and of other linear pictures, without rendering.

use std::path::{Path, PathBuf};

use lookfrom::film::Picture;
use lookfrom::session::{Developed, Development, Exposure, FilmFile, FilmParts, Fireflies};
use lookfrom_scene::image::{self, Channels, Encoding, Reading};
use lookfrom_scene::settings::{Background, Tonemap};
use lookfrom_scene::{Disk, Inputs, LoadContext, Location};

use crate::args::DevelopArguments;
use crate::exit::{self, DONE, Failure};
use crate::naming;
use crate::output::Target;

/// Bytes of a pixel as it is developed: linear light, and what is encoded.
const DEVELOPED: u64 = 16;

/// Develops every picture and returns the exit code. One that fails does not stop the others; its code is kept.
pub(crate) fn run(arguments: &DevelopArguments) -> u8 {
    let encoding = &arguments.encoding;
    let targets = naming::targets(&arguments.pictures, arguments.output.as_deref(), encoding.format(), false);
    let targets = match targets.and_then(|targets| encoding.apply(targets)) {
        Ok(targets) => targets,
        Err(failure) => return failure.report(),
    };
    if let Err(failure) = keep_pictures(&arguments.pictures, &targets) {
        return failure.report();
    }
    let mut code = DONE;
    for (path, target) in arguments.pictures.iter().zip(&targets) {
        if let Err(failure) = develop(path, target, arguments) {
            let of_failure = failure.report();
            if code == DONE {
                code = of_failure;
            }
        }
    }
    code
}

/// Refuses to overwrite pictures of the call, before any is written.
fn keep_pictures(pictures: &[PathBuf], targets: &[Target]) -> Result<(), Failure> {
    let inputs = Inputs::default();
    pictures.iter().for_each(|path| inputs.note_input(path, &path.display().to_string(), &Disk));
    targets.iter().try_for_each(|target| target.keep_inputs(&inputs))
}

fn develop(path: &Path, target: &Target, arguments: &DevelopArguments) -> Result<(), Failure> {
    let inputs = Inputs::default();
    let files = inputs.record(&Disk, path.display().to_string());
    let mut context = LoadContext::within(&arguments.memory.budget(), &files);
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let mut film = None;
    let mut developed = if is_exr {
        let is_film = FilmFile::is_film(&context.read(path)?);
        if is_film && arguments.layer.is_none() {
            let mut parts = FilmParts::new(&files, &context.budget);
            parts.add(path, |_| ()).map_err(exit::in_scene(path))?;
            let development = of_film(&parts, path, arguments)?;
            if target.format().has_layers() || parts.need_all(&development) {
                let file = FilmFile::read(&context.read(path)?, path, &context.budget)?;
                let developed = file.develop(&development);
                film = Some(file.film);
                developed
            } else {
                let pixels =
                    parts.whole().map_or(0, |whole| whole.film.width() as u64 * whole.film.height() as u64);
                context.keep(pixels * DEVELOPED, "the developed picture", &Location::file(path))?;
                parts.develop(&development)?
            }
        } else {
            of_exr(path, arguments, &mut context)?
        }
    } else {
        let reading = Reading { layer: arguments.layer.as_deref(), ..Reading::new(Encoding::Srgb) };
        let image = image::read_as(path, &reading, &mut context)?;
        context.keep(image.len() as u64 * DEVELOPED, "the developed picture", &Location::file(path))?;
        let alpha =
            if image.has_alpha() { (0..image.len()).map(|k| image.alpha(k)).collect() } else { Vec::new() };
        let picture =
            Picture { width: image.width, height: image.height, pixels: image.texels().collect(), alpha };
        of_picture((picture, Vec::new(), Vec::new()), path, arguments)?
    };
    if arguments.exposure == Some(Exposure::Auto) {
        context.warnings.push(developed.expose(path));
    }
    exit::say_warnings(&context.warnings);
    target.format().check_background(developed.development.background).map_err(exit::in_scene(path))?;
    target.write_by(&inputs, &|mut out| developed.write(film.as_ref(), target.format(), &mut out))
}

/// The development of a film that is asked for.
fn of_film(parts: &FilmParts<'_>, path: &Path, arguments: &DevelopArguments) -> Result<Development, Failure> {
    let own = parts.whole().map(|whole| whole.provenance.development);
    let mut development = own.ok_or_else(|| Failure::Usage(format!("{} is no film", path.display())))?;
    let has_alpha = development.background != Background::Environment;
    change(&mut development, arguments, has_alpha, path)?;
    if let Some(denoise) = arguments.denoise {
        development.denoise = denoise;
    }
    if let Some(fireflies) = arguments.fireflies {
        development.fireflies = fireflies;
    }
    Ok(development)
}

/// A picture, its other channels and the texts of its header.
type Plain = (Picture, Vec<(String, Vec<f32>)>, Vec<(String, String)>);

fn of_picture(
    (picture, layers, header): Plain,
    path: &Path,
    arguments: &DevelopArguments,
) -> Result<Developed, Failure> {
    if arguments.denoise.is_some() || arguments.fireflies.is_some() {
        return Err(Failure::Usage(format!(
            "{} is no film: without the sums of its samples nothing is known of its noise\n  help: render it with --film",
            path.display()
        )));
    }
    let has_alpha = !picture.alpha.is_empty();
    let mut development = Development {
        exposure: 0.0,
        tonemap: Tonemap::Clamp,
        background: if has_alpha { Background::Transparent } else { Background::Environment },
        denoise: false,
        fireflies: Fireflies::Keep,
    };
    change(&mut development, arguments, has_alpha, path)?;
    Ok(Developed { picture, layers, cryptomattes: Vec::new(), header, denoised: false, development })
}

/// Applies what can be changed of any linear picture.
fn change(
    development: &mut Development,
    arguments: &DevelopArguments,
    has_alpha: bool,
    path: &Path,
) -> Result<(), Failure> {
    if let Some(background) = arguments.background {
        if !has_alpha || background == Background::Environment {
            return Err(Failure::Usage(format!(
                "{} has {}: its background cannot become {background}",
                path.display(),
                if has_alpha { "no environment any more" } else { "no alpha" }
            )));
        }
        development.background = background;
    }
    if let Some(Exposure::Stops(stops)) = arguments.exposure {
        development.exposure = stops;
    }
    if let Some(tonemap) = arguments.tonemap {
        development.tonemap = tonemap;
    }
    Ok(())
}

/// The picture of an OpenEXR file that is no film, or one of its layers.
fn of_exr(
    path: &Path,
    arguments: &DevelopArguments,
    context: &mut LoadContext<'_>,
) -> Result<Developed, Failure> {
    let exr = image::read_exr_layer(path, arguments.layer.as_deref(), context)?;
    let Channels { width, height, mut channels, mut attributes } = exr;
    // A layer of a film is no film: the sums are not read, and the checksum is that of its own file.
    attributes.retain(|(name, _)| name != "crc32" && name != "film" && !name.starts_with("film."));
    let mut take = |name: &str| {
        let index = channels.iter().position(|(known, _)| known == name)?;
        Some(channels.remove(index).1)
    };
    let [r, g, b, alpha] = ["R", "G", "B", "A"].map(|name| take(name).unwrap_or_default());
    let pixels = r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect();
    of_picture((Picture { width, height, pixels, alpha }, channels, attributes), path, arguments)
}
