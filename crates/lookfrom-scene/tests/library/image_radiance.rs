//! Radiance pictures: signatures, orientations, packings, exposure, X Y Z.

use std::path::Path;

use lookfrom_scene::image::{self, By, Encoding, Reading};
use lookfrom_scene::{LoadContext, Memory};

/// Two rows of three pixels: 2, 3, 4 and 5, 6, 7 in red.
fn pixels() -> Vec<[u8; 4]> {
    (2..8).map(|k| [k * 16, 128, 32, 128]).collect()
}

fn flat(pixels: &[[u8; 4]]) -> Vec<u8> {
    pixels.as_flattened().to_vec()
}

/// Colours, columns and rows, warnings.
type Read = (Vec<[f32; 3]>, [u32; 2], Vec<String>);

fn read_by(by: By, head: &str, pixels: &[u8]) -> Result<Read, String> {
    let mut files = Memory::default();
    files.0.insert("a.pic".into(), [head.as_bytes(), pixels].concat());
    let mut context = LoadContext::new(&files);
    let reading = Reading { by, ..Reading::new(Encoding::Srgb) };
    let image =
        image::read_as(Path::new("a.pic"), &reading, &mut context).map_err(|error| error.to_string())?;
    let said = context.warnings.iter().map(ToString::to_string).collect();
    Ok((image.texels().collect(), [image.width, image.height], said))
}

fn read(head: &str, pixels: &[u8]) -> Read {
    read_by(By::Standard, head, pixels).unwrap()
}

fn expected() -> Vec<[f32; 3]> {
    (2..8).map(|k| [k as f32 / 16.0, 0.5, 0.125]).collect()
}

#[test]
fn signatures_and_line_ends() {
    for head in [
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "#?AUTOPANO\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "#?RADIANCE\r\n# made by hand\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 2 +X 3\r\n",
        "FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "pfilt -x 3\nSOFTWARE=a\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n",
        "#?RADIANCE\n\n-Y 2 +X 3\n",
    ] {
        assert_eq!(read(head, &flat(&pixels())), (expected(), [3, 2], vec![]), "{head}");
    }
}

#[test]
fn all_eight_orientations_are_one_picture() {
    let all = pixels();
    let at = |x: usize, y: usize| all[y * 3 + x];
    for (sign_y, ys) in [("-Y", [0, 1]), ("+Y", [1, 0])] {
        for (sign_x, xs) in [("+X", [0, 1, 2]), ("-X", [2, 1, 0])] {
            let rows: Vec<[u8; 4]> = ys.iter().flat_map(|&y| xs.map(|x| at(x, y))).collect();
            let columns: Vec<[u8; 4]> = xs.iter().flat_map(|&x| ys.map(|y| at(x, y))).collect();
            let head = |axes: String| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{axes}\n");
            let by_rows = read(&head(format!("{sign_y} 2 {sign_x} 3")), &flat(&rows));
            let by_columns = read(&head(format!("{sign_x} 3 {sign_y} 2")), &flat(&columns));
            assert_eq!(by_rows, (expected(), [3, 2], vec![]), "{sign_y} {sign_x}");
            assert_eq!(by_columns, (expected(), [3, 2], vec![]), "{sign_x} {sign_y}");
        }
    }
}

#[test]
fn packed_lines() {
    // Eight columns: the first channel as a run, the second as bytes, the others as runs.
    let mut packed = vec![2, 2, 0, 8, 128 + 8, 64];
    packed.extend([8, 0, 16, 32, 48, 64, 80, 96, 112]);
    packed.extend([128 + 8, 32, 128 + 8, 128]);
    let head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
    let (texels, _, _) = read(head, &packed);
    assert_eq!(texels, (0..8).map(|k| [0.25, k as f32 / 16.0, 0.125]).collect::<Vec<_>>());
    // The older runs: a pixel, and how often it is repeated.
    let (texels, _, _) = read(head, &[64, 128, 32, 128, 1, 1, 1, 7]);
    assert_eq!(texels, [[0.25, 0.5, 0.125]; 8]);
    // A run that is longer than the line, and a file that ends early.
    for bad in [&[64, 128, 32, 128, 1, 1, 1, 9][..], &packed[..18], &[2, 2, 0, 8, 255, 1], &[2, 2, 0, 8, 0]] {
        let error = read_by(By::Standard, head, bad).unwrap_err();
        assert!(error.starts_with("a.pic: not a complete picture: ends in line 1 of 1"), "{error}");
    }
}

#[test]
fn exposure_is_divided_out_and_primaries_become_ours() {
    let head = |lines: &str| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n\n-Y 2 +X 3\n");
    let (texels, _, said) = read(&head("EXPOSURE=4\nEXPOSURE= 0.5\nCOLORCORR=1 1 0.5"), &flat(&pixels()));
    assert_eq!(texels, (2..8).map(|k| [k as f32 / 32.0, 0.25, 0.125]).collect::<Vec<_>>());
    assert!(said[0].contains("an exposure of 2, 2, 1"), "{said:?}");
    // pbrt leaves it.
    let (texels, _, said) = read_by(By::PbrtLight, &head("EXPOSURE=4"), &flat(&pixels())).unwrap();
    assert_eq!((texels, said), (expected(), vec![]));
    for bad in ["EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=a", "EXPOSURE=1e999", "COLORCORR=1 1", "PRIMARIES=1"] {
        let (texels, _, said) = read(&head(bad), &flat(&pixels()));
        assert_eq!((texels, said.len()), (expected(), 1), "{bad}");
        assert!(said[0].contains("a.pic:3"), "{said:?}");
    }
    let xyze = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n";
    // Red of Rec. 709.
    let (texels, _, _) = read(xyze, &[211, 109, 10, 127]);
    let [r, g, b] = texels[0];
    assert!((r - 1.0).abs() < 0.01 && g.abs() < 0.01 && b.abs() < 0.01, "{texels:?}");
    let wide = head("PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329");
    let (texels, _, _) = read(&wide, &flat(&[[160, 17, 4, 128]; 6]));
    let [r, g, b] = texels[0];
    assert!((r - 1.0).abs() < 0.02 && g.abs() < 0.02 && b.abs() < 0.02, "{texels:?}");
    let error = read_by(By::Standard, "#?RADIANCE\nFORMAT=64-bit\n\n-Y 1 +X 1\n", &[0; 4]).unwrap_err();
    assert!(error.contains("a.pic:2: pixels of the format \"64-bit\" are not read"), "{error}");
    let error = read_by(By::Standard, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", &[]).unwrap_err();
    assert!(error.contains("without a line for the resolution"), "{error}");
}

#[test]
fn shapes_that_are_no_panorama_are_told() {
    let said = |[width, height]: [u32; 2]| {
        let mut files = Memory::default();
        let pixels = vec![[0.5; 3]; (width * height) as usize];
        files.0.insert("sky.pfm".into(), image::encode_pfm(width, height, &pixels).unwrap());
        let scene = "[camera]\nlookfrom = [0, 0, 5]\nlookat = [0, 0, 0]\n[[light]]\ntype = \"environment\"\nimage = \"sky.pfm\"\n";
        files.0.insert("a.toml".into(), scene.into());
        let mut context = LoadContext::new(&files);
        lookfrom_scene::load::scene(Path::new("a.toml"), &mut context).unwrap();
        context.warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for panorama in [[2, 1], [64, 32], [64, 31], [200, 99], [1, 1]] {
        assert_eq!(said(panorama), Vec::<String>::new(), "{panorama:?}");
    }
    for (shape, word) in [
        ([64, 64], "mirror ball"),
        ([96, 16], "strip"),
        ([16, 96], "strip"),
        ([64, 48], "cross"),
        ([64, 20], "part"),
    ] {
        let said = said(shape);
        assert!(said.len() == 1 && said[0].starts_with("a.toml:6:9:") && said[0].contains(word), "{said:?}");
    }
}
