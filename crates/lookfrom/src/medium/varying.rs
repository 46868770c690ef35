//! Media that vary in space: their coefficients at a point, and bounds of them.

use glam::{DMat4, DVec3, Mat3, Vec3};
use lookfrom_scene::medium::{Density as Written, Variation};
use lookfrom_simd::{Float, Real};

use super::Coefficients;
use super::cloud::Cloud;
use super::grid::{Lookup, PlacedGrid};
use super::majorants::Majorants;
use crate::core::color::{Unbounded, Wavelengths, blackbody, blackbody_rgb};
use crate::core::lanes::width::Width;
use crate::core::lanes::{LANES, row, store};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;
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

    /// The coefficients at points of medium space, from those where the density is 1; `emission_scale` multiplies what emits in the
    /// place of their emission, which has no meaning where that is 0. Grids are looked up as `lookup` says: of emission, whose product with
    /// absorption is what counts, by a choice of its own.
    #[inline(always)]
    pub(super) fn at<W: Width>(
        &self,
        width: W,
        points: Vector<W::Real>,
        lookup: Lookup<W>,
        even: &Coefficients<W::Real>,
        emission_scale: f32,
        (textures, modes): (&Textures, &[&SpectralMode; LANES]),
    ) -> Coefficients<W::Real> {
        let mut here = *even;
        match &self.density {
            Density::Colors { absorption, scattering, emission } => {
                if let Some(colors) = absorption {
                    here.absorption *= colors.at(width, points, lookup, modes);
                }
                if let Some(colors) = scattering {
                    here.scattering *= colors.at(width, points, lookup, modes);
                }
                if let Some(colors) = emission.as_ref().filter(|_| emission_scale != 0.0) {
                    let emission = colors.at(width, points, lookup.another(), modes);
                    here.emission = emission * points.x.like(emission_scale);
                }
            }
            one => {
                let density = one.numbers(width, points, lookup, textures);
                here.absorption = here.absorption * density;
                here.scattering = here.scattering * density;
            }
        }
        if emission_scale == 0.0 {
            return here.at_most(Coefficients::MOST);
        }
        if let Some(temperature) = &self.temperature {
            let columns = store(points);
            let emission = width.spectra_of(
                #[inline(always)]
                |lane| temperature.emission(Vec3::from_array(row(&columns, lane)), modes[lane]),
            );
            here.emission = emission * points.x.like(emission_scale);
        }
        if let Some(scale) = &self.emission_scale {
            here.emission = here.emission * scale.numbers_at(width, points, Lookup::Interpolated);
        }
        here.at_most(Coefficients::MOST)
    }
}

impl<R: Real> Coefficients<R> {
    /// Absorption and scattering no greater than a bound in any lane.
    #[inline(always)]
    fn at_most(self, most: f32) -> Self {
        let bounded = |spectrum: Spectrum<R>| {
            spectrum.map(
                #[inline(always)]
                |lane| Float::min(lane, lane.like(most)),
            )
        };
        Self { absorption: bounded(self.absorption), scattering: bounded(self.scattering), ..self }
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

    /// The numbers at points of medium space; of colours there are none.
    #[inline(always)]
    fn numbers<W: Width>(
        &self,
        width: W,
        points: Vector<W::Real>,
        lookup: Lookup<W>,
        textures: &Textures,
    ) -> W::Real {
        match self {
            Self::Grid(grid) => grid.numbers_at(width, points, lookup),
            Self::Cloud(cloud) => cloud.at(points),
            Self::Texture { of, most, world_from_medium } => {
                let columns = store(points);
                width.f32s(
                    #[inline(always)]
                    |lane| {
                        let point = Vec3::from_array(row(&columns, lane));
                        let world = world_from_medium.transform_point3(point.as_dvec3());
                        // NaN is no density.
                        textures
                            .float(*of, &TexturePoint { world, ..TexturePoint::NOWHERE })
                            .max(0.0)
                            .min(*most)
                    },
                )
            }
            Self::Colors { .. } => points.x.like(1.0),
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
    #[inline(always)]
    fn at<W: Width>(
        &self,
        width: W,
        points: Vector<W::Real>,
        lookup: Lookup<W>,
        modes: &[&SpectralMode; LANES],
    ) -> Spectrum<W::Real> {
        match &self.uplifted {
            Some(uplifted) if wavelengths(modes[0]).is_some() => {
                let lambda = width.spectra_of(
                    #[inline(always)]
                    |lane| match wavelengths(modes[lane]) {
                        Some(wavelengths) => Spectrum(wavelengths.lambda),
                        None => Spectrum::BLACK,
                    },
                );
                let values = uplifted.spectra_at(width, points, lookup, &lambda);
                if self.spectrum_type != SpectrumType::Illuminant {
                    return values;
                }
                let daylight = width.spectra_of(
                    #[inline(always)]
                    |lane| match wavelengths(modes[lane]) {
                        Some(wavelengths) => wavelengths.daylight,
                        None => Spectrum::BLACK,
                    },
                );
                values * daylight
            }
            _ if let Lookup::OneCell(bits) = lookup => {
                let values = self.rgb.chosen(width, points, bits);
                width.spectra_of(
                    #[inline(always)]
                    |lane| spectrum_of(values[lane], self.spectrum_type, modes[lane]),
                )
            }
            _ => {
                let columns = store(points);
                width.spectra_of(
                    #[inline(always)]
                    |lane| {
                        let point = Vec3::from_array(row(&columns, lane));
                        self.rgb.at(point, |rgb| spectrum_of(rgb, self.spectrum_type, modes[lane]))
                    },
                )
            }
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

/// The wavelengths of a spectral mode.
#[inline(always)]
fn wavelengths(mode: &SpectralMode) -> Option<&Wavelengths> {
    match mode {
        SpectralMode::Spectral(wavelengths) => Some(wavelengths),
        SpectralMode::Rgb => None,
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
