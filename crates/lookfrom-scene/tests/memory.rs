//! One budget for all that a file makes us allocate: what damaged headers claim is refused before it is allocated, what was
//! reserved is given back, and what fits is read.
//!
//! A program of its own, since it watches the most memory that its process has had.

use std::path::Path;

use lookfrom_scene::{Budget, Error, ErrorKind, LoadContext, Memory, Scene, image, load};

/// Far less than what the headers below claim, and far more than what their files need.
const LITTLE: u64 = 64 << 20;

fn within(limit: u64, name: &str, content: &[u8]) -> Result<Scene, Error> {
    let files = Memory([(name.into(), content.to_vec())].into());
    let budget = Budget::new(limit);
    let read = load::scene(Path::new(name), &mut LoadContext::within(&budget, &files));
    assert_eq!(budget.left(), limit, "{name}: all is given back with the context");
    read
}

fn picture(limit: u64, name: &str, content: &[u8]) -> Result<image::Image, Error> {
    let files = Memory([(name.into(), content.to_vec())].into());
    image::read(Path::new(name), &mut LoadContext::within(&Budget::new(limit), &files))
}

/// The most resident memory of this process so far in bytes, where the system tells.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// The file must be refused, and not by an allocation.
#[track_caller]
fn refused<T>(read: Result<T, Error>, says: &str) {
    let Err(error) = read else { panic!("it was read") };
    assert!(error.to_string().contains(says), "{error}");
    assert!(peak() < 400 << 20, "{} bytes", peak());
}

fn gltf(accessor: &str) -> Vec<u8> {
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[ACCESSOR],
        "bufferViews":[{"buffer":0,"byteLength":4}],"buffers":[{"byteLength":4,"uri":"data:;base64,AAAAAA=="}]}"#;
    text.replace("ACCESSOR", accessor).into_bytes()
}

#[test]
fn claims_of_models_are_refused() {
    let zeros = r#"{"componentType":5126,"count":60000000,"type":"VEC3"}"#;
    refused(
        within(LITTLE, "a.gltf", &gltf(zeros)),
        "an accessor of 60000000 elements takes 686.6 MiB of memory",
    );
    // Each of several fits, but not all of them.
    let zeros = r#"{"componentType":5126,"count":2000000,"type":"VEC3"},{"componentType":5126,"count":2000000,"type":"VEC3"},
        {"componentType":5126,"count":2000000,"type":"VEC4"}"#;
    let several = String::from_utf8(gltf(zeros)).expect("text");
    let several = several.replace("\"POSITION\":0", "\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":2");
    refused(within(LITTLE, "a.gltf", several.as_bytes()), "an accessor of 2000000 elements takes");
    let points =
        String::from_utf8(gltf(r#"{"componentType":5126,"count":2000000,"type":"VEC3"}"#)).expect("text");
    let points = points.replace("\"attributes\"", "\"mode\":0,\"attributes\"");
    refused(within(LITTLE, "a.gltf", points.as_bytes()), "a primitive takes 244.1 MiB of memory");
    let beyond = r#"{"bufferView":0,"componentType":5126,"count":99999999999,"type":"VEC3"}"#;
    refused(within(LITTLE, "a.gltf", &gltf(beyond)), "99999999999");
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n\
               property float y\nproperty float z\nend_header\n";
    refused(within(LITTLE, "a.ply", ply.as_bytes()), "a.ply");
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(within(LITTLE, "a.stl", &stl), "a.stl");
    let pbrt = "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 11 \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\
                \"integer indices\" [0 1 2]\n";
    refused(within(LITTLE, "a.pbrt", pbrt.as_bytes()), "of memory, but of the limit of 64.0 MiB");
}

#[test]
fn claims_of_scenes_are_refused() {
    let lathe = "[[lathe]]\nprofile = [[1, 0], [1, 1], [1, 2], [1, 3], [1, 4]]\nsegments = 1000000\n";
    refused(within(LITTLE, "a.toml", lathe.as_bytes()), "a.toml");
    let flake = "[[sphereflake]]\ndepth = 7\n";
    refused(within(LITTLE, "a.toml", flake.as_bytes()), "the sphereflake takes");
    let numbers = format!("[[mesh]]\npositions = [{}]\n", "0,".repeat(1 << 20));
    refused(within(LITTLE, "a.toml", numbers.as_bytes()), "the parsed scene takes");
    let nodes = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{}{{}}]}}"#, "{},".repeat(1 << 20));
    refused(within(LITTLE, "a.gltf", nodes.as_bytes()), "the file takes");
    let tables: String = (0..5000).map(|number| format!("[a{number}.{}]\n", ["b"; 20].join("."))).collect();
    refused(within(LITTLE, "a.toml", tables.as_bytes()), "the parsed scene takes");
    let materials = format!("WorldBegin {}", "Material \"diffuse\" ".repeat(1 << 18));
    refused(within(LITTLE, "a.pbrt", materials.as_bytes()), "the material takes");
    let text = format!("[[text]]\nfont = \"a.ttf\"\ntext = \"{}\"\n", "x".repeat(10_000));
    refused(within(LITTLE, "a.toml", text.as_bytes()), "the text takes");
}

/// A PNG that claims a size, with a checksum that is right.
fn png(width: u32, height: u32) -> Vec<u8> {
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    let header = chunk(b"IHDR", &[&size[..], &[8, 6, 0, 0, 0]].concat());
    [b"\x89PNG\r\n\x1a\n".to_vec(), header, chunk(b"IDAT", b"")].concat()
}

/// A chunk of a PNG with its length and checksum.
fn chunk(name: &[u8], content: &[u8]) -> Vec<u8> {
    let mut crc = u32::MAX;
    for &byte in name.iter().chain(content) {
        crc =
            (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 });
    }
    [&(content.len() as u32).to_be_bytes(), name, content, &(!crc).to_be_bytes()].concat()
}

/// Bytes as a zlib stream of blocks that say "the last byte, 258 times".
fn much_from_little(bytes: usize) -> Vec<u8> {
    // One block of fixed codes: a literal 0, then lengths of 258 at the distance 1, and the end. Codes are sent by their
    // highest bit first, all else by its lowest.
    let (mut stream, mut filled) = (vec![0x78, 0x9c, 0], 0_u32);
    let mut push = |code: u32, length: u32| {
        for place in (0..length).rev() {
            if filled == 8 {
                stream.push(0);
                filled = 0;
            }
            *stream.last_mut().expect("a byte") |= ((code >> place & 1) as u8) << filled;
            filled += 1;
        }
    };
    push(0b1_10, 3);
    push(0x30, 8);
    for _ in 0..bytes / 258 {
        push(0b1100_0101, 8);
        push(0, 5);
    }
    push(0, 7);
    let (mut a, mut b) = (1_u64, 0_u64);
    for _ in 0..1 + bytes / 258 * 258 {
        (a, b) = (a % 65521, (b + a) % 65521);
    }
    stream.extend(((b << 16 | a) as u32).to_be_bytes());
    stream
}

#[test]
fn profiles_of_pictures_do_not_unpack_without_end() {
    let whole = image::encode_png(1, 1, &[7; 3]).expect("a picture");
    // Behind the header.
    let (head, rest) = whole.split_at(33);
    let profile = chunk(b"iCCP", &[b"a\0\0", &*much_from_little(1 << 29)].concat());
    let read = picture(LITTLE, "a.png", &[head, &profile, rest].concat());
    assert!(read.is_ok(), "{:?}", read.err());
    assert!(peak() < 400 << 20, "{} bytes", peak());
}

#[test]
fn claims_of_pictures_are_refused() {
    refused(picture(LITTLE, "a.png", &png(10_000, 10_000)), "a picture of 10000×10000 texels takes");
    refused(picture(LITTLE, "a.png", &png(1_000_000, 1_000_000)), "limit");
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 12000 +X 12000\n".to_vec();
    refused(picture(LITTLE, "a.hdr", &hdr), "a picture of 12000×12000 texels takes");
    // Start of frame: 8 bits, 16,000 × 16,000, three components.
    let frame =
        b"\xff\xd8\xff\xc0\0\x11\x08\x3e\x80\x3e\x80\x03\x01\x11\0\x02\x11\0\x03\x11\0\xff\xda".to_vec();
    refused(picture(LITTLE, "a.jpg", &frame), "a.jpg");
    let mut ktx2 = b"\xabKTX 20\xbb\r\n\x1a\n".to_vec();
    ktx2.extend([43_u32, 1, 16_000, 16_000, 0, 0, 1, 1, 0].iter().flat_map(|number| number.to_le_bytes()));
    ktx2.extend([0; 64]);
    refused(picture(LITTLE, "a.ktx2", &ktx2), "a picture of 16000×16000 texels takes");
    refused(picture(LITTLE, "a.pfm", b"PF\n1000000 1000000\n-1\n"), "limit");
    let mut exr = image::encode_exr(1, 1, &[("Y".to_owned(), &[0.0])], &[]).expect("a picture");
    let window = b"dataWindow\0box2i\0\x10\0\0\0";
    let place =
        exr.windows(window.len()).position(|bytes| bytes == window).expect("it has one") + window.len();
    exr[place + 8..place + 12].copy_from_slice(&14_999_i32.to_le_bytes());
    exr[place + 12..place + 16].copy_from_slice(&14_999_i32.to_le_bytes());
    refused(picture(LITTLE, "a.exr", &exr), "a.exr");
}

#[test]
fn a_picture_without_which_a_reader_goes_on_is_still_an_error() {
    let obj = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mtl = "newmtl m\nmap_Kd a.png\n";
    let content =
        [("a.obj", obj.as_bytes().to_vec()), ("a.mtl", mtl.as_bytes().to_vec()), ("a.png", png(9000, 9000))];
    let files = Memory(content.map(|(name, bytes)| (name.into(), bytes)).into());
    let budget = Budget::new(LITTLE);
    let read = load::scene(Path::new("a.obj"), &mut LoadContext::within(&budget, &files));
    let error = read.expect_err("there is no memory for the picture");
    assert_eq!((error.kind, &*error.at.file), (ErrorKind::Limit, "a.png"), "{error}");
}

#[test]
fn what_fits_is_read_and_counted_by_its_length() {
    let bytes = image::encode_png(300, 200, &vec![7; 3 * 300 * 200]).expect("a picture");
    let files = Memory([("a.png".into(), bytes)].into());
    let budget = Budget::new(LITTLE);
    let mut context = LoadContext::within(&budget, &files);
    let read = image::read(Path::new("a.png"), &mut context).expect("it fits");
    assert_eq!((read.bytes(), LITTLE - budget.left()), (4 * 300 * 200, 4 * 300 * 200));
    drop(context);
    assert_eq!(budget.left(), LITTLE);
}
