//! Media, and those on the sides of shapes.

use std::rc::Rc;

use super::Reader;
use super::plugin::{Plugin, Property, Value};
use crate::error::Result;
use crate::material::Color;
use crate::medium::{Medium, Sides};
use crate::scene::MediumId;
use crate::spectrum::Curve;

impl Reader<'_, '_> {
    /// The media that a shape bounds.
    pub(super) fn sides(&mut self, shape: &Plugin) -> Result<Option<Sides>> {
        let (inside, outside) =
            (self.medium_named(shape, "interior")?, self.medium_named(shape, "exterior")?);
        Ok((inside.is_some() || outside.is_some()).then_some(Sides { inside, outside }))
    }

    fn medium_named(&mut self, shape: &Plugin, name: &str) -> Result<Option<MediumId>> {
        let Some(property) = shape.find(name) else { return Ok(None) };
        match property.plugin(&self.ids)?.filter(|plugin| plugin.class == "medium") {
            Some(medium) => self.medium(&medium).map(Some),
            None => Err(property.wrong("a <medium>")),
        }
    }

    pub(super) fn medium(&mut self, plugin: &Rc<Plugin>) -> Result<MediumId> {
        if let Some(&id) = self.media.get(&Rc::as_ptr(plugin)) {
            return Ok(id);
        }
        if plugin.kind != "homogeneous" {
            return Err(plugin.unsupported(&["homogeneous"]));
        }
        plugin.ignore(&["sample_emitters", "has_spectral_extinction"]);
        let sigma_t = self.coefficient(plugin, "sigma_t", 1.0)?;
        let albedo = self.coefficient(plugin, "albedo", 0.75)?;
        if albedo.iter().any(|value| *value > 1.0) {
            return Err(plugin.refuse("albedo", "numbers from 0 to 1"));
        }
        let scale = plugin.float_where("scale", 1.0, "a number of at least 0", |scale| scale >= 0.0)?;
        let part = |of: fn(f32) -> f32| Color::Value(std::array::from_fn(|i| sigma_t[i] * of(albedo[i])));
        let g = match plugin.part("phase", &self.ids)? {
            None => 0.0,
            Some(phase) => match &*phase.kind {
                "isotropic" => 0.0,
                "hg" => phase.float_where("g", 0.8, "a number between −1 and 1", |g| g.abs() < 1.0)?,
                _ => return Err(phase.unsupported(&["hg", "isotropic"])),
            },
        };
        let name = plugin.id.clone().unwrap_or_else(|| plugin.kind.clone());
        self.scene.media.push(Medium {
            absorption: part(|albedo| 1.0 - albedo),
            scattering: part(|albedo| albedo),
            scale: scale as f32,
            g: g as f32,
            ..Medium::clear(name, plugin.at.clone())
        });
        let id = MediumId(self.scene.media.len() as u32 - 1);
        self.media.insert(Rc::as_ptr(plugin), id);
        Ok(id)
    }

    fn coefficient(&mut self, plugin: &Plugin, name: &str, default: f32) -> Result<[f32; 3]> {
        match plugin.find(name) {
            None => Ok([default; 3]),
            Some(Property { value: Value::Color(rgb), .. }) => Ok(*rgb),
            Some(Property { value: Value::Curve(Curve::Constant(value)), .. }) => Ok([*value; 3]),
            Some(Property { value: Value::Float(value), .. }) if *value >= 0.0 => Ok([*value as f32; 3]),
            Some(property) => match property.plugin(&self.ids)? {
                Some(volume) if volume.kind == "constvolume" => self.coefficient(&volume, "value", 1.0),
                Some(volume) => Err(volume.unsupported(&["constvolume"])),
                None => Err(property.wrong("a colour of at least 0")),
            },
        }
    }
}
