//! Contents of OpenEXR pictures, and of the films among them.

use std::collections::BTreeMap;
use std::path::Path;

use lookfrom::session::FilmFile;
use lookfrom_scene::image;
use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::{Budget, Disk, LoadContext, Location};
use serde::Serialize;

use crate::exit::{Failure, answer};
use lookfrom_scene::json;
use lookfrom_scene::plural::{are, counted};

/// The JSON object of a picture, which docs/guide/command.md explains.
#[derive(Serialize)]
struct Picture {
    picture: String,
    width: u32,
    height: u32,
    channels: Vec<String>,
    /// The texts of the header.
    header: BTreeMap<String, String>,
    /// `None` for a picture that is no film.
    film: Option<Film>,
}

/// The content of a film.
#[derive(Serialize)]
struct Film {
    /// Columns and rows, the last two exclusive.
    area: [u32; 4],
    /// The largest number of samples of a pixel.
    samples: u32,
    /// Samples of all pixels together.
    samples_taken: u64,
    /// The samples that it holds of each pixel: a line for each band of rows.
    ledger: String,
    /// Numbers of the samples that each pixel was to have; `None` if all are there.
    goal: Option<[u32; 2]>,
    dropped: u64,
    inputs: Vec<Input>,
    arguments: Vec<String>,
}

/// A file of the scene.
#[derive(Serialize)]
struct Input {
    path: String,
    sha256: String,
}

/// Describes a picture.
pub(super) fn info(path: &Path, is_json: bool, budget: &Budget) -> Result<(), Failure> {
    let mut context = LoadContext::within(budget, &Disk);
    let bytes = context.read(path)?;
    let film =
        if FilmFile::is_film(&bytes) { Some(film(&FilmFile::read(&bytes, path, budget)?)) } else { None };
    let exr = image::exr_contents(&bytes, &Location::file(path), &mut context)?;
    let header = exr.attributes.into_iter().filter(|(name, _)| !name.starts_with("film"));
    let picture = Picture {
        picture: path.display().to_string(),
        width: exr.width,
        height: exr.height,
        channels: exr.channels,
        header: header.collect(),
        film,
    };
    answer(&if is_json { json::line(&picture) } else { for_people(&picture) })
}

fn film(file: &FilmFile) -> Film {
    let (film, provenance) = (&file.film, &file.provenance);
    let PixelBounds { x0, y0, x1, y1 } = film.area();
    Film {
        area: [x0, y0, x1, y1],
        samples: film.ledger().most(),
        samples_taken: film.ledger().total(),
        ledger: film.ledger().to_string(),
        goal: provenance.goal.as_ref().map(|goal| [goal.start, goal.end]),
        dropped: film.dropped(),
        inputs: provenance
            .inputs()
            .map(|(path, sha256)| Input { path: path.to_owned(), sha256: sha256.to_owned() })
            .collect(),
        arguments: provenance.arguments.clone(),
    }
}

fn for_people(picture: &Picture) -> String {
    let mut lines = vec![
        picture.picture.clone(),
        format!("  {:<10} {} × {} pixels", "image", picture.width, picture.height),
        format!("  {:<10} {}", "channels", picture.channels.join(" ")),
    ];
    if let Some(film) = &picture.film {
        let [x0, y0, x1, y1] = film.area;
        let pixels = u64::from(x1 - x0) * u64::from(y1 - y0);
        lines.push(format!(
            "  {:<10} {} per pixel at most, {:.1} on average, in the area {x0},{y0},{x1},{y1}",
            "film",
            counted(film.samples, "sample"),
            film.samples_taken as f64 / pixels.max(1) as f64
        ));
        let goal = film.goal.map(|[start, end]| match picture.header.get("noise") {
            // Whether it is reached is known to who measures it.
            Some(noise) => format!("an error of {noise}, which lookfrom resume {} reaches", picture.picture),
            None => format!("samples {start}..{end} are not all there: lookfrom resume {}", picture.picture),
        });
        lines.extend(goal.map(|goal| format!("  {:<10} {goal}", "goal")));
        // The ledger of an unfinished film has a line for each row of tiles.
        let shown: Vec<&str> = film.ledger.lines().take(4).collect();
        lines.push(format!("  {:<10} {}", "ledger", shown.join("\n             ")));
        if film.dropped > 0 {
            lines.push(format!("  {:<10} {} not finite", "dropped", are(film.dropped, "sample")));
        }
        lines.extend(film.inputs.iter().map(|Input { path, sha256 }| {
            format!("  {:<10} {} {path}", "input", sha256.chars().take(12).collect::<String>())
        }));
        if !film.arguments.is_empty() {
            lines.push(format!("  {:<10} {}", "arguments", film.arguments.join(" ")));
        }
    }
    lines.extend(picture.header.iter().map(|(name, text)| format!("  {name:<10} {text}")));
    lines.join("\n")
}
