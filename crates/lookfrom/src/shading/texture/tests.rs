use super::*;
use glam::DMat4;
use lookfrom_scene::image::Encoding;
use lookfrom_scene::material::Scalar;
use lookfrom_scene::scene::ImageId;
use lookfrom_scene::texture::{Mapping, TexelFilter, Wrap};

const FIRST: TextureId = TextureId(0);

fn textures_of(kinds: &[TextureKind], images: Vec<Image>, curves: Vec<Curve>) -> Textures {
    Textures::new(kinds, images, curves, ColorMode::Spectral)
}

/// Shorthands for colours and numbers of a scene.
impl Textures {
    fn rgb_of(&self, color: Color, spectrum_type: SpectrumType, at: &TexturePoint) -> [f32; 3] {
        self.rgb(&self.spectrum_texture(color, spectrum_type), at)
    }

    fn spectrum_of(
        &self,
        color: Color,
        of: SpectrumType,
        at: &TexturePoint,
        mode: &SpectralMode,
    ) -> Spectrum {
        self.spectrum(&self.spectrum_texture(color, of), at, mode)
    }

    fn scalar(&self, scalar: Scalar, at: &TexturePoint) -> f32 {
        self.float(scalar.into(), at)
    }
}

fn at(u: f32, v: f32) -> TexturePoint<'static> {
    TexturePoint { uv: Vec2::new(u, v), n: Vec3::Y, ..TexturePoint::NOWHERE }
}

fn in_world(x: f64, y: f64, z: f64) -> TexturePoint<'static> {
    TexturePoint { world: DVec3::new(x, y, z), ..at(0.0, 0.0) }
}

const WORLD: Mapping = Mapping::World { texture_from_world: DMat4::IDENTITY };

fn only(kind: TextureKind) -> Textures {
    textures_of(&[kind], vec![], vec![])
}

fn number(textures: &Textures, at: &TexturePoint) -> f32 {
    textures.scalar(Scalar::Texture(FIRST), at)
}

fn picture(filter: TexelFilter, scale: f32, invert: bool) -> TextureKind {
    TextureKind::Image {
        image: ImageId(0),
        mapping: Mapping::UV,
        wrap: [Wrap::Clamp; 2],
        filter,
        channel: Channel::Rgb,
        scale,
        invert,
    }
}

fn two_by_two() -> Image {
    let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
    Image::from_linear("", 2, 2, texels)
}

#[test]
fn texels_sit_where_they_should() {
    let color = Color::Texture(FIRST);
    for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
        let textures = textures_of(&[picture(filter, 1.0, false)], vec![two_by_two()], vec![]);
        let rgb = |u, v| textures.rgb_of(color, SpectrumType::Unbounded, &at(u, v));
        // v runs up: the top row of the image is at v near 1.
        assert_eq!(rgb(0.25, 0.75), [0.0; 3]);
        assert_eq!(rgb(0.75, 0.75), [1.0; 3]);
        assert_eq!(rgb(0.25, 0.25), [2.0; 3]);
        if filter == TexelFilter::Bilinear {
            assert_eq!(rgb(0.5, 0.5), [1.5; 3]);
            // A quarter of the way between texel centres, along both axes.
            assert_eq!(rgb(0.375, 0.625), [0.75; 3]);
        }
        // An albedo is clamped, an illuminant is not.
        assert_eq!(textures.rgb_of(color, SpectrumType::Albedo, &at(0.25, 0.25)), [1.0; 3]);
        assert_eq!(textures.rgb_of(color, SpectrumType::Illuminant, &at(0.25, 0.25)), [2.0; 3]);
    }
}

#[test]
fn a_picture_as_a_number() {
    let image = Image::from_linear("", 1, 1, vec![[0.1, 0.2, 0.6]]);
    let value = |filter, scale, invert| {
        number(&textures_of(&[picture(filter, scale, invert)], vec![image.clone()], vec![]), &at(0.5, 0.5))
    };
    assert!((value(TexelFilter::Bilinear, 1.0, false) - 0.3).abs() < 1e-6);
    assert_eq!(value(TexelFilter::Nearest, 1.0, false), 0.1);
    assert!((value(TexelFilter::Bilinear, 2.0, true) - 0.4).abs() < 1e-6);
    assert_eq!(value(TexelFilter::Bilinear, 9.0, true), 0.0);
    assert!((value(TexelFilter::Bilinear, -1.0, false) + 0.3).abs() < 1e-6);
}

#[test]
fn a_scaled_picture_is_clamped_after_its_scale() {
    let image = Image::from_linear("", 1, 1, vec![[0.75, 0.5, 0.25]]);
    let scale =
        |of: u32, by| TextureKind::Scale { color: Color::Texture(TextureId(of)), by: Scalar::Value(by) };
    let kinds = vec![picture(TexelFilter::Bilinear, 1.0, true), scale(0, 4.0), scale(1, 0.5)];
    let textures = textures_of(&kinds, vec![image], vec![]);
    // 1 − 2 × texel, not 2 × (1 − texel)
    let rgb = textures.rgb_of(Color::Texture(TextureId(2)), SpectrumType::Albedo, &at(0.5, 0.5));
    assert_eq!(rgb, [0.0, 0.0, 0.5]);
}

#[test]
fn a_checker_alternates() {
    let checker = |mapping| {
        only(TextureKind::Checker { even: Color::gray(1.0), odd: Color::gray(0.0), footprint: 0.0, mapping })
    };
    let squares = checker(Mapping::UV);
    let found = [(0.5, 0.5), (1.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)].map(|(u, v)| number(&squares, &at(u, v)));
    assert_eq!(found, [1.0, 0.0, 0.0, 1.0]);
    let cubes = checker(WORLD);
    let points = [(0.5, 0.0, 0.5), (1.5, 0.0, 0.5), (-0.5, 0.0, 0.5), (-0.5, 0.0, -0.5), (-0.5, -0.5, -0.5)];
    let found = points.map(|(x, y, z)| number(&cubes, &in_world(x, y, z)));
    assert_eq!(found, [1.0, 0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn blends() {
    let (low, high) = (Color::gray(2.0), Color::gray(6.0));
    let mix =
        |amount| number(&only(TextureKind::Mix { low, high, amount: Scalar::Value(amount) }), &at(0.0, 0.0));
    assert_eq!([0.0, 0.25, 1.0, 1.5].map(mix), [2.0, 3.0, 6.0, 8.0]);

    let along = only(TextureKind::DirectionMix { low, high, direction: Vec3::Y });
    let tilted = |n| number(&along, &TexturePoint { n, ..at(0.0, 0.0) });
    assert_eq!([Vec3::Y, Vec3::NEG_Y, Vec3::X].map(tilted), [6.0, 6.0, 2.0]);
    assert!((tilted(Vec3::new(0.8, -0.6, 0.0)) - 4.4).abs() < 1e-6);

    let sides = only(TextureKind::Sides { outside: low, inside: high });
    let seen = |is_inside| number(&sides, &TexturePoint { is_inside, ..at(0.0, 0.0) });
    assert_eq!([false, true].map(seen), [2.0, 6.0]);

    let corners = [1.0, 2.0, 3.0, 5.0].map(Color::gray);
    let bilinear = only(TextureKind::Bilinear { corners, mapping: Mapping::UV });
    let found = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.25)]
        .map(|(u, v)| number(&bilinear, &at(u, v)));
    assert_eq!(found, [1.0, 2.0, 3.0, 5.0, 2.375]);

    let scale = |by| TextureKind::Scale { color: Color::Value([0.5, 1.0, 2.0]), by };
    let by_a_number = only(scale(Scalar::Value(2.0)));
    assert_eq!(
        by_a_number.rgb_of(Color::Texture(FIRST), SpectrumType::Unbounded, &at(0.0, 0.0)),
        [1.0, 2.0, 4.0]
    );
    let kinds =
        vec![scale(Scalar::Texture(TextureId(1))), TextureKind::Bilinear { corners, mapping: Mapping::UV }];
    let by_a_texture = textures_of(&kinds, vec![], vec![]);
    assert_eq!(
        by_a_texture.rgb_of(Color::Texture(FIRST), SpectrumType::Unbounded, &at(1.0, 0.0)),
        [1.5, 3.0, 6.0]
    );
}

#[test]
fn mappings() {
    let place = |mapping: &Mapping, x, y, z| mapping::coordinates(mapping, &in_world(x, y, z)).to_array();
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let error = (DVec3::from(found) - DVec3::from(expected)).length();
        assert!(error < 1e-6, "{found:?}, not {expected:?}");
    };
    let texture_from_world = DMat4::from_translation(DVec3::new(0.0, 0.0, -1.0));
    let spherical = Mapping::Spherical { texture_from_world };
    near(place(&spherical, 0.0, 0.0, 3.0), [0.0, 0.0, 0.0]);
    near(place(&spherical, 2.0, 0.0, 1.0), [0.5, 0.0, 0.0]);
    near(place(&spherical, 0.0, 2.0, 1.0), [0.5, 0.25, 0.0]);
    near(place(&spherical, 0.0, -1.0, 2.0), [0.25, 0.75, 0.0]);
    near(place(&spherical, 0.0, 0.0, 1.0), [0.0, 0.0, 0.0]);
    let cylindrical = Mapping::Cylindrical { texture_from_world };
    near(place(&cylindrical, 3.0, 0.0, 5.0), [0.5, 4.0, 0.0]);
    near(place(&cylindrical, 0.0, 1.0, 0.0), [0.75, -1.0, 0.0]);
    near(place(&cylindrical, -1.0, -1e-12, 0.0), [0.0, -1.0, 0.0]);
    let axes = [Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 1.0)];
    let planar = Mapping::Planar { texture_from_world, axes, offset: [0.5, -0.5] };
    near(place(&planar, 1.0, 2.0, 3.0), [2.5, 3.5, 0.0]);
    near(place(&Mapping::World { texture_from_world }, 1.0, 2.0, 3.0), [1.0, 2.0, 2.0]);
    let uv = Mapping::Uv { scale: [2.0, 3.0], offset: [0.25, 0.5] };
    near(mapping::coordinates(&uv, &at(0.5, 1.0)).to_array(), [1.25, 3.5, 0.0]);
}

#[test]
fn dots_are_round_and_stay_in_their_cells() {
    let dots =
        only(TextureKind::Dots { inside: Color::gray(1.0), outside: Color::gray(0.0), mapping: Mapping::UV });
    let (mut with, mut steps) = (0, 0);
    for cell in 0..400 {
        let (i, j) = ((cell % 20) as f32, (cell / 20) as f32);
        let mut area = 0;
        for step in 0..400 {
            let (x, y) = ((step % 20) as f32 / 20.0 - 0.475, (step / 20) as f32 / 20.0 - 0.475);
            area += number(&dots, &at(i + x, j + y)) as u32;
        }
        // The area is π 0.35² of a cell, or 0.
        let part = area as f32 / 400.0;
        assert!(part == 0.0 || (part - 0.385).abs() < 0.03, "{part}");
        with += u32::from(area > 0);
        steps += 1;
    }
    assert!((0.3..0.7).contains(&(with as f32 / steps as f32)), "{with} of {steps}");
}

#[test]
fn patterns_of_noise() {
    let p = Vec3::new(3.3, -0.4, 7.9);
    let here = in_world(3.3, -0.4, 7.9);
    let fbm = only(TextureKind::Fbm { octaves: 5, roughness: 0.7, footprint: 0.0, mapping: WORLD });
    assert_eq!(number(&fbm, &here), perlin::fbm(p, 0.7, 5));
    let wrinkled = only(TextureKind::Wrinkled { octaves: 5, roughness: 0.7, footprint: 0.0, mapping: WORLD });
    assert_eq!(number(&wrinkled, &here), perlin::turbulence(p, 0.7, 5));
    let windy = only(TextureKind::Windy { footprint: 0.0, mapping: WORLD });
    assert_eq!(number(&windy, &here), perlin::fbm(0.1 * p, 0.5, 3).abs() * perlin::fbm(p, 0.5, 6));

    // Without variation the marble's colours are those of the palette's curve.
    let kind = TextureKind::PbrtMarble {
        octaves: 8,
        roughness: 0.5,
        scale: 2.0,
        variation: 0.0,
        footprint: 0.0,
        mapping: WORLD,
    };
    let marble = only(kind);
    let rgb = |y| marble.rgb_of(Color::Texture(FIRST), SpectrumType::Albedo, &in_world(0.0, y, 0.0));
    let near = |found: [f32; 3], expected: [f32; 3]| {
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-5), "{found:?}, not {expected:?}");
    };
    let quarter = std::f64::consts::FRAC_PI_4;
    near(rgb(-quarter), [0.87, 0.87, 0.9]);
    near(rgb(quarter), [0.87, 0.87, 0.9]);
    // sin 0 = 0: the middle of the six segments, where the fourth curve begins
    near(rgb(0.0), [0.75, 0.75, 0.75]);
}

#[test]
fn spectra_seen_in_daylight_have_their_colors() {
    let lambda: Vec<f32> = (360..=830).map(|nm| nm as f32).collect();
    let texels: Vec<[f32; 3]> =
        (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|c| c as f32 * 0.45 + 0.05)).collect();
    let image = Image::from_linear("", 27, 1, texels.clone());
    let textures = textures_of(&[picture(TexelFilter::Nearest, 1.0, false)], vec![image], vec![]);
    let curve_of = |color, usage, at: &TexturePoint| -> Vec<f32> {
        let spectral = |nm: &f32| {
            let mode = SpectralMode::Spectral(Wavelengths::new([*nm; 4], [1.0; 4]));
            textures.spectrum_of(color, usage, at, &mode).0[2]
        };
        lambda.iter().map(spectral).collect()
    };
    for (i, texel) in texels.iter().enumerate() {
        let here = at((i as f32 + 0.5) / 27.0, 0.5);
        let dense = |usage| {
            let values = curve_of(Color::Texture(FIRST), usage, &here);
            DenselySampledSpectrum::from_samples(std::array::from_fn(|i| values[i]))
        };
        let found = [
            dense(SpectrumType::Albedo).to_rgb_reflectance(),
            dense(SpectrumType::Unbounded).to_rgb_reflectance(),
            dense(SpectrumType::Illuminant).to_rgb(),
        ];
        for (usage, found) in ["albedo", "unbounded", "illuminant"].iter().zip(found) {
            assert!((0..3).all(|c| (found[c] - texel[c]).abs() < 1e-2), "{usage}: {found:?}, not {texel:?}");
        }
    }
}

#[test]
fn spectra_are_blended_and_curves_read() {
    let mode = SpectralMode::Spectral(Wavelengths::new([450.0, 500.0, 550.0, 600.0], [1.0; 4]));
    let curves = vec![
        Curve::Constant(0.5),
        Curve::Tabulated { wavelengths: vec![400.0, 600.0], values: vec![0.0, 1.0] },
    ];
    let red = Color::Value([0.8, 0.1, 0.1]);
    let ramp = Color::Curve(CurveId(1));
    let kinds = vec![TextureKind::Mix { low: red, high: ramp, amount: Scalar::Value(0.25) }];
    let textures = textures_of(&kinds, vec![], curves);
    let spectrum = |color| textures.spectrum_of(color, SpectrumType::Albedo, &at(0.0, 0.0), &mode);
    let expected = spectrum(red) * 0.75 + Spectrum([0.25, 0.5, 0.75, 1.0]) * 0.25;
    assert_eq!(spectrum(Color::Texture(FIRST)), expected);
    // A grey needs no table and stays exact; a curve keeps its value in RGB, too.
    assert_eq!(spectrum(Color::gray(0.3)), Spectrum([0.3; 4]));
    let rgb = textures.rgb_of(Color::Curve(CurveId(0)), SpectrumType::Albedo, &at(0.0, 0.0));
    assert!(rgb.iter().all(|c| (c - 0.5).abs() < 1e-5), "{rgb:?}");
    assert_eq!(textures.curve(CurveId(0)).max(), 0.5);
}

#[test]
fn metals_under_light_of_equal_energy_have_the_colors_of_mitsuba() {
    // Of Mitsuba 3.9 (`scalar_rgb`): the parameters `eta` and `k` of a conductor.
    for (name, of_mitsuba) in [
        ("metal-Ag-eta", [0.155276, 0.116728, 0.138388]),
        ("metal-Au-eta", [0.143036, 0.375307, 1.442045]),
        ("metal-Au-k", [3.982997, 2.385556, 1.603359]),
        ("metal-MgO-eta", [2.089584, 1.650723, 1.594879]),
        ("metal-MgO-k", [0.0, 0.0, 0.0]),
    ] {
        let curve = lookfrom_scene::spectrum::named(name).expect("a metal");
        let textures = Textures::new(&[], vec![], vec![curve], ColorMode::Rgb);
        let color = |white| {
            let texture = textures.index_of_refraction(Color::Curve(CurveId(0)), white);
            textures.rgb(&texture, &at(0.0, 0.0))
        };
        let found = color(Illuminant::EqualEnergy);
        let is_near = |c: usize| (found[c] - of_mitsuba[c]).abs() < 5e-3 * of_mitsuba[c] + 1e-6;
        assert!((0..3).all(is_near), "{name}: {found:?}");
        assert!(name == "metal-MgO-k" || color(Illuminant::D65) != found);
    }
    // Colours that are written are what they are.
    let none = only(TextureKind::product(Scalar::Value(1.0), Scalar::Value(1.0)));
    let red = none.index_of_refraction(Color::Value([0.5, 0.1, 0.2]), Illuminant::EqualEnergy);
    assert_eq!(none.rgb(&red, &at(0.0, 0.0)), [0.5, 0.1, 0.2]);
}

#[test]
fn nothing_is_nan_anywhere() {
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e20, 3e9, 1e-40, -0.0];
    let (a, b, octaves, roughness) = (Color::gray(0.2), Color::Value([0.1, 0.5, 0.9]), 4, 0.5);
    let identity = DMat4::IDENTITY;
    let axes = [Vec3::X, Vec3::Y];
    let mappings = [
        Mapping::UV,
        Mapping::Spherical { texture_from_world: identity },
        Mapping::Cylindrical { texture_from_world: identity },
        Mapping::Planar { texture_from_world: identity, axes, offset: [0.0; 2] },
        WORLD,
    ];
    for mapping in mappings {
        let mut kinds = vec![
            TextureKind::Checker { even: a, odd: b, footprint: 0.0, mapping },
            TextureKind::Noise { low: a, high: b, octaves, mapping },
            TextureKind::Marble { vein: a, base: b, octaves, turbulence: 3.0, mapping },
            TextureKind::Bilinear { corners: [a, b, a, b], mapping },
            TextureKind::Dots { inside: a, outside: b, mapping },
            TextureKind::Fbm { octaves, roughness, footprint: 0.0, mapping },
            TextureKind::Wrinkled { octaves, roughness, footprint: 0.0, mapping },
            TextureKind::Windy { footprint: 0.0, mapping },
            TextureKind::PbrtMarble {
                octaves,
                roughness,
                scale: 1.0,
                variation: 0.2,
                footprint: 0.0,
                mapping,
            },
        ];
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
            for filter in [TexelFilter::Bilinear, TexelFilter::Nearest] {
                kinds.push(TextureKind::Image {
                    image: ImageId(0),
                    mapping,
                    wrap: [wrap, Wrap::Repeat],
                    filter,
                    channel: Channel::Rgb,
                    scale: 1.0,
                    invert: false,
                });
            }
        }
        let textures = textures_of(&kinds, vec![two_by_two()], vec![]);
        for (index, kind) in kinds.iter().enumerate() {
            for u in wild {
                for v in wild {
                    let world = DVec3::new(u.into(), v.into(), u.into());
                    let point = TexturePoint { world, ..at(u, v) };
                    let color = Color::Texture(TextureId(index as u32));
                    let rgb = textures.rgb_of(color, SpectrumType::Unbounded, &point);
                    assert!(rgb.iter().all(|c| c.is_finite()), "{kind:?} at {u}, {v}: {rgb:?}");
                }
            }
        }
    }
}

fn affine(set: u32, matrix: [[f32; 3]; 2]) -> Mapping {
    Mapping::Affine { set, matrix }
}

#[test]
fn channels_are_greys_and_alpha_is_no_color() {
    let image = Image::from_bytes("", 2, 1, vec![[255, 51, 0, 102], [255, 51, 0, 204]], Encoding::Srgb);
    let channels = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha, Channel::Rgb];
    let kinds = channels.map(|channel| TextureKind::Image {
        image: ImageId(0),
        mapping: Mapping::UV,
        wrap: [Wrap::Clamp, Wrap::Black],
        filter: TexelFilter::Bilinear,
        channel,
        scale: 2.0,
        invert: false,
    });
    let textures = textures_of(&kinds, vec![image], vec![]);
    let number = |index, at: &TexturePoint| textures.scalar(Scalar::Texture(TextureId(index)), at);
    let green = lookfrom_scene::image::linear_from_srgb(0.2);
    // In the middle between both texels; the black above and below has no weight at v = 0.5.
    let found: Vec<f32> = (0..4).map(|index| number(index, &at(0.5, 0.5))).collect();
    assert_eq!(found, [2.0, 2.0 * green, 0.0, 2.0 * (0.5 * 0.4 + 0.5 * 0.8)]);
    let gray = textures.rgb_of(Color::Texture(TextureId(3)), SpectrumType::Unbounded, &at(0.0, 0.5));
    assert_eq!(gray, [0.8; 3]);
    // Each axis wraps on its own.
    assert_eq!((number(3, &at(-3.0, 0.5)), number(3, &at(0.5, 3.0))), (0.8, 0.0));
    assert_eq!(
        textures.rgb_of(Color::Texture(TextureId(4)), SpectrumType::Albedo, &at(0.5, 0.5)),
        [1.0, 2.0 * green, 0.0]
    );
}

#[test]
fn products_multiply_channels_and_only_one_factor_is_light() {
    let curves = vec![Curve::Constant(0.5)];
    let (a, b) = (Color::Value([0.5, 0.25, 1.0]), Color::Value([0.5, 3.0, 0.0]));
    let kinds = vec![
        TextureKind::Product { a, b },
        TextureKind::Product { a: Color::gray(2.0), b: Color::gray(3.0) },
        TextureKind::Product { a: Color::gray(0.5), b: Color::Texture(TextureId(1)) },
        TextureKind::Product { a: Color::gray(2.0), b: Color::Curve(CurveId(0)) },
    ];
    let textures = textures_of(&kinds, vec![], curves);
    let [of_colors, of_grays, nested, with_curve] = [0, 1, 2, 3].map(|id| Color::Texture(TextureId(id)));
    let here = TexturePoint::NOWHERE;
    assert_eq!(textures.rgb_of(of_colors, SpectrumType::Unbounded, &here), [0.25, 0.75, 0.0]);
    assert_eq!(textures.rgb_of(of_colors, SpectrumType::Albedo, &here), [0.25, 0.25, 0.0]);
    assert_eq!(textures.scalar(Scalar::Texture(TextureId(2)), &here), 3.0);

    let mode = SpectralMode::Spectral(Wavelengths::new([450.0, 500.0, 550.0, 600.0], [1.0; 4]));
    let spectrum = |color, usage| textures.spectrum_of(color, usage, &here, &mode);
    for usage in [SpectrumType::Unbounded, SpectrumType::Illuminant] {
        let six = spectrum(Color::gray(6.0), usage);
        assert_eq!(spectrum(of_grays, usage), six, "{usage:?}");
        let three = spectrum(Color::gray(3.0), usage);
        assert_eq!(spectrum(nested, usage), three, "{usage:?}");
    }
    let colored = spectrum(a, SpectrumType::Unbounded) * spectrum(b, SpectrumType::Unbounded);
    assert_eq!(spectrum(of_colors, SpectrumType::Unbounded), colored);
    assert_eq!(spectrum(with_curve, SpectrumType::Unbounded), Spectrum([1.0; 4]));
}

#[test]
fn quotients_of_numbers_are_0_where_nothing_divides() {
    let part = Scalar::Texture(TextureId(0));
    let quotient = |a, b| TextureKind::Quotient { a, b };
    let kinds = [
        TextureKind::Product { a: Color::gray(0.5), b: Color::gray(0.5) },
        quotient(part, Scalar::Value(0.5)),
        quotient(Scalar::Value(0.5), part),
        quotient(part, Scalar::Value(0.0)),
    ];
    let textures = textures_of(&kinds, vec![], vec![]);
    let number = |id| textures.scalar(Scalar::Texture(TextureId(id)), &TexturePoint::NOWHERE);
    assert_eq!([1, 2, 3].map(number), [0.5, 2.0, 0.0]);
}

#[test]
fn mappings_choose_a_set_of_coordinates_and_turn_it() {
    let image = Image::from_linear("", 2, 2, vec![[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]]);
    let quarter_turn = [[0.0, 1.0, 0.25], [-1.0, 0.0, 1.0]];
    let kinds = [(0, quarter_turn), (2, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), (9, quarter_turn)].map(
        |(set, matrix)| TextureKind::Image {
            image: ImageId(0),
            mapping: affine(set, matrix),
            wrap: [Wrap::Repeat; 2],
            filter: TexelFilter::Nearest,
            channel: Channel::Rgb,
            scale: 1.0,
            invert: false,
        },
    );
    let textures = textures_of(&kinds, vec![image], vec![]);
    let mut here = at(0.4, 0.1);
    here.more_uvs[1] = Vec2::new(0.9, 0.9);
    let number = |id| textures.scalar(Scalar::Texture(TextureId(id)), &here);
    // (0.35, 0.6): upper left. (0.9, 0.9): upper right. A missing set is (0, 0), rotated to (0.25, 1): upper
    // left.
    assert_eq!([number(0), number(1), number(2)], [1.0, 2.0, 1.0]);
}

#[test]
fn vertices_have_opacities_and_what_is_opaque_is_known() {
    let clear = Image::from_bytes("", 1, 1, vec![[0, 0, 0, 0]], Encoding::Linear);
    let opaque = Image::from_bytes("", 1, 1, vec![[0, 0, 0, 255]], Encoding::Linear);
    let alpha = |image, wrap| TextureKind::Image {
        image: ImageId(image),
        mapping: Mapping::UV,
        wrap: [wrap; 2],
        filter: TexelFilter::Bilinear,
        channel: Channel::Alpha,
        scale: 1.0,
        invert: false,
    };
    let of = |id| Color::Texture(TextureId(id));
    let kinds = vec![
        TextureKind::VertexAlpha,
        alpha(0, Wrap::Repeat),
        alpha(1, Wrap::Repeat),
        alpha(1, Wrap::Black),
        TextureKind::Product { a: of(0), b: of(2) },
        TextureKind::Product { a: of(2), b: Color::gray(0.5) },
        TextureKind::Threshold { value: Scalar::Texture(TextureId(4)), edge: 0.5 },
    ];
    let textures = textures_of(&kinds, vec![clear, opaque], vec![]);
    let is_one = |id, has| textures.is_one(FloatTexture::Texture(TextureId(id)), has);
    assert_eq!(
        [0, 1, 2, 3, 4, 5, 6].map(|id| is_one(id, false)),
        [true, false, true, false, true, false, true]
    );
    assert!(![0, 4, 6].iter().any(|&id| is_one(id, true)));
    assert!(
        textures.is_one(FloatTexture::Constant(1.0), true)
            && !textures.is_one(FloatTexture::Constant(0.0), false)
    );
    for opacity in [0.25, 0.75] {
        let here = TexturePoint { opacity, ..at(0.5, 0.5) };
        assert_eq!(textures.scalar(Scalar::Texture(TextureId(4)), &here), opacity);
        let cut = textures.scalar(Scalar::Texture(TextureId(6)), &here);
        assert_eq!(cut, if opacity < 0.5 { 0.0 } else { 1.0 });
    }
}

/// Textures in a chain, each made of the one before by `part`.
fn chain(count: u32, part: impl Fn(Color, u32) -> TextureKind) -> Vec<TextureKind> {
    let first = TextureKind::VertexColor { tint: [0.5, 0.25, 0.75] };
    let others = (1..count).map(|k| part(Color::Texture(TextureId(k - 1)), k));
    std::iter::once(first).chain(others).collect()
}

#[test]
fn textures_that_are_used_a_billion_times_are_evaluated_once() {
    let four = |before, _| TextureKind::Bilinear { corners: [before; 4], mapping: Mapping::UV };
    let textures = textures_of(&chain(16, four), vec![], vec![]);
    let last = Color::Texture(TextureId(15));
    // All weights are powers of 2.
    let at = at(0.5, 0.5);
    assert_eq!(textures.rgb_of(last, SpectrumType::Albedo, &at), [0.5, 0.25, 0.75]);
    assert_eq!(textures.scalar(Scalar::Texture(TextureId(15)), &at), 0.5);
}

#[test]
fn values_that_are_kept_are_those_that_are_not() {
    // Numbers, colours and both spectrum types of one texture in one graph.
    let woven = |before, k: u32| match (k % 3, before) {
        (0, Color::Texture(id)) => {
            TextureKind::Mix { low: before, high: Color::Value([0.9, 0.1, 1.5]), amount: Scalar::Texture(id) }
        }
        (1, _) => TextureKind::Product { a: before, b: before },
        _ => TextureKind::Bilinear {
            corners: [before, Color::Value([1.0; 3]), before, Color::Texture(FIRST)],
            mapping: Mapping::UV,
        },
    };
    let kept = textures_of(&chain(13, woven), vec![], vec![]);
    assert!(kept.keeps_values[12] && !kept.keeps_values[3]);
    let mut again = kept.clone();
    again.keeps_values.fill(false);
    let modes = [SpectralMode::Rgb, SpectralMode::Spectral(Wavelengths::sample_visible(0.3))];
    for index in 0..13 {
        let color = Color::Texture(TextureId(index));
        for (of, mode) in [SpectrumType::Albedo, SpectrumType::Unbounded, SpectrumType::Illuminant]
            .into_iter()
            .flat_map(|of| modes.map(|mode| (of, mode)))
        {
            let at = at(0.3, 0.8);
            assert_eq!(kept.spectrum_of(color, of, &at, &mode), again.spectrum_of(color, of, &at, &mode));
            let number = Scalar::Texture(TextureId(index));
            assert_eq!(kept.scalar(number, &at), again.scalar(number, &at));
        }
    }
}
