//! Films of parts of a picture, merged band by band: their sums are read as the merged film is written.
//!
//! Parts that are rows or crops of the picture are in memory only while their rows are written, so that a picture may be larger
//! than the memory. Parts with other samples of the same pixels would all be in memory at once: those are better merged as
//! [films](FilmFile::merge).

use std::fmt;
use std::io::{Seek, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use lookfrom_scene::budget::Reservation;
use lookfrom_scene::image::{ExrFill, ExrRowStream, write_exr};
use lookfrom_scene::settings::{Background, PixelBounds};
use lookfrom_scene::{Budget, Error, ErrorKind, Files, LoadContext, Location, Result};

use super::encode::{Light, Rows};
use super::film_file::{self, Opened};
use super::layers::Layers;
use super::options::unsuitable;
use super::{Developed, Development, FilmFile, Fireflies, Provenance, header, spectral};
use crate::film::{Film, Picture, StoredRows};

/// Number of rows that are read together.
const BAND: u32 = 32;

/// Bytes of a pixel of a band while it is read and written: its sums in a tile and in the film, its numbers in the files.
const OF_BAND: u64 = 1500;

/// Bytes of a pixel for each bucket of a spectral film.
const OF_BUCKET: u64 = 80;

/// Films of parts of a picture, of which only the headers are in memory.
pub struct FilmParts<'a> {
    files: &'a dyn Files,
    budget: Budget,
    /// The provenance of all parts, with a film that knows their samples but has no sums.
    whole: Option<FilmFile>,
    parts: Vec<PartFile>,
}

impl fmt::Debug for FilmParts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FilmParts").field("parts", &self.parts).finish_non_exhaustive()
    }
}

/// A film's file.
#[derive(Debug)]
struct PartFile {
    path: PathBuf,
    area: PixelBounds,
    /// Among the numbers of its rows, the place of each channel of the film.
    places: Vec<usize>,
    /// Length of the file.
    bytes: u64,
}

impl<'a> FilmParts<'a> {
    /// None yet. What is read comes from `files` and counts in the budget.
    pub fn new(files: &'a dyn Files, budget: &Budget) -> Self {
        Self { files, budget: budget.clone(), whole: None, parts: Vec::new() }
    }

    /// Adds a film; `adapt` may change the texts that may differ between films of the same picture.
    ///
    /// # Errors
    /// As [`FilmFile::read`] and [`FilmFile::merge`]. Then it is not added.
    pub fn add(&mut self, path: &Path, adapt: impl FnOnce(&mut Provenance)) -> Result<()> {
        let bytes = LoadContext::within(&self.budget, self.files).read(path)?;
        let length = bytes.len() as u64;
        let Opened { places, mut file, .. } = Opened::new(bytes, path)?;
        adapt(&mut file.provenance);
        let area = file.film.area();
        match &mut self.whole {
            None => self.whole = Some(file),
            Some(whole) => {
                whole.merge(&file).map_err(|error| Error { at: Location::file(path), ..error })?;
            }
        }
        self.parts.push(PartFile { path: path.to_owned(), area, places, bytes: length });
        Ok(())
    }

    /// The film that they are together: it knows its samples, but has no sums.
    pub fn whole(&self) -> Option<&FilmFile> {
        self.whole.as_ref()
    }

    /// Whether a development needs all pixels at once: to denoise them, or to spread fireflies.
    pub fn need_all(&self, development: &Development) -> bool {
        let is_denoised = |FilmFile { film, .. }: &FilmFile| film.ledger().is_from_start(film.area());
        development.fireflies == Fireflies::Spread
            || development.denoise && self.whole.as_ref().is_some_and(is_denoised)
    }

    /// Whether they can be merged in bands, and that takes less memory than to have the whole film.
    pub fn are_bands(&self) -> bool {
        self.whole.as_ref().is_some_and(|FilmFile { film, provenance }| {
            !self.need_all(&provenance.development)
                && self.most_bytes() + band_bytes(film) < film.memory_of(film.area())
        })
    }

    /// The most bytes of files that are open at the same time.
    fn most_bytes(&self) -> u64 {
        let open = |row: u32| -> u64 {
            let is_open = |part: &&PartFile| (part.area.y0..part.area.y1 + BAND).contains(&row);
            self.parts.iter().filter(is_open).map(|part| part.bytes).sum()
        };
        self.parts.iter().map(|part| open(part.area.y0 / BAND * BAND + BAND)).max().unwrap_or(0)
    }

    /// The rows of a part, from its first on.
    fn open(&self, part: &PartFile) -> Result<ExrRowStream> {
        let PartFile { path, area, places, .. } = part;
        let bytes = LoadContext::within(&self.budget, self.files).read(path)?;
        let opened = Opened::new(bytes, path)?;
        if opened.places != *places || opened.file.film.area() != *area {
            let message = "this film was changed while it was merged";
            return Err(Error::new(ErrorKind::Io, &Location::file(path), message).hint("merge again"));
        }
        opened.rows.stream(area.y0..area.y1)
    }

    /// Writes the merged film with its picture; `adapt` may change the texts of its provenance.
    ///
    /// # Errors
    /// As [`FilmFile::read`]; `Io` where `out` fails; `Request` if there are no parts.
    pub fn write(
        &self,
        adapt: impl FnOnce(&Provenance, &Film) -> Provenance,
        out: &mut (impl Write + Seek),
    ) -> Result<()> {
        let (FilmFile { film, provenance }, mut bands) = self.bands()?;
        let texts = header::finished(&provenance.header, film, &provenance.development, false);
        let mut channels = Vec::new();
        bands.with_rows(|rows| channels = rows.channels());
        let header = adapt(provenance, film).exr_header(film, channels, &texts);
        write_exr(&header, &mut bands, out)
    }

    /// Develops the merged film, without its layers.
    ///
    /// # Errors
    /// As [`FilmParts::write`]; `Request` for a development that [needs all pixels](FilmParts::need_all).
    pub fn develop(&self, development: &Development) -> Result<Developed> {
        if self.need_all(development) {
            return Err(unsuitable(
                "denoising and the spreading of fireflies need the whole film".to_owned(),
            ));
        }
        let (FilmFile { film, provenance }, mut bands) = self.bands()?;
        let [width, height] = [film.width(), film.height()];
        let pixels = Vec::with_capacity(width as usize * height as usize);
        let mut picture = Picture { width, height, pixels, alpha: Vec::new() };
        for y0 in (0..height).step_by(BAND as usize) {
            let rows = y0..height.min(y0 + BAND);
            bands.prepare(rows.clone())?;
            let band = PixelBounds { x0: 0, y0, x1: width, y1: rows.end };
            let Picture { pixels, alpha, .. } = bands.film.picture_of(band);
            picture.pixels.extend(pixels);
            picture.alpha.extend(alpha);
        }
        let header = header::finished(&provenance.header, film, development, false);
        Ok(Developed {
            picture,
            layers: Vec::new(),
            cryptomattes: Vec::new(),
            header,
            denoised: false,
            development: *development,
        })
    }

    /// The merged film before its first row is read.
    fn bands(&self) -> Result<(&FilmFile, Bands<'_>)> {
        let Some(whole) = &self.whole else {
            return Err(unsuitable("there are no films to merge".to_owned()));
        };
        let memory =
            self.budget.reserve(band_bytes(&whole.film), "rows of the merged film", &Location::default())?;
        let bands = Bands {
            parts: self,
            film: whole.film.clone(),
            light_paths: header::light_paths(&whole.provenance.header).map(str::to_owned).collect(),
            buckets: spectral::channels(&whole.provenance.header),
            background: whole.provenance.development.background,
            open: Mutex::default(),
            first: 0,
            next: 0,
            _memory: memory,
        };
        Ok((whole, bands))
    }
}

/// The bytes reserved for the rows of a merged film that are in memory.
fn band_bytes(film: &Film) -> u64 {
    u64::from(film.width()) * u64::from(BAND) * (OF_BAND + film.buckets() as u64 * OF_BUCKET)
}

/// The merged film while it is written: of its sums, only those of some rows are in memory.
struct Bands<'a> {
    parts: &'a FilmParts<'a>,
    film: Film,
    light_paths: Vec<String>,
    buckets: Vec<String>,
    background: Background,
    /// The files of parts of which some rows, but not all, have been read, by the number of the part.
    open: Mutex<Vec<(usize, ExrRowStream)>>,
    /// The first row that may be wanted, and the next to be read.
    first: u32,
    next: u32,
    _memory: Reservation,
}

impl Bands<'_> {
    /// Calls `use_rows` with the rows of the picture.
    fn with_rows(&self, use_rows: impl FnOnce(&Rows<'_>)) {
        let film = &self.film;
        let light_paths = self.light_paths.iter().map(String::as_str).collect();
        let buckets = self.buckets.clone();
        let layers = &Layers::OfFilm { film, light_paths, cryptomattes: &[], buckets, noisy: None };
        use_rows(&Rows { light: Light::Film(film), layers, background: self.background });
    }

    /// Reads some rows of a part.
    fn read(&mut self, number: usize, rows: Range<u32>) -> Result<()> {
        let part = &self.parts.parts[number];
        let open = self.open.get_mut().unwrap_or_else(PoisonError::into_inner);
        let index = match open.iter().position(|(known, _)| *known == number) {
            Some(index) => index,
            None => {
                open.push((number, self.parts.open(part)?));
                open.len() - 1
            }
        };
        let width = self.film.width() as usize;
        let mut sums = StoredRows::of(&mut self.film, part.area)?;
        for row in rows.clone() {
            let numbers = open[index].1.next_row()?;
            sums.load(row, |channel| &numbers[part.places[channel] * width..][..width])?;
        }
        sums.flush()?;
        if rows.end == part.area.y1 {
            open.swap_remove(index);
        }
        Ok(())
    }
}

impl ExrFill for Bands<'_> {
    fn prepare(&mut self, rows: Range<u32>) -> Result<()> {
        self.film.forget(&(self.first..rows.start));
        self.first = rows.start;
        while self.next < rows.end {
            let band = self.next..self.next + BAND;
            for number in 0..self.parts.parts.len() {
                let PixelBounds { y0, y1, .. } = self.parts.parts[number].area;
                let rows = band.start.max(y0)..band.end.min(y1);
                if !rows.is_empty() {
                    self.read(number, rows)?;
                }
            }
            self.next = band.end;
        }
        Ok(())
    }

    fn fill(&self, row: u32, bytes: &mut [u8]) {
        self.with_rows(|rows| film_file::fill(&self.film, rows, row, bytes));
    }
}
