//! Tables of measured materials, compiled: densities that choose normals, and what normals reflect.

use std::fmt;

use glam::Vec3;
use lookfrom_scene::measured as written;
use lookfrom_scene::measured::Tables;

use super::Measured;
use super::half_angle::HalfAngleValues;
use super::interpolant::Interpolant;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::kept::Kept;
use crate::shading::bsdf::lanes::LaneBsdf;

/// The tables of a measured material, compiled.
pub struct MeasuredTables {
    pub(super) is_isotropic: bool,
    /// The density of visible normals.
    vndf: Interpolant<2>,
    /// The density of the numbers that choose one.
    luminance: Interpolant<2>,
    pub(super) values: Values,
    digest: String,
}

/// From directions to `f`.
pub(super) enum Values {
    Adaptive(Box<Reflectances>),
    HalfAngle(HalfAngleValues),
}

/// The reflectance s over the numbers that choose a normal, and what makes `f` of it.
pub(super) struct Reflectances {
    ndf: Interpolant<0>,
    sigma: Interpolant<0>,
    spectra: Interpolant<3>,
    /// Reflectances of red, green and blue, as wavelengths 0, 1 and 2 of a table.
    colors: Interpolant<3>,
}

impl fmt::Debug for MeasuredTables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MeasuredTables({})", self.digest)
    }
}

impl MeasuredTables {
    /// Compiles tables. For each wavelength of RGL's there is the colour, in linear Rec. 709, of what is 1 there and 0 at its neighbours.
    pub fn new(written: &written::Measured, of_wavelengths: &[[f32; 3]]) -> Self {
        let (is_isotropic, digest) = (written.is_isotropic(), written.digest.clone());
        match &written.tables {
            Tables::Adaptive(tables) => {
                let written::Adaptive { phi, theta, wavelengths, .. } = &**tables;
                Self {
                    is_isotropic,
                    vndf: Interpolant::density(&tables.vndf, [phi, theta]),
                    luminance: Interpolant::density(&tables.luminance, [phi, theta]),
                    values: Values::Adaptive(Box::new(Reflectances {
                        ndf: Interpolant::plain(&tables.ndf, []),
                        sigma: Interpolant::plain(&tables.sigma, []),
                        spectra: Interpolant::plain(&tables.spectra, [phi, theta, wavelengths]),
                        colors: Interpolant::plain(
                            &colors(tables, of_wavelengths),
                            [phi, theta, &[0.0, 1.0, 2.0]],
                        ),
                    })),
                    digest,
                }
            }
            Tables::HalfAngle(tables) => {
                let values = HalfAngleValues::new(tables);
                let [vndf, luminance] = values.densities();
                Self { is_isotropic, vndf, luminance, values: Values::HalfAngle(values), digest }
            }
        }
    }

    /// The compiled tables of a file, which are kept as long as the process, once for each content. As [`Self::new`].
    pub fn kept(written: &written::Measured, of_wavelengths: &[[f32; 3]]) -> &'static Self {
        static TABLES: Kept<MeasuredTables> = Kept::new();
        TABLES.get(|known| known.digest == written.digest, || Self::new(written, of_wavelengths))
    }

    /// The numbers that choose a normal by its place, and the density of their directions but for the [`jacobian`](super::jacobian); φ and θ are those of
    /// the outgoing direction.
    pub(super) fn invert(&self, [phi, theta]: [f32; 2], normal: [f32; 2]) -> [f32; 3] {
        let (u, of_normal) = self.vndf.invert(normal, &self.vndf.between([phi, theta]));
        let of_luminance = self.luminance.pdf(u, &self.luminance.between([phi, theta]));
        [u[0], u[1], of_normal * of_luminance]
    }

    /// The place of a normal by two numbers, those which choose it, and the density, which is 0 where there is none; as
    /// [`Self::invert`].
    pub(super) fn sample(&self, [phi, theta]: [f32; 2], u: [f32; 2]) -> [f32; 5] {
        let sampled = self.luminance.sample(u, &self.luminance.between([phi, theta]));
        let Some((u, of_luminance)) = sampled else { return [0.0; 5] };
        let Some((normal, of_normal)) = self.vndf.sample(u, &self.vndf.between([phi, theta])) else {
            return [0.0; 5];
        };
        [normal[0], normal[1], u[0], u[1], of_luminance * of_normal]
    }

    /// The fraction of light from all around that is reflected straight up, in linear Rec. 709.
    pub(crate) fn albedo(&'static self) -> [f32; 3] {
        const COUNT: u32 = 256;
        let bsdf = Measured::new(self, None);
        let numbers =
            |index: u32| [(index as f32 + 0.5) / COUNT as f32, index.reverse_bits() as f32 * 2_f32.powi(-32)];
        let mut sum = Spectrum::BLACK;
        let seen = bsdf.prepare(Vec3::Z.into());
        let samples = (0..COUNT).map(|index| bsdf.sample(&seen, 0.0, numbers(index)));
        for sample in samples.filter(|sample| sample.is_valid && sample.pdf > 0.0) {
            sum += sample.f * (sample.wi.z.abs() / sample.pdf / COUNT as f32);
        }
        sum.rgb()
    }
}

/// Spectra as colours, in place of three wavelengths.
fn colors(written: &written::Adaptive, of_wavelengths: &[[f32; 3]]) -> written::Table {
    let area = written.spectra.area();
    let count = written.wavelengths.len();
    let mut values = Vec::with_capacity(written.spectra.values.len() / count * 3);
    for tables in written.spectra.values.chunks(area * count) {
        for channel in 0..3 {
            values.extend((0..area).map(|place| {
                let terms = of_wavelengths.iter().enumerate();
                terms.map(|(k, color)| color[channel] * tables[k * area + place]).sum::<f32>().max(0.0)
            }));
        }
    }
    written::Table { size: written.spectra.size, values }
}

impl Reflectances {
    /// The reflectance by the numbers that choose a normal, for wavelengths or for red, green and blue.
    pub(super) fn reflectances(
        &self,
        [phi, theta]: [f32; 2],
        u: [f32; 2],
        wavelengths: Option<[f32; 4]>,
    ) -> Spectrum {
        match wavelengths {
            Some(wavelengths) => {
                let at = |nm| self.spectra.value(u, &self.spectra.between([phi, theta, nm]));
                Spectrum(wavelengths.map(|nm| at(nm).max(0.0)))
            }
            None => {
                let at = |channel: f32| self.colors.value(u, &self.colors.between([phi, theta, channel]));
                Spectrum::from_rgb([0.0, 1.0, 2.0].map(at))
            }
        }
    }

    /// The density of normals at the place of one, and the projected area of the facets at that of a direction.
    pub(super) fn facets(&self, normal: [f32; 2], direction: [f32; 2]) -> [f32; 2] {
        let ndf = self.ndf.value(normal, &self.ndf.between([]));
        [ndf, self.sigma.value(direction, &self.sigma.between([]))]
    }
}
