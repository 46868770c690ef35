//! Textures at eight points side by side, in RGB: checkerboards of two colours, and pictures. The bits are those of
//! [`Textures::spectrum`].

use glam::DMat4;
use lookfrom_scene::texture::{Channel, Mapping, TexelFilter};
use lookfrom_simd::{Float, Real, Simd, f32x8, f64x8, mask64x8, prelude::*};

use super::evaluation::{Evaluation, RgbEvaluation};
use super::input::{Input, SpectrumTexture};
use super::look_ups::Picture;
use super::mapping::{self, bounded};
use super::node::Node;
use super::{Textures, picture};
use crate::core::lanes::{by_lane, gather_spectrum, splat_spectrum};
use crate::core::spectrum::Spectrum;
use crate::core::vector::Vector;

/// Inputs of texture evaluation at eight points.
#[derive(Clone, Copy)]
pub(crate) struct TexturePoints<S: Simd> {
    /// Texture coordinates, where they are known.
    pub(crate) uv: Option<[f32x8<S>; 2]>,
    /// Positions in world space (not render space).
    pub(crate) world: Vector<f64x8<S>>,
}

impl Textures {
    /// The spectra at eight points; `None` for textures that are not evaluated side by side. Not inlined, since a material has several.
    #[inline(never)]
    pub(crate) fn spectra<S: Simd>(
        &self,
        simd: S,
        texture: &SpectrumTexture,
        at: &TexturePoints<S>,
    ) -> Option<Spectrum<f32x8<S>>> {
        simd.vectorize(
            #[inline(always)]
            || self.spectra_now(simd, texture, at),
        )
    }

    #[inline(always)]
    fn spectra_now<S: Simd>(
        &self,
        simd: S,
        texture: &SpectrumTexture,
        at: &TexturePoints<S>,
    ) -> Option<Spectrum<f32x8<S>>> {
        let Input::Texture(id) = texture.input else { return None };
        let evaluation = RgbEvaluation(texture.spectrum_type);
        match &self.nodes[id.index()] {
            Node::Checker {
                even: Input::Constant(even),
                odd: Input::Constant(odd),
                footprint: 0.0,
                mapping,
            } => {
                let is_even = are_even(off_border(mapping, at)?);
                let is_even = f32x8::splat(simd, 0.0).narrow_mask(is_even);
                let (even, odd) = (evaluation.constant(even), evaluation.constant(odd));
                Some(Spectrum::select(is_even, splat_spectrum(simd, even), splat_spectrum(simd, odd)))
            }
            Node::Image { picture, channel: Channel::Rgb, scale, invert } => {
                let Picture { image, mapping, wraps, filter, .. } = &self.pictures[*picture as usize];
                if *filter != TexelFilter::Bilinear {
                    return None;
                }
                let p = Vector::<f32x8<S>>::narrow(coordinates(mapping, at)?);
                // v runs up, rows run down.
                let st = [p.x, -p.y + 1.0];
                let texels = picture::look_up_lanes(simd, &self.images[*image], st, *wraps);
                Some(gather_spectrum(
                    simd,
                    &by_lane!(lane => {
                        let [r, g, b, _] = texels[lane];
                        evaluation.texel([scale * r, scale * g, scale * b], *invert, *filter)
                    }),
                ))
            }
            _ => None,
        }
    }
}

/// As [`mapping::coordinates`]; `None` for mappings of other kinds, and where texture coordinates are not known.
#[inline(always)]
fn coordinates<S: Simd>(mapping: &Mapping, at: &TexturePoints<S>) -> Option<Vector<f64x8<S>>> {
    let zero = Float::like(at.world.x, 0.0);
    match mapping {
        Mapping::Uv { scale, offset } => {
            let [u, v] = at.uv?;
            let (s, t) = (u * scale[0] + offset[0], v * scale[1] + offset[1]);
            Some(Vector { x: Real::widen(bounded(s)), y: Real::widen(bounded(t)), z: zero })
        }
        Mapping::Affine { set: 0, matrix: [[a, b, c], [d, e, f]] } => {
            let [u, v] = at.uv?;
            let (s, t) = (u * *a + v * *b + *c, u * *d + v * *e + *f);
            Some(Vector { x: Real::widen(bounded(s)), y: Real::widen(bounded(t)), z: zero })
        }
        Mapping::World { texture_from_world } => {
            let Vector { x, y, z } = transformed(texture_from_world, at.world);
            Some(Vector { x: bounded(x), y: bounded(y), z: bounded(z) })
        }
        _ => None,
    }
}

/// As [`mapping::off_border`].
#[inline(always)]
fn off_border<S: Simd>(mapping: &Mapping, at: &TexturePoints<S>) -> Option<Vector<f64x8<S>>> {
    let p = coordinates(mapping, at)?;
    let shift = Float::like(p.x, mapping::OFF_BORDER);
    Some(match mapping {
        Mapping::World { .. } => p + Vector { x: shift, y: shift, z: shift },
        _ => p,
    })
}

/// Whether the sums of the integer parts of bounded numbers are even.
#[inline(always)]
fn are_even<S: Simd>(p: Vector<f64x8<S>>) -> mask64x8<S> {
    let half = (Float::floor(p.x) + Float::floor(p.y) + Float::floor(p.z)) * 0.5;
    Float::eq(Float::floor(half), half)
}

/// Points, transformed.
#[inline(always)]
fn transformed<S: Simd>(matrix: &DMat4, p: Vector<f64x8<S>>) -> Vector<f64x8<S>> {
    let [x, y, z, w] = [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis];
    Vector {
        x: p.x * x.x + p.y * y.x + p.z * z.x + w.x,
        y: p.x * x.y + p.y * y.y + p.z * z.y + w.y,
        z: p.x * x.z + p.y * y.z + p.z * z.z + w.z,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2};
    use lookfrom_scene::image::Image;
    use lookfrom_scene::material::Color;
    use lookfrom_scene::scene::{ImageId, TextureId};
    use lookfrom_scene::settings::ColorMode;
    use lookfrom_scene::texture::{TextureKind, Wrap};
    use lookfrom_simd::{Kernel, dispatch, level};

    use super::*;
    use crate::core::hash;
    use crate::core::lanes::{LANES, scatter_spectrum};
    use crate::shading::texture::{SpectralMode, SpectrumType, TexturePoint};

    struct At<'a>(&'a Textures, &'a SpectrumTexture, &'a [TexturePoint<'static>; LANES]);

    impl Kernel for At<'_> {
        type Output = Option<[Spectrum; LANES]>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let Self(textures, texture, points) = self;
            let uv = [
                f32x8::load_array(simd, by_lane!(lane => points[lane].uv.x)),
                f32x8::load_array(simd, by_lane!(lane => points[lane].uv.y)),
            ];
            let world = Vector {
                x: f64x8::load_array(simd, by_lane!(lane => points[lane].world.x)),
                y: f64x8::load_array(simd, by_lane!(lane => points[lane].world.y)),
                z: f64x8::load_array(simd, by_lane!(lane => points[lane].world.z)),
            };
            let spectra = textures.spectra(simd, texture, &TexturePoints { uv: Some(uv), world })?;
            Some(scatter_spectrum(spectra))
        }
    }

    /// A number of any size and sign, now and then a special one.
    fn number(seed: u64, index: u64) -> f64 {
        let bits = hash::pair(seed, index);
        let mantissa = (bits >> 40) as f64 / 8_388_608.0 - 1.0;
        match bits % 41 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -0.0,
            3 => mantissa.round(),
            exponent => mantissa * libm::exp2(exponent as f64 - 6.0),
        }
    }

    fn mappings() -> [Mapping; 4] {
        let turned = DMat4::from_rotation_y(0.3) * DMat4::from_scale(DVec3::splat(5.0));
        [
            Mapping::UV,
            Mapping::Uv { scale: [3.0, -0.7], offset: [0.25, 1e3] },
            Mapping::Affine { set: 0, matrix: [[0.6, -0.8, 0.1], [0.8, 0.6, 7.0]] },
            Mapping::World { texture_from_world: DMat4::from_translation(DVec3::ONE) * turned },
        ]
    }

    #[test]
    fn eight_at_once_are_eight_one_by_one() {
        let texels = (0..35_u64).map(|i| [0, 1, 2].map(|c| (hash::pair(i, c) % 300) as f32 / 200.0 - 0.2));
        let images = vec![Image::from_linear("", 7, 5, texels.collect::<Vec<_>>())];
        let mut kinds = Vec::new();
        for mapping in mappings() {
            let (even, odd) = (Color::Value([0.75, 0.1, 1.5]), Color::Value([0.0, 0.8, 0.2]));
            kinds.push(TextureKind::Checker { even, odd, footprint: 0.0, mapping });
            for (wrap, invert) in [(Wrap::Repeat, false), (Wrap::Black, true), (Wrap::Mirror, false)] {
                kinds.push(TextureKind::Image {
                    image: ImageId(0),
                    mapping,
                    wrap: [wrap, Wrap::Clamp],
                    filter: TexelFilter::Bilinear,
                    channel: Channel::Rgb,
                    scale: 0.5,
                    invert,
                });
            }
        }
        let textures = Textures::new(&kinds, images, vec![], ColorMode::Rgb);
        for (index, kind) in kinds.iter().enumerate() {
            for spectrum_type in [SpectrumType::Albedo, SpectrumType::Unbounded] {
                let color = Color::Texture(TextureId(index as u32));
                let texture = textures.spectrum_texture(color, spectrum_type);
                for round in 0..500 {
                    let points = std::array::from_fn(|lane| {
                        let number = |axis| number(8 * round + lane as u64, axis);
                        TexturePoint {
                            uv: Vec2::new(number(0) as f32, number(1) as f32),
                            world: DVec3::new(number(2), number(3), number(4)),
                            ..TexturePoint::NOWHERE
                        }
                    });
                    let together = dispatch(level(), At(&textures, &texture, &points)).unwrap();
                    for (point, of_eight) in points.iter().zip(together) {
                        let alone = textures.spectrum(&texture, point, &SpectralMode::Rgb);
                        let bits = |spectrum: Spectrum| spectrum.0.map(f32::to_bits);
                        assert_eq!(bits(of_eight), bits(alone), "{kind:?} at {point:?}");
                    }
                }
            }
        }
    }
}
