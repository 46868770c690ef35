//! Derivations of the numbers of a light sample: formulas of its radiance, its density and its choice, with their operands,
//! for people who compute them anew.
//!
//! Those of lights that project pictures are in `pictures`; area lights, environments, portals and the light tree have theirs
//! beside them.

mod pictures;

use glam::{Mat3, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::light::{Edge, Falloff};
use serde::Serialize;

use super::{IncompletePdf, Light, LightSample, LightSampleContext, cos_to_axis, fade, in_cone, toward};
use crate::core::spectrum::Spectrum;
use crate::shading::texture::{SpectralMode, Textures};

/// A formula, and its operands by name: each is a number, or one number for each lane or child.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Derivation {
    /// The formula.
    pub formula: String,
    /// The operands.
    pub numbers: Vec<(&'static str, Vec<f64>)>,
}

impl Derivation {
    pub(super) fn new(formula: impl Into<String>, numbers: Vec<(&'static str, Vec<f64>)>) -> Self {
        Self { formula: formula.into(), numbers }
    }
}

/// The factor of a cone that fades with the angle.
const LINEAR_EDGE: &str = "S = (acos outer − acos cos) / (acos outer − acos inner), from 0 to 1";

/// The texel of a direction in an equal-area octahedral square (Clarberg 2008).
pub(super) const OCTAHEDRAL: &str = "i = ⌊½ (1 ± U) columns⌋, j = ⌊½ (1 ± V) rows⌋ with the signs of x and y; \
    R = √(1 − |z|), Q = R atan2(|y|, |x|) 2 / π; (U, V) = (R − Q, Q) where z ≥ 0, else (1 − Q, 1 − R + Q)";

impl Light {
    /// The formulas of the sample's radiance (of point lights: of the light that arrives; not of area lights, see
    /// [`Light::emission`]) and of its density; `at` is the point that is lit. Nothing where there is nothing to compute, as
    /// of distant lights.
    pub(crate) fn derivations(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        sample: &LightSample,
        mode: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Vec<Derivation> {
        let from = at.point;
        let of_light = match self {
            Self::Point { position, intensity, falloff } => toward(from, *position).map(|(_, distance)| {
                let [law, faded] = fall_off(*falloff, distance);
                let numbers = vec![("I", lanes(intensity.even(textures, mode), mode)), law, faded];
                Derivation::new(format!("L = I · fall-off(d); fall-off = {}", law_of(*falloff)), numbers)
            }),
            Self::Spot { position, axis, intensity, cos_outer, cos_inner, edge, falloff } => {
                toward(from, *position).map(|(_, distance)| {
                    let cos = cos_to_axis(from, *position, *axis);
                    let [law, faded] = fall_off(*falloff, distance);
                    let numbers = vec![
                        ("I", lanes(intensity.even(textures, mode), mode)),
                        law,
                        faded,
                        ("axis", axis.to_array().to_vec()),
                        ("cos to the axis", vec![cos]),
                        ("cos outer, inner", vec![*cos_outer, *cos_inner]),
                        ("S", vec![f64::from(in_cone(*edge, [*cos_outer, *cos_inner], cos))]),
                    ];
                    let of_cone = match edge {
                        Edge::Smooth => "S = x² (3 − 2x), x = (cos − outer) / (inner − outer), from 0 to 1",
                        Edge::Linear => LINEAR_EDGE,
                    };
                    let formula =
                        format!("L = I · fall-off(d) · S; fall-off = {}; {of_cone}", law_of(*falloff));
                    Derivation::new(formula, numbers)
                })
            }
            Self::Area(light) => light.of_density(at, sample),
            Self::Projection(light) => return light.derivations(textures, from, mode),
            Self::Goniometric(light) => return light.derivations(textures, from, mode),
            Self::Environment(light) => return light.derivations(textures, at, sample, mode, incomplete_pdf),
            Self::Distant { .. } => None,
        };
        of_light.into_iter().collect()
    }

    /// The formula of the radiance `li` of an area light, with operands.
    pub(crate) fn emission(
        &self,
        textures: &Textures,
        li: Spectrum,
        mode: &SpectralMode,
    ) -> Option<Derivation> {
        match self {
            Self::Area(light) => Some(light.of_radiance(textures, li, mode)),
            _ => None,
        }
    }
}

/// The law of a fall-off.
fn law_of(falloff: Falloff) -> &'static str {
    match falloff {
        Falloff::None => "1",
        Falloff::Linear => "1 / d",
        Falloff::Quadratic => "1 / d²",
    }
}

/// The distance and the fall-off there.
fn fall_off(falloff: Falloff, distance: f64) -> [(&'static str, Vec<f64>); 2] {
    [("d", vec![distance]), ("fall-off", vec![f64::from(fade::<f32>(falloff, distance))])]
}

/// The lanes that are in use.
pub(super) fn lanes(light: Spectrum, mode: &SpectralMode) -> Vec<f64> {
    let used = if matches!(mode, SpectralMode::Rgb) { 3 } else { 4 };
    light.0[..used].iter().map(|lane| f64::from(*lane)).collect()
}

/// The words for a colour where light has wavelengths.
pub(super) fn as_spectrum(mode: &SpectralMode) -> &'static str {
    if matches!(mode, SpectralMode::Rgb) { "" } else { ", made a spectrum of the light's white" }
}

pub(super) fn vector(v: impl Into<[f32; 3]>) -> Vec<f64> {
    v.into().map(f64::from).to_vec()
}

/// A direction in a light's space, and the rows of the matrix `M` that leads there.
pub(super) fn in_space(m: &Mat3, direction: Vec3) -> Vec<(&'static str, Vec<f64>)> {
    let [x, y, z] = m.transpose().to_cols_array_2d();
    vec![
        ("M, row 1", vector(x)),
        ("M, row 2", vector(y)),
        ("M, row 3", vector(z)),
        ("(x, y, z)", vector(direction)),
    ]
}

/// The size of a picture, and a texel of it.
pub(super) fn place(image: &Image, [column, row]: [usize; 2]) -> [(&'static str, Vec<f64>); 2] {
    let pair = |pair: [f64; 2]| pair.to_vec();
    [
        ("columns, rows", pair([image.width, image.height].map(f64::from))),
        ("i, j", pair([column, row].map(|index| index as f64))),
    ]
}

/// The texel of a picture that contains a point, from its first row down.
pub(super) fn texel_at(image: &Image, [s, t]: [f32; 2]) -> [usize; 2] {
    let index = |x: f32, size: u32| ((x * size as f32).max(0.0) as usize).min(size as usize - 1);
    [index(s, image.width), index(t, image.height)]
}

/// The colour of a texel.
pub(super) fn color_of(image: &Image, [column, row]: [usize; 2]) -> [f32; 3] {
    image.texel(row * image.width as usize + column)
}

/// The cell that was sampled, near one by a rounded direction: that whose density is the sample's. `size` is that of the grid.
pub(super) fn cell_of_density(
    [column, row]: [usize; 2],
    [columns, rows]: [usize; 2],
    pdf: f32,
    density: impl Fn([usize; 2]) -> f64,
) -> [usize; 2] {
    let near = |cell: [usize; 2]| (density(cell) / f64::from(pdf) - 1.0).abs() < 1e-4;
    let around = [0, 1, columns.saturating_sub(1)];
    let cells = [row, row + 1, row.saturating_sub(1)]
        .into_iter()
        .filter(|row| *row < rows)
        .flat_map(|row| around.map(|step| [(column + step) % columns, row]));
    cells.into_iter().find(|cell| near(*cell)).unwrap_or([column, row])
}
