//! Derivations of environments: the texel of a direction, its weight, the density, the radiance.

use std::f64::consts::PI;

use glam::Vec3;
use lookfrom_scene::image::Image;

use super::{Environment, MapLayout, Sky, SkyImage, brightest_around};
use crate::core::distribution::Cell;
use crate::light::derivation::{
    Derivation, OCTAHEDRAL, as_spectrum, cell_of_density, color_of, in_space, lanes, place, texel_at, vector,
};
use crate::light::guide::GuideCell;
use crate::light::{IncompletePdf, LightSample, LightSampleContext};
use crate::shading::texture::{SpectralMode, Textures};

/// The texel of a direction in an equirectangular map.
const EQUIRECTANGULAR: &str = "i = ⌊u columns⌋, j = ⌊v rows⌋; u = ½ + atan2(x, −z) / 2π, v = acos(y) / π";

impl Environment {
    /// The formulas of the radiance and the density of a direction; as [`Light::derivations`](super::super::Light::derivations).
    pub(in crate::light) fn derivations(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        sample: &LightSample,
        mode: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Vec<Derivation> {
        let LightSample { wi, pdf, .. } = *sample;
        let mut all = match (&self.portal, &self.sky, incomplete_pdf) {
            _ if self.guide.is_some() && incomplete_pdf == IncompletePdf::Allowed => {
                self.of_guide(textures, at, wi, mode)
            }
            (Some(portal), sky, _) => {
                let scale = if let Sky::Image(sky) = sky { sky.scale } else { [1.0; 3] };
                portal.derivations(at.point, wi, pdf, scale, mode)
            }
            (None, Sky::Image(sky), _) => sky.derivations(textures, wi, pdf, mode, incomplete_pdf),
            (None, _, IncompletePdf::Allowed) => Vec::new(),
            (None, _, IncompletePdf::Forbidden) => vec![Derivation::new(
                "pdf = cos / π, cos = N·wi: a direction by its cosine to the normal",
                vec![("N", vector(at.n)), ("cos", vec![f64::from(at.n.dot(wi))])],
            )],
        };
        if let Sky::Gradient { zenith, horizon, nadir } = &self.sky {
            let colors = [("horizon", horizon), ("zenith", zenith), ("nadir", nadir)];
            let colors = colors.map(|(name, color)| (name, lanes(color.even(textures, mode), mode)));
            all.push(Derivation::new(
                "L = (1 − |y|) horizon + |y| zenith (nadir where y < 0), y that of wi",
                [("y", vec![f64::from(wi.y)])].into_iter().chain(colors).collect(),
            ));
        }
        all
    }

    /// The formulas where a guide is known.
    fn of_guide(
        &self,
        textures: &Textures,
        at: &LightSampleContext,
        wi: Vec3,
        mode: &SpectralMode,
    ) -> Vec<Derivation> {
        let unguided = self.unguided_pdf(wi);
        let of_guide = self.histogram(at).map(|histogram| {
            let share = f64::from(histogram.share);
            let mut numbers = vec![("w", vec![share])];
            if let Some(GuideCell { place, probabilities, length }) = histogram.cell(wi) {
                numbers.extend([
                    ("column, row", place.map(|index| index as f64).to_vec()),
                    ("P(column), P(row)", probabilities.map(f64::from).to_vec()),
                    ("l", vec![f64::from(length)]),
                ]);
            }
            numbers.push(("G", vec![f64::from(histogram.pdf(wi))]));
            numbers.push(("D", vec![f64::from(unguided)]));
            Derivation::new(
                "pdf = w G + (1 − w) D, D the density without the guide; G = P(column) P(row) · 32² / 4 · l³, 0 where the guide has \
                 seen nothing; l = |q|, q = wi / (|x| + |y| + |z|); column = ⌊16 (q_x + 1)⌋, row = ⌊16 (q_y + 1)⌋, where q_z < 0 with \
                 (1 − |q_y|, 1 − |q_x|) and the signs of q",
                numbers,
            )
        });
        let of_map = match &self.sky {
            Sky::Image(sky) => sky.derivations(textures, wi, unguided, mode, IncompletePdf::Allowed),
            _ => Vec::new(),
        };
        of_guide.into_iter().chain(of_map).collect()
    }
}

impl SkyImage {
    fn derivations(
        &self,
        textures: &Textures,
        wi: Vec3,
        pdf: f32,
        mode: &SpectralMode,
        incomplete_pdf: IncompletePdf,
    ) -> Vec<Derivation> {
        let image = textures.image(self.image);
        let size = [image.width as usize, image.height as usize];
        let to_map = self.world_from_light.transpose();
        let (uv, per_solid_angle) = self.uv(wi.into());
        let choice = self.choice(incomplete_pdf);
        let uniform = choice.size() != size;
        let density = |[column, row]: [usize; 2]| {
            let Cell { row: of_row, column: in_row } = choice.cell([column, row]);
            of_row * in_row * (size[0] * size[1]) as f64 * f64::from(per_solid_angle)
        };
        let by_direction = texel_at(image, uv);
        let texel = match uniform || pdf == 0.0 {
            true => by_direction,
            false => cell_of_density(by_direction, size, pdf, density),
        };
        let (of_texel, jacobian) = match self.layout {
            MapLayout::LatitudeLongitude => (EQUIRECTANGULAR, "2π² sin θ"),
            MapLayout::Octahedral => (OCTAHEDRAL, "4π"),
        };
        let mut numbers = in_space(&to_map, to_map * wi);
        let [of_size, index] = place(image, texel);
        numbers.extend([of_size.clone(), index]);
        let direction = Derivation::new(
            format!(
                "texel (i, j) of the map: {of_texel}; (x, y, z) = M wi: the direction in the map's space"
            ),
            numbers,
        );
        let mut numbers = vec![of_size];
        if self.layout == MapLayout::LatitudeLongitude {
            // By the density over solid angle: near the poles the rounded direction has lost its sine.
            let sin = match uniform || pdf == 0.0 {
                true => 1.0 / (2.0 * PI * PI * f64::from(per_solid_angle)),
                false => {
                    let Cell { row, column } = choice.cell(texel);
                    row * column * (size[0] * size[1]) as f64 / (2.0 * PI * PI * f64::from(pdf))
                }
            };
            numbers.push(("sin θ", vec![sin]));
        }
        let formula = if uniform {
            format!("pdf = 1 / ({jacobian}): no texel is brighter than others")
        } else {
            numbers.extend(self.weight(image, texel, incomplete_pdf));
            let compensation = match incomplete_pdf {
                IncompletePdf::Allowed => "max(B − mean, 0)",
                IncompletePdf::Forbidden => "B",
            };
            let (sine, bright) = match self.layout {
                MapLayout::LatitudeLongitude => (" sin θ_j", "the texel and its neighbours"),
                MapLayout::Octahedral => ("", "the texel"),
            };
            format!(
                "pdf = P(j) P(i) columns rows / ({jacobian}): by row, then column; \
                 P(j) P(i) = W / ΣW up to 2⁻³¹, W = {compensation}{sine}, B the brightest channel of {bright}"
            )
        };
        vec![direction, Derivation::new(formula, numbers), self.of_radiance(image, uv, mode)]
    }

    /// The probabilities of a texel, and the weight that they are of.
    fn weight(
        &self,
        image: &Image,
        texel: [usize; 2],
        incomplete_pdf: IncompletePdf,
    ) -> Vec<(&'static str, Vec<f64>)> {
        let Cell { row, column } = self.choice(incomplete_pdf).cell(texel);
        let brightest = f64::from(brightest_around(image, self.layout, texel));
        let is_compensated = incomplete_pdf == IncompletePdf::Allowed;
        let mut weight = if is_compensated { (brightest - f64::from(self.mean)).max(0.0) } else { brightest };
        let mut numbers = vec![("P(j)", vec![row]), ("P(i)", vec![column]), ("B", vec![brightest])];
        if is_compensated {
            numbers.push(("mean", vec![f64::from(self.mean)]));
        }
        if self.layout == MapLayout::LatitudeLongitude {
            let sin = libm::sin(PI * (texel[1] as f64 + 0.5) / f64::from(image.height));
            numbers.push(("sin θ_j", vec![sin]));
            weight *= sin;
        }
        numbers.push(("W", vec![weight]));
        numbers.push(("ΣW", vec![self.sums[usize::from(is_compensated)]]));
        numbers
    }

    /// The colour at (u, v).
    fn of_radiance(&self, image: &Image, [u, v]: [f32; 2], mode: &SpectralMode) -> Derivation {
        if self.layout == MapLayout::Octahedral {
            let color = color_of(image, texel_at(image, [u, v]));
            let numbers = vec![("scale", vector(self.scale)), ("texel", vector(color))];
            return Derivation::new(format!("L = scale · texel (i, j){}", as_spectrum(mode)), numbers);
        }
        let [u, v] = self.in_picture([u, v]);
        let (x, y) = (u * image.width as f32 - 0.5, v * image.height as f32 - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |step: i64| (x.floor() as i64 + step).rem_euclid(i64::from(image.width)) as usize;
        let row = |step: i64| (y.floor() as i64 + step).clamp(0, i64::from(image.height) - 1) as usize;
        let texel = |across, down| vector(color_of(image, [column(across), row(down)]));
        let place = match self.picture_v {
            [1.0, 0.0] => "",
            _ => "; v = (½ + v′ (rows − 1)) / rows by v′ = θ/π, since the outermost rows are the poles",
        };
        let (sum, spectrum) = match self.blends_apart(mode) {
            true => (
                "scale · D65 · Σ w S(T / (2 max T)) · Σ w · 2 max T, S the smooth spectrum of a colour, of the texels T with the weights w \
                     of (1−f)(1−g) T00 + f(1−g) T10 + (1−f)g T01 + fg T11",
                "",
            ),
            false => ("scale · ((1−f)(1−g) T00 + f(1−g) T10 + (1−f)g T01 + fg T11)", as_spectrum(mode)),
        };
        Derivation::new(
            format!(
                "L = {sum}{spectrum}; f and g are the fractions of u columns − ½ and \
                 v rows − ½, from whose whole parts on the four texels are{place}"
            ),
            vec![
                ("scale", vector(self.scale)),
                ("u, v", vec![f64::from(u), f64::from(v)]),
                ("f, g", vec![f64::from(fx), f64::from(fy)]),
                ("T00", texel(0, 0)),
                ("T10", texel(1, 0)),
                ("T01", texel(0, 1)),
                ("T11", texel(1, 1)),
            ],
        )
    }
}
