//! What fills space: media that absorb are rendered, what they would scatter is not.

use std::rc::Rc;

use super::Reader;
use super::lexer::{Lexer, Token};
use super::params::Parameters;
use super::spectra::Meaning::Unbounded;
use super::text::Place;
use crate::error::Result;
use crate::material::Color;
use crate::medium::{Medium, Sides};
use crate::scene::MediumId;

const KINDS: &[&str] = &["cloud", "homogeneous", "nanovdb", "rgbgrid", "uniformgrid"];

/// pbrt's `sigma_a` where a file names none, per mm of its unit.
const SIGMA_A: [f32; 3] = [0.0011, 0.0024, 0.014];

impl Reader<'_, '_> {
    pub(super) fn make_medium(&mut self, name: String, p: &Parameters) -> Result<()> {
        let kind = p.string("type")?.unwrap_or_default().to_owned();
        if !KINDS.contains(&kind.as_str()) {
            return Err(Self::unknown(&p.place, "medium", &kind, KINDS.iter().copied()));
        }
        if kind != "homogeneous" || p.has("preset") {
            p.ignore_all();
            let message = format!("the medium {name:?} is not rendered yet: light passes it as a vacuum");
            self.warn_once(&format!("medium {name}"), &p.place, message);
            self.media.insert(name, None);
            return Ok(());
        }
        let absorption = self.color(p, "sigma_a", Color::Value(SIGMA_A), Unbounded)?;
        let scattering = self.color_or_none(p, "sigma_s", Unbounded)?;
        let is_clear = |color| matches!(color, Color::Value(rgb) if rgb == [0.0; 3]);
        if !scattering.is_some_and(is_clear) {
            let message =
                format!("the medium {name:?} only absorbs: what it would scatter is not rendered yet");
            self.warn_once(&format!("medium {name}"), &p.place, message);
        }
        p.ignore(&["Le", "Lescale", "g"]);
        let scale = p.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
        let id = MediumId(self.scene.media.len() as u32);
        self.scene.media.push(Medium { name: name.clone(), at: p.place.location(), absorption, scale });
        self.media.insert(name, Some(id));
        Ok(())
    }

    pub(super) fn medium_interface(&mut self, lexer: &mut Lexer<'_>) -> Result<()> {
        let inside = lexer.string("a quoted name of a medium, or \"\"")?;
        let mut outside = inside.clone();
        if matches!(lexer.peek()?, Some(Token::Quoted(_))) {
            outside = lexer.string("a quoted name of a medium")?;
        }
        self.state.media = Some(Rc::new([inside, outside]));
        Ok(())
    }

    /// What the next shape has on its sides.
    pub(super) fn sides(&self, place: &Place) -> Result<Option<Sides>> {
        let Some(names) = self.state.media.clone() else { return Ok(None) };
        let find = |name: &String| {
            if name.is_empty() {
                return Ok(None);
            }
            let known = self.media.keys().map(String::as_str);
            self.media.get(name).copied().ok_or_else(|| Self::unknown(place, "medium", name, known))
        };
        let [inside, outside] = [find(&names[0])?, find(&names[1])?];
        // the same on both sides is no border
        Ok((inside != outside).then_some(Sides { inside, outside }))
    }
}
