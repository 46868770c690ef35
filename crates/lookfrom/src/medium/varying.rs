//! Media that vary in space: their coefficients at a point, and bounds of them.

use glam::{DMat4, DVec3, Mat3, Vec3};
use lookfrom_scene::medium::{Density as Written, Variation};

use super::Coefficients;
use super::cloud::Cloud;
use super::grid::PlacedGrid;
use super::majorants::Majorants;
use crate::core::color::{Unbounded, blackbody, blackbody_rgb};
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{
    FloatTexture, SpectralMode, SpectrumType, TexturePoint, Textures, spectrum_of, uplift,
};

/// Variation of a medium in space.
#[derive(Clone, Debug)]
pub struct Varying {
    /// Medium space from render space: a matrix, then an offset.
    medium_from_render: (Mat3, Vec3),
    density: Density,
    emission_scale: Option<PlacedGrid<f32>>,
    temperature: Option<Temperature>,
    pub(super) majorants: Majorants,
}

/// Factor of the coefficients.
#[derive(Clone, Debug)]
enum Density {
    Grid(PlacedGrid<f32>),
    Colors { absorption: Option<Colors>, scattering: Option<Colors>, emission: Option<Colors> },
    Cloud(Cloud),
    Texture { of: FloatTexture, most: f32, world_from_medium: DMat4 },
}

/// Colours of a grid.
#[derive(Clone, Debug)]
struct Colors {
    rgb: PlacedGrid<[f32; 3]>,
    /// As spectra, where those will be evaluated.
    uplifted: Option<PlacedGrid<Unbounded>>,
    spectrum_type: SpectrumType,
}

#[derive(Clone, Debug)]
struct Temperature {
    grid: PlacedGrid<f32>,
    offset: f32,
    scale: f32,
}

/// Temperatures that emit nothing, in kelvin.
const COLD: f32 = 100.0;

/// Layers of a cloud that have bounds of their own.
const LAYERS: u32 = 32;

impl Varying {
    /// Compiles a variation, in a box if it has none of its own: one around a sphere, by its centre in the world and its radius.
    pub(crate) fn compile(
        textures: &Textures,
        written: &Variation,
        origin: DVec3,
        around: (DVec3, f64),
    ) -> Self {
        let medium_from_world = written.world_from_medium.inverse();
        let bounds = written.bounds.unwrap_or_else(|| {
            let (center, radius) = around;
            let center = medium_from_world.transform_point3(center);
            let rows = medium_from_world.transpose();
            let reach = DVec3::new(
                rows.x_axis.truncate().length(),
                rows.y_axis.truncate().length(),
                rows.z_axis.truncate().length(),
            );
            [center - reach * radius, center + reach * radius].map(DVec3::as_vec3)
        });
        let density = Density::compile(textures, written);
        Self {
            medium_from_render: medium_from_render(&medium_from_world, origin),
            majorants: density.majorants(bounds),
            density,
            emission_scale: written.emission_scale.as_ref().map(PlacedGrid::new),
            temperature: written.temperature.as_ref().map(|of| Temperature {
                grid: PlacedGrid::new(&of.grid),
                offset: of.offset,
                scale: of.scale,
            }),
        }
    }

    /// A point of render space in medium space.
    #[inline]
    pub(super) fn point(&self, point: Vec3) -> Vec3 {
        self.medium_from_render.0 * point + self.medium_from_render.1
    }

    /// A direction of render space in medium space, of any length.
    #[inline]
    pub(super) fn direction(&self, direction: Vec3) -> Vec3 {
        self.medium_from_render.0 * direction
    }

    /// The coefficients at a point of medium space, from those where the density is 1; `emission_scale` multiplies what emits in the
    /// place of their emission.
    #[inline]
    pub(super) fn at(
        &self,
        point: Vec3,
        even: &Coefficients,
        emission_scale: f32,
        (textures, mode): (&Textures, &SpectralMode),
    ) -> Coefficients {
        let mut here = *even;
        match &self.density {
            Density::Colors { absorption, scattering, emission } => {
                if let Some(colors) = absorption {
                    here.absorption *= colors.at(point, mode);
                }
                if let Some(colors) = scattering {
                    here.scattering *= colors.at(point, mode);
                }
                if let Some(colors) = emission {
                    here.emission = colors.at(point, mode) * emission_scale;
                }
            }
            one => {
                let density = one.number(point, textures);
                here.absorption = here.absorption * density;
                here.scattering = here.scattering * density;
            }
        }
        if let Some(temperature) = &self.temperature {
            here.emission = temperature.emission(point, mode) * emission_scale;
        }
        if let Some(scale) = &self.emission_scale {
            here.emission = here.emission * scale.at(point, |value| value);
        }
        let limited = |coefficient: Spectrum| coefficient.map(|sigma| sigma.min(Coefficients::MOST));
        Coefficients { absorption: limited(here.absorption), scattering: limited(here.scattering), ..here }
    }
}

impl Density {
    fn compile(textures: &Textures, written: &Variation) -> Self {
        match &written.density {
            Written::Grid(placed) => Self::Grid(PlacedGrid::new(placed)),
            Written::Colors { absorption, scattering, emission } => {
                let colors = |of: &Option<_>, spectrum_type| {
                    of.as_ref().map(|placed| {
                        let rgb: PlacedGrid<[f32; 3]> = PlacedGrid::new(placed);
                        let uplifted = textures.uplifts().then(|| rgb.map(|rgb| uplift(spectrum_type, rgb)));
                        Colors { rgb, uplifted, spectrum_type }
                    })
                };
                Self::Colors {
                    absorption: colors(absorption, SpectrumType::Unbounded),
                    scattering: colors(scattering, SpectrumType::Unbounded),
                    emission: colors(emission, SpectrumType::Illuminant),
                }
            }
            &Written::Cloud { density, wispiness, frequency } => {
                Self::Cloud(Cloud { density, wispiness, frequency })
            }
            &Written::Texture { of, most } => Self::Texture {
                of: FloatTexture::from(of),
                most,
                world_from_medium: written.world_from_medium,
            },
            _ => Self::Texture {
                of: FloatTexture::Constant(0.0),
                most: 0.0,
                world_from_medium: DMat4::IDENTITY,
            },
        }
    }

    /// The number at a point of medium space; of colours there is none.
    #[inline]
    fn number(&self, point: Vec3, textures: &Textures) -> f32 {
        match self {
            Self::Grid(grid) => grid.at(point, |value| value),
            Self::Cloud(cloud) => cloud.at(point),
            Self::Texture { of, most, world_from_medium } => {
                let world = world_from_medium.transform_point3(point.as_dvec3());
                // NaN is no density.
                textures.float(*of, &TexturePoint { world, ..TexturePoint::NOWHERE }).max(0.0).min(*most)
            }
            Self::Colors { .. } => 1.0,
        }
    }

    fn majorants(&self, bounds: [Vec3; 2]) -> Majorants {
        match self {
            Self::Grid(grid) => Majorants::of_grid(bounds, grid, |value| value),
            Self::Cloud(cloud) => Majorants::of_layers(bounds, LAYERS, |low, high| cloud.most(low, high)),
            Self::Texture { most, .. } => Majorants::of_layers(bounds, 1, |_, _| *most),
            Self::Colors { absorption, scattering, .. } => {
                let of = |colors: &Option<Colors>| colors.as_ref().map(|colors| colors.majorants(bounds));
                match (of(absorption), of(scattering)) {
                    (Some(a), Some(b)) => a.plus(&b),
                    (Some(one), None) | (None, Some(one)) => one.plus_one(),
                    (None, None) => Majorants::of_layers(bounds, 1, |_, _| 2.0),
                }
            }
        }
    }
}

impl Colors {
    fn at(&self, point: Vec3, mode: &SpectralMode) -> Spectrum {
        match (&self.uplifted, mode) {
            (Some(uplifted), SpectralMode::Spectral(wavelengths)) => {
                let values = uplifted.spectrum_at(point, &wavelengths.lambda);
                if self.spectrum_type == SpectrumType::Illuminant {
                    values * wavelengths.daylight
                } else {
                    values
                }
            }
            _ => self.rgb.at(point, |rgb| spectrum_of(rgb, self.spectrum_type, mode)),
        }
    }

    /// Bounds of all lanes in the mode that the scene is rendered in.
    fn majorants(&self, bounds: [Vec3; 2]) -> Majorants {
        match &self.uplifted {
            Some(uplifted) => Majorants::of_grid(bounds, uplifted, |of| of.most()),
            None => Majorants::of_grid(bounds, &self.rgb, |[r, g, b]| r.max(g).max(b)),
        }
    }
}

impl Temperature {
    /// The blackbody radiance at a point, relative to its maximum.
    fn emission(&self, point: Vec3, mode: &SpectralMode) -> Spectrum {
        let kelvin = (self.grid.at(point, |value| value) - self.offset) * self.scale;
        match mode {
            _ if !(kelvin > COLD) => Spectrum::BLACK,
            SpectralMode::Rgb => Spectrum::from_rgb(blackbody_rgb(kelvin)),
            SpectralMode::Spectral(wavelengths) => blackbody(kelvin, wavelengths),
        }
    }
}

/// Medium space from render space, whose origin is a point of the world.
fn medium_from_render(medium_from_world: &DMat4, origin: DVec3) -> (Mat3, Vec3) {
    let matrix = glam::DMat3::from_mat4(*medium_from_world);
    (matrix.as_mat3(), medium_from_world.transform_point3(origin).as_vec3())
}
