//! Derivations of lights that project pictures: the direction in the light's space, its texel, the intensity.

use glam::{DVec3, Mat3, Vec3};
use lookfrom_scene::light::{Edge, Projected};
use lookfrom_scene::texture::TexelFilter;

use super::{
    Derivation, LINEAR_EDGE, OCTAHEDRAL, as_spectrum, color_of, in_space, lanes, place, texel_at, vector,
};
use crate::core::warp;
use crate::light::picture::{Goniometric, Projection};
use crate::light::{cos_to_axis, in_cone, toward};
use crate::shading::texture::{SpectralMode, Textures};

/// The direction from a light in its space.
const FROM_LIGHT: &str = "(x, y, z) = M (−wi), of unit length: the direction from the light, in its space";

/// The direction from a light to a point, in the light's space and of unit length, and their distance.
fn direction(light_from_render: &Mat3, position: DVec3, from: DVec3) -> Option<(Vec3, f64)> {
    let (wi, distance) = toward(from, position)?;
    Some(((*light_from_render * -wi).normalize_or_zero(), distance))
}

/// The words for the light of a picture at the texel (i, j), by its filter.
fn of_texel(filter: TexelFilter) -> &'static str {
    match filter {
        TexelFilter::Nearest => "texel (i, j) of the picture",
        TexelFilter::Bilinear | TexelFilter::Mip { .. } => {
            "the picture, interpolated between the texel (i, j) and its neighbours,"
        }
    }
}

impl Projection {
    /// Formulas of the light that arrives at a point.
    pub(in crate::light) fn derivations(
        &self,
        textures: &Textures,
        from: DVec3,
        mode: &SpectralMode,
    ) -> Vec<Derivation> {
        let Some((w, distance)) = direction(&self.light_from_render, self.position, from) else {
            return Vec::new();
        };
        let image = textures.image(self.image);
        let [half_x, half_y] = self.half_size;
        let st = [0.5 + 0.5 * w.x / (w.z * half_x), 0.5 - 0.5 * w.y / (w.z * half_y)];
        let texel = texel_at(image, st);
        let [size, index] = place(image, texel);
        let mut numbers = vec![
            ("half size at z = 1", vec![f64::from(half_x), f64::from(half_y)]),
            size,
            index,
            ("texel", vector(color_of(image, texel))),
            ("scale", vec![f64::from(self.scale)]),
            ("d", vec![distance]),
        ];
        let (mut factors, mut laws) = (String::new(), String::new());
        let cos = cos_to_axis(from, self.position, self.axis);
        if let Some([outer, inner]) = self.cone {
            factors.push_str(" · S");
            laws.push_str(&format!("; {LINEAR_EDGE}"));
            numbers.push(("cos outer, inner", vec![outer, inner]));
            numbers.push(("S", vec![f64::from(in_cone(Edge::Linear, [outer, inner], cos))]));
        }
        if self.quantity == Projected::Irradiance {
            factors.push_str(" / cos³");
        }
        if !factors.is_empty() {
            laws.push_str("; cos = axis · (−wi)");
            numbers.push(("axis", self.axis.to_array().to_vec()));
            numbers.push(("cos to the axis", vec![cos]));
        }
        let texel = of_texel(self.filter);
        vec![
            Derivation::new(FROM_LIGHT, in_space(&self.light_from_render, w)),
            Derivation::new(
                format!(
                    "L = I / d², I = scale{factors} · {texel}{}; \
                     i = ⌊½ (1 + x / (half_x z)) columns⌋, j = ⌊½ (1 − y / (half_y z)) rows⌋{laws}",
                    as_spectrum(mode)
                ),
                numbers,
            ),
        ]
    }
}

impl Goniometric {
    /// Formulas of the light that arrives at a point.
    pub(in crate::light) fn derivations(
        &self,
        textures: &Textures,
        from: DVec3,
        mode: &SpectralMode,
    ) -> Vec<Derivation> {
        let Some((w, distance)) = direction(&self.light_from_render, self.position, from) else {
            return Vec::new();
        };
        let image = textures.image(self.image);
        let texel = texel_at(image, warp::octahedral_square(w.into()));
        let [size, index] = place(image, texel);
        let numbers = vec![
            size,
            index,
            ("texel", vector(color_of(image, texel))),
            ("I₀", lanes(self.intensity.even(textures, mode), mode)),
            ("d", vec![distance]),
        ];
        vec![
            Derivation::new(FROM_LIGHT, in_space(&self.light_from_render, w)),
            Derivation::new(
                format!(
                    "L = I / d², I = I₀ · (red + green + blue) / 3 of {}; {OCTAHEDRAL}",
                    of_texel(self.filter)
                ),
                numbers,
            ),
        ]
    }
}
