//! Answers of a window to the questions of its page.

use lookfrom::inspect;
use lookfrom::session::{Format, Session};
use lookfrom_scene::settings::{ImageSettings, RenderSettings};
use lookfrom_scene::{Error, Result, toml};

use crate::compare::luminance_variance;
use crate::develop::Shown;
use crate::mailbox::Outgoing;
use crate::message::{Answer, FileFormat, Header, Request, TableAnswer};
use crate::render::Window;
use crate::view::refused;
use crate::view_render::ViewRender;
use crate::{lobe, source, space, words};

/// The most samples of a pixel that are inspected at once: it takes a second or so.
const MOST_INSPECTED: u32 = 4096;

impl Window {
    /// The answer to a question.
    ///
    /// # Errors
    /// `Request` for what is not in the picture, or where there is none yet.
    pub(crate) fn answer_to(&self, question: &Request) -> Result<Outgoing> {
        let text = |answer: Answer| Outgoing::Text(answer.text());
        match *question {
            Request::Pixel { id, x, y } => self.pixel(id, [x, y]).map(text),
            Request::Inspect { id, x, y, sample, depth, min_contribution } => {
                self.inspection(id, [x, y], sample, depth, min_contribution).map(text)
            }
            Request::Lobe { id, x, y, sample, address } => self.lobe(id, [x, y], sample, address).map(text),
            Request::Value { id, x, y } => self.value(id, [x, y]).map(text),
            Request::Words { id } => self.words(id, self.slice.is_some()).map(text),
            Request::Vocabulary { id } => {
                let tables = toml::vocabulary().into_iter().map(|(title, keys)| TableAnswer { title, keys });
                Ok(text(Answer::Vocabulary { id, tables: tables.collect() }))
            }
            Request::Space { id, ref camera, size } => {
                let loaded = self.loaded.as_ref().ok_or_else(nothing_yet)?;
                let session = self.render.as_ref().map_or(&loaded.session, |render| &render.session);
                Ok(Outgoing::Binary(space::frame(session, id, camera, size)?))
            }
            Request::Save { id, format } => self.file(id, format),
            Request::Handout { id, pixel, sample } => {
                Ok(self.named(id, "html", "text/html", self.handout(pixel, sample)?.as_bytes()))
            }
            Request::View(_) | Request::Pause { .. } => Err(refused("internal error: this is no question")),
        }
    }

    /// The render of the view.
    pub(crate) fn rendered(&self) -> Result<&ViewRender> {
        self.render.as_ref().ok_or_else(nothing_yet)
    }

    /// The session, developed as the picture on the screen is.
    pub(crate) fn as_shown(&self) -> Result<Session> {
        let (Some(render), Some(request)) = (&self.render, &self.request) else { return Err(nothing_yet()) };
        let mut session = render.session.clone();
        let own = session.image().clone();
        let tonemap = request.tonemap(own.tonemap)?;
        session.set_image(ImageSettings {
            exposure: request.exposure,
            tonemap,
            denoise: request.denoise,
            ..own
        })?;
        Ok(session)
    }

    pub(crate) fn pixel(&self, id: u64, pixel: [u32; 2]) -> Result<Answer> {
        let session = self.as_shown()?;
        let samples = session.settings().samples.min(MOST_INSPECTED);
        let report = Box::new(inspect::inspect_pixel(session.renderer(), pixel, 0..samples)?);
        Ok(Answer::Pixel { id, report })
    }

    pub(crate) fn inspection(
        &self,
        id: u64,
        pixel: [u32; 2],
        sample: u32,
        depth: Option<u32>,
        min_contribution: Option<f32>,
    ) -> Result<Answer> {
        let sample = self.rendered()?.checked(pixel, sample)?;
        let mut session = self.as_shown()?;
        let own = session.settings().clone();
        session.set_settings(RenderSettings {
            depth: depth.unwrap_or(own.depth).min(256),
            min_contribution: min_contribution.unwrap_or(own.min_contribution),
            ..own
        })?;
        let inspection = inspect::inspect(session.renderer(), sample);
        let text = inspection.to_string();
        Ok(Answer::Inspection { id, inspection: Box::new(inspection), text })
    }

    pub(crate) fn lobe(&self, id: u64, pixel: [u32; 2], sample: u32, address: u64) -> Result<Answer> {
        let render = self.rendered()?;
        let sample = render.checked(pixel, sample)?;
        lobe::answer(render.session.renderer(), id, sample, address).map(|lobe| Answer::Lobe(Box::new(lobe)))
    }

    pub(crate) fn value(&self, id: u64, [x, y]: [u32; 2]) -> Result<Answer> {
        let render = self.rendered()?;
        render.check_pixel([x, y])?;
        let film = render.film.as_ref().ok_or_else(nothing_yet)?;
        let reference = self.loaded.as_ref().and_then(|loaded| loaded.reference.as_ref());
        let reference = reference.filter(|image| x < image.width && y < image.height);
        Ok(Answer::Value {
            id,
            x,
            y,
            rgb: film.mean(x, y),
            samples: film.samples(x, y),
            deviation: luminance_variance(film, [x, y]).sqrt(),
            reference: reference.map(|image| image.texel(y as usize * image.width as usize + x as usize)),
        })
    }

    /// The view in words. The scene file is whole where there is none beside which it could be saved, or imports the scene's.
    pub(crate) fn words(&self, id: u64, is_whole: bool) -> Result<Answer> {
        let (Some(render), Some(request), Some(own)) = (&self.render, &self.request, &self.loaded) else {
            return Err(nothing_yet());
        };
        let settings = self.document.settings();
        let source = source::of_toml(&settings.scene, self.document.files());
        let toml = words::toml(&render.session, own, request, source.as_deref(), is_whole)?;
        let command = words::command(&render.session, request, &settings.typed);
        Ok(Answer::Words { id, toml, command })
    }

    /// The finished bytes of the picture in its colours.
    pub(crate) fn picture(&self, format: Format) -> Result<Vec<u8>> {
        let (Some(render), Some(request), Some(loaded)) = (&self.render, &self.request, &self.loaded) else {
            return Err(nothing_yet());
        };
        let film = render.film.as_ref().ok_or_else(nothing_yet)?;
        Shown { session: &render.session, film, is_coarse: false, loaded, request }.file(format)
    }

    fn file(&self, id: u64, format: FileFormat) -> Result<Outgoing> {
        let (format, extension, mime) = match format {
            FileFormat::Png => (Format::Png, "png", "image/png"),
            FileFormat::Exr => (Format::Exr, "exr", "image/x-exr"),
        };
        Ok(self.named(id, extension, mime, &self.picture(format)?))
    }

    /// A file with the name of the scene.
    fn named(&self, id: u64, extension: &str, mime: &'static str, bytes: &[u8]) -> Outgoing {
        let stem = self.document.settings().scene.file_stem().unwrap_or_default().to_string_lossy();
        let header = Header::File { id, name: format!("{stem}.{extension}"), mime };
        Outgoing::Binary(header.frame(&[bytes]))
    }
}

pub(crate) fn nothing_yet() -> Error {
    refused("there is no picture yet")
}
