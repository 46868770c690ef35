//! Spectra of colours that are the same everywhere, for eight samples at once.

use lookfrom_simd::{Simd, f32x8, prelude::*};

use super::input::{Constant, Input};
use super::{SpectralMode, SpectrumTexture, SpectrumType, TexturePoint, Textures};
use crate::core::color::{Sigmoid, Unbounded};
use crate::core::lanes::{Columns, LANES, bitmask, by_lane, gather_spectrum, load, load_spectrum, set_row};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

impl Textures {
    /// As [`Textures::spectrum`], for colours that do not vary. Not inlined, since a material has several.
    #[inline(never)]
    pub(crate) fn constants<S: Simd>(
        &self,
        simd: S,
        colors: &[&SpectrumTexture; LANES],
        modes: &[&SpectralMode; LANES],
    ) -> Spectrum<f32x8<S>> {
        simd.vectorize(
            #[inline(always)]
            || self.constants_now(simd, colors, modes),
        )
    }

    #[inline(always)]
    fn constants_now<S: Simd>(
        &self,
        simd: S,
        colors: &[&SpectrumTexture; LANES],
        modes: &[&SpectralMode; LANES],
    ) -> Spectrum<f32x8<S>> {
        let is_one = bitmask(&by_lane!(lane => std::ptr::eq(colors[lane], colors[0]))) == (1 << LANES) - 1;
        if is_one && let Some(spectra) = uplifted(simd, colors[0], modes) {
            return spectra;
        }
        if let Some(lift) = Lift::new(self, colors, modes) {
            return lift.spectra(simd);
        }
        let mut spectra = [[0.0; LANES]; 4];
        for lane in 0..LANES {
            let spectrum = self.spectrum(colors[lane], &TexturePoint::NOWHERE, modes[lane]);
            set_row(&mut spectra, lane, spectrum.0);
        }
        load_spectrum(simd, &spectra)
    }
}

/// One colour for all samples; `None` where it varies or was not uplifted, and in RGB.
#[inline(always)]
fn uplifted<S: Simd>(
    simd: S,
    color: &SpectrumTexture,
    modes: &[&SpectralMode; LANES],
) -> Option<Spectrum<f32x8<S>>> {
    let Input::Constant(Constant { uplifts: Some(uplifts), .. }) = &color.input else { return None };
    let SpectralMode::Spectral(first) = modes[0] else { return None };
    let wavelengths = by_lane!(lane => match modes[lane] {
        SpectralMode::Spectral(wavelengths) => wavelengths,
        SpectralMode::Rgb => first,
    });
    let lambda = gather_spectrum(simd, &by_lane!(lane => Spectrum(wavelengths[lane].lambda)));
    let Unbounded { scale, sigmoid: Sigmoid([a, b, c]) } = *uplifts.of(color.spectrum_type);
    let [a, b, c] = [f32x8::splat(simd, a), f32x8::splat(simd, b), f32x8::splat(simd, c)];
    let lift = Unbounded { scale: f32x8::splat(simd, scale), sigmoid: Sigmoid([a, b, c]) };
    let spectra = lift.at(&lambda.0);
    Some(match color.spectrum_type {
        SpectrumType::Illuminant => {
            spectra * gather_spectrum(simd, &by_lane!(lane => wavelengths[lane].daylight))
        }
        SpectrumType::Albedo | SpectrumType::Unbounded => spectra,
    })
}

/// Scaled sigmoids in lanes, and the wavelengths at which they are evaluated.
struct Lift {
    coefficients: Columns<3>,
    scale: [f32; LANES],
    lambda: [Spectrum; LANES],
    /// The factors of the sigmoids: daylight for illuminants, the values of curves.
    factor: [Spectrum; LANES],
}

impl Lift {
    /// `None` where a colour varies or was not uplifted, and in RGB.
    #[inline(always)]
    fn new(
        textures: &Textures,
        colors: &[&SpectrumTexture; LANES],
        modes: &[&SpectralMode; LANES],
    ) -> Option<Self> {
        let mut lift = Self {
            coefficients: [[0.0; LANES]; 3],
            scale: [1.0; LANES],
            lambda: [Spectrum::BLACK; LANES],
            factor: [Spectrum([1.0; 4]); LANES],
        };
        for lane in 0..LANES {
            let SpectralMode::Spectral(wavelengths) = modes[lane] else { return None };
            lift.lambda[lane] = Spectrum(wavelengths.lambda);
            let SpectrumTexture { input, spectrum_type, .. } = colors[lane];
            let uplift = match input {
                Input::Constant(Constant { uplifts: Some(uplifts), .. }) => {
                    if *spectrum_type == SpectrumType::Illuminant {
                        lift.factor[lane] = wavelengths.daylight;
                    }
                    *uplifts.of(*spectrum_type)
                }
                Input::Curve(id) => {
                    lift.factor[lane] = textures.curve(*id).at_sampled(wavelengths);
                    Unbounded::gray(1.0)
                }
                _ => return None,
            };
            let Unbounded { scale, sigmoid: Sigmoid(coefficients) } = uplift;
            set_row(&mut lift.coefficients, lane, coefficients);
            lift.scale[lane] = scale;
        }
        Some(lift)
    }

    #[inline(always)]
    fn spectra<S: Simd>(&self, simd: S) -> Spectrum<f32x8<S>> {
        let Vector { x, y, z } = load(simd, &self.coefficients);
        let scale = f32x8::load_array(simd, self.scale);
        let lambda = gather_spectrum(simd, &self.lambda);
        let spectra = Unbounded { scale, sigmoid: Sigmoid([x, y, z]) }.at(&lambda.0);
        spectra * gather_spectrum(simd, &self.factor)
    }
}

#[cfg(test)]
mod tests {
    use lookfrom_scene::material::Color;
    use lookfrom_scene::scene::CurveId;
    use lookfrom_scene::settings::ColorMode;
    use lookfrom_scene::spectrum::named;
    use lookfrom_simd::{Kernel, Level, dispatch};

    use super::*;
    use crate::core::color::Wavelengths;
    use crate::core::hash;
    use crate::core::lanes::scatter_spectrum;

    struct Eight<'a> {
        textures: &'a Textures,
        colors: &'a [SpectrumTexture; LANES],
        modes: &'a [SpectralMode; LANES],
    }

    impl Kernel for Eight<'_> {
        type Output = [Spectrum; LANES];
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let colors = by_lane!(lane => &self.colors[lane]);
            let modes = by_lane!(lane => &self.modes[lane]);
            scatter_spectrum(self.textures.constants(simd, &colors, &modes))
        }
    }

    /// Colours of any size, greys and curves among them, as reflectances, other quantities and light, in RGB and at wavelengths.
    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let mut count = 0_u64;
        let mut number = || {
            count += 1;
            (hash::pair(count, 3) >> 40) as f32 / 16_777_216.0
        };
        let mut levels = vec![Level::baseline(), Level::new()];
        #[cfg(target_arch = "x86_64")]
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
        for round in 0..500 {
            let is_spectral = round % 4 != 0;
            let color_mode = if is_spectral { ColorMode::Spectral } else { ColorMode::Rgb };
            let curve = named("stdillum-A").expect("a curve of our own");
            let textures = Textures::new(&[], Vec::new(), vec![curve], color_mode);
            let colors = std::array::from_fn(|lane| {
                let size = libm::exp2f(8.0 * number() - 6.0);
                let gray = [size * number(); 3];
                let rgb =
                    if number() < 0.2 { gray } else { [number(), number(), number()].map(|c| size * c) };
                let color = if number() < 0.2 { Color::Curve(CurveId(0)) } else { Color::Value(rgb) };
                let types = [SpectrumType::Albedo, SpectrumType::Unbounded, SpectrumType::Illuminant];
                textures.spectrum_texture(color, types[(round + lane) % 3])
            });
            let modes = std::array::from_fn(|_| match is_spectral {
                true => SpectralMode::Spectral(Wavelengths::sample_visible(number())),
                false => SpectralMode::Rgb,
            });
            for &level in &levels {
                let eight = dispatch(level, Eight { textures: &textures, colors: &colors, modes: &modes });
                for lane in 0..LANES {
                    let alone = textures.spectrum(&colors[lane], &TexturePoint::NOWHERE, &modes[lane]);
                    assert_eq!(eight[lane], alone, "{:?} {:?}", colors[lane], modes[lane]);
                }
            }
        }
    }
}
