//! `[media]`: participating media, and the bodies that they fill.

use glam::{DMat4, Vec3};

use super::table::Table;
use super::value::Value;
use super::volume::{CLOUD, COLORS, Hot, Volume, cloud};
use super::{Reader, transform};
use crate::error::Result;
use crate::grid::Placed;
use crate::material::{Color, Material, MaterialKind, Scalar};
use crate::medium::presets::Preset;
use crate::medium::{DROPLETS, Density, DraineLobe, Extinction, Medium, Variation};
use crate::scene::{MaterialId, MediumId};
use crate::volume::placement;

/// The keys of media, besides those of transforms.
pub(super) const KEYS: &[&str] = &[
    "preset",
    "absorption",
    "scattering",
    "extinction",
    "albedo",
    "g",
    "droplets",
    "draine",
    "density",
    "max_density",
    "emission",
    "temperature",
    "density_scale",
    "emission_scale",
    "emission_density",
    "bounds",
];

/// Mean cosine g of a lobe of a phase function.
fn mean_cosine(value: Value<'_>) -> Result<f32> {
    value.single_where("a number between -1 and 1, exclusive", |g| g.abs() < 1.0)
}

/// A second lobe of a phase function.
fn draine(value: Value<'_>) -> Result<DraineLobe> {
    let table = value.table("a lobe")?;
    table.allow(&[&["g", "alpha", "share"]]);
    let g = table.or("g", 0.0, mean_cosine);
    let alpha = table.or("alpha", 1.0, |value| {
        value.single_where("a number of at least 0", |alpha| alpha >= 0.0 && alpha.is_finite())
    });
    let share = table.or("share", 1.0, |value| {
        value.single_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share))
    });
    Ok(DraineLobe { g, alpha, share })
}

impl Reader<'_, '_> {
    /// Reads `[media]`.
    pub(super) fn read_media(&mut self, value: Value<'_>) {
        self.knows_all_names &= value.is_table();
        for entry in value.named("[media]") {
            let name = entry.key();
            let id = MediumId(self.scene.media.len() as u32);
            if let Some(before) = self.media.insert(name.to_owned(), id) {
                entry.note(super::twice(entry, "medium", &self.scene.media[before.index()].at));
            }
            let table = entry.table(format!("[media.{name}]"));
            let medium = match entry.noting(table.map(Some), None) {
                Some(table) => self.medium(name, &table),
                None => Medium::clear(name, entry.at()),
            };
            self.scene.media.push(medium);
        }
    }

    fn medium(&mut self, name: &str, table: &Table<'_>) -> Medium {
        table.allow(&[KEYS, transform::KEYS]);
        let mut medium = Medium::clear(name, table.at());
        medium.extinction = self.extinction(table);
        table.one_of(&["g", "droplets"]);
        table.one_of(&["draine", "droplets"]);
        medium.draine = table.maybe("draine", draine);
        medium.g = table.or("g", 0.0, mean_cosine);
        medium.droplets = table.maybe("droplets", |value| {
            let what = "a diameter in micrometres, of 0.1 to 50";
            value.single_where(what, |diameter| DROPLETS.contains(&diameter))
        });
        let density = table.maybe("density", |value| self.density(value, table));
        let temperature = table.maybe("temperature", |value| self.temperature(value));
        (medium.emission, medium.emission_scale) = match temperature {
            None => table.or("emission", (Color::BLACK, 1.0), |value| self.light_color(value, false)),
            Some(_) => {
                let factor = table.or("emission", 1.0, |value| {
                    value.single_where("a factor of at least 0", |factor| factor >= 0.0)
                });
                (Color::BLACK, factor * Medium::ABSOLUTE)
            }
        };
        let factor = |value: Value<'_>| value.single_where("a number of at least 0", |factor| factor >= 0.0);
        medium.emission_scale = table.or("emission_scale", medium.emission_scale, factor);
        medium.scale = table.or("density_scale", 1.0, factor);
        if let Some(Number::Even(density)) = density {
            medium.scale *= density;
        }
        let emission_density = table.maybe("emission_density", |value| self.volume(value));
        medium.variation = varying(table, density, temperature, emission_density).map(|variation| {
            Variation { bounds: table.or("bounds", variation.bounds, box_or_none), ..variation }
        });
        medium
    }

    fn extinction(&mut self, table: &Table<'_>) -> Extinction {
        for part in ["preset", "absorption", "scattering"] {
            table.one_of(&[part, "extinction"]);
        }
        table.one_of(&["scattering", "albedo"]);
        let Some(sum) = table.maybe("extinction", |value| self.coefficient(value)) else {
            if let Some(albedo) = table.find("albedo") {
                albedo.note(albedo.error("`albedo` needs an `extinction`"));
            }
            let preset = table.maybe("preset", preset);
            let [absorption, scattering] = preset
                .map_or([[0.0; 3]; 2], |preset| [preset.absorption, preset.scattering])
                .map(Color::Value);
            return Extinction::Parts {
                absorption: table.or("absorption", absorption, |value| self.coefficient(value)),
                scattering: table.or("scattering", scattering, |value| self.coefficient(value)),
            };
        };
        let albedo = table.or("albedo", Color::BLACK, |value| match self.coefficient(value)? {
            Color::Value(rgb) if rgb.iter().any(|part| *part > 1.0) => {
                Err(value.wrong("numbers from 0 to 1"))
            }
            albedo => Ok(albedo),
        });
        Extinction::Sum { sum, albedo }
    }

    /// A coefficient per unit of length: the same everywhere.
    fn coefficient(&mut self, value: Value<'_>) -> Result<Color> {
        match self.optical_color(value)? {
            Color::Texture(_) => Err(value
                .error(format!("`{}` is a texture; expected a number or a colour", value.key()))
                .hint("what varies is the `density`")),
            color => Ok(color),
        }
    }

    /// A density: a number, a texture, or numbers by the place.
    fn density(&mut self, value: Value<'_>, table: &Table<'_>) -> Result<Number> {
        if value.is_table() && !value.table("a density")?.has("type") {
            let of = value.table("a density")?;
            let has = |keys: &[&str]| keys.iter().any(|key| of.has(key));
            return Ok(match () {
                () if has(CLOUD) => Number::Varying(cloud(&of)),
                () if has(COLORS) => Number::Varying(self.colors(&of)?),
                () => Number::Volume(self.volume(value)?),
            });
        }
        let most = table.or("max_density", 1.0, |value| {
            value.single_where("a number greater than 0", |most| most > 0.0 && most.is_finite())
        });
        Ok(match self.scalar_where(value, "a number of at least 0", |density| density >= 0.0)? {
            Scalar::Value(density) => Number::Even(density),
            of => Number::Varying(Density::Texture { of, most }),
        })
    }

    /// The medium with the name in `value`.
    pub(super) fn medium_named(&self, value: Value<'_>) -> Result<MediumId> {
        let name = value.text("the name of a medium")?;
        self.named(&self.media, "medium", value, name)
    }

    /// A material, or where there is none an interface, of bodies that are filled with a medium.
    pub(super) fn filled(&mut self, material: Option<MaterialId>, medium: MediumId) -> MaterialId {
        if let Some(&id) = self.filled.get(&(material, medium)) {
            return id;
        }
        let written = match material {
            Some(id) => self.scene.materials[id.index()].clone(),
            None => {
                let Medium { name, at, .. } = &self.scene.media[medium.index()];
                Material::new(name.clone(), at.clone(), MaterialKind::Interface)
            }
        };
        let id = MaterialId(self.scene.materials.len() as u32);
        self.scene.materials.push(Material { medium: Some(medium), ..written });
        self.filled.insert((material, medium), id);
        id
    }
}

/// The measured medium with the name in `value`.
pub(super) fn preset(value: Value<'_>) -> Result<&'static Preset> {
    let known: Vec<_> = Preset::all().iter().map(|preset| (preset.name, preset)).collect();
    value.choice(&known)
}

/// A number that may vary.
enum Number {
    Even(f32),
    Varying(Density),
    Volume(Volume),
}

/// Two corners, or `"none"`.
fn box_or_none(value: Value<'_>) -> Result<Option<[Vec3; 2]>> {
    if value.as_text() == Some("none") {
        return Ok(None);
    }
    let expected = "two corners, the lower and the upper one, or \"none\"";
    let [low, high] = value.list_of(expected)?;
    let [low, high] = [super::shape::point(low)?, super::shape::point(high)?];
    if low.cmple(high).all() { Ok(Some([low, high])) } else { Err(value.wrong(expected)) }
}

/// The variation of a medium in space, if it has any. It is told in the space of the densities or, where they have none of their own, of
/// the temperatures, or of what multiplies the emission.
fn varying(
    table: &Table<'_>,
    density: Option<Number>,
    temperature: Option<Hot>,
    emission: Option<Volume>,
) -> Option<Variation> {
    let (density, grid) = match density {
        Some(Number::Volume(volume)) => (None, Some(volume)),
        Some(Number::Varying(density)) => (Some(density), None),
        Some(Number::Even(_)) | None => (None, None),
    };
    let volumes = [
        ("density", grid.as_ref()),
        ("temperature", temperature.as_ref().map(|hot| &hot.volume)),
        ("emission_density", emission.as_ref()),
    ];
    let first = volumes.into_iter().find_map(|(key, volume)| Some((key, volume?.world_from_medium)));
    if first.is_none() && density.is_none() {
        return None;
    }
    let space = first.unwrap_or(("density", DMat4::IDENTITY));
    let temperature = temperature.and_then(|mut hot| {
        hot.volume = placed_in(space, "temperature", hot.volume, table)?;
        Some(hot)
    });
    let emission = emission.and_then(|volume| placed_in(space, "emission_density", volume, table));
    let bounds = [grid.as_ref(), temperature.as_ref().map(|hot| &hot.volume)];
    let around = |[a, b]: [Vec3; 2], [c, d]: [Vec3; 2]| [a.min(c), b.max(d)];
    Some(Variation {
        world_from_medium: transform::after(table, &transform::world_from_object(table), &space.1),
        bounds: bounds.into_iter().flatten().map(|volume| volume.bounds).reduce(around),
        density: match grid {
            Some(volume) => Density::Grid(volume.placed),
            None => density.unwrap_or(Density::Texture { of: Scalar::Value(1.0), most: 1.0 }),
        },
        emission_scale: emission.map(|volume| volume.placed),
        temperature: temperature.map(Hot::temperature),
    })
}

/// A volume, the value of a key, in the space of that of another key.
fn placed_in(
    (name, space): (&str, DMat4),
    key: &'static str,
    volume: Volume,
    table: &Table<'_>,
) -> Option<Volume> {
    let Some(place) = placement(&space, &volume.world_from_medium, volume.bounds) else {
        table.note(table.error_at(key, format!("its axes are not those of `{name}`")));
        return None;
    };
    let placed = Placed { bounds: volume.placed.bounds.map(&place), ..volume.placed };
    Some(Volume { placed, bounds: volume.bounds.map(&place), world_from_medium: space })
}
