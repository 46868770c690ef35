//! Derivations of area lights: the radiance by what is written, the density by the place.

use glam::DVec3;

use super::{AreaDensity, AreaLight};
use crate::core::spectrum::Spectrum;
use crate::light::derivation::{Derivation, lanes};
use crate::light::{EmissionSpectrum, LightSample, LightSampleContext, Target, Total};
use crate::shading::texture::{SpectralMode, TexturePoint, Textures};

impl AreaLight {
    /// The formula of the radiance `li` that leaves it toward a point, with operands.
    pub(in crate::light) fn of_radiance(
        &self,
        textures: &Textures,
        li: Spectrum,
        mode: &SpectralMode,
    ) -> Derivation {
        let EmissionSpectrum { color, scale } = self.radiance;
        let varies = color.varies();
        // The place on a texture is known to the sample alone, which keeps only the light.
        let color = match varies {
            true => li / scale,
            false => textures.spectrum(&color, &TexturePoint::NOWHERE, mode),
        };
        let mut numbers = vec![("s", vec![f64::from(scale)]), ("C", lanes(color, mode))];
        let (mut product, mut of_color) = ("L = s C", "its colour");
        if varies {
            of_color = "the colour of its texture there, less what alpha and coat keep";
        } else if self.alpha.or(self.coat).is_some() {
            (product, of_color) = ("L = s C T", "its colour, T what alpha and coat let through");
            numbers.push(("T", vec![f64::from(li.max_lane() / (color * scale).max_lane())]));
        }
        let sides = if self.two_sided { "on both sides" } else { "on the side of its normal" };
        let (of_scale, written) = self.of_scale();
        numbers.extend(written);
        Derivation::new(format!("{product} {sides}: C {of_color}, s {of_scale}"), numbers)
    }

    /// The formula of the radiance's scale, with operands.
    fn of_scale(&self) -> (&'static str, Vec<(&'static str, Vec<f64>)>) {
        let one = |x: f32| vec![f64::from(x)];
        let factor = ("k", one(self.written.factor));
        match (self.written.total, self.written.of_curve) {
            (None, None) => ("as written", Vec::new()),
            (None, Some(luminance)) => {
                ("= k / Y: k as written, Y the luminance of its curve", vec![factor, ("Y", one(luminance))])
            }
            (Some(Total { power, luminance, .. }), of_curve) => (
                "= k Φ / (n π A Y): k and the power Φ as written, n sides of the area A, Y the luminance of its colour",
                vec![
                    factor,
                    ("Φ", one(power)),
                    ("n", vec![if self.two_sided { 2.0 } else { 1.0 }]),
                    ("A", vec![self.area()]),
                    ("Y", one(of_curve.unwrap_or(luminance))),
                ],
            ),
        }
    }

    /// The formula of a sampled point's density, with operands; `at` is the point that is lit.
    pub(in crate::light) fn of_density(
        &self,
        at: &LightSampleContext,
        sample: &LightSample,
    ) -> Option<Derivation> {
        let from = at.point;
        let Target::Surface(point, normal) = sample.target else { return None };
        let distance = DVec3::from_array(point.position).distance(from);
        let cos = normal.dot(sample.wi.as_dvec3()).abs();
        let of_place = [
            ("d", vec![distance]),
            ("n at the light", normal.to_array().to_vec()),
            ("cos at the light", vec![cos]),
        ];
        /// Corners relative to the point that is lit.
        const CORNERS: [&str; 3] = ["a − p", "b − p", "c − p"];
        let seen = |corners: [DVec3; 3]| {
            CORNERS.into_iter().zip(corners.map(|corner| (corner - from).to_array().to_vec()))
        };
        let to = point.position.into();
        let density = match self.place_at(at.time) {
            None => self.density(from, to),
            Some(place) => place.density(from, to, |from, to| self.density(from, to)),
        };
        Some(match density {
            AreaDensity::Area { area, probability, corners } => Derivation::new(
                match corners {
                    Some(_) => {
                        "pdf = P d² / (A cos): a point of a triangle a b c of the area A = |(b − a) × (c − a)| / 2"
                    }
                    None => "pdf = P d² / (A cos): a point of the area A",
                },
                [("P", vec![probability]), ("A", vec![area])]
                    .into_iter()
                    .chain(of_place)
                    .chain(corners.into_iter().flat_map(seen))
                    .collect(),
            ),
            AreaDensity::SolidAngle { solid_angle, probability, corners } => Derivation::new(
                "pdf = P / Ω: a direction of a triangle's solid angle; \
                 tan(Ω/2) = |A·(B×C)| / (1 + A·B + B·C + C·A), with A B C the unit vectors of a − p, b − p, c − p",
                [("P", vec![probability]), ("Ω", vec![solid_angle])]
                    .into_iter()
                    .chain(seen(corners))
                    .collect(),
            ),
            AreaDensity::Cone { radius, distance } => Derivation::new(
                "pdf = 1 / (2π (1 − cos θ)), sin θ = R / D: a direction of the cone around a sphere",
                vec![("R", vec![radius]), ("D", vec![distance])],
            ),
            AreaDensity::Patch { probability, place, corners, here } => Derivation::new(
                "pdf = P s d² / (J cos): a point of a bilinear patch, whose area element is J; \
                 s = 4 ((1−u)(1−v) J00 + u(1−v) J10 + (1−u)v J01 + uv J11) / (J00 + J10 + J01 + J11)",
                [
                    ("P", vec![probability]),
                    ("u, v", place.to_vec()),
                    ("J", vec![here]),
                    ("J00, J10, J01, J11", corners.to_vec()),
                ]
                .into_iter()
                .chain(of_place)
                .collect(),
            ),
        })
    }
}
