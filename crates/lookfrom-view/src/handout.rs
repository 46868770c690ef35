//! A hand-out: the page with one picture and one pixel as a single file, which is opened without a server and asks nobody.
//!
//! It holds the answers of a window, as they would be sent to its page.

use std::fmt::Write;
use std::sync::Arc;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lookfrom::session::Format;
use lookfrom_scene::files::SharedFiles;
use lookfrom_scene::plural::counted;
use lookfrom_scene::{Inputs, Result};
use serde_json::Value;

use crate::document::Document;
use crate::mailbox::Mailbox;
use crate::message::{Answer, Header, ViewRequest};
use crate::render::Window;
use crate::view::refused;
use crate::{Settings, bundle, source, space, told};

/// The most samples whose rays are held.
const MOST_SAMPLES: usize = 8;

/// Renders a scene in its own view, follows the samples of a pixel (by default the middle one), and returns the page as HTML. It holds the
/// brightest samples, and shows that of this number first, if there is one.
///
/// # Errors
/// Errors of the scene; `Request` for a pixel or a sample that it does not have.
pub fn handout(
    settings: Settings,
    files: SharedFiles,
    pixel: Option<[u32; 2]>,
    sample: Option<u32>,
) -> Result<String> {
    let document = Arc::new(Document::new(settings, files));
    let loaded = Arc::new(document.load(1, &Inputs::default())?);
    let image = loaded.session.image();
    let view = ViewRequest { exposure: image.exposure, denoise: image.denoise, ..ViewRequest::default() };
    check(pixel, [image.width, image.height])?;
    let samples = loaded.session.settings().samples;
    if let Some(sample) = sample.filter(|sample| *sample >= samples) {
        return Err(refused(format!(
            "there is no sample {sample}: the picture has {} per pixel, counted from 0",
            counted(samples, "sample")
        )));
    }
    let mut window = Window::new(Arc::<Mailbox>::default(), document, None);
    window.loaded = Some(loaded);
    window.look(view)?;
    while window.has_work() {
        window.step()?;
    }
    window.handout(pixel, sample)
}

/// # Errors
/// `Request` for a pixel that a picture of this size does not have.
fn check(pixel: Option<[u32; 2]>, [width, height]: [u32; 2]) -> Result<()> {
    match pixel {
        Some([x, y]) if x >= width || y >= height => {
            Err(refused(format!("pixel {x} {y} is outside of the picture of {width} × {height} pixels")))
        }
        _ => Ok(()),
    }
}

impl Window {
    /// The page of the view as it is, as HTML.
    ///
    /// # Errors
    /// As [`handout`], and where there is no picture yet.
    pub(crate) fn handout(&self, pixel: Option<[u32; 2]>, sample: Option<u32>) -> Result<String> {
        let (render, session) = (self.rendered()?, self.as_shown()?);
        let (width, height) = (session.image().width, session.image().height);
        check(pixel, [width, height])?;
        let pixel = pixel.unwrap_or([width / 2, height / 2]);
        let png = self.picture(Format::Png)?;
        let report = self.pixel(0, pixel)?;
        let brightest = match &report {
            Answer::Pixel { report, .. } => report.all.iter().map(|row| row.sample).collect(),
            _ => Vec::new(),
        };
        let others = brightest.into_iter().filter(|&other| Some(other) != sample);
        let held: Vec<u32> = sample.into_iter().chain(others).take(MOST_SAMPLES).collect();
        let samples = held.iter().map(|&sample| self.held(pixel, sample)).collect::<Result<Vec<_>>>()?;
        let mut scene = self.loaded.as_ref().map(|loaded| Box::new(loaded.told(&session)));
        if let Some(scene) = &mut scene {
            scene.reference = None;
        }
        let picture = Header::Picture {
            view: 0,
            width,
            height,
            scale: 1,
            samples: render.samples + render.lent.back,
            of: session.settings().samples,
            done: render.is_done(),
            layer: "color".to_owned(),
            seconds: render.spent.as_secs_f64(),
            camera: told::camera(&session),
            screen_from_world: space::of_points(&session),
            sizes: vec![png.len()],
        };
        let [x, y] = pixel;
        // Answers stand here as they are sent: numbers that are read and written again could lose bits.
        let kept = format!(
            r#"{{"pixel":[{x},{y}],"sample":{},"scene":{},"progress":{},"picture":{},"png":"{}","words":{},"report":{},"value":{},"samples":{{{}}},"source":{}}}"#,
            held.first().copied().unwrap_or_default(),
            scene.map(|scene| Answer::Scene(scene).text()).unwrap_or_default(),
            render.progress(0).text(),
            picture.text(),
            STANDARD.encode(&png),
            self.words(0, true)?.text(),
            report.text(),
            self.value(0, pixel)?.text(),
            samples.join(","),
            Value::from(source::of(&self.document.settings().scene, self.document.files()))
        );
        bundle::page("handout.js", "handout", &kept)
    }

    /// The rays of a sample, and the scattering at each of their ends that has a lobe.
    fn held(&self, pixel: [u32; 2], sample: u32) -> Result<String> {
        let inspection = self.inspection(0, pixel, sample, None, None)?;
        let mut lobes = String::new();
        if let Answer::Inspection { inspection, .. } = &inspection {
            for ray in inspection.rays.iter().filter(|ray| ray.met.is_some()) {
                // Mirrors and rays that leave the scene have none.
                if let Ok(lobe) = self.lobe(0, pixel, sample, ray.address) {
                    let comma = if lobes.is_empty() { "" } else { "," };
                    let _ = write!(lobes, "{comma}\"{}\":{}", ray.address, lobe.text());
                }
            }
        }
        Ok(format!(r#""{sample}":{{"inspection":{},"lobes":{{{lobes}}}}}"#, inspection.text()))
    }
}
