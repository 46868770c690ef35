//! TIFF: every kind of samples and colours, in files made here byte by byte.

use std::path::Path;

use lookfrom_scene::image::{self, Image};
use lookfrom_scene::{ErrorKind, LoadContext, Memory};

/// Tags of TIFF 6.0.
const BITS: u16 = 258;
const PHOTOMETRIC: u16 = 262;
const SAMPLES: u16 = 277;
const PLANAR: u16 = 284;
const EXTRA: u16 = 338;
const FORMAT: u16 = 339;
const NO_DATA: u16 = 42113;

/// Values of the tag `PHOTOMETRIC`.
const WHITE_IS_ZERO: u16 = 0;
const BLACK_IS_ZERO: u16 = 1;
const RGB: u16 = 2;
const CMYK: u16 = 5;
const YCBCR: u16 = 6;

/// Values of the tag `FORMAT`.
const SIGNED: u16 = 2;
const FLOAT: u16 = 3;

/// A file of 3 × 2 texels: each of `strips` holds as many rows as there are in one plane.
fn file(tags: &[(u16, &[u16])], strips: &[&[u8]]) -> Vec<u8> {
    const SHORT: u16 = 3;
    const LONG: u16 = 4;
    let mut entries: Vec<(u16, u16, Vec<u8>)> = Vec::new();
    let short = |values: &[u16]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let long = |values: Vec<u32>| values.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>();
    let first = 8_u32;
    let starts = strips.iter().scan(first, |at, strip| Some(std::mem::replace(at, *at + strip.len() as u32)));
    entries.extend([(256, SHORT, short(&[3])), (257, SHORT, short(&[2])), (278, SHORT, short(&[2]))]);
    entries.extend([(259, SHORT, short(&[1])), (273, LONG, long(starts.collect()))]);
    entries.push((279, LONG, long(strips.iter().map(|strip| strip.len() as u32).collect())));
    entries.extend(tags.iter().map(|(tag, values)| match *tag {
        NO_DATA => (NO_DATA, 2, values.iter().map(|&value| value as u8).collect()),
        _ => (*tag, SHORT, short(values)),
    }));
    entries.sort_by_key(|entry| entry.0);

    let mut data = strips.concat();
    let mut directory = (entries.len() as u16).to_le_bytes().to_vec();
    for (tag, kind, mut bytes) in entries {
        let size = match kind {
            SHORT => 2,
            LONG => 4,
            _ => 1,
        };
        directory.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
        directory.extend((bytes.len() as u32 / size).to_le_bytes());
        if bytes.len() > 4 {
            let at = first + data.len() as u32;
            data.append(&mut bytes);
            bytes = at.to_le_bytes().to_vec();
        }
        bytes.resize(4, 0);
        directory.append(&mut bytes);
    }
    directory.extend([0; 4]);
    [b"II*\0".as_slice(), &(first + data.len() as u32).to_le_bytes(), &data, &directory].concat()
}

fn read(bytes: Vec<u8>) -> lookfrom_scene::Result<(Image, Vec<String>)> {
    let mut files = Memory::default();
    files.0.insert("a.tif".into(), bytes);
    let mut context = LoadContext::new(&files);
    let image = image::read_data(Path::new("a.tif"), &mut context)?;
    Ok((image, context.warnings.iter().map(ToString::to_string).collect()))
}

/// The texels of a file that has no faults.
fn texels(tags: &[(u16, &[u16])], strips: &[&[u8]]) -> Vec<[f32; 3]> {
    let (image, warnings) = read(file(tags, strips)).expect("it is whole");
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((image.width, image.height), (3, 2));
    image.texels().collect()
}

/// The texels of a picture in grey.
fn greys(bits: u16, format: u16, samples: &[u8]) -> Vec<f32> {
    let tags: [(u16, &[u16]); 3] = [(BITS, &[bits]), (PHOTOMETRIC, &[BLACK_IS_ZERO]), (FORMAT, &[format])];
    let texels = texels(&tags, &[samples]);
    assert!(texels.iter().all(|texel| texel[0] == texel[1] && texel[1] == texel[2]));
    texels.iter().map(|texel| texel[0]).collect()
}

fn bytes_of<const N: usize, T>(values: [T; 6], bytes: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    values.into_iter().flat_map(bytes).collect()
}

#[test]
fn numbers_of_heights_are_kept() {
    let heights = [-3.5, 0.0, 0.25, 1.0, 4096.0, 8848.5];
    assert_eq!(greys(32, FLOAT, &bytes_of(heights, f32::to_le_bytes)), heights);
    assert_eq!(greys(64, FLOAT, &bytes_of(heights.map(f64::from), f64::to_le_bytes)), heights);
    let halves = [-3.5, 0.0, 0.25, 1.0, 4096.0, 8848.0];
    assert_eq!(greys(16, FLOAT, &bytes_of(halves.map(half::f16::from_f32), half::f16::to_le_bytes)), halves);
    let metres = [-430, 0, 1, 2, 255, 8848];
    assert_eq!(
        greys(16, SIGNED, &bytes_of(metres.map(|m| m as i16), i16::to_le_bytes)),
        metres.map(|m| m as f32)
    );
    assert_eq!(greys(32, SIGNED, &bytes_of(metres, i32::to_le_bytes)), metres.map(|m| m as f32));
}

#[test]
fn numbers_without_sign_are_between_black_and_white() {
    let parts = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    assert_eq!(greys(8, 1, &[0, 51, 102, 153, 204, 255]), parts);
    assert_eq!(greys(16, 1, &bytes_of(parts.map(|part| (part * 65535.0) as u16), u16::to_le_bytes)), parts);
    let wide = parts.map(|part| (f64::from(part) * f64::from(u32::MAX)) as u32);
    let read = greys(32, 1, &bytes_of(wide, u32::to_le_bytes));
    assert!(read.iter().zip(parts).all(|(read, part)| (read - part).abs() < 1e-7), "{read:?}");
    // Rows begin at whole bytes.
    assert_eq!(greys(1, 1, &[0b1010_0000, 0b0110_0000]), [1.0, 0.0, 1.0, 0.0, 1.0, 1.0]);
    assert_eq!(
        greys(2, 1, &[0b0001_1000, 0b1100_0100]),
        [0.0, 85.0, 170.0, 255.0, 0.0, 85.0].map(|v| v / 255.0)
    );
    assert_eq!(greys(4, 1, &[0x0f, 0x30, 0x50, 0x70]), [0.0, 1.0, 0.2, 1.0 / 3.0, 0.0, 7.0 / 15.0]);
    let inverted: [(u16, &[u16]); 2] = [(BITS, &[8]), (PHOTOMETRIC, &[WHITE_IS_ZERO])];
    assert_eq!(texels(&inverted, &[&[0, 51, 102, 153, 204, 255]])[1], [0.8; 3]);
}

#[test]
fn colours_become_rgb() {
    let counts = |tag, samples: &'static [u16]| (tag, samples);
    let planes: [&[u8]; 3] = [&[255, 0, 0, 51, 0, 0], &[0, 255, 0, 51, 0, 0], &[0, 0, 255, 51, 0, 0]];
    let expected = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2; 3], [0.0; 3], [0.0; 3]];
    let rgb = [counts(BITS, &[8, 8, 8]), counts(PHOTOMETRIC, &[RGB]), counts(SAMPLES, &[3])];
    let interleaved: Vec<u8> = (0..6).flat_map(|texel| planes.map(|plane| plane[texel])).collect();
    assert_eq!(texels(&rgb, &[&interleaved]), expected);
    assert_eq!(texels(&[&rgb[..], &[counts(PLANAR, &[2])]].concat(), &planes), expected);

    // A fourth channel that is no opacity, and one that is.
    let four: Vec<u8> =
        (0..6).flat_map(|texel| [planes[0][texel], planes[1][texel], planes[2][texel], 102]).collect();
    for (extra, alpha) in [(0, 1.0), (2, 0.4)] {
        let kind = [extra];
        let tags = [
            (BITS, [8; 4].as_slice()),
            counts(PHOTOMETRIC, &[RGB]),
            counts(SAMPLES, &[4]),
            (EXTRA, kind.as_slice()),
        ];
        let (image, _) = read(file(&tags, &[&four])).expect("four channels");
        assert_eq!(image.texels().collect::<Vec<_>>(), expected);
        assert!((image.alpha(3) - alpha).abs() < 1e-6, "{extra}: {}", image.alpha(3));
    }
    let grey_and_alpha =
        [counts(BITS, &[8, 8]), counts(PHOTOMETRIC, &[BLACK_IS_ZERO]), counts(SAMPLES, &[2])];
    let tags = [&grey_and_alpha[..], &[counts(EXTRA, &[2])]].concat();
    let (image, _) = read(file(&tags, &[&[51, 102].repeat(6)])).expect("grey and opacity");
    assert_eq!((image.texel(5), image.alpha(5)), ([0.2; 3], 0.4));

    // Cyan, magenta, yellow, black, half a black, nothing.
    let inks = [[255, 0, 0, 0], [0, 255, 0, 0], [0, 0, 255, 0], [0, 0, 0, 255], [0, 0, 0, 102], [0; 4]];
    let cmyk = [(BITS, [8; 4].as_slice()), counts(PHOTOMETRIC, &[CMYK]), counts(SAMPLES, &[4])];
    let expected = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0], [0.0; 3], [0.6; 3], [1.0; 3]];
    assert_eq!(texels(&cmyk, &[inks.as_flattened()]), expected);

    // Red, green and blue as JPEG stores them, and three greys.
    let stored =
        [[76, 85, 255], [150, 44, 21], [29, 255, 107], [0, 128, 128], [51, 128, 128], [255, 128, 128]];
    let tags = [
        counts(BITS, &[8, 8, 8]),
        counts(PHOTOMETRIC, &[YCBCR]),
        counts(SAMPLES, &[3]),
        counts(530, &[1, 1]),
    ];
    let found = texels(&tags, &[stored.as_flattened()]);
    let expected = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3], [0.2; 3], [1.0; 3]];
    let differences = found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(differences.fold(0.0, f32::max) < 0.006, "{found:?}");
}

/// GDAL's mark of what was not measured.
#[test]
fn where_nothing_was_measured_is_the_least_height() {
    let heights = [-9999.0, 120.0, 80.5, 90.0, -9999.0, 100.0];
    let text: Vec<u16> = b"-9999\0".iter().map(|&byte| byte.into()).collect();
    let tags = [(BITS, [32].as_slice()), (PHOTOMETRIC, &[1]), (FORMAT, &[FLOAT]), (NO_DATA, &text)];
    let (image, warnings) = read(file(&tags, &[&bytes_of(heights, f32::to_le_bytes)])).expect("heights");
    assert_eq!(
        image.texels().map(|texel| texel[0]).collect::<Vec<_>>(),
        [80.5, 120.0, 80.5, 90.0, 80.5, 100.0]
    );
    assert!(warnings[0].contains("2 values without data: 80.5, the least"), "{warnings:?}");
}

#[test]
fn what_is_not_read_is_an_error() {
    let tags = |bits: &'static [u16], photometric: &'static [u16]| [(BITS, bits), (PHOTOMETRIC, photometric)];
    // Palettes, L*a*b*, twelve bits.
    for (tags, strip) in [(tags(&[8], &[3]), 6), (tags(&[8], &[8]), 6), (tags(&[12], &[1]), 10)] {
        let error = read(file(&tags, &[&vec![0; strip]])).expect_err("not read");
        assert_eq!(error.kind, ErrorKind::Unsupported, "{error}");
        assert!(error.to_string().contains("TIFF"), "{error}");
    }
    let whole = file(&tags(&[8], &[1]), &[&[1, 2, 3, 4, 5, 6]]);
    for length in 0..whole.len() {
        let error = read(whole[..length].to_vec()).expect_err("damaged");
        assert!(matches!(error.kind, ErrorKind::Syntax | ErrorKind::Unsupported), "{length}: {error}");
    }
    let error = read(b"no picture at all".to_vec()).expect_err("damaged");
    assert_eq!(error.kind, ErrorKind::Unsupported);
}
