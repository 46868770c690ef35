//! Pictures: what is written comes back, whatever the format; what is hostile is an error.

use std::io::Cursor;
use std::path::Path;

use ::image::{
    DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Rgb, Rgb32FImage, RgbImage, Rgba,
    RgbaImage,
};
use lookfrom_scene::image::{self, ExrChannel, ExrHeader, Image, Metadata, Pixels};
use lookfrom_scene::{ErrorKind, LoadContext, Memory};
use proptest::prelude::*;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::{RGB8, RGB32Float, RGBA8, RGBA16};

fn read_as(name: &str, bytes: &[u8], texels: Option<u64>) -> lookfrom_scene::Result<(Image, usize)> {
    let mut files = Memory::default();
    files.0.insert(name.into(), bytes.to_vec());
    let mut context = LoadContext::new(&files);
    context.limits.texels = texels.unwrap_or(1 << 20);
    image::read(Path::new(name), &mut context).map(|image| (image, context.warnings.len()))
}

fn texels_of(image: &Image) -> Vec<[f32; 3]> {
    image.texels().collect()
}

fn gradient() -> RgbImage {
    RgbImage::from_fn(7, 5, |x, y| ::image::Rgb([(x * 40) as u8, (y * 60) as u8, 128]))
}

fn encode(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    if format == ImageFormat::Tiff {
        let (width, height) = (picture.width(), picture.height());
        let mut file = TiffEncoder::new(&mut bytes).expect("TIFF");
        match picture {
            DynamicImage::ImageRgb8(picture) => file.write_image::<RGB8>(width, height, picture),
            DynamicImage::ImageRgba8(picture) => file.write_image::<RGBA8>(width, height, picture),
            DynamicImage::ImageRgba16(picture) => file.write_image::<RGBA16>(width, height, picture),
            DynamicImage::ImageRgb32F(picture) => file.write_image::<RGB32Float>(width, height, picture),
            picture => unreachable!("{:?}", picture.color()),
        }
        .expect("encodes");
        return bytes.into_inner();
    }
    picture.write_to(&mut bytes, format).expect("encodes");
    bytes.into_inner()
}

#[test]
fn every_lossless_format_gives_the_same_linear_colors() {
    let picture = DynamicImage::from(gradient());
    let expected: Vec<[f32; 3]> = gradient()
        .pixels()
        .map(|pixel| pixel.0.map(|value| image::linear_from_srgb(f32::from(value) / 255.0)))
        .collect();
    for (name, format) in [
        ("a.png", ImageFormat::Png),
        ("a.bmp", ImageFormat::Bmp),
        ("a.tga", ImageFormat::Tga),
        ("a.ppm", ImageFormat::Pnm),
        ("a.webp", ImageFormat::WebP),
        ("a.tif", ImageFormat::Tiff),
    ] {
        let bytes = encode(&picture, format);
        let (read, _) = read_as(name, &bytes, None).expect(name);
        assert_eq!((read.width, read.height, texels_of(&read)), (7, 5, expected.clone()), "{name}");
        // The content tells, not the extension; only TGA has no mark.
        if format != ImageFormat::Tga {
            assert_eq!(
                texels_of(&read_as("a.jpg", &bytes, None).expect(name).0),
                expected,
                "{name} named .jpg"
            );
        }
    }
    for format in [ImageFormat::Jpeg, ImageFormat::Gif] {
        let (read, _) = read_as("a", &encode(&picture, format), None).expect("lossy formats are read");
        assert_eq!((read.width, read.height), (7, 5));
        let found = texels_of(&read);
        let differences =
            found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
        assert!(differences.sum::<f32>() / (7.0 * 5.0 * 3.0) < 0.03, "{format:?}");
    }
}

#[test]
fn sixteen_bits_and_data_and_alpha() {
    let deep = DynamicImage::from(DynamicImage::from(gradient()).into_rgb16());
    let (read, _) = read_as("a.png", &encode(&deep, ImageFormat::Png), None).expect("16-bit PNG");
    assert!((read.texel(0)[2] - image::linear_from_srgb(128.0 / 255.0)).abs() < 1e-6);

    let clear = DynamicImage::from(RgbaImage::from_pixel(2, 2, ::image::Rgba([255, 0, 128, 0])));
    let bytes = encode(&clear, ImageFormat::Png);
    let (read, _) = read_as("a.png", &bytes, None).expect("alpha is dropped");
    assert_eq!(read.texel(0)[0], 1.0);

    let mut files = Memory::default();
    files.0.insert("a.png".into(), bytes.clone());
    let data = image::read_data(Path::new("a.png"), &mut LoadContext::new(&files)).expect("data");
    assert_eq!(data.texel(3), [1.0, 0.0, 128.0 / 255.0]);

    // From memory, alpha with it: as it is, whatever the curve.
    let mut context = LoadContext::new(&files);
    let mut decoded = |picture: &DynamicImage, format| {
        image::decode(&encode(picture, format), "embedded", image::Encoding::Srgb, &mut context)
            .expect("whole")
    };
    let half = DynamicImage::from(RgbaImage::from_pixel(2, 2, ::image::Rgba([188, 0, 0, 51])));
    for picture in [&half, &DynamicImage::from(half.clone().into_rgba16())] {
        for format in [ImageFormat::Png, ImageFormat::Tiff] {
            let read = decoded(picture, format);
            assert!(read.has_alpha() && (read.alpha(3) - 0.2).abs() < 1e-6, "{format:?}");
            assert!((read.texel(3)[0] - image::linear_from_srgb(188.0 / 255.0)).abs() < 1e-6);
        }
    }
    assert!(!decoded(&DynamicImage::from(gradient()), ImageFormat::Png).has_alpha());
    let error = image::decode(b"nothing", "/images/3", image::Encoding::Linear, &mut context).unwrap_err();
    assert!(error.to_string().starts_with("/images/3: "), "{error}");
}

#[test]
fn light_is_kept_as_it_is() {
    let texels: Vec<[f32; 3]> = (0..40 * 33)
        .map(|i| [i as f32 * 0.25, libm::exp2f((i % 60) as f32 - 30.0), 1.0 / (1.0 + i as f32)])
        .collect();
    let pfm = image::encode_pfm(40, 33, &texels).expect("PFM");
    assert_eq!(texels_of(&read_as("a.pfm", &pfm, None).expect("PFM").0), texels);
    // The third number of the head is a factor.
    let twice: Vec<u8> =
        [b"Pf\n2 1\n-2.0\n".as_slice(), &1.5_f32.to_le_bytes(), &0.25_f32.to_le_bytes()].concat();
    assert_eq!(texels_of(&read_as("a.pfm", &twice, None).expect("PFM").0), [[3.0; 3], [0.5; 3]]);

    let planes = [0, 1, 2].map(|c| texels.iter().map(|texel| texel[c]).collect::<Vec<f32>>());
    let depth: Vec<f32> = (0..40 * 33).map(|i| i as f32).collect();
    let channels = [
        ("R".to_owned(), planes[0].as_slice()),
        ("G".to_owned(), planes[1].as_slice()),
        ("B".to_owned(), planes[2].as_slice()),
        ("depth.Z".to_owned(), depth.as_slice()),
    ];
    let notes =
        [("scene".to_owned(), "hero.toml".to_owned()), ("comments".to_owned(), "für später".to_owned())];
    let exr = image::encode_exr(40, 33, &channels, &notes).expect("EXR");
    assert_eq!(texels_of(&read_as("a.exr", &exr, None).expect("EXR").0), texels);

    let mut files = Memory::default();
    files.0.insert("a.exr".into(), exr.clone());
    let all = image::read_exr(Path::new("a.exr"), &mut LoadContext::new(&files)).expect("EXR");
    assert_eq!(all.channel("depth.Z"), Some(depth.as_slice()));
    assert!(all.attributes.contains(&notes[0]), "{:?}", all.attributes);

    let mut turned = channels.clone();
    turned.reverse();
    assert_eq!(image::encode_exr(40, 33, &turned, &notes).expect("EXR"), exr);

    // Shared exponents keep 8 bits of the largest primary, rounded: on average nothing is lost.
    let hdr = image::encode_hdr(40, 33, &texels).expect("HDR");
    let (read, _) = read_as("a.hdr", &hdr, None).expect("HDR");
    let mut excess = 0.0;
    for (a, b) in texels_of(&read).iter().zip(&texels) {
        let largest = b.iter().fold(0.0_f32, |most, &value| most.max(value));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() <= largest / 255.0), "{a:?} {b:?}");
        excess += (0..3).map(|c| (a[c] - b[c]) / largest.max(f32::MIN_POSITIVE)).sum::<f32>();
    }
    assert!(excess.abs() / (3.0 * texels.len() as f32) < 2e-4, "{excess}");
}

#[test]
fn channels_of_16_bits_have_the_nearest_halves() {
    const NUMBERS: [f32; 8] = [1.0, 1.0 / 3.0, -2049.0, 65504.0, 1e9, f32::MIN, f32::NEG_INFINITY, 1e-9];
    let header = ExrHeader {
        width: 8,
        height: 1,
        channels: vec![("R".to_owned(), ExrChannel::Half), ("Z".to_owned(), ExrChannel::Float)],
        ..ExrHeader::default()
    };
    let bytes: Vec<u8> = NUMBERS.iter().chain(&NUMBERS).flat_map(|number| number.to_le_bytes()).collect();
    let mut file = Cursor::new(Vec::new());
    image::write_exr(&header, &mut |_: u32, row: &mut [u8]| row.copy_from_slice(&bytes), &mut file)
        .expect("EXR");
    let mut files = Memory::default();
    files.0.insert("a.exr".into(), file.into_inner());
    let read = image::read_exr(Path::new("a.exr"), &mut LoadContext::new(&files)).expect("EXR");
    let third = 1365.0 / 4096.0;
    let halves = [1.0, third, -2048.0, 65504.0, 65504.0, -65504.0, f32::NEG_INFINITY, 0.0];
    assert_eq!(read.channel("R"), Some(halves.as_slice()));
    assert_eq!(read.channel("Z"), Some(NUMBERS.as_slice()));
}

#[test]
fn a_crop_is_the_data_window() {
    let depth: Vec<f32> = (0..40 * 33).map(|i| i as f32).collect();
    let mut header = ExrHeader {
        width: 40,
        height: 33,
        crop: Some([3..39, 5..30]),
        channels: ["Y", "Z"].map(|name| (name.to_owned(), ExrChannel::Float)).into(),
        ..ExrHeader::default()
    };
    let written = |header: &ExrHeader| {
        let mut file = Cursor::new(Vec::new());
        let mut fill = |row: u32, bytes: &mut [u8]| {
            let numbers = depth[row as usize * 40..].iter().take(40).flat_map(|number| number.to_le_bytes());
            bytes[40 * 4..].copy_from_slice(&numbers.collect::<Vec<u8>>());
        };
        image::write_exr(header, &mut fill, &mut file).map(|()| file.into_inner())
    };
    let bytes = written(&header).expect("EXR");
    let read = exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false).expect("a header");
    let window = read.headers[0].own_attributes.layer_position;
    assert_eq!((window.0, window.1, read.headers[0].layer_size.0), (3, 5, 36));

    let mut files = Memory::default();
    files.0.insert("a.exr".into(), bytes);
    let read = image::read_exr(Path::new("a.exr"), &mut LoadContext::new(&files)).expect("EXR");
    let is_held = |i: usize| (3..39).contains(&(i % 40)) && (5..30).contains(&(i / 40));
    let cropped: Vec<f32> = (0..40 * 33).map(|i| if is_held(i) { depth[i] } else { 0.0 }).collect();
    assert_eq!(read.channel("Z"), Some(cropped.as_slice()));

    for (x1, y1) in [(41, 30), (39, 34), (3, 30)] {
        header.crop = Some([3..x1, 5..y1]);
        assert!(written(&header).expect_err("no part").message.contains("40 × 33 pixels"));
    }
}

/// Values beyond the range of RGBE (Ward 1991) saturate: their exponents do not wrap, and bright ones do not become black.
#[test]
fn the_ends_of_shared_exponents() {
    let brightest = 255.0 * 2.0_f32.powi(119);
    let kept = |values: [f32; 3]| {
        let hdr = image::encode_hdr(1, 1, &[values]).expect("HDR");
        texels_of(&read_as("a.hdr", &hdr, None).expect("HDR").0)[0]
    };
    for (values, expected) in [
        ([f32::INFINITY, 0.0, 1.0], [brightest, 0.0, 0.0]),
        ([f32::MAX, f32::MAX, -1.0], [brightest, brightest, 0.0]),
        ([1.8e38, 0.0, 0.0], [brightest, 0.0, 0.0]),
        ([f32::NAN, -f32::INFINITY, 0.5], [0.0, 0.0, 0.5]),
        ([1e-40, 0.0, 0.0], [0.0; 3]),
        ([f32::from_bits(1), 0.0, 0.0], [0.0; 3]),
        // Half-way to the next mantissa, and to the next exponent.
        ([1.0, 0.5 / 128.0, 0.49 / 128.0], [1.0, 1.0 / 128.0, 0.0]),
        ([255.6 / 128.0, 1.0, 0.0], [2.0, 1.0, 0.0]),
    ] {
        assert_eq!(kept(values), expected, "{values:?}");
    }
    for exponent in -127..=126 {
        let value = 2.0_f32.powi(exponent);
        assert_eq!(kept([value, 0.0, value]), [value, 0.0, value], "2^{exponent}");
    }
}

#[test]
fn eight_bits_come_back() {
    let rgb = gradient().into_raw();
    for bytes in [image::encode_png(7, 5, &rgb).expect("PNG"), image::encode_ppm(7, 5, &rgb).expect("PPM")] {
        let found = ::image::load_from_memory(&bytes).expect("other programs read it").into_rgb8();
        assert_eq!(found.as_raw(), &rgb);
    }
    assert_eq!(image::encode_png(7, 6, &rgb).unwrap_err().kind, ErrorKind::Invalid);
    assert_eq!(image::encode_ppm(0, 0, &[]).unwrap_err().kind, ErrorKind::Invalid);
    let twice = [("R".to_owned(), [0.0].as_slice()), ("R".to_owned(), [0.0].as_slice())];
    assert_eq!(image::encode_exr(1, 1, &twice, &[]).unwrap_err().kind, ErrorKind::Invalid);
    let own = [("channels".to_owned(), String::new())];
    assert_eq!(image::encode_exr(1, 1, &twice[..1], &own).unwrap_err().kind, ErrorKind::Invalid);
}

#[test]
fn pictures_for_display_come_back_with_what_is_told_of_them() {
    let rgb = gradient().into_raw();
    let size = [7, 5];
    let rgba: Vec<u8> =
        rgb.chunks_exact(3).enumerate().flat_map(|(i, c)| [c[0], c[1], c[2], 7 * i as u8]).collect();
    let wide: Vec<u16> = (0..4 * 35).map(|i| i * 467).collect();
    let metadata = Metadata::new("a program", "seed: 3\nscene: größe.toml");
    let told = Some(&metadata);
    let lossless = [
        (image::encode_png_of(size, Pixels::Rgb8(&rgb), told), DynamicImage::from(gradient())),
        (image::encode_webp(size, Pixels::Rgb8(&rgb), told), gradient().into()),
        (
            image::encode_png_of(size, Pixels::Rgba8(&rgba), told),
            RgbaImage::from_raw(7, 5, rgba.clone()).unwrap().into(),
        ),
        (
            image::encode_webp(size, Pixels::Rgba8(&rgba), told),
            RgbaImage::from_raw(7, 5, rgba.clone()).unwrap().into(),
        ),
        (
            image::encode_png_of(size, Pixels::Rgba16(&wide), told),
            ImageBuffer::<Rgba<u16>, _>::from_raw(7, 5, wide.clone()).unwrap().into(),
        ),
        (
            image::encode_png_of(size, Pixels::Rgb16(&wide[..105]), told),
            ImageBuffer::<Rgb<u16>, _>::from_raw(7, 5, wide[..105].to_vec()).unwrap().into(),
        ),
    ];
    let mut files: Vec<Vec<u8>> = Vec::new();
    for (bytes, expected) in lossless {
        let bytes = bytes.expect("a picture");
        assert_eq!(::image::load_from_memory(&bytes).expect("other programs read it"), expected);
        files.push(bytes);
    }
    let jpeg = image::encode_jpeg(size, &rgb, 100, told).expect("a picture");
    let found = ::image::load_from_memory(&jpeg).expect("other programs read it").into_rgb8();
    assert!(found.as_raw().iter().zip(&rgb).all(|(a, b)| a.abs_diff(*b) <= 4), "{found:?}");
    files.push(jpeg);

    for bytes in files {
        let reader = ImageReader::new(Cursor::new(&bytes)).with_guessed_format().unwrap();
        let mut decoder = reader.into_decoder().unwrap();
        let exif = decoder.exif_metadata().unwrap().expect("Exif");
        let icc = decoder.icc_profile().unwrap().expect("an ICC profile");
        assert_eq!(
            (&icc[36..40], u32::from_be_bytes(icc[..4].try_into().unwrap()) as usize),
            (&b"acsp"[..], icc.len())
        );
        // The fields of the first directory, and of the one that it leads to.
        let number =
            |at: usize, bytes: usize| (0..bytes).fold(0, |sum, k| sum | usize::from(exif[at + k]) << (8 * k));
        let field = |directory: usize, tag: usize| {
            let fields = (0..number(directory, 2)).map(|k| directory + 2 + 12 * k);
            let at = fields.into_iter().find(|at| number(*at, 2) == tag).expect("the field");
            (number(at + 4, 4), number(at + 8, 4))
        };
        let text = |tag: usize| {
            let (count, at) = field(8, tag);
            std::str::from_utf8(&exif[at..at + count]).expect("UTF-8").trim_end_matches('\0')
        };
        assert_eq!(&exif[..8], b"II*\0\x08\0\0\0");
        assert_eq!((text(0x0131), text(0x010e)), ("a program", "seed: 3\nscene: größe.toml"));
        assert_eq!(field(field(8, 0x8769).1, 0xa001), (1, 1), "its colours are not sRGB");
    }
    assert_eq!(image::encode_webp([7, 6], Pixels::Rgb8(&rgb), None).unwrap_err().kind, ErrorKind::Invalid);
    let long = vec![0; 3 * 70_000];
    assert_eq!(image::encode_jpeg([70_000, 1], &long, 90, None).unwrap_err().kind, ErrorKind::Invalid);
    assert_eq!(
        image::encode_webp([70_000, 1], Pixels::Rgb8(&long), None).unwrap_err().kind,
        ErrorKind::Invalid
    );
}

/// A PNG whose header claims a size, with a right checksum, and nothing behind it.
fn png_claim(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([8, 2, 0, 0, 0]);
    let mut checksum = !0_u32;
    for &byte in &chunk {
        checksum ^= u32::from(byte);
        for _ in 0..8 {
            checksum = (checksum >> 1) ^ (0xedb8_8320 & (checksum & 1).wrapping_neg());
        }
    }
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\r".to_vec();
    bytes.extend(chunk);
    bytes.extend((!checksum).to_be_bytes());
    bytes.extend(b"\0\0\0\x04IDAT\0\0\0\0");
    bytes
}

#[test]
fn a_claim_is_checked_before_memory_is_asked_for() {
    for (name, bytes) in [
        ("a.png", png_claim(1_000_000, 1_000_000)),
        ("b.png", png_claim(40_000, 40_000)),
        ("a.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n".to_vec()),
        ("a.ppm", b"P6 1000000 1000000 255\n".to_vec()),
        ("a.pfm", b"PF 1000000 1000000 -1.0\n".to_vec()),
    ] {
        let error = read_as(name, &bytes, Some(1 << 28)).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Limit, "{error}");
        assert!(error.hint.is_some());
    }
    let exr = image::encode_exr(8, 8, &[("R".to_owned(), &[0.0; 64])], &[]).expect("EXR");
    let error = read_as("a.exr", &exr, Some(63)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.exr: 8×8 texels are more than the limit of 63\n  help: make the picture smaller"
    );
}

#[test]
fn errors_say_what_to_do() {
    let said = |name: &str, bytes: &[u8]| read_as(name, bytes, None).unwrap_err().to_string();
    let whole = "\n  help: check that the file is whole; opening it in another program and saving it again may repair it";
    assert_eq!(said("a.png", b""), format!("a.png: the file is empty; expected a picture{whole}"));
    assert!(said("a.xyz", b"what is this").starts_with("a.xyz: the picture format is not known"));
    assert!(said("a.xyz", b"what is this").contains("save it as one of PNG, JPEG"));
    let exr =
        image::encode_exr(1, 1, &[("X".to_owned(), &[0.0]), ("Z".to_owned(), &[0.0])], &[]).expect("EXR");
    assert_eq!(
        said("a.exr", &exr),
        "a.exr: has the channels X, Z; expected R, G and B, or Y\n  help: write the picture again with channels of these names, or name a layer"
    );
    let nan = image::encode_pfm(2, 1, &[[f32::NAN, 1.0, f32::INFINITY], [0.5; 3]]).expect("PFM");
    let (read, warnings) = read_as("a.pfm", &nan, None).expect("bad values are survived");
    assert_eq!((read.texel(0), warnings), ([0.0, 1.0, 65504.0], 2));
}

#[test]
fn pictures_of_other_programs() {
    let exr = image::encode_exr(2, 1, &[("weight".to_owned(), &[0.25, 2.0])], &[]).expect("EXR");
    let (gray, _) = read_as("a.exr", &exr, None).expect("its only channel is grey");
    assert_eq!((gray.texel(0), gray.texel(1)), ([0.25; 3], [2.0; 3]));

    // One block of DXT1 (S3TC): red and blue as 5, 6 and 5 bits, the rows take the first and the second in turn.
    let mut dds = b"DDS ".to_vec();
    let mut words = [0_u32; 31];
    words[..4].copy_from_slice(&[124, 0x1007, 4, 4]);
    words[18..21].copy_from_slice(&[32, 4, u32::from_le_bytes(*b"DXT1")]);
    words[26] = 0x1000;
    dds.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    dds.extend([0x00, 0xf8, 0x1f, 0x00, 0x00, 0x55, 0x00, 0x55]);
    let (blocks, _) = read_as("a.dds", &dds, None).expect("DXT1");
    let [red, blue] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(blocks.len(), 16);
    for row in 0..4 {
        assert_eq!(blocks.texel(4 * row), if row % 2 == 0 { red } else { blue }, "row {row}");
    }
}

fn samples() -> Vec<Vec<u8>> {
    let picture = DynamicImage::from(gradient());
    let float =
        DynamicImage::from(Rgb32FImage::from_fn(7, 5, |x, y| ::image::Rgb([x as f32, y as f32, 0.5])));
    let mut all: Vec<Vec<u8>> = [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::Bmp,
        ImageFormat::Tga,
        ImageFormat::Pnm,
        ImageFormat::WebP,
        ImageFormat::Tiff,
        ImageFormat::Gif,
    ]
    .into_iter()
    .map(|format| encode(&picture, format))
    .collect();
    all.extend([ImageFormat::Hdr, ImageFormat::Tiff].map(|format| encode(&float, format)));
    let values: Vec<f32> = (0..35).map(|i| i as f32).collect();
    let channels = ["R", "G", "B"].map(|name| (name.to_owned(), values.as_slice()));
    all.push(image::encode_exr(7, 5, &channels, &[("a".to_owned(), "b".to_owned())]).expect("EXR"));
    all.push(image::encode_pfm(2, 1, &[[1.0; 3]; 2]).expect("PFM"));
    all
}

#[test]
fn a_picture_that_ends_early_is_an_error_or_a_picture() {
    for sample in samples() {
        for length in 0..sample.len() {
            let _ = read_as("a.tga", &sample[..length], None);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn hostile_bytes_never_panic(
        which in 0_usize..12,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = samples().swap_remove(which);
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        let _ = read_as("a.tga", &bytes, None);
    }
}
