//! Validation of a scene that no reader has made: that every id leads to something, every array has the length that it
//! should, and numbers are those that their documentation allows. A world compiled from a valid scene renders without a panic.

mod camera;
mod light;
mod material;
mod settings;
mod shape;
mod texture;

use std::fmt::Display;

use glam::{DMat4, Vec3};

use crate::chain;
use crate::error::{Error, Location, Result};
use crate::grid::Placed;
use crate::image::Image;
use crate::light::Power;
use crate::material::{Color, Scalar};
use crate::medium::{DROPLETS, Density, Medium};
use crate::scene::{CurveId, ImageId, Instance, MaterialId, MediumId, Scene, TextureId};
use crate::spectrum::Curve;

pub(crate) use camera::check_surface;

impl Scene {
    /// Checks that the scene is as the documentation of its parts says. Scenes from readers are.
    ///
    /// # Errors
    /// `Invalid` for an id without a target, an array of the wrong length, a number out of range, or a texture or material
    /// that is made of itself; `Limit` for too deep chains of textures or materials, and too large a picture.
    pub fn validate(&self) -> Result<()> {
        camera::check(self)?;
        self.image.validate()?;
        self.render.validate()?;
        let nowhere = Location::default();
        for (index, curve) in self.curves.iter().enumerate() {
            check_curve(&Part::new(self, &nowhere, "spectrum").numbered(index, None), curve)?;
        }
        for (index, image) in self.images.iter().enumerate() {
            check_picture(&Part::new(self, &nowhere, "image").numbered(index, Some(&image.name)), image)?;
        }
        texture::check(self)?;
        material::check(self)?;
        for (index, medium) in self.media.iter().enumerate() {
            check_medium(&Part::new(self, &medium.at, "medium").numbered(index, Some(&medium.name)), medium)?;
        }
        shape::check(self)?;
        for (index, instance) in self.instances.iter().enumerate() {
            check_instance(&Part::new(self, &instance.at, "instance").numbered(index, None), instance)?;
        }
        light::check(self)?;
        let textures = chain::check(&self.textures, 0..self.textures.len());
        let materials = chain::check(&self.materials, 0..self.materials.len());
        Error::all(textures.into_iter().chain(materials).collect()).map_or(Ok(()), Err)
    }
}

fn check_curve(part: &Part<'_>, curve: &Curve) -> Result<()> {
    match curve {
        Curve::Constant(value) => part.finite("value", &[f64::from(*value)]),
        Curve::Tabulated { wavelengths, values } => {
            part.as_many("values", values.len(), "wavelengths", wavelengths.len())?;
            if !wavelengths.is_sorted_by(|a, b| a < b) {
                return Err(part.fault("its wavelengths are not in strictly ascending order"));
            }
            part.all("values", values, "finite", |value| value.is_finite())
        }
        Curve::Blackbody { kelvin } => part.finite("kelvin", &[f64::from(*kelvin)]),
    }
}

fn check_picture(part: &Part<'_>, image: &Image) -> Result<()> {
    let texels = u64::from(image.width) * u64::from(image.height);
    if texels > 0 && texels == image.len() as u64 {
        return Ok(());
    }
    Err(part.fault(format!("it has {}×{} texels, but data of {}", image.width, image.height, image.len())))
}

fn check_medium(part: &Part<'_>, medium: &Medium) -> Result<()> {
    for (name, color) in medium.extinction.colors() {
        part.color(name, color)?;
    }
    part.color("emission", medium.emission)?;
    part.at_least_zero("scale", medium.scale.into())?;
    part.at_least_zero("emission_scale", medium.emission_scale.into())?;
    part.number("g", medium.g.into(), "between −1 and 1", medium.g.abs() < 1.0)?;
    if let Some(lobe) = medium.draine {
        part.number("g", lobe.g.into(), "between −1 and 1", lobe.g.abs() < 1.0)?;
        part.at_least_zero("alpha", lobe.alpha.into())?;
        part.number("share", lobe.share.into(), "from 0 to 1", (0.0..=1.0).contains(&lobe.share))?;
    }
    if let Some(diameter) = medium.droplets {
        part.number("droplets", diameter.into(), "between 0.1 and 50", DROPLETS.contains(&diameter))?;
    }
    let Some(variation) = &medium.variation else { return Ok(()) };
    part.matrix("world_from_medium", &variation.world_from_medium)?;
    if variation.world_from_medium.determinant() == 0.0 {
        return Err(part.fault("world_from_medium has no inverse"));
    }
    if let Some(bounds) = variation.bounds {
        check_box(part, bounds)?;
    }
    match &variation.density {
        Density::Grid(placed) => check_numbers(part, "density", placed)?,
        Density::Colors { absorption, scattering, emission } => {
            for (name, colors) in
                [("absorption", absorption), ("scattering", scattering), ("emission", emission)]
            {
                let Some(placed) = colors else { continue };
                check_box(part, placed.bounds)?;
                let is_color = |rgb: &[f32; 3]| rgb.iter().all(|value| *value >= 0.0 && value.is_finite());
                part.all(name, placed.grid.stored(), "a colour of finite numbers ≥ 0", is_color)?;
            }
            if let (Some(absorption), Some(scattering)) = (absorption, scattering)
                && absorption.grid.size() != scattering.grid.size()
            {
                return Err(part.fault("absorption and scattering have grids of different sizes"));
            }
        }
        Density::Cloud { density, wispiness, frequency } => {
            part.finite("cloud", &[*density, *wispiness, *frequency].map(f64::from))?;
        }
        Density::Texture { of, most } => {
            part.scalar("density", *of)?;
            part.at_least_zero("most", f64::from(*most))?;
        }
    }
    if let Some(placed) = &variation.emission_scale {
        check_numbers(part, "emission_scale", placed)?;
    }
    let Some(temperature) = &variation.temperature else { return Ok(()) };
    check_box(part, temperature.grid.bounds)?;
    part.all("temperature", temperature.grid.grid.stored(), "finite", |value| value.is_finite())?;
    part.finite("temperature", &[temperature.offset, temperature.scale].map(f64::from))
}

fn check_numbers(part: &Part<'_>, name: &str, placed: &Placed<f32>) -> Result<()> {
    check_box(part, placed.bounds)?;
    let is_valid = |value: &f32| *value >= 0.0 && value.is_finite();
    part.all(name, placed.grid.stored(), "a finite number ≥ 0", is_valid)
}

fn check_box(part: &Part<'_>, bounds @ [low, high]: [Vec3; 2]) -> Result<()> {
    for corner in bounds {
        part.finite("bounds", &corner.to_array().map(f64::from))?;
    }
    match low.cmple(high).all() {
        true => Ok(()),
        false => Err(part.fault("bounds has a first corner beyond the second")),
    }
}

fn check_instance(part: &Part<'_>, instance: &Instance) -> Result<()> {
    part.id("object", instance.object.index(), part.scene.objects.len())?;
    if let Some(material) = instance.material {
        part.material(material)?;
    }
    part.matrix("world_from_object", &instance.world_from_object)
}

/// A part of a scene that is checked.
#[derive(Clone, Copy)]
struct Part<'a> {
    scene: &'a Scene,
    at: &'a Location,
    /// The kind of thing, such as `material`.
    kind: &'a str,
    /// The index among parts of its kind and its own name, if it has them.
    index: Option<usize>,
    name: Option<&'a str>,
}

impl<'a> Part<'a> {
    /// The only part of a kind.
    fn new(scene: &'a Scene, at: &'a Location, kind: &'a str) -> Self {
        Self { scene, at, kind, index: None, name: None }
    }

    /// One of several parts of its kind.
    fn numbered(self, index: usize, name: Option<&'a str>) -> Self {
        Self { index: Some(index), name, ..self }
    }

    /// The error of this part, which begins like `material 3 "glass": `.
    fn fault(&self, message: impl Display) -> Error {
        let index = self.index.map(|index| format!(" {index}")).unwrap_or_default();
        let name = self.name.map(|name| format!(" {name:?}")).unwrap_or_default();
        Error::invalid(self.at, format!("{}{index}{name}: {message}", self.kind))
    }

    /// Checks an index into an arena of things of a kind.
    fn id(&self, kind: &str, index: usize, count: usize) -> Result<()> {
        if index < count {
            return Ok(());
        }
        Err(self.fault(format!("there is no {kind} {index}; the scene has {count}, from 0")))
    }

    fn material(&self, id: MaterialId) -> Result<()> {
        self.id("material", id.index(), self.scene.materials.len())
    }

    fn texture(&self, id: TextureId) -> Result<()> {
        self.id("texture", id.index(), self.scene.textures.len())
    }

    fn curve(&self, id: CurveId) -> Result<()> {
        self.id("spectrum", id.index(), self.scene.curves.len())
    }

    fn image(&self, id: ImageId) -> Result<()> {
        self.id("image", id.index(), self.scene.images.len())
    }

    fn power(&self, power: &Power) -> Result<()> {
        self.finite("power", &[power.scale, power.total.unwrap_or(0.0)].map(f64::from))
    }

    fn medium(&self, id: Option<MediumId>) -> Result<()> {
        id.map_or(Ok(()), |id| self.id("medium", id.index(), self.scene.media.len()))
    }

    fn color(&self, name: &str, color: Color) -> Result<()> {
        match color {
            Color::Value(rgb) => self.finite(name, &rgb.map(f64::from)),
            Color::Texture(id) => self.texture(id),
            Color::Curve(id) => self.curve(id),
        }
    }

    fn scalar(&self, name: &str, scalar: Scalar) -> Result<()> {
        match scalar {
            Scalar::Value(value) => self.finite(name, &[value.into()]),
            Scalar::Texture(id) => self.texture(id),
        }
    }

    fn matrix(&self, name: &str, matrix: &DMat4) -> Result<()> {
        self.finite(name, &matrix.to_cols_array())
    }

    /// Checks the numbers of a value.
    fn finite(&self, name: &str, numbers: &[f64]) -> Result<()> {
        match numbers.iter().find(|number| !number.is_finite()) {
            None => Ok(()),
            Some(number) => Err(self.fault(format!("{name} has {number}; expected finite numbers"))),
        }
    }

    fn positive(&self, name: &str, number: f64) -> Result<()> {
        self.number(name, number, "a positive number", number > 0.0 && number.is_finite())
    }

    fn at_least_zero(&self, name: &str, number: f64) -> Result<()> {
        self.number(name, number, "a number ≥ 0", number >= 0.0 && number.is_finite())
    }

    /// Checks a number, given what is expected and whether it is that.
    fn number(&self, name: &str, number: f64, expected: &str, is_valid: bool) -> Result<()> {
        if is_valid { Ok(()) } else { Err(self.fault(format!("{name} is {number}; expected {expected}"))) }
    }

    /// Checks each item of an array.
    fn all<T>(&self, name: &str, items: &[T], expected: &str, is_valid: impl Fn(&T) -> bool) -> Result<()> {
        match items.iter().position(|item| !is_valid(item)) {
            None => Ok(()),
            Some(index) => Err(self.fault(format!("{name}[{index}] is not {expected}"))),
        }
    }

    /// Checks the length of an array by that of another.
    fn as_many(&self, name: &str, count: usize, others: &str, expected: usize) -> Result<()> {
        if count == expected {
            return Ok(());
        }
        Err(self.fault(format!("it has {count} {name} for {expected} {others}; expected one for each")))
    }

    /// Checks the length of an array of vertices' attributes, which may be absent.
    fn none_or_as_many(&self, name: &str, count: usize, vertices: usize) -> Result<()> {
        if count == 0 { Ok(()) } else { self.as_many(name, count, "vertices", vertices) }
    }
}
