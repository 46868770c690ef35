//! Films as files: OpenEXR pictures for every viewer, which also hold the exact sums and know what they are of.
//!
//! The channels `R`, `G`, `B` … are the picture. The channels `film.*` are the sums of [`Film`], as unsigned integers
//! ([`Film::stored_channels`]). The attributes `film.*` are texts: `film.ledger` (which samples of which pixels it
//! holds, [`SampleLedger`]), `film.area`, `film.dropped` (samples that were not finite, and the first), `film.inputs`
//! (the digests of the scene's files), `film.options` (the digest of what else decides samples), `film.sampling` (the
//! version of the code that computes samples), `film.develop` ([`Development`]), `film.scene` and `film.arguments` (to go
//! on) and `film.goal` (the samples that are not all there yet). `crc32` is the checksum of the file.

use std::io::{Seek, Write};
use std::ops::Range;
use std::path::Path;

use lookfrom_scene::image::{ExrChannel, ExrHeader, ExrRows, write_exr};
use lookfrom_scene::settings::{Background, ImageSettings, Layers, PixelBounds, Sensor, Tonemap};
use lookfrom_scene::{Error, ErrorKind, Limits, Location, Result};

use super::{Developed, Development, Fireflies, encode, finish, header};
use crate::film::{Film, Picture, SampleId, SampleLedger};
use crate::render::SAMPLING_VERSION;

/// The version of the format, in the attribute `film`.
const FORMAT: &str = "1";

/// The prefix of our attributes and channels.
const PREFIX: &str = "film";

/// What a film is of, and what its reader needs besides the sums.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// The texts of the header that any number of samples has in common, sorted by name.
    pub(super) header: Vec<(String, String)>,
    /// The files of the scene by name and their SHA-256, in hexadecimal digits.
    pub(super) inputs: Vec<(String, String)>,
    /// The digest of the other options that decide samples.
    pub(super) options: String,
    /// [`SAMPLING_VERSION`].
    pub(super) sampling: u32,
    /// How the picture is developed.
    pub development: Development,
    /// The path of the scene, relative to the folder of the film, if its maker tells.
    pub scene: Option<String>,
    /// Arguments by which its maker can open the same session again, for its own use.
    pub arguments: Vec<String>,
    /// The samples that every pixel was to have, if some are not there yet.
    pub goal: Option<Range<u32>>,
}

/// A film and its provenance, as a file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// The film.
    pub film: Film,
    /// What it is of.
    pub provenance: Provenance,
}

impl FilmFile {
    /// Whether the bytes of an OpenEXR file are those of a film. It may be damaged.
    pub fn is_film(bytes: &[u8]) -> bool {
        const MARK: &[u8] = b"film\0string\0";
        // Attributes are in front of the pixels; channels and texts of a usual film take less than this.
        bytes[..bytes.len().min(1 << 16)].windows(MARK.len()).any(|window| window == MARK)
    }

    /// Reads a film file.
    ///
    /// # Errors
    /// `Syntax` where it is damaged; `Invalid` where it is no film, or of another version of the format; `Limit` where
    /// it is too large.
    pub fn read(bytes: &[u8], path: &Path) -> Result<Self> {
        let at = Location::file(path);
        let rows = ExrRows::open(bytes, &at, &Limits::default())?;
        let found = rows.header();
        let text = |name: &str| {
            let found = found.attributes.iter().find(|(known, _)| known == name);
            found.map(|(_, text)| text.as_str())
        };
        match text(PREFIX) {
            Some(FORMAT) => {}
            Some(other) => {
                let message = format!("a film of format {other}; this program reads format {FORMAT}");
                return Err(Error::new(ErrorKind::Unsupported, &at, message)
                    .hint("use the version of the program that wrote it"));
            }
            None => {
                return Err(Error::invalid(
                    &at,
                    "this picture has no film: only its light, not the sums of its samples",
                )
                .hint("render it with --film"));
            }
        }
        let damaged = |what: &str| Error::syntax(&at, format!("this film is damaged: {what}"));
        let attribute = |name: &str| {
            let name = format!("{PREFIX}.{name}");
            text(&name).ok_or_else(|| damaged(&format!("it has no attribute {name}")))
        };
        let provenance = Provenance {
            header: header::common(
                found.attributes.iter().filter(|(name, _)| !is_ours(name)).cloned().collect(),
            ),
            inputs: attribute("inputs")?
                .lines()
                .filter_map(|line| line.split_once(' '))
                .map(|(digest, name)| (name.to_owned(), digest.to_owned()))
                .collect(),
            options: attribute("options")?.to_owned(),
            sampling: attribute("sampling")?.parse().map_err(|_| damaged("film.sampling is no number"))?,
            development: development_of(attribute("develop")?)
                .ok_or_else(|| damaged("film.develop cannot be understood"))?,
            scene: text("film.scene").map(str::to_owned),
            arguments: text("film.arguments").unwrap_or_default().lines().map(str::to_owned).collect(),
            goal: match text("film.goal") {
                None => None,
                Some(goal) => {
                    let (start, end) = goal.split_once("..").unwrap_or_default();
                    let (start, end) = (start.parse().ok(), end.parse().ok());
                    Some(start.zip(end).map(|(start, end)| start..end).ok_or_else(|| damaged("film.goal"))?)
                }
            },
        };

        // The sums of a film of the same kind have the same channels, or the file is damaged.
        let [x0, y0, x1, y1] = numbers(attribute("area")?).ok_or_else(|| damaged("film.area"))?;
        let area = PixelBounds { x0, y0, x1, y1 };
        if x0 >= x1 || y0 >= y1 || x1 > found.width || y1 > found.height {
            return Err(damaged("film.area is not a part of the picture"));
        }
        let has = |channel: &str| found.channels.iter().any(|(name, _)| name == channel);
        let image = ImageSettings {
            width: found.width,
            height: found.height,
            crop: Some(area),
            layers: if has("film.aov.samples.0") { Layers::Geometry } else { Layers::None },
            denoise: has("film.feature.samples.0"),
            background: if has("film.alpha.sum.0") {
                Background::Transparent
            } else {
                Background::Environment
            },
            sensor: Sensor {
                // Any sensor that does not measure X, Y and Z.
                white_balance: has("film.sensor.samples.0").then_some(5000.0),
                ..Sensor::default()
            },
            ..ImageSettings::default()
        };
        let mut film = Film::for_image(&image).map_err(|error| Error { at: at.clone(), ..error })?;
        let place = |name: &String| {
            let place =
                found.channels.iter().position(|(known, kind)| known == name && *kind == ExrChannel::Uint);
            place.ok_or_else(|| damaged(&format!("it has no channel {name}")))
        };
        let places = film.stored_channels().iter().map(place).collect::<Result<Vec<usize>>>()?;
        let ledger: SampleLedger = attribute("ledger")?.parse().map_err(|wrong: String| damaged(&wrong))?;
        if ledger.bounds().is_some_and(|b| b.x0 < x0 || b.y0 < y0 || b.x1 > x1 || b.y1 > y1) {
            return Err(damaged("its ledger has pixels outside of film.area"));
        }
        *film.ledger_mut() = ledger;
        let [count, x, y, sample] = numbers(attribute("dropped")?).ok_or_else(|| damaged("film.dropped"))?;
        let first = (count > 0).then_some(SampleId { pixel: [x as u32, y as u32], sample: sample as u32 });
        film.set_dropped(count, first);
        let width = found.width as usize;
        rows.read(&mut |row, numbers| {
            film.load_row(row, |channel| &numbers[places[channel] * width..][..width]);
            Ok(())
        })?;
        Ok(Self { film, provenance })
    }

    /// Adds another film of the same picture: other samples, or other pixels, for which room is made. The goal of either
    /// is forgotten.
    ///
    /// # Errors
    /// `Invalid` where it is of another picture, says what differs, or has samples that this one has already; `Limit`
    /// where there is no memory. Then no sample has been added.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        self.provenance.check_same(&other.provenance)?;
        if self.provenance.noise() != other.provenance.noise() {
            return Err(Error::invalid(&Location::default(), "films with different limits of noise"));
        }
        let [a, b] = [self.film.area(), other.film.area()];
        let (x0, y0, x1, y1) = (a.x0.min(b.x0), a.y0.min(b.y0), a.x1.max(b.x1), a.y1.max(b.y1));
        self.film.enlarge(PixelBounds { x0, y0, x1, y1 })?;
        self.film.merge(&other.film)?;
        // Of texts that may differ, such as names of files on other machines, the same ones for any order of the films.
        if other.provenance.order() < self.provenance.order() {
            self.provenance = other.provenance.clone();
        }
        self.provenance.goal = None;
        Ok(())
    }

    /// Develops the film as its provenance says, or otherwise.
    pub fn develop(&self, development: &Development) -> Developed {
        finish::develop(&self.film, development, &self.provenance.header, true)
    }

    /// Writes the file, with the picture that was developed from the film.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write(&self, developed: &Developed, out: &mut (impl Write + Seek)) -> Result<()> {
        self.provenance.write(&self.film, developed, out)
    }
}

impl Provenance {
    /// The files of the scene: names and SHA-256, in hexadecimal digits.
    pub fn inputs(&self) -> impl Iterator<Item = (&str, &str)> {
        self.inputs.iter().map(|(name, digest)| (name.as_str(), digest.as_str()))
    }

    /// The limit of noise of adaptive sampling.
    pub fn noise(&self) -> Option<&str> {
        let noise = self.header.iter().find(|(name, _)| name == header::NOISE);
        noise.map(|(_, text)| text.as_str())
    }

    /// Compares what two films are of, but for limits of noise, which end a render.
    ///
    /// # Errors
    /// `Invalid` with the first difference.
    pub fn check_same(&self, other: &Self) -> Result<()> {
        let differ = |message: String| {
            Err(Error::invalid(&Location::default(), format!("a film of another picture: {message}"))
                .hint("only films of the same scene with the same settings belong together"))
        };
        if self.sampling != other.sampling {
            return differ(format!(
                "its samples are those of version {} of the program's sampling, not {}",
                other.sampling, self.sampling
            ));
        }
        let settings = |of: &Self| {
            let named = |(name, _): &&(String, String)| !matches!(name.as_str(), "software" | header::NOISE);
            of.header.iter().filter(named).cloned().collect::<Vec<_>>()
        };
        let (mine, theirs) = (settings(self), settings(other));
        let value = |of: &[(String, String)], name: &str| {
            let found = of.iter().find(|(known, _)| known == name);
            found.map_or_else(|| "not set".to_owned(), |(_, text)| text.clone())
        };
        if let Some((name, _)) =
            theirs.iter().chain(&mine).find(|(name, _)| value(&mine, name) != value(&theirs, name))
        {
            return differ(format!("{name} is {} there, {} here", value(&theirs, name), value(&mine, name)));
        }
        // Files are compared by content: their names may differ between machines.
        let digests = |of: &Self| {
            let mut digests: Vec<String> = of.inputs.iter().map(|(_, digest)| digest.clone()).collect();
            digests.sort();
            digests
        };
        let (mine, theirs) = (digests(self), digests(other));
        if mine != theirs {
            let odd = |of: &Self, others: &[String]| {
                of.inputs.iter().find(|(_, digest)| !others.contains(digest)).map(|(name, _)| name.clone())
            };
            let name =
                odd(other, &mine).or_else(|| odd(self, &theirs)).unwrap_or_else(|| "a file".to_owned());
            return differ(format!("{name} has another content"));
        }
        if self.options != other.options {
            return differ(
                "other options for the surroundings, the floor, the turntable or the selected parts of the file".to_owned(),
            );
        }
        Ok(())
    }

    /// Writes a film of this provenance as a file, with its picture.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write(&self, film: &Film, developed: &Developed, out: &mut (impl Write + Seek)) -> Result<()> {
        let Developed { picture, layers, header, development, .. } = developed;
        let picture = encode::channels(picture, layers, development.background);
        let channels = picture.iter().map(|(name, _)| (name.clone(), ExrChannel::Float));
        let sums = film.stored_channels().into_iter().map(|name| (name, ExrChannel::Uint));
        let mut attributes = header.clone();
        attributes.extend(self.attributes(film));
        attributes.sort();
        let header = ExrHeader {
            width: film.width(),
            height: film.height(),
            channels: channels.chain(sums).collect(),
            attributes,
            is_fast: true,
            has_checksum: true,
        };
        let width = film.width() as usize;
        let fill = |row: u32, bytes: &mut [u8]| {
            let (of_picture, of_sums) = bytes.split_at_mut(picture.len() * width * 4);
            for ((_, values), bytes) in picture.iter().zip(of_picture.chunks_exact_mut(width * 4)) {
                for (value, bytes) in values[row as usize * width..].iter().zip(bytes.chunks_exact_mut(4)) {
                    bytes.copy_from_slice(&value.to_le_bytes());
                }
            }
            film.store_row(row, of_sums);
        };
        write_exr(&header, &fill, out)
    }

    /// Writes an unfinished film: its picture is the light as it was computed, and AOVs are in the sums only.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write_checkpoint(&self, film: &Film, out: &mut (impl Write + Seek)) -> Result<()> {
        let picture: Picture = film.picture();
        let development = self.development;
        let header = header::finished(&self.header, film, &development, false);
        let developed = Developed { picture, layers: Vec::new(), header, denoised: false, development };
        self.write(film, &developed, out)
    }

    fn order(&self) -> impl Ord {
        (
            self.header.clone(),
            self.inputs.clone(),
            self.scene.clone(),
            self.arguments.clone(),
            text_of(&self.development),
        )
    }

    fn attributes(&self, film: &Film) -> Vec<(String, String)> {
        let PixelBounds { x0, y0, x1, y1 } = film.area();
        let SampleId { pixel: [x, y], sample } =
            film.first_dropped().unwrap_or(SampleId { pixel: [0, 0], sample: 0 });
        let inputs: Vec<String> =
            self.inputs.iter().map(|(name, digest)| format!("{digest} {name}")).collect();
        let mut attributes = vec![
            (PREFIX, FORMAT.to_owned()),
            ("film.area", format!("{x0} {y0} {x1} {y1}")),
            ("film.ledger", film.ledger().to_string()),
            ("film.dropped", format!("{} {x} {y} {sample}", film.dropped())),
            ("film.inputs", inputs.join("\n")),
            ("film.options", self.options.clone()),
            ("film.sampling", self.sampling.to_string()),
            ("film.develop", text_of(&self.development)),
        ];
        if let Some(scene) = &self.scene {
            attributes.push(("film.scene", scene.clone()));
        }
        if !self.arguments.is_empty() {
            attributes.push(("film.arguments", self.arguments.join("\n")));
        }
        if let Some(goal) = &self.goal
            && !film.ledger().missing(film.area(), goal).is_empty()
        {
            attributes.push(("film.goal", format!("{}..{}", goal.start, goal.end)));
        }
        attributes.into_iter().map(|(name, text)| (name.to_owned(), text)).collect()
    }

    /// The provenance of pictures that this program computes.
    pub(super) fn new(
        header: Vec<(String, String)>,
        inputs: Vec<(String, String)>,
        options: String,
        development: Development,
    ) -> Self {
        Self {
            header,
            inputs,
            options,
            sampling: SAMPLING_VERSION,
            development,
            scene: None,
            arguments: Vec::new(),
            goal: None,
        }
    }
}

fn is_ours(name: &str) -> bool {
    name == PREFIX || name.strip_prefix(PREFIX).is_some_and(|rest| rest.starts_with('.'))
}

/// Numbers with spaces between them.
fn numbers<T: std::str::FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(' ').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok()
}

/// `EXPOSURE TONEMAP BACKGROUND DENOISE FIREFLIES`, exact.
fn text_of(development: &Development) -> String {
    let &Development { exposure, tonemap, background, denoise, fireflies } = development;
    let background = match background {
        Background::Color([r, g, b]) => format!("{r},{g},{b}"),
        Background::Environment | Background::Transparent => background.to_string(),
    };
    let word = |is_on: bool, word: &'static str| if is_on { word } else { "-" };
    format!(
        "{exposure} {} {background} {} {}",
        tonemap.word(),
        word(denoise, "denoise"),
        word(fireflies == Fireflies::Spread, "fireflies")
    )
}

/// The inverse of [`text_of`].
fn development_of(text: &str) -> Option<Development> {
    let [exposure, tonemap, background, denoise, fireflies]: [&str; 5] =
        text.split(' ').collect::<Vec<_>>().try_into().ok()?;
    let &(_, tonemap) = Tonemap::WORDS.iter().find(|(word, _)| *word == tonemap)?;
    let background = match background {
        "environment" => Background::Environment,
        "transparent" => Background::Transparent,
        color => {
            let color: Option<Vec<f32>> = color.split(',').map(|number| number.parse().ok()).collect();
            Background::Color(color?.try_into().ok()?)
        }
    };
    let fireflies = if fireflies == "fireflies" { Fireflies::Spread } else { Fireflies::Keep };
    Some(Development {
        exposure: exposure.parse().ok()?,
        tonemap,
        background,
        denoise: denoise == "denoise",
        fireflies,
    })
}
