//! Chunks by an encoder of our own, and one of c-blosc.

use std::path::Path;

use super::*;
use crate::error::Location;

/// The compression of a chunk.
#[derive(Clone, Copy, Debug)]
struct ChunkPacking {
    flags: u8,
    codec: u8,
    type_size: usize,
    block: usize,
}

fn packed(bytes: &[u8], by: ChunkPacking) -> Vec<u8> {
    let ChunkPacking { flags, codec, type_size, block } = by;
    let mut chunk = vec![2, 1, flags | codec << 5, type_size as u8];
    [bytes.len(), block, 0].iter().for_each(|length| chunk.extend((*length as u32).to_le_bytes()));
    if flags & STORED != 0 {
        chunk.extend(bytes);
        return chunk;
    }
    let starts = chunk.len();
    chunk.resize(starts + 4 * bytes.len().div_ceil(block), 0);
    for (index, bytes) in bytes.chunks(block).enumerate() {
        let start = (chunk.len() as u32).to_le_bytes();
        chunk[starts + 4 * index..][..4].copy_from_slice(&start);
        let count = bytes.len() / type_size;
        let shuffled = |at: usize| match at < count * type_size && flags & SHUFFLED != 0 {
            true => bytes[at % count * type_size + at / count],
            false => bytes[at],
        };
        let bytes: Vec<u8> = (0..bytes.len()).map(shuffled).collect();
        let is_divided =
            flags & WHOLE == 0 && type_size <= 16 && block / type_size >= 128 && bytes.len() == block;
        for part in bytes.chunks(if is_divided { block / type_size } else { block }) {
            let packed = match codec {
                1 => lz4_flex::block::compress(part),
                _ => miniz_oxide::deflate::compress_to_vec_zlib(part, 6),
            };
            let packed = if packed.len() < part.len() { &packed } else { part };
            chunk.extend((packed.len() as u32).to_le_bytes());
            chunk.extend(packed);
        }
    }
    chunk
}

fn unpacked(chunk: &[u8], length: usize) -> Result<Vec<u8>> {
    let at = Location::file(Path::new("a.vdb"));
    let mut into = vec![0; length];
    unpack(Bytes::new(chunk, &at, ""), &mut into).map(|()| into)
}

/// Bytes of which some parts become shorter and others do not.
fn sample(length: usize) -> Vec<u8> {
    let mut state = 1_u32;
    let random = |index: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if index % 4 < 2 { (state >> 24) as u8 } else { (index / 64) as u8 }
    };
    (0..length).map(random).collect()
}

#[test]
fn what_was_packed_is_unpacked() {
    for length in [0, 1, 3, 17, 512, 2048, 5003] {
        for flags in [0, SHUFFLED, STORED, SHUFFLED | STORED, WHOLE, SHUFFLED | WHOLE] {
            for codec in [1, 3] {
                for (type_size, block) in
                    [(1, 256), (2, 1024), (4, 512), (4, 2048), (3, 384), (8, 1024), (20, 400)]
                {
                    let by = ChunkPacking { flags, codec, type_size, block };
                    let bytes = sample(length);
                    assert_eq!(unpacked(&packed(&bytes, by), length), Ok(bytes), "{length} {by:?}");
                }
            }
        }
    }
}

#[test]
fn a_chunk_of_c_blosc_is_unpacked() {
    // 1100 numbers, `floor(i / 40) / 2`, by c-blosc 1.21.3.
    const CHUNK: &str = "020121043011000030110000e8000000140000000f0000001f000100ffffffff375000000000000f0000\
        001f000100ffffffff375000000000008a0000001f0001003c1f800100141fc00100140f9f00151f200100141f400100141f60\
        0100140fef00142f80900100141fa00100141fb00100140f6701142fc0d00100141fe00100141ff00100140fe001151f080100\
        141f100100141f180100140f5702142f20280100141f300100141f380100140fcf02142f40480100141f500100141a58010050\
        58585858581c0000001f000100141f3f0100641f400100ffcd1f410100ffb4504141414141";
    let digits: Vec<u32> = CHUNK.chars().filter_map(|digit| digit.to_digit(16)).collect();
    let chunk: Vec<u8> = digits.as_chunks().0.iter().map(|[high, low]| (high << 4 | low) as u8).collect();
    let expected: Vec<u8> = (0..1100).flat_map(|index| ((index / 40) as f32 * 0.5).to_le_bytes()).collect();
    assert_eq!(unpacked(&chunk, expected.len()), Ok(expected));
}

#[test]
fn what_is_not_unpacked_is_told() {
    let good = ChunkPacking { flags: SHUFFLED, codec: 1, type_size: 4, block: 1024 };
    let of = |at: usize, byte: u8| {
        let mut chunk = packed(&sample(2048), good);
        chunk[at] = byte;
        let error = unpacked(&chunk, 2048).expect_err("broken");
        (error.kind, error.message)
    };
    let unsupported = |message: &str| (ErrorKind::Unsupported, message.to_owned());
    let expected = "Blosc by Zstandard, expected shuffled bytes by LZ4 (at byte 2)";
    assert_eq!(of(2, 4 << 5 | SHUFFLED), unsupported(expected));
    let expected = "Blosc with shuffled bits, expected shuffled bytes by LZ4 (at byte 2)";
    assert_eq!(of(2, 1 << 5 | BITS_SHUFFLED), unsupported(expected));
    let expected = "version 5 of Blosc's format, expected shuffled bytes by LZ4 (at byte 0)";
    assert_eq!(of(0, 5), unsupported(expected));
    let expected = "a chunk of Blosc with 2303 bytes, expected 2048 (at byte 4)";
    assert_eq!(of(4, 0xff), (ErrorKind::Syntax, expected.into()));
    assert_eq!(of(3, 0).1, "blocks of 1024 bytes and numbers of 0 (at byte 3)");
}

#[test]
fn broken_chunks_are_survived() {
    for codec in [1, 3] {
        let whole = packed(&sample(2048), ChunkPacking { flags: SHUFFLED, codec, type_size: 4, block: 1024 });
        for at in 0..whole.len() {
            assert!(unpacked(&whole[..at], 2048).is_err(), "{at}");
            for bit in 0..8 {
                let mut broken = whole.clone();
                broken[at] ^= 1 << bit;
                let _ = unpacked(&broken, 2048);
            }
        }
    }
}
