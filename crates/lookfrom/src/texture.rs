//! Colour over surfaces: from a point of a surface to a spectrum.
//!
//! The textures' parameters are those of `lookfrom_scene::texture`; here they only lose their names.

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom_scene::image::Image;
use lookfrom_scene::material::{Color, Scalar};
use lookfrom_scene::texture::{Mapping, TexelFilter, TextureKind, Wrap};

use crate::noise;
use crate::spectrum::Spectrum;

/// Every texture and picture of a world.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    kinds: Vec<TextureKind>,
    images: Vec<Image>,
}

/// What a texture may depend on.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint {
    /// Texture coordinates.
    pub uv: Vec2,
    /// In the world (not render space).
    pub world: DVec3,
    /// The mesh's own linear colour.
    pub color: [f32; 3],
}

impl Textures {
    /// Takes over a scene's textures and pictures, whose ids are then indices here.
    pub fn new(kinds: Vec<TextureKind>, images: Vec<Image>) -> Self {
        Self { kinds, images }
    }

    /// A picture by its index.
    pub fn image(&self, index: usize) -> &Image {
        &self.images[index]
    }

    /// The colour at a point.
    pub fn color(&self, color: Color, at: &TexturePoint) -> Spectrum {
        Spectrum::from_rgb(self.rgb(color, at))
    }

    fn rgb(&self, color: Color, at: &TexturePoint) -> [f32; 3] {
        let id = match color {
            Color::Value(rgb) => return rgb,
            Color::Texture(id) => id,
            Color::Curve(_) => return [1.0; 3],
        };
        match &self.kinds[id.index()] {
            TextureKind::Image { image, mapping, wrap, filter, scale, invert } => {
                let uv = coordinates(mapping, at);
                // v runs up, rows run down
                let st = [uv.x as f32, 1.0 - uv.y as f32];
                let rgb = look_up(&self.images[image.index()], st, [*wrap; 2], *filter).map(|c| scale * c);
                if *invert { rgb.map(|c| 1.0 - c) } else { rgb }
            }
            TextureKind::Checker { even, odd, mapping } => {
                let p = coordinates(mapping, at);
                let cell = p.x.floor() + p.y.floor() + p.z.floor();
                let is_even = (0.5 * cell).floor() == 0.5 * cell;
                self.rgb(if is_even { *even } else { *odd }, at)
            }
            TextureKind::Noise { low, high, octaves, mapping } => {
                let amount = 0.5 + 0.5 * noise::fbm(coordinates(mapping, at).as_vec3(), *octaves);
                self.blend(*low, *high, amount, at)
            }
            TextureKind::Marble { vein, base, octaves, turbulence, mapping } => {
                let p = coordinates(mapping, at).as_vec3();
                let phase = p.x + turbulence * noise::turbulence(p, *octaves);
                let wave = libm::sinf(std::f32::consts::PI * phase).abs();
                self.blend(*vein, *base, wave.sqrt(), at)
            }
            TextureKind::Scale { color, by } => {
                let by = self.scalar(*by, at);
                self.rgb(*color, at).map(|c| c * by)
            }
            TextureKind::Mix { low, high, amount } => self.blend(*low, *high, self.scalar(*amount, at), at),
            TextureKind::DirectionMix { .. }
            | TextureKind::Bilinear { .. }
            | TextureKind::Dots { .. }
            | TextureKind::Fbm { .. }
            | TextureKind::Wrinkled { .. }
            | TextureKind::Windy { .. }
            | TextureKind::PbrtMarble { .. } => [0.5; 3],
            TextureKind::VertexColor { tint } => std::array::from_fn(|c| at.color[c] * tint[c]),
        }
    }

    /// The number at a point: the mean of a texture's channels.
    pub fn scalar(&self, scalar: Scalar, at: &TexturePoint) -> f32 {
        match scalar {
            Scalar::Value(value) => value,
            Scalar::Texture(id) => {
                let [r, g, b] = self.rgb(Color::Texture(id), at);
                (r + g + b) / 3.0
            }
        }
    }

    fn blend(&self, from: Color, to: Color, amount: f32, at: &TexturePoint) -> [f32; 3] {
        let amount = amount.clamp(0.0, 1.0);
        let (from, to) = (self.rgb(from, at), self.rgb(to, at));
        std::array::from_fn(|c| from[c] * (1.0 - amount) + to[c] * amount)
    }
}

/// Where a point lies in its pattern. Space patterns are shifted by an odd little amount, so that surfaces which lie
/// exactly on a border of two cells (a floor at y = 0) do not flicker between them.
fn coordinates(mapping: &Mapping, at: &TexturePoint) -> DVec3 {
    match mapping {
        Mapping::Uv { scale, offset } => {
            (at.uv * Vec2::from_array(*scale) + Vec2::from_array(*offset)).extend(0.0).as_dvec3()
        }
        Mapping::Spherical { texture_from_world }
        | Mapping::Cylindrical { texture_from_world }
        | Mapping::Planar { texture_from_world, .. }
        | Mapping::World { texture_from_world } => in_space(texture_from_world, at.world),
    }
}

fn in_space(texture_from_world: &DMat4, world: DVec3) -> DVec3 {
    texture_from_world.transform_point3(world) + DVec3::splat(1.0 / 8192.0)
}

/// The colour of a picture at `(s, t)`, with `t` *down* and both from 0 to 1 over the picture.
pub fn look_up(
    image: &Image,
    [s, t]: [f32; 2],
    [wrap_s, wrap_t]: [Wrap; 2],
    filter: TexelFilter,
) -> [f32; 3] {
    let texel = |x: f32, y: f32| match (wrapped(x, image.width, wrap_s), wrapped(y, image.height, wrap_t)) {
        (Some(x), Some(y)) => image.texels[y * image.width as usize + x],
        _ => [0.0; 3],
    };
    let (x, y) = (s * image.width as f32, t * image.height as f32);
    match filter {
        TexelFilter::Nearest => texel(x.floor(), y.floor()),
        TexelFilter::Bilinear => {
            // texel centres are at halves
            let (x, y) = (x - 0.5, y - 0.5);
            let (x0, y0) = (x.floor(), y.floor());
            let (fx, fy) = (x - x0, y - y0);
            let corners =
                [texel(x0, y0), texel(x0 + 1.0, y0), texel(x0, y0 + 1.0), texel(x0 + 1.0, y0 + 1.0)];
            std::array::from_fn(|c| {
                let top = corners[0][c] * (1.0 - fx) + corners[1][c] * fx;
                let bottom = corners[2][c] * (1.0 - fx) + corners[3][c] * fx;
                top * (1.0 - fy) + bottom * fy
            })
        }
    }
}

/// The column (or row) that a whole number means, `None` for one outside that is black. Numbers that are not finite are
/// outside, or texel 0.
fn wrapped(x: f32, size: u32, wrap: Wrap) -> Option<usize> {
    let size = f64::from(size);
    let x = f64::from(x);
    if !x.is_finite() {
        return (wrap != Wrap::Black).then_some(0);
    }
    let inside = match wrap {
        Wrap::Repeat => x.rem_euclid(size),
        Wrap::Mirror => {
            let folded = x.rem_euclid(2.0 * size);
            if folded < size { folded } else { 2.0 * size - 1.0 - folded }
        }
        Wrap::Clamp => x.clamp(0.0, size - 1.0),
        Wrap::Black if x < 0.0 || x >= size => return None,
        Wrap::Black => x,
    };
    Some(inside.min(size - 1.0) as usize)
}

/// The coordinates on a unit sphere whose poles lie on the y axis: u around from +x toward −z… by `atan2(−z, x)`, v from the south pole.
pub fn sphere_uv(n: Vec3) -> Vec2 {
    let u = libm::atan2f(-n.z, n.x) / (2.0 * std::f32::consts::PI);
    let v = libm::acosf((-n.y).clamp(-1.0, 1.0)) / std::f32::consts::PI;
    Vec2::new(if u < 0.0 { u + 1.0 } else { u }, v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lookfrom_scene::scene::{ImageId, TextureId};

    fn two_by_two() -> Image {
        let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        Image { name: String::new(), width: 2, height: 2, texels }
    }

    #[test]
    fn texels_sit_where_they_should() {
        let textures = |filter| {
            let kind = TextureKind::Image {
                image: ImageId(0),
                mapping: Mapping::UV,
                wrap: Wrap::Clamp,
                filter,
                scale: 1.0,
                invert: false,
            };
            Textures::new(vec![kind], vec![two_by_two()])
        };
        let at = |u: f32, v: f32| TexturePoint { uv: Vec2::new(u, v), world: DVec3::ZERO, color: [1.0; 3] };
        let color = Color::Texture(TextureId(0));
        for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
            let textures = textures(filter);
            // v runs up: the top row of the picture is at v near 1
            assert_eq!(textures.rgb(color, &at(0.25, 0.75)), [0.0; 3]);
            assert_eq!(textures.rgb(color, &at(0.75, 0.75)), [1.0; 3]);
            assert_eq!(textures.rgb(color, &at(0.25, 0.25)), [2.0; 3]);
        }
        assert_eq!(textures(TexelFilter::Bilinear).rgb(color, &at(0.5, 0.5)), [1.5; 3]);
        assert!(textures(TexelFilter::Bilinear).rgb(color, &at(f32::NAN, 1e38))[0].is_nan());
    }

    #[test]
    fn wrapping() {
        let columns = |wrap| [-3.0, -1.0, 0.0, 1.0, 2.0, 5.0].map(|x| wrapped(x, 2, wrap));
        assert_eq!(columns(Wrap::Repeat), [1, 1, 0, 1, 0, 1].map(Some));
        assert_eq!(columns(Wrap::Mirror), [1, 0, 0, 1, 1, 1].map(Some));
        assert_eq!(columns(Wrap::Clamp), [0, 0, 0, 1, 1, 1].map(Some));
        assert_eq!(columns(Wrap::Black), [None, None, Some(0), Some(1), None, None]);
        assert_eq!(wrapped(f32::INFINITY, 2, Wrap::Repeat), Some(0));
    }

    #[test]
    fn a_checker_alternates() {
        let kind = TextureKind::Checker {
            even: Color::gray(1.0),
            odd: Color::gray(0.0),
            mapping: Mapping::World { texture_from_world: DMat4::IDENTITY },
        };
        let textures = Textures::new(vec![kind], vec![]);
        let at =
            |x: f64, z: f64| TexturePoint { uv: Vec2::ZERO, world: DVec3::new(x, 0.0, z), color: [1.0; 3] };
        let value = |x, z| textures.rgb(Color::Texture(TextureId(0)), &at(x, z))[0];
        assert_eq!(
            [value(0.5, 0.5), value(1.5, 0.5), value(-0.5, 0.5), value(-0.5, -0.5)],
            [1.0, 0.0, 0.0, 1.0]
        );
    }
}
