//! Parts of a picture that are rendered elsewhere: lent, rendered for another worker, and taken back.

use std::io::Cursor;
use std::path::Path;
use std::time::Duration;

use lookfrom::film::Film;
use lookfrom::render::StopCriteria;
use lookfrom::session::FilmFile;
use lookfrom_scene::settings::RenderSettings;
use lookfrom_scene::{Budget, Result};

use crate::lent::{Lent, Part};
use crate::view::refused;
use crate::view_render::{Stage, ViewRender};

impl ViewRender {
    /// Lends some of the samples that are left, so many that they take about as long as `least`; none where that is nearly the rest.
    pub(crate) fn lend(&mut self, least: Duration) -> Option<Part> {
        if self.stage != Stage::Full || self.film.is_none() || self.samples == 0 {
            return None;
        }
        let pace = self.spent.as_secs_f64() / f64::from(self.samples);
        let wanted = (least.as_secs_f64() / pace.max(1e-9)).ceil().max(1.0);
        let left = self.lent.start - self.samples;
        if f64::from(left) < 2.0 * wanted {
            return None;
        }
        let end = self.lent.start;
        self.lent.start -= wanted as u32;
        self.lent.out += 1;
        Some(Part { picture: self.lent.picture, samples: self.lent.start..end })
    }

    /// Renders a part of the picture of another worker, and returns its film as a file.
    ///
    /// # Errors
    /// An error where the session keeps no films, and for no samples.
    pub(crate) fn render_part(&self, part: &Part) -> Result<Vec<u8>> {
        let settings = RenderSettings { samples: part.samples.end, ..self.session.settings().clone() };
        let renderer = self.session.renderer().with_settings(settings)?;
        let film = Film::for_image(self.session.image())?;
        let rendered = renderer.render_onto(film, part.samples.start, &StopCriteria::default(), None, &())?;
        let mut bytes = Cursor::new(Vec::new());
        self.session.provenance()?.write_checkpoint(&rendered.film, &mut bytes)?;
        Ok(bytes.into_inner())
    }

    /// Takes back a part, with the film that another worker has rendered. Returns whether it has been added: those of earlier pictures
    /// are not. What cannot be added is rendered here.
    pub(crate) fn take_part(&mut self, part: &Part, bytes: &[u8], budget: &Budget) -> bool {
        if part.picture != self.lent.picture {
            return false;
        }
        let is_added = self.add(part, bytes, budget).is_ok();
        if is_added {
            // A film does not say how many rays it took: as many as the samples before.
            let count = part.samples.end - part.samples.start;
            self.rays += self.rays / u64::from(self.samples + self.lent.back) * u64::from(count);
            self.lent.out -= 1;
            self.lent.back += count;
            self.settle();
        } else {
            let back = self.lent.back;
            self.lent = Lent { back, ..Lent::none(self.session.settings().samples) };
        }
        is_added
    }

    fn add(&mut self, part: &Part, bytes: &[u8], budget: &Budget) -> Result<()> {
        let file = FilmFile::read(bytes, Path::new("a part"), budget)?;
        self.session.provenance()?.check_same(&file.provenance)?;
        if file.film.ledger().range() != Some(part.samples.clone()) {
            return Err(refused("this part has other samples"));
        }
        let film = self.film.as_mut().ok_or_else(|| refused("there is no film to add it to"))?;
        film.merge(&file.film)
    }
}
