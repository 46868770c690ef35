//! OpenEXR pictures of other programs: windows, parts, layers, primaries, infinities.

use std::io::Cursor;
use std::path::Path;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, ImageAttributes, IntegerBounds, Layer,
    LayerAttributes, Layers, Vec2, WritableImage,
};
use lookfrom_scene::image::{self, By, Encoding as Curve, Image, Reading};
use lookfrom_scene::{LoadContext, Location, Memory};

type Channel = (&'static str, Vec<f32>);

/// A part at a place of the picture.
fn part(
    name: Option<&str>,
    [x, y]: [i32; 2],
    [width, height]: [usize; 2],
    channels: &[Channel],
) -> Layer<AnyChannels<FlatSamples>> {
    let list = channels.iter().map(|(name, values)| AnyChannel::new(*name, FlatSamples::F32(values.clone())));
    let attributes = LayerAttributes {
        layer_name: name.map(exr::prelude::Text::from),
        layer_position: Vec2(x, y),
        ..LayerAttributes::default()
    };
    Layer::new(Vec2(width, height), attributes, Encoding::UNCOMPRESSED, AnyChannels::sort(list.collect()))
}

fn file(
    [width, height]: [usize; 2],
    chromaticities: Option<Chromaticities>,
    parts: Vec<Layer<AnyChannels<FlatSamples>>>,
) -> Vec<u8> {
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions(Vec2(width, height)));
    attributes.chromaticities = chromaticities;
    let image: ExrImage<Layers<AnyChannels<FlatSamples>>> = ExrImage::from_layers(attributes, parts);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).expect("a picture");
    bytes.into_inner()
}

fn read(bytes: &[u8], reading: &Reading<'_>) -> Result<(Image, Vec<String>), String> {
    let mut files = Memory::default();
    files.0.insert("a.exr".into(), bytes.to_vec());
    let mut context = LoadContext::new(&files);
    let image =
        image::read_as(Path::new("a.exr"), reading, &mut context).map_err(|error| error.to_string())?;
    Ok((image, context.warnings.iter().map(|warning| warning.message.clone()).collect()))
}

fn layer(bytes: &[u8], layer: Option<&str>) -> Result<(Vec<[f32; 3]>, Vec<String>), String> {
    let reading = Reading { layer, ..Reading::new(Curve::Srgb) };
    read(bytes, &reading).map(|(image, said)| (image.texels().collect(), said))
}

fn rgb(prefix: &[&'static str; 3], value: f32, count: usize) -> Vec<Channel> {
    prefix.iter().zip([1.0, 2.0, 4.0]).map(|(name, scale)| (*name, vec![value * scale; count])).collect()
}

const RGB: [&str; 3] = ["R", "G", "B"];

#[test]
fn the_picture_is_the_display_window() {
    let values: Vec<f32> = (1..=6).map(|i| i as f32).collect();
    let gray = |at, size| file([4, 3], None, vec![part(None, at, size, &[("Y", values.clone())])]);
    let shown = |bytes: &[u8]| layer(bytes, None).unwrap().0.iter().map(|texel| texel[0]).collect::<Vec<_>>();
    // A crop, of three columns and two rows.
    let crop = gray([1, 1], [3, 2]);
    assert_eq!(shown(&crop), [0., 0., 0., 0., 0., 1., 2., 3., 0., 4., 5., 6.]);
    let (pbrt, _) = read(&crop, &Reading { by: By::PbrtTexture, ..Reading::new(Curve::Srgb) }).unwrap();
    assert_eq!((pbrt.width, pbrt.height), (3, 2), "pbrt's picture is the data window");
    // It reaches beyond the corner.
    assert_eq!(shown(&gray([-1, -1], [3, 2])), [5., 6., 0., 0., 0., 0., 0., 0., 0., 0., 0., 0.]);
    assert_eq!(shown(&gray([3, 0], [2, 3])), [0., 0., 0., 1., 0., 0., 0., 3., 0., 0., 0., 5.]);
    // Nothing of it is shown.
    let (image, said) = read(&gray([9, 9], [2, 3]), &Reading::new(Curve::Srgb)).unwrap();
    assert_eq!((image.width, image.height, said.len()), (2, 3, 1), "{said:?}");

    let all = {
        let mut files = Memory::default();
        files.0.insert("a.exr".into(), crop);
        image::read_exr(Path::new("a.exr"), &mut LoadContext::new(&files)).unwrap()
    };
    assert_eq!((all.width, all.height, all.channels[0].1.len()), (4, 3, 12));
}

#[test]
fn the_header_says_what_is_read_and_sums_of_films_are_not() {
    let mut channels = rgb(&RGB, 1.0, 2);
    channels.push(("film.sum", vec![7.0; 2]));
    let film = file([2, 1], None, vec![part(None, [0, 0], [2, 1], &channels)]);
    let parts = vec![
        part(Some("beauty"), [0, 0], [2, 1], &rgb(&RGB, 2.0, 2)),
        part(Some("depth"), [1, 0], [1, 1], &[("Z", vec![9.0])]),
    ];
    for (bytes, names) in [(film, "B G R"), (file([2, 1], None, parts), "beauty.B beauty.G beauty.R depth.Z")]
    {
        let mut files = Memory::default();
        files.0.insert("a.exr".into(), bytes.clone());
        let mut context = LoadContext::new(&files);
        let all = image::read_exr(Path::new("a.exr"), &mut context).unwrap();
        let contents = image::exr_contents(&bytes, &Location::default(), &mut context).unwrap();
        assert_eq!(contents.channels.join(" "), names);
        assert!(all.channels.iter().map(|(name, _)| name).eq(&contents.channels));
        assert_eq!(
            (all.width, all.height, all.attributes),
            (contents.width, contents.height, contents.attributes)
        );
    }
}

#[test]
fn the_first_part_or_layer_with_colors_is_taken() {
    let single = file([2, 1], None, vec![part(Some("rgba"), [0, 0], [2, 1], &rgb(&RGB, 1.0, 2))]);
    assert_eq!(layer(&single, None).unwrap(), (vec![[1.0, 2.0, 4.0]; 2], vec![]));
    assert_eq!(layer(&single, Some("rgba")).unwrap().0[0], [1.0, 2.0, 4.0]);

    let parts = vec![
        part(Some("depth"), [0, 0], [2, 1], &[("Z", vec![9.0; 2])]),
        part(Some("beauty"), [0, 0], [2, 1], &rgb(&RGB, 2.0, 2)),
        // A part of another size.
        part(Some("albedo"), [1, 0], [1, 1], &rgb(&RGB, 3.0, 1)),
    ];
    let parts = file([2, 1], None, parts);
    assert_eq!(layer(&parts, None).unwrap(), (vec![[2.0, 4.0, 8.0]; 2], vec![]));
    assert_eq!(layer(&parts, Some("albedo")).unwrap().0, [[0.0; 3], [3.0, 6.0, 12.0]]);
    assert_eq!(layer(&parts, Some("depth")).unwrap().0, [[9.0; 3]; 2]);
    assert_eq!(
        layer(&parts, Some("albdo")).unwrap_err(),
        "a.exr: there is no layer \"albdo\" in it\n  help: did you mean \"albedo\"?"
    );

    let passes = ["ViewLayer.AO.R", "ViewLayer.AO.G", "ViewLayer.AO.B"];
    let combined = ["ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"];
    let normal = ["ViewLayer.Normal.X", "ViewLayer.Normal.Y", "ViewLayer.Normal.Z"];
    let mut channels = rgb(&passes, 1.0, 1);
    channels.extend(rgb(&combined, 5.0, 1));
    channels.extend(rgb(&normal, 7.0, 1));
    let layered = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels)]);
    let (texels, said) = layer(&layered, None).unwrap();
    assert_eq!(texels, [[5.0, 10.0, 20.0]]);
    assert!(said[0].contains("ViewLayer.Combined is taken") && said[0].contains("ViewLayer.AO"), "{said:?}");
    assert_eq!(layer(&layered, Some("AO")).unwrap().0, [[1.0, 2.0, 4.0]]);
    assert_eq!(layer(&layered, Some("ViewLayer.Normal")).unwrap().0, [[7.0, 14.0, 28.0]]);
    let only = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels[3..6])]);
    assert_eq!(layer(&only, None).unwrap(), (vec![[5.0, 10.0, 20.0]], vec![]));

    // Colours without a layer come first.
    let mut channels = rgb(&["albedo.R", "albedo.G", "albedo.B"], 1.0, 1);
    channels.extend(rgb(&RGB, 6.0, 1));
    let beside = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels)]);
    assert_eq!(layer(&beside, None).unwrap(), (vec![[6.0, 12.0, 24.0]], vec![]));
    let png = image::encode_png(1, 1, &[1, 2, 3]).unwrap();
    assert!(layer(&png, Some("a")).unwrap_err().contains("only OpenEXR pictures have layers"));
}

#[test]
fn the_colors_of_other_primaries_become_ours() {
    let near = |found: [f32; 3], expected: [f32; 3]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-3), "{found:?} {expected:?}");
    };
    let chromaticities = |[rx, ry, gx, gy, bx, by, wx, wy]: [f32; 8]| Chromaticities {
        red: Vec2(rx, ry),
        green: Vec2(gx, gy),
        blue: Vec2(bx, by),
        white: Vec2(wx, wy),
    };
    let of = |colors: [f32; 8], [r, g, b]: [f32; 3], by| {
        let channels = [("R", vec![r]), ("G", vec![g]), ("B", vec![b])];
        let bytes = file([1, 1], Some(chromaticities(colors)), vec![part(None, [0, 0], [1, 1], &channels)]);
        read(&bytes, &Reading { by, ..Reading::new(Curve::Srgb) }).unwrap().0.texel(0)
    };
    let aces = [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767];
    // Red of Rec. 709 in ACES2065-1 (SMPTE ST 2065-1, Bradford's adaptation).
    near(of(aces, [0.4396, 0.0898, 0.0175], By::Standard), [1.0, 0.0, 0.0]);
    near(of(aces, [0.5; 3], By::Standard), [0.5; 3]);
    // Of a light of pbrt's, white stays the white of ACES, which is warmer than ours.
    let light = of(aces, [0.5; 3], By::PbrtLight);
    assert!(light[0] > 0.51 && light[2] < 0.48, "{light:?}");
    let xyz = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0];
    near(of(xyz, [0.9505, 1.0, 1.089], By::Standard), [1.0; 3]);
    near(of(xyz, [0.4124, 0.2126, 0.0193], By::Standard), [1.0, 0.0, 0.0]);
    let rec2020 = [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329];
    near(of(rec2020, [0.6274, 0.0691, 0.0164], By::Standard), [1.0, 0.0, 0.0]);
    let ours = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    assert_eq!(of(ours, [0.1, 0.2, 0.3], By::Standard), [0.1, 0.2, 0.3]);
    // What spans no colours changes nothing.
    assert_eq!(of([0.0; 8], [0.1, 0.2, 0.3], By::Standard), [0.1, 0.2, 0.3]);

    let channels = [("X", vec![0.4124]), ("Y", vec![0.2126]), ("Z", vec![0.0193])];
    let named = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels)]);
    near(layer(&named, None).unwrap().0[0], [1.0, 0.0, 0.0]);
    let (y, r, b) = (0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125, 0.5, 0.125);
    let channels = [("Y", vec![y]), ("RY", vec![(r - y) / y]), ("BY", vec![(b - y) / y])];
    let chroma = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels)]);
    near(layer(&chroma, None).unwrap().0[0], [0.5, 0.25, 0.125]);
    // Data are no colours.
    let channels = [("R", vec![0.25]), ("G", vec![0.5]), ("B", vec![0.75])];
    let bytes = file([1, 1], Some(chromaticities(aces)), vec![part(None, [0, 0], [1, 1], &channels)]);
    assert_eq!(read(&bytes, &Reading::new(Curve::Linear)).unwrap().0.texel(0), [0.25, 0.5, 0.75]);
}

/// What `develop` and `compare` read: the same colours as a texture's, beside all other channels.
#[test]
fn a_layer_becomes_the_picture_and_the_other_channels_stay() {
    let read = |bytes: &[u8], layer: Option<&str>| {
        let mut files = Memory::default();
        files.0.insert("a.exr".into(), bytes.to_vec());
        let found = image::read_exr_layer(Path::new("a.exr"), layer, &mut LoadContext::new(&files));
        found.map(|all| all.channels).map_err(|error| error.message)
    };
    let mut combined = rgb(&["View.Combined.R", "View.Combined.G", "View.Combined.B"], 5.0, 1);
    combined.push(("View.Combined.A", vec![1.0]));
    combined.push(("View.Depth.Z", vec![9.0]));
    let layered = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &combined)]);
    let channels = [("R", 5.0), ("G", 10.0), ("B", 20.0), ("A", 1.0), ("View.Depth.Z", 9.0)]
        .map(|(name, value)| (name.to_owned(), vec![value]));
    assert_eq!(read(&layered, None).unwrap(), channels);
    let depth = read(&layered, Some("Depth")).unwrap();
    assert_eq!(depth[..3], ["R", "G", "B"].map(|name| (name.to_owned(), vec![9.0])));
    assert_eq!(depth.len(), 3 + 4);
    assert!(read(&layered, Some("Mist")).unwrap_err().contains("there is no layer"));

    let rec2020 = Chromaticities {
        red: Vec2(0.708, 0.292),
        green: Vec2(0.17, 0.797),
        blue: Vec2(0.131, 0.046),
        white: Vec2(0.3127, 0.329),
    };
    let red = [("R", vec![0.6274]), ("G", vec![0.0691]), ("B", vec![0.0164])];
    let wide = read(&file([1, 1], Some(rec2020), vec![part(None, [0, 0], [1, 1], &red)]), None).unwrap();
    assert!(
        wide.iter().zip([1.0, 0.0, 0.0]).all(|((_, found), expected)| (found[0] - expected).abs() < 2e-3),
        "{wide:?}"
    );
}

#[test]
fn infinite_light_is_very_bright() {
    let values = [1.0, f32::INFINITY, f32::NAN, f32::NEG_INFINITY];
    let of = |first: f32| {
        let values = [[first].as_slice(), &values[1..]].concat();
        let (texels, said) =
            layer(&file([4, 1], None, vec![part(None, [0, 0], [4, 1], &[("Y", values)])]), None).unwrap();
        assert_eq!(said.len(), 2, "{said:?}");
        texels.iter().map(|texel| texel[0]).collect::<Vec<_>>()
    };
    assert_eq!(of(3.0), [3.0, 65504.0, 0.0, 0.0]);
    assert_eq!(of(1e9), [1e9, 1e9, 0.0, 0.0]);
}

#[test]
fn subsampled_chroma_is_told() {
    let channels = [("BY", vec![0.0; 4]), ("RY", vec![0.0; 4]), ("Y", vec![1.0; 4])];
    let mut bytes = file([2, 2], None, vec![part(None, [0, 0], [2, 2], &channels)]);
    for name in ["BY\0", "RY\0"] {
        let at = bytes.windows(3).position(|window| window == name.as_bytes()).unwrap();
        let sampling = at + 3 + 8;
        bytes[sampling..sampling + 8].copy_from_slice(&[2, 0, 0, 0, 2, 0, 0, 0]);
    }
    assert_eq!(
        layer(&bytes, None).unwrap_err(),
        "a.exr: OpenEXR with luminance and subsampled chroma (Y, RY, BY) is not read here: BY, RY have fewer values \
         than pixels\n  help: the file is whole; save it with the channels R, G and B, each with a value for every pixel"
    );
}

/// The opacity is the channel A of the layer that has the colours; one that is 1 everywhere is none.
#[test]
fn opacities_are_read() {
    let with = |name: &'static str, alpha: [f32; 2]| {
        let mut channels = rgb(&RGB, 1.0, 2);
        channels.push((name, alpha.to_vec()));
        let bytes = file([2, 1], None, vec![part(None, [0, 0], [2, 1], &channels)]);
        read(&bytes, &Reading::new(Curve::Srgb)).unwrap().0
    };
    let image = with("A", [0.25, 1.0]);
    assert_eq!((image.has_alpha(), image.alpha(0), image.alpha(1)), (true, 0.25, 1.0));
    assert!(!with("A", [1.0, 1.0]).has_alpha() && !with("mask.A", [0.25, 1.0]).has_alpha());
    // pbrt's numbers of such a picture are its opacity.
    let channels = [rgb(&RGB, 1.0, 1), vec![("A", vec![0.25])]].concat();
    let bytes = file([1, 1], None, vec![part(None, [0, 0], [1, 1], &channels)]);
    let files = Memory([("a.exr".into(), bytes)].into());
    let opacity = image::read_opacity(Path::new("a.exr"), &mut LoadContext::new(&files), Curve::Srgb);
    assert_eq!(opacity.unwrap().unwrap().texel(0), [0.25; 3]);
}
