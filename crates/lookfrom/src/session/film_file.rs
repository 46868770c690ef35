//! Films as files: OpenEXR pictures for every viewer, which also hold the exact sums and know what they are of.
//!
//! The channels `R`, `G`, `B` … are the picture. The channels `film.*` are the sums of [`Film`], as unsigned integers
//! ([`Film::stored_channels`]). The attributes `film.*` are texts: `film.ledger` (which samples of which pixels it
//! holds, [`SampleLedger`]), `film.area`, `film.dropped` (samples that were not finite, and the first), `film.inputs`
//! (the digests of the scene's files), `film.options` (the digest of what else decides samples), `film.sampling` (the
//! version of the code that computes samples), `film.develop` ([`Development`]), `film.scene` and `film.arguments` (to go
//! on) and `film.goal` (the samples that are not all there yet). `crc32` is the checksum of the file.

use std::io::{Seek, Write};
use std::path::Path;

use lookfrom_scene::budget::Reservation;
use lookfrom_scene::image::{ExrChannel, ExrHeader, ExrRows, write_exr};
use lookfrom_scene::settings::PixelBounds;
use lookfrom_scene::{Budget, Error, ErrorKind, Limits, Location, Remedy, Result};

use super::layers;
use super::provenance::{FORMAT, PREFIX, Provenance, Texts};
use super::{Developed, Development, encode, finish, header};
use crate::film::{Film, Layout, MOST_PIXELS, SampleId, SampleLedger, StoredRows};

/// A film and its provenance, as a file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// The film.
    pub film: Film,
    /// The origin of the film.
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
    /// it is too large, or the budget for it and its picture too small.
    pub fn read(bytes: &[u8], path: &Path, budget: &Budget) -> Result<Self> {
        let Opened { rows, places, file } = Opened::new(bytes, path)?;
        let Self { mut film, provenance } = file;
        let what = format!("a film of {} × {} pixels", film.width(), film.height());
        let _memory = budget.reserve(film.memory_of(film.area()), &what, &Location::file(path))?;
        let width = film.width() as usize;
        let area = film.area();
        let mut sums = StoredRows::of(&mut film, area)?;
        rows.read(&mut |row, numbers| {
            sums.load(row, |channel| &numbers[places[channel] * width..][..width])
        })?;
        sums.flush()?;
        Ok(Self { film, provenance })
    }

    /// Adds another film of the same picture: other samples, or other pixels, for which room is made. The goal of either
    /// is forgotten.
    ///
    /// # Errors
    /// `Invalid` where it is of another picture (it says what differs) or another part of an adaptive one, or has samples that this one has
    /// already. Then no sample has been added.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        self.provenance.check_same(&other.provenance)?;
        if !self.provenance.adapts_as(&other.provenance) {
            let message = "films with different limits of noise, or different allocations of samples";
            return Err(Error::invalid(&Location::default(), message));
        }
        if self.provenance.is_adaptive() && self.film.area() != other.film.area() {
            let message = "an adaptive picture has no parts: all of it decides where its samples are";
            return Err(Error::invalid(&Location::default(), message)
                .hint("render parts with the same number of samples for all pixels"));
        }
        self.film.enlarge(other.film.area());
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
        finish::develop(&self.film, development, &self.provenance.header)
    }

    /// Writes the file, with the picture that was developed from the film.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write(&self, developed: &Developed, out: &mut (impl Write + Seek)) -> Result<()> {
        self.provenance.write(&self.film, developed, out)
    }

    /// The memory that the film takes, with one that is [merged](FilmFile::merge), and what developing it takes.
    ///
    /// # Errors
    /// `Limit` if the budget is exceeded.
    pub fn room_for(&self, other: Option<&Self>, budget: &Budget, path: &Path) -> Result<Reservation> {
        let film = &self.film;
        let what = format!("the merged film of {} × {} pixels", film.width(), film.height());
        let area = other.map_or(film.area(), |other| film.area().union(other.film.area()));
        budget.reserve(film.memory_of(area), &what, &Location::file(path))
    }
}

/// A film's file of which only the header has been read.
pub(super) struct Opened<B> {
    /// Its rows, and among their numbers the place of each channel of the film.
    pub(super) rows: ExrRows<B>,
    pub(super) places: Vec<usize>,
    /// The origin of the film, with one that knows its samples but has no sums.
    pub(super) file: FilmFile,
}

impl<B: AsRef<[u8]>> Opened<B> {
    /// Reads the header, and tests the checksum of the file.
    ///
    /// # Errors
    /// As [`FilmFile::read`].
    pub(super) fn new(bytes: B, path: &Path) -> Result<Self> {
        let at = Location::file(path);
        let limits = Limits { texels: MOST_PIXELS, ..Limits::default() };
        let rows = ExrRows::open(bytes, &at, &limits)?;
        let found = rows.header();
        let texts = Texts { attributes: &found.attributes, at: &at };
        match texts.find(PREFIX) {
            Some(FORMAT) => {}
            Some(other) => {
                let message = format!("a film of format {other}; this program reads format {FORMAT}");
                return Err(Error::new(ErrorKind::Unsupported, &at, message)
                    .hint("use the version of the program that wrote it"));
            }
            None => {
                let message = "this picture has no film: only its light, not the sums of its samples";
                return Err(Error::invalid(&at, message).hint(Remedy::KeptFilm));
            }
        }
        let provenance = Provenance::of_texts(&texts)?;

        // An empty film with the same sums.
        let [x0, y0, x1, y1] = texts.read("film.area", numbers)?;
        let area = PixelBounds { x0, y0, x1, y1 };
        if x0 >= x1 || y0 >= y1 || x1 > found.width || y1 > found.height {
            return Err(texts.damaged("film.area is not a part of the picture"));
        }
        let is_of_sums = |(_, kind): &&(String, ExrChannel)| *kind == ExrChannel::Uint;
        let names: Vec<&str> = found.channels.iter().filter(is_of_sums).map(|(name, _)| &**name).collect();
        let layout = Layout::of_channels(&names);
        let mut film = Film::with_layout([found.width, found.height], area, layout)
            .map_err(|error| Error { at: at.clone(), ..error })?;
        let place = |name: &String| {
            let place =
                found.channels.iter().position(|(known, kind)| known == name && *kind == ExrChannel::Uint);
            place.ok_or_else(|| texts.damaged(&format!("it has no channel {name}")))
        };
        let places = film.stored_channels().iter().map(place).collect::<Result<Vec<usize>>>()?;

        // Its ledger.
        let ledger: SampleLedger = texts.read("film.ledger", |text| text.parse().ok())?;
        if ledger.bounds().is_some_and(|b| b.x0 < x0 || b.y0 < y0 || b.x1 > x1 || b.y1 > y1) {
            return Err(texts.damaged("its ledger has pixels outside of film.area"));
        }
        *film.ledger_mut() = ledger;
        let [count, x, y, sample] = texts.read("film.dropped", numbers)?;
        let first = (count > 0).then_some(SampleId { pixel: [x as u32, y as u32], sample: sample as u32 });
        film.set_dropped(count, first);
        Ok(Self { rows, places, file: FilmFile { film, provenance } })
    }
}

impl Provenance {
    /// Writes a film of this provenance as a file, with its picture.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write(&self, film: &Film, developed: &Developed, out: &mut (impl Write + Seek)) -> Result<()> {
        let Developed { picture, header, development, .. } = developed;
        let layers = &developed.layers_with(Some(film));
        let light = encode::Light::Picture(picture);
        let rows = encode::Rows { light, layers, background: development.background };
        self.write_rows(film, &rows, header, out)
    }

    fn write_rows(
        &self,
        film: &Film,
        rows: &encode::Rows<'_>,
        texts: &[(String, String)],
        out: &mut (impl Write + Seek),
    ) -> Result<()> {
        let texts: Vec<_> = texts.iter().cloned().chain(rows.layers.attributes()).collect();
        let header = self.exr_header(film, rows.channels(), &texts);
        write_exr(&header, &mut |row: u32, bytes: &mut [u8]| fill(film, rows, row, bytes), out)
    }

    /// The header of a film's file, whose picture has these channels and texts.
    pub(super) fn exr_header(
        &self,
        film: &Film,
        channels: Vec<String>,
        texts: &[(String, String)],
    ) -> ExrHeader {
        let channels = channels.into_iter().map(|name| (name, ExrChannel::Float));
        let sums = film.stored_channels().into_iter().map(|name| (name, ExrChannel::Uint));
        let mut attributes = texts.to_vec();
        attributes.extend(self.attributes(film));
        attributes.sort();
        ExrHeader {
            width: film.width(),
            height: film.height(),
            crop: None,
            channels: channels.chain(sums).collect(),
            attributes,
            is_fast: true,
            has_checksum: true,
        }
    }

    /// Writes an unfinished film: its picture is the light as it was computed, and AOVs are in the sums only.
    ///
    /// # Errors
    /// `Io` where `out` fails.
    pub fn write_checkpoint(&self, film: &Film, out: &mut (impl Write + Seek)) -> Result<()> {
        let header = header::finished(&self.header, film, &self.development, false);
        let light = encode::Light::Film(film);
        let layers = &layers::Layers::Given(&[]);
        let rows = encode::Rows { light, layers, background: self.development.background };
        self.write_rows(film, &rows, &header, out)
    }
}

/// Writes the numbers of a row of a film's file: of its picture, and of the sums of the film.
pub(super) fn fill(film: &Film, rows: &encode::Rows<'_>, row: u32, bytes: &mut [u8]) {
    let (of_picture, of_sums) = bytes.split_at_mut(rows.channels().len() * film.width() as usize * 4);
    rows.fill(row, of_picture);
    film.store_row(row, of_sums);
}

/// Numbers with spaces between them.
fn numbers<T: std::str::FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(' ').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok()
}
