//! Small NanoVDB files, by the offsets of the format.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

/// Bytes of nodes.
const UPPER: usize = 270_400;
const LOWER: usize = 33_856;
const TREE: usize = 672;
const ROOT: usize = TREE + 64;

/// Bytes of chunks of Blosc, and of blocks in them: NanoVDB has chunks of a gibibyte and blocks of 2¹⁸.
const CHUNK: usize = 1 << 18;
const BLOCK: usize = 1 << 16;

/// A grid to be written.
#[derive(Clone)]
pub(crate) struct Sketch {
    pub(crate) name: &'static str,
    pub(crate) class: u32,
    pub(crate) kind: u32,
    pub(crate) background: f32,
    /// Of the map from index space to the world.
    pub(crate) rows: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    /// The least and largest coordinates of active values.
    pub(crate) bounds: [[i32; 3]; 2],
    /// Tiles by their least coordinates: of 4096³, 128³ and 8³ cells.
    pub(crate) tiles: [BTreeMap<[i32; 3], f32>; 3],
    /// Leaves by their least coordinates.
    pub(crate) leaves: BTreeMap<[i32; 3], Vec<u8>>,
}

impl Sketch {
    pub(crate) fn new(name: &'static str) -> Self {
        Self {
            name,
            class: 2,
            kind: 1,
            background: 0.0,
            rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0; 3],
            bounds: [[0; 3], [7; 3]],
            tiles: Default::default(),
            leaves: BTreeMap::new(),
        }
    }

    /// The bytes of the grid.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let lower = |first: &[i32; 3]| aligned(*first, 7);
        let upper = |first: &[i32; 3]| aligned(*first, 12);
        let lowers: BTreeSet<_> = self.leaves.keys().chain(self.tiles[2].keys()).map(lower).collect();
        let uppers: BTreeSet<_> = lowers.iter().chain(self.tiles[1].keys()).map(upper).collect();
        let count = uppers.len() + self.tiles[0].len();
        let mut at = ROOT + 64 + 32 * count;
        let mut place = |bytes: usize| {
            at += bytes;
            at - bytes
        };
        let uppers: BTreeMap<_, usize> = uppers.into_iter().map(|first| (first, place(UPPER))).collect();
        let lowers: BTreeMap<_, usize> = lowers.into_iter().map(|first| (first, place(LOWER))).collect();
        let leaves: BTreeMap<_, usize> =
            self.leaves.iter().map(|(first, leaf)| (*first, place(leaf.len()))).collect();
        let mut bytes = vec![0; at];
        let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);

        put(0, b"NanoVDB0");
        put(16, &(32_u32 << 21).to_le_bytes());
        let rows = self.rows.iter().flatten().chain([0.0; 9].iter()).chain(&self.translation);
        rows.enumerate().for_each(|(index, number)| put(384 + 8 * index, &number.to_le_bytes()));
        put(632, &self.class.to_le_bytes());
        put(636, &self.kind.to_le_bytes());
        put(TREE + 24, &64_u64.to_le_bytes());
        let bounds = self.bounds.iter().flatten();
        bounds.enumerate().for_each(|(index, number)| put(ROOT + 4 * index, &number.to_le_bytes()));
        put(ROOT + 24, &(count as u32).to_le_bytes());
        put(ROOT + 28, &self.background.to_le_bytes());

        let children = uppers.iter().map(|(first, at)| (first, (at - ROOT) as u64, 0.0));
        let tiles = self.tiles[0].iter().map(|(first, value)| (first, 0, *value));
        for (index, (first, child, value)) in children.chain(tiles).enumerate() {
            let [x, y, z] = first.map(|coordinate| u64::from(coordinate as u32 >> 12));
            let at = ROOT + 64 + 32 * index;
            put(at, &(x << 42 | y << 21 | z).to_le_bytes());
            put(at + 8, &child.to_le_bytes());
            put(at + 20, &value.to_le_bytes());
        }
        // The tables of inner nodes begin with the background everywhere.
        for (at, table, count) in
            uppers.values().map(|at| (at, 8256, 1 << 15)).chain(lowers.values().map(|at| (at, 1088, 1 << 12)))
        {
            (0..count).for_each(|index| put(at + table + 8 * index, &self.background.to_le_bytes()));
        }
        let mut masks: BTreeMap<usize, u8> = BTreeMap::new();
        let mut child = |node: usize, mask: usize, table: usize, index: usize, child: usize| {
            *masks.entry(node + mask + index / 8).or_default() |= 1 << (index % 8);
            ((child - node) as u64, node + table + 8 * index)
        };
        for (first, &at) in &lowers {
            let (offset, entry) = child(uppers[&upper(first)], 4128, 8256, index(*first, 7, 5), at);
            put(entry, &offset.to_le_bytes());
        }
        for (first, &at) in &leaves {
            let (offset, entry) = child(lowers[&lower(first)], 544, 1088, index(*first, 3, 4), at);
            put(entry, &offset.to_le_bytes());
            put(at, &self.leaves[first]);
        }
        masks.into_iter().for_each(|(at, mask)| put(at, &[mask]));
        for (first, value) in &self.tiles[1] {
            put(uppers[&upper(first)] + 8256 + 8 * index(*first, 7, 5), &value.to_le_bytes());
        }
        for (first, value) in &self.tiles[2] {
            put(lowers[&lower(first)] + 1088 + 8 * index(*first, 3, 4), &value.to_le_bytes());
        }
        bytes
    }
}

/// A file of one segment.
pub(crate) fn file(codec: u16, grids: &[Sketch]) -> Vec<u8> {
    let mut file = b"NanoVDB0".to_vec();
    file.extend((32_u32 << 21).to_le_bytes());
    file.extend((grids.len() as u16).to_le_bytes());
    file.extend(codec.to_le_bytes());
    let grids: Vec<_> = grids.iter().map(|grid| (grid, grid.bytes())).collect();
    let stored: Vec<Vec<u8>> = grids.iter().map(|(_, bytes)| packed(codec, bytes)).collect();
    for ((Sketch { name, class, .. }, bytes), stored) in grids.iter().zip(&stored) {
        let mut metadata = vec![0; 176];
        metadata[..8].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
        metadata[8..16].copy_from_slice(&(stored.len() as u64).to_le_bytes());
        metadata[36..40].copy_from_slice(&class.to_le_bytes());
        metadata[136..140].copy_from_slice(&(name.len() as u32 + 1).to_le_bytes());
        file.extend(metadata);
        file.extend(name.as_bytes());
        file.push(0);
    }
    file.extend(stored.concat());
    file
}

fn packed(codec: u16, bytes: &[u8]) -> Vec<u8> {
    match codec {
        0 => return bytes.to_vec(),
        2 => return bytes.chunks(CHUNK).flat_map(blosc).collect(),
        _ => {}
    }
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("memory");
    let packed = encoder.finish().expect("memory");
    [&(packed.len() as u64).to_le_bytes()[..], &packed].concat()
}

/// A chunk of Blosc after its length: each block of LZ4 in four parts, with shuffled bytes.
fn blosc(bytes: &[u8]) -> Vec<u8> {
    let mut chunk = vec![2, 1, 0x21, 4];
    [bytes.len(), BLOCK, 0].iter().for_each(|length| chunk.extend((*length as u32).to_le_bytes()));
    let starts = chunk.len();
    chunk.resize(starts + 4 * bytes.len().div_ceil(BLOCK), 0);
    for (index, block) in bytes.chunks(BLOCK).enumerate() {
        let start = (chunk.len() as u32).to_le_bytes();
        chunk[starts + 4 * index..][..4].copy_from_slice(&start);
        let shuffled: Vec<u8> = (0..4).flat_map(|byte| block.iter().skip(byte).step_by(4)).copied().collect();
        for part in shuffled.chunks(if block.len() == BLOCK { BLOCK / 4 } else { BLOCK }) {
            let packed = lz4_flex::block::compress(part);
            let packed = if packed.len() < part.len() { &packed } else { part };
            chunk.extend((packed.len() as u32).to_le_bytes());
            chunk.extend(packed);
        }
    }
    [&(chunk.len() as u64).to_le_bytes()[..], &chunk].concat()
}

/// A leaf of numbers, by the place of each in it.
pub(crate) fn numbers(value: impl Fn([i32; 3]) -> f32) -> Vec<u8> {
    let mut leaf = vec![0; 96];
    leaf.extend((0..512).flat_map(|index| value(place(index)).to_le_bytes()));
    leaf
}

/// A leaf of codes of 2ⁿ bits.
pub(crate) fn codes(log: u32, minimum: f32, quantum: f32, code: impl Fn([i32; 3]) -> u16) -> Vec<u8> {
    let mut leaf = vec![0; 96 + (64 << log)];
    leaf[15] = (log << 5) as u8;
    leaf[80..84].copy_from_slice(&minimum.to_le_bytes());
    leaf[84..88].copy_from_slice(&quantum.to_le_bytes());
    for index in 0..512_usize {
        let bits = u32::from(code(place(index as i32))) << ((index << log) % 8);
        let byte = 96 + (index << log) / 8;
        leaf[byte] |= bits as u8;
        if log == 4 {
            leaf[byte + 1] = (bits >> 8) as u8;
        }
    }
    leaf
}

/// The place of a value in a leaf.
fn place(index: i32) -> [i32; 3] {
    [index / 64, index / 8 % 8, index % 8]
}

/// The least coordinates of the cube of 2ⁿ cells along a side.
fn aligned(first: [i32; 3], log: u32) -> [i32; 3] {
    first.map(|coordinate| coordinate >> log << log)
}

/// The index of a child of 2ⁿ cells in its node of 2ᵐ children along a side.
fn index(first: [i32; 3], cells: u32, children: u32) -> usize {
    let [x, y, z] = first.map(|coordinate| (coordinate >> cells & ((1 << children) - 1)) as usize);
    (x << children | y) << children | z
}
