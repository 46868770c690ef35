//! The `MakeNamedMedium` directive. Homogeneous media are rendered, others are not.

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
use crate::warning::Warning;

const KINDS: &[&str] = &["cloud", "homogeneous", "nanovdb", "rgbgrid", "uniformgrid"];

/// pbrt's default `sigma_a` and `sigma_s`, in mm⁻¹: whole milk.
const SIGMA_A: [f32; 3] = [0.0011, 0.0024, 0.014];
const SIGMA_S: [f32; 3] = [2.55, 3.21, 3.77];

/// The integrators that support media; the others treat all media as a vacuum.
const KNOWING: &[&str] = &["volpath", "simplevolpath", "bdpt", "mlt"];

/// A named medium.
pub(super) struct NamedMedium {
    /// `None` for a medium that is not rendered.
    id: Option<MediumId>,
    /// That it is not rendered, for a warning when it is used.
    warning: Option<Warning>,
}

impl Reader<'_, '_> {
    pub(super) fn make_medium(&mut self, name: String, p: &Parameters) -> Result<()> {
        let kind = p.string("type")?.unwrap_or_default().to_owned();
        if !KINDS.contains(&kind.as_str()) {
            return Err(Self::unknown(&p.place, "medium", &kind, KINDS.iter().copied()));
        }
        if kind != "homogeneous" || p.has("preset") {
            p.ignore_all();
            let message = format!("the medium {name:?} is not rendered yet: it is treated as a vacuum");
            let warning = Some(Warning::new(&p.place.location(), message));
            self.media.insert(name, NamedMedium { id: None, warning });
            return Ok(());
        }
        let absorption = self.color(p, "sigma_a", Color::Value(SIGMA_A), Unbounded)?;
        let scattering = self.color(p, "sigma_s", Color::Value(SIGMA_S), Unbounded)?;
        let emission = self.light_color(p, "Le")?.unwrap_or(Color::Value([0.0; 3]));
        let at_least_zero =
            |name, default| p.float_where(name, default, "a number of at least 0", |v| v >= 0.0);
        let (scale, emission_scale) = (at_least_zero("scale", 1.0)?, at_least_zero("Lescale", 1.0)?);
        let g = p.float_where("g", 0.0, "a number between -1 and 1", |g| g.abs() < 1.0)?;
        let id = MediumId(self.scene.media.len() as u32);
        self.scene.media.push(Medium {
            name: name.clone(),
            at: p.place.location(),
            absorption,
            scattering,
            g,
            scale,
            emission,
            emission_scale,
        });
        self.media.insert(name, NamedMedium { id: Some(id), warning: None });
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

    /// Records whether the scene's integrator supports media.
    pub(super) fn settle_media(&mut self, integrator: &str, place: &Place) {
        self.scene.render.media = KNOWING.contains(&integrator);
        self.without_media = (!self.scene.render.media).then(|| (integrator.to_owned(), place.clone()));
    }

    /// The media on both sides of the next shape.
    pub(super) fn sides(&mut self, place: &Place) -> Result<Option<Sides>> {
        let Some(names) = self.state.media.clone() else { return Ok(None) };
        let [inside, outside] = [self.medium(&names[0], place)?, self.medium(&names[1], place)?];
        // Equal media on both sides need no interface.
        if names[0] == names[1] {
            return Ok(None);
        }
        names.iter().for_each(|name| self.use_medium(name));
        Ok(Some(Sides { inside, outside }))
    }

    /// The medium around the camera: the outside medium at its definition.
    pub(super) fn medium_around(&mut self, name: &str, camera: &Place) -> Result<Option<MediumId>> {
        let medium = self.medium(name, camera)?;
        self.use_medium(name);
        Ok(medium)
    }

    /// A medium by its name; the vacuum has an empty name.
    fn medium(&self, name: &str, place: &Place) -> Result<Option<MediumId>> {
        if name.is_empty() {
            return Ok(None);
        }
        let known = self.media.keys().map(String::as_str);
        let named = self.media.get(name).ok_or_else(|| Self::unknown(place, "medium", name, known))?;
        Ok(named.id)
    }

    /// Warns of media that are not rendered, when one is first used.
    fn use_medium(&mut self, name: &str) {
        let Some(named) = self.media.get_mut(name) else { return };
        match self.without_media.take() {
            Some((integrator, place)) => {
                let message = format!(
                    "the integrator {integrator:?} does not support media, as in pbrt: they are treated as a vacuum; \"volpath\" supports them"
                );
                self.context.warn(&place.location(), message);
            }
            None if self.scene.render.media => self.context.warnings.extend(named.warning.take()),
            None => {}
        }
    }
}
