//! Files written by Basis Universal's encoder 2.5, files made here, and damaged copies of them.

use std::io::Write;
use std::path::Path;

use super::*;
use crate::image::read::KTX2_MAGIC;
use crate::{Limits, Memory};

fn run(bytes: &[u8]) -> Result<Pixels> {
    let limits = Limits { texels: 1 << 12, ..Limits::default() };
    let files = Memory::default();
    let context = LoadContext { limits, ..LoadContext::new(&files) };
    decode(bytes, &Location::file(Path::new("picture.ktx2")), &context)
}

/// A file of 3 × 2 texels in this format and with this level.
fn file(format: u32, packing: u32, level: &[u8], unpacked: usize) -> Vec<u8> {
    let mut bytes = KTX2_MAGIC.to_vec();
    for field in [format, 1, 3, 2, 0, 0, 1, 1, packing, 0, 0, 0, 0] {
        bytes.extend(field.to_le_bytes());
    }
    for field in [0, 0, 104, level.len() as u64, unpacked as u64] {
        bytes.extend(field.to_le_bytes());
    }
    bytes.extend(level);
    bytes
}

#[test]
fn plain_bytes_are_texels() {
    let level: Vec<u8> = (1..=24).collect();
    let first = |format: u32, size: usize| {
        let pixels = run(&file(format, PLAIN, &level[..6 * size], 6 * size)).unwrap();
        assert_eq!((pixels.width, pixels.height, pixels.texels.len()), (3, 2, 6));
        pixels.texels[..2].to_vec()
    };
    assert_eq!(first(9, 1), [[1, 0, 0, 255], [2, 0, 0, 255]]);
    assert_eq!(first(16, 2), [[1, 2, 0, 255], [3, 4, 0, 255]]);
    assert_eq!(first(29, 3), [[1, 2, 3, 255], [4, 5, 6, 255]]);
    assert_eq!(first(30, 3), [[3, 2, 1, 255], [6, 5, 4, 255]]);
    assert_eq!(first(43, 4), [[1, 2, 3, 4], [5, 6, 7, 8]]);
    assert_eq!(first(50, 4), [[3, 2, 1, 4], [7, 6, 5, 8]]);
}

#[test]
fn levels_are_unpacked_within_what_they_should_have() {
    let zlib = |level: &[u8]| {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(level).unwrap();
        encoder.finish().unwrap()
    };
    let level: Vec<u8> = (1..=6).collect();
    assert_eq!(run(&file(9, ZLIB, &zlib(&level), 6)).unwrap().texels[5], [6, 0, 0, 255]);
    // Zstandard: a frame with one raw block.
    let zstandard = [&[0x28, 0xb5, 0x2f, 0xfd, 0x20, 6, 49, 0, 0][..], &level].concat();
    assert_eq!(run(&file(9, ZSTANDARD, &zstandard, 6)).unwrap().texels[5], [6, 0, 0, 255]);
    // A decompression bomb is stopped one byte after the expected end.
    let bomb = run(&file(9, ZLIB, &zlib(&vec![0; 1 << 20]), 6)).unwrap_err();
    assert!(bomb.message.contains("should have 6 bytes, and has 7"), "{bomb}");
}

#[test]
fn what_is_not_read_says_so() {
    let kinds = [
        (file(146, PLAIN, &[0; 16], 16), ErrorKind::Unsupported),
        (file(9, 77, &[0; 6], 6), ErrorKind::Unsupported),
        (file(9, PLAIN, &[0; 5], 5), ErrorKind::Syntax),
        (file(9, ZSTANDARD, &[0; 6], 6), ErrorKind::Syntax),
        (KTX2_MAGIC.to_vec(), ErrorKind::Syntax),
    ];
    for (bytes, kind) in kinds {
        let error = run(&bytes).unwrap_err();
        assert_eq!(error.kind, kind, "{error}");
    }
    let mut large = file(9, PLAIN, &[0; 6], 6);
    large[20] = 0xff;
    large[22] = 0xff;
    assert_eq!(run(&large).unwrap_err().kind, ErrorKind::Limit);
}

mod basis {
    use super::*;

    /// 10 × 6 texels, (40 + 20 x, 30 + 30 y, 100), opaque where x < 5, else 64: in ETC1S, in UASTC, and in UASTC with
    /// Zstandard and mipmaps.
    const ETC1S: &str = "ab4b5458203230bb0d0a1a0a00000000010000000a000000060000000000000000000000010000000100000001000000\
    680000003c000000a400000024000000c800000000000000ab0000000000000073010000000000000800000000000000\
    00000000000000003c0000000000000002003800a301020003030000080800000000000000003f000000000000000000\
    ffffffff40003f0f0000000000000000ffffffff1f0000004b545877726974657200426173697320556e697665727361\
    6c20322e3530000009000600390000001900000031000000000000000000000000000000040000000400000004000000\
    13c094000000000010e4018a204014000000800050bb8f1e0e206e8000000000e402ab9403600a000000002008c24654\
    c7d4163d167a50b8001c181818005055555555555585d2d7d707a852fdafaaaaaa0200c144000000000010843afa2825\
    005300040000000048595080070d03000082a69c084480006002000000000000010400724ddc03f9beea01";
    const UASTC: &str = "ab4b5458203230bb0d0a1a0a00000000010000000a000000060000000000000000000000010000000100000000000000\
    680000002c000000940000002c00000000000000000000000000000000000000c0000000000000006000000000000000\
    60000000000000002c0000000000000002002800a601020003030000100000000000000000007f030000000000000000\
    ffffffff1f0000004b545877726974657200426173697320556e6976657273616c20322e35300000040000007f7f0000\
    db92c65cabb0f11843c851d962ea73fb28418d037893330732337477b8bbfcff28eaa803e490332326226566a9aaedee\
    5b241d8aabf09e181332dcfedcfedcfe0f916f090e55cd9e54d3cd880c2e2e2edf83df0132b7252d19191090dadfdf0f";
    const UASTC_ZSTANDARD: &str = "ab4b5458203230bb0d0a1a0a00000000010000000a000000060000000000000000000000010000000400000002000000\
    b00000002c000000dc00000024000000000000000000000000000000000000005b010000000000006900000000000000\
    600000000000000032010000000000002900000000000000200000000000000019010000000000001900000000000000\
    10000000000000000001000000000000190000000000000010000000000000002c0000000000000002002800a6010200\
    03030000100000000000000000007f030000000000000000ffffffff1f0000004b545877726974657200426173697320\
    556e6976657273616c20322e3530000028b52ffd201081000037f28e8cf39ad001000000000000000028b52ffd201081\
    00007f9106149ceadd1d1999b5584545450528b52ffd202001010028120c08ebe2320701314475ccfdccfd48e9681c66\
    e04a4816115555dddddddd28b52ffd2060010300db92c65cabb0f11843c851d962ea73fb28418d037893330732337477\
    b8bbfcff28eaa803e490332326226566a9aaedee5b241d8aabf09e181332dcfedcfedcfe0f916f090e55cd9e54d3cd88\
    0c2e2e2edf83df0132b7252d19191090dadfdf0f";

    fn bytes(text: &str) -> Vec<u8> {
        let digit = |byte: u8| char::from(byte).to_digit(16).unwrap() as u8;
        text.as_bytes().as_chunks().0.iter().map(|&[high, low]| 16 * digit(high) + digit(low)).collect()
    }

    fn farthest(file: &str) -> i32 {
        let pixels = run(&bytes(file)).unwrap();
        assert_eq!((pixels.width, pixels.height), (10, 6));
        let expected = |x: i32, y: i32| [40 + 20 * x, 30 + 30 * y, 100, if x < 5 { 255 } else { 64 }];
        let places = (0..6).flat_map(|y| (0..10).map(move |x| (x, y)));
        let far = |(texel, (x, y)): (&[u8; 4], (i32, i32))| {
            let channels = texel.iter().zip(expected(x, y));
            channels.map(|(&found, expected)| (i32::from(found) - expected).abs()).max().unwrap()
        };
        pixels.texels.iter().zip(places).map(far).max().unwrap()
    }

    #[test]
    fn pictures_are_what_was_written_as_far_as_their_format_goes() {
        assert!(farthest(UASTC) <= 24, "{}", farthest(UASTC));
        assert!(farthest(UASTC_ZSTANDARD) <= 24, "{}", farthest(UASTC_ZSTANDARD));
        // Two colours for each 4 × 4 texels, along one line in the direction of grey.
        assert!(farthest(ETC1S) <= 96, "{}", farthest(ETC1S));
    }

    #[test]
    fn damaged_files_give_errors_or_other_texels_but_no_panic() {
        for text in [ETC1S, UASTC, UASTC_ZSTANDARD] {
            let whole = bytes(text);
            for length in 12..whole.len() {
                let _ = run(&whole[..length]);
            }
            for place in 12..whole.len() {
                for change in [1, 4, 16, 64, 128, 255] {
                    let mut bytes = whole.clone();
                    bytes[place] ^= change;
                    if let Ok(pixels) = run(&bytes) {
                        assert_eq!(
                            pixels.texels.len() as u64,
                            u64::from(pixels.width) * u64::from(pixels.height)
                        );
                    }
                }
            }
        }
    }
}
