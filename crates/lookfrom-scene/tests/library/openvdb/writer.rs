//! Small OpenVDB files, as `io/Archive.cc`, `io/Compression.h` and `tree/` of OpenVDB write them.

use std::collections::{BTreeMap, BTreeSet};

use half::f16;

/// Flags of compressions.
pub(crate) const ZIP: u32 = 1;
pub(crate) const ACTIVE: u32 = 2;
pub(crate) const BLOSC: u32 = 4;

/// A value, and whether it is active.
pub(crate) type Voxel = (f32, bool);

/// A grid to be written.
#[derive(Clone)]
pub(crate) struct Draft {
    /// The name, and its number after `\x1e` if there are others of the same name.
    pub(crate) name: &'static str,
    /// The name of the grid whose tree it has.
    pub(crate) parent: &'static str,
    pub(crate) class: &'static str,
    pub(crate) tree: &'static str,
    pub(crate) flags: u32,
    pub(crate) map: (&'static str, Vec<f64>),
    pub(crate) background: f32,
    /// Tiles by their least coordinates: of 4096³, 128³ and 8³ cells.
    pub(crate) tiles: [BTreeMap<[i32; 3], Voxel>; 3],
    /// Leaves by their least coordinates.
    pub(crate) leaves: BTreeMap<[i32; 3], Vec<Voxel>>,
}

impl Draft {
    pub(crate) fn new(name: &'static str) -> Self {
        Self {
            name,
            parent: "",
            class: "fog volume",
            tree: "Tree_float_5_4_3",
            flags: BLOSC | ACTIVE,
            map: ("TranslationMap", vec![0.0; 3]),
            background: 0.0,
            tiles: Default::default(),
            leaves: BTreeMap::new(),
        }
    }

    /// The bytes of the grid in a file of a version.
    fn bytes(&self, version: u32) -> Vec<u8> {
        let has_codes = version >= 222;
        let mut out = if has_codes { self.flags.to_le_bytes().to_vec() } else { Vec::new() };
        // Of an unknown type is passed by its size.
        let is_half = u8::from(self.tree.ends_with("HalfFloat"));
        let metadata = [
            ("class", "string", self.class.as_bytes()),
            ("is_saved_as_half_float", "bool", &[is_half]),
            ("other", "__unknown", &[1, 2, 3]),
        ];
        out.extend((metadata.len() as u32).to_le_bytes());
        for (name, kind, value) in metadata {
            [name.as_bytes(), kind.as_bytes(), value].iter().for_each(|part| text(&mut out, part));
        }
        text(&mut out, self.map.0.as_bytes());
        out.extend(self.map.1.iter().flat_map(|number| number.to_le_bytes()));
        if !self.parent.is_empty() {
            return out;
        }
        out.extend(1_u32.to_le_bytes());
        out.extend(self.single(self.background));
        let lowers: BTreeSet<_> = self.leaves.keys().chain(self.tiles[2].keys()).map(aligned::<7>).collect();
        let uppers: BTreeSet<_> = lowers.iter().chain(self.tiles[1].keys()).map(aligned::<12>).collect();
        [self.tiles[0].len(), uppers.len()]
            .iter()
            .for_each(|count| out.extend((*count as u32).to_le_bytes()));
        let corner = |out: &mut Vec<u8>, first: &[i32; 3]| {
            out.extend(first.iter().flat_map(|coordinate| coordinate.to_le_bytes()));
        };
        for (first, (value, is_active)) in &self.tiles[0] {
            corner(&mut out, first);
            out.extend(self.single(*value));
            out.push(u8::from(*is_active));
        }
        for upper in uppers {
            corner(&mut out, &upper);
            let children: BTreeSet<_> = lowers.iter().filter(|lower| aligned::<12>(lower) == upper).collect();
            self.inner::<12, 7>(&mut out, has_codes, (upper, &children), &self.tiles[1]);
            for lower in children {
                let leaves = self.leaves.keys().filter(|leaf| aligned::<7>(leaf) == *lower);
                let children: BTreeSet<_> = leaves.collect();
                self.inner::<7, 3>(&mut out, has_codes, (*lower, &children), &self.tiles[2]);
                children.iter().for_each(|leaf| mask(&mut out, self.leaves[*leaf].iter().map(|cell| cell.1)));
            }
        }
        // In the order of the nodes, which is not that of coordinates.
        let by_node = |leaf: &&[i32; 3]| (aligned::<12>(leaf), aligned::<7>(leaf), **leaf);
        let mut leaves: Vec<_> = self.leaves.keys().collect();
        leaves.sort_by_key(by_node);
        for leaf in leaves {
            let cells = &self.leaves[leaf];
            mask(&mut out, cells.iter().map(|cell| cell.1));
            if has_codes {
                self.values(&mut out, cells, &vec![false; cells.len()]);
                continue;
            }
            corner(&mut out, leaf);
            // A second array, as of those that were never removed.
            out.push(2);
            for scale in [1.0, 2.0] {
                self.array(&mut out, &cells.iter().map(|cell| scale * cell.0).collect::<Vec<_>>());
            }
        }
        out
    }

    /// Masks and tiles of a node of 2ⁿ cells along a side, with children of 2ᵐ.
    fn inner<const N: u32, const M: u32>(
        &self,
        out: &mut Vec<u8>,
        has_codes: bool,
        (node, children): ([i32; 3], &BTreeSet<&[i32; 3]>),
        tiles: &BTreeMap<[i32; 3], Voxel>,
    ) {
        let side = 1 << (N - M);
        let first = |index: i32| {
            let place = [index / side / side, index / side % side, index % side];
            std::array::from_fn(|axis| node[axis] + (place[axis] << M))
        };
        let places: Vec<[i32; 3]> = (0..side * side * side).map(first).collect();
        let is_child: Vec<bool> = places.iter().map(|first| children.contains(first)).collect();
        let cell = |first| tiles.get(first).copied().unwrap_or((self.background, false));
        let cells: Vec<Voxel> = places.iter().map(cell).collect();
        mask(out, is_child.iter().copied());
        mask(out, cells.iter().map(|cell| cell.1));
        if has_codes {
            return self.values(out, &cells, &is_child);
        }
        let tiles = cells.iter().zip(is_child).filter(|(_, is_child)| !is_child);
        self.array(out, &tiles.map(|(cell, _)| cell.0).collect::<Vec<_>>());
    }

    /// The values of a node: which of those that are not active are written depends on how many different ones there are.
    fn values(&self, out: &mut Vec<u8>, cells: &[Voxel], is_child: &[bool]) {
        let mut others = Vec::new();
        for (&(value, is_active), is_child) in cells.iter().zip(is_child) {
            if !is_active && !is_child && !others.contains(&value) {
                others.push(value);
            }
        }
        let all = |out: &mut Vec<u8>, is_stored: &dyn Fn(&Voxel) -> bool| {
            let stored = cells.iter().filter(|cell| is_stored(cell));
            self.array(out, &stored.map(|cell| cell.0).collect::<Vec<_>>());
        };
        if self.flags & ACTIVE == 0 || others.len() > 2 {
            out.push(6);
            return all(out, &|_| true);
        }
        // The background is the second one.
        others.sort_by_key(|value| *value == self.background);
        let second = others.get(1).copied();
        let (code, written) = match (others.first(), second) {
            (None, _) => (0, 0),
            (Some(value), None) if *value == self.background => (0, 0),
            (Some(value), None) if *value == -self.background => (1, 0),
            (Some(_), None) => (2, 1),
            (Some(value), Some(second)) if second == self.background && *value == -second => (3, 0),
            (_, Some(second)) if second == self.background => (4, 1),
            _ => (5, 2),
        };
        out.push(code);
        others[..written].iter().for_each(|value| out.extend(self.single(*value)));
        if let Some(second) = second {
            mask(out, cells.iter().map(|cell| !cell.1 && cell.0 == second));
        }
        all(out, &|cell| cell.1);
    }

    fn single(&self, value: f32) -> Vec<u8> {
        match &self.tree[..9] {
            "Tree_doub" => f64::from(value).to_le_bytes().to_vec(),
            "Tree_half" => f16::from_f32(value).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        }
    }

    fn array(&self, out: &mut Vec<u8>, values: &[f32]) {
        let is_half = self.tree.ends_with("HalfFloat");
        let bytes: Vec<u8> = match is_half {
            true => values.iter().flat_map(|value| f16::from_f32(*value).to_le_bytes()).collect(),
            false => values.iter().flat_map(|value| self.single(*value)).collect(),
        };
        if self.flags & (ZIP | BLOSC) == 0 || (is_half && values.is_empty()) {
            return out.extend(bytes);
        }
        let packed = match self.flags & BLOSC {
            0 => miniz_oxide::deflate::compress_to_vec_zlib(&bytes, 6),
            _ => blosc(&bytes),
        };
        let is_shorter = packed.len() < bytes.len();
        let length = if is_shorter { packed.len() as i64 } else { -(bytes.len() as i64) };
        out.extend(length.to_le_bytes());
        out.extend(if is_shorter { packed } else { bytes });
    }
}

/// A chunk of one block with shuffled bytes.
fn blosc(bytes: &[u8]) -> Vec<u8> {
    let mut chunk = vec![2, 1, 0x31, 4];
    let shuffled: Vec<u8> = (0..4).flat_map(|byte| bytes.iter().skip(byte).step_by(4)).copied().collect();
    let block = lz4_flex::block::compress(&shuffled);
    let numbers = [bytes.len(), bytes.len(), 0, 20, block.len()];
    chunk.extend(numbers.iter().flat_map(|number| (*number as u32).to_le_bytes()));
    chunk.extend(block);
    chunk
}

/// A file of these grids.
pub(crate) fn file(grids: &[Draft]) -> Vec<u8> {
    file_of_version(224, grids)
}

/// A file of a version of the format. Before 222 the first grid tells how all are packed: by ZIP, as always before 220, or not.
pub(crate) fn file_of_version(version: u32, grids: &[Draft]) -> Vec<u8> {
    let mut file = b" BDV\0\0\0\0".to_vec();
    [version, 10, 0].iter().for_each(|number| file.extend(number.to_le_bytes()));
    file.push(1);
    if (220..222).contains(&version) {
        file.push((grids[0].flags & ZIP) as u8);
    }
    file.extend(b"00000000-0000-0000-0000-000000000000");
    file.extend(0_u32.to_le_bytes());
    file.extend((grids.len() as u32).to_le_bytes());
    for grid in grids {
        [grid.name, grid.tree, grid.parent].iter().for_each(|part| text(&mut file, part.as_bytes()));
        let (first, body) = (file.len() as u64 + 24, grid.bytes(version));
        [first, first, first + body.len() as u64].iter().for_each(|at| file.extend(at.to_le_bytes()));
        file.extend(body);
    }
    file
}

fn text(out: &mut Vec<u8>, text: &[u8]) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text);
}

fn mask(out: &mut Vec<u8>, bits: impl Iterator<Item = bool>) {
    let bits: Vec<bool> = bits.collect();
    let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
    out.extend(bits.chunks(8).map(byte));
}

/// The least coordinates of the cube of 2ⁿ cells along a side.
fn aligned<const N: u32>(first: &[i32; 3]) -> [i32; 3] {
    first.map(|coordinate| coordinate >> N << N)
}
