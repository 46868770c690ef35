//! Trees of nodes: a root of any size, upper nodes of 32³ children or tiles, lower ones of 16³, leaves of 8³ values.

use std::collections::BTreeSet;

use glam::IVec3;

use super::header::HEADER;
use super::leaf::Kind;
use crate::error::{ErrorKind, Result};
use crate::volume::bytes::Bytes;
use crate::volume::nodes::{Nodes, Tile, check_near};

/// The position of the root node, from the tree on, is there.
const ROOT: u64 = HEADER + 24;
/// Bytes of the root node before its tiles, and of each tile.
const ROOT_BASE: u64 = 64;
const ROOT_TILE: u64 = 32;

/// A kind of inner nodes.
struct Level {
    name: &'static str,
    /// Along a side: the logarithms of the number of children, and of the number of cells of a child.
    children: u32,
    cells: u32,
    /// Offsets of the bits of children, and of the table of children or values.
    mask: usize,
    table: usize,
    bytes: u64,
}

/// The inner nodes below the root.
const LEVELS: [Level; 2] = [
    Level { name: "an upper node", children: 5, cells: 7, mask: 4128, table: 8256, bytes: 270_400 },
    Level { name: "a lower node", children: 4, cells: 3, mask: 544, table: 1088, bytes: 33856 },
];

/// The nodes of a tree, and the bytes of its leaves.
pub(super) struct Tree<'a> {
    bytes: Bytes<'a>,
    pub(super) kind: Kind,
    pub(super) nodes: Nodes,
    /// The bytes of the leaves, in their order.
    pub(super) leaves: Vec<&'a [u8]>,
    /// Bytes that nodes have not taken yet: fewer than that, if no two of them are one.
    left: u64,
}

impl<'a> Tree<'a> {
    /// Finds all tiles and leaves.
    ///
    /// # Errors
    /// `Syntax` for positions outside of the file and nodes that are in several places; `Limit` for coordinates that are too large.
    pub(super) fn new(bytes: Bytes<'a>, kind: Kind) -> Result<Self> {
        let root = HEADER.saturating_add(bytes.u64(ROOT)?);
        bytes.slice(root, ROOT_BASE, "the root node")?;
        let corner = |at| Ok(IVec3::new(bytes.i32(at)?, bytes.i32(at + 4)?, bytes.i32(at + 8)?));
        let [low, high] = [corner(root)?, corner(root + 12)?];
        let is_empty = low.cmpgt(high).any();
        if !is_empty {
            check_near(low, bytes, root)?;
            check_near(high, bytes, root)?;
        }
        let nodes = Nodes {
            background: bytes.f32(root + 28)?,
            bounds: if is_empty { [IVec3::ZERO; 2] } else { [low, high + 1] },
            ..Nodes::default()
        };
        let mut tree = Self { bytes, kind, nodes, leaves: Vec::new(), left: bytes.length() };
        tree.read_root(root)?;
        Ok(tree)
    }

    fn read_root(&mut self, root: u64) -> Result<()> {
        let count = u64::from(self.bytes.u32(root + 24)?);
        let table = root + ROOT_BASE;
        self.bytes.slice(table, count * ROOT_TILE, "the table of the root node")?;
        let mut known = BTreeSet::new();
        for at in (0..count).map(|index| table + index * ROOT_TILE) {
            let (key, child) = (self.bytes.u64(at)?, self.bytes.u64(at + 8)?);
            // Coordinates over 2¹², in 21 bits each.
            let first = [42, 21, 0].map(|shift| ((key >> shift) as u32 & 0x1f_ffff).wrapping_shl(12) as i32);
            if !known.insert(first) {
                return Err(self.bytes.error(at, ErrorKind::Syntax, "the root node has the same tile twice"));
            }
            let first = IVec3::from_array(first);
            let value = self.bytes.f32(at + 20)?;
            if child == 0 && value == self.nodes.background {
                continue;
            }
            check_near(first, self.bytes, at)?;
            match child {
                0 => self.nodes.tiles.push(Tile { first, side: 1 << 12, value }),
                child => self.read_inner(&LEVELS, root.wrapping_add(child), first)?,
            }
        }
        Ok(())
    }

    fn read_inner(&mut self, levels: &[Level], at: u64, first: IVec3) -> Result<()> {
        let [level, below @ ..] = levels else { return self.read_leaf(at, first) };
        let node = self.take(at, level.bytes, level.name)?;
        let (mask, table) = (&node[level.mask..], node[level.table..].as_chunks::<8>().0);
        for (index, entry) in table.iter().take(1 << (3 * level.children)).enumerate() {
            let side = 1 << level.children;
            let place = [index / side / side, index / side % side, index % side];
            let first = first + (IVec3::from_array(place.map(|place| place as i32)) << level.cells);
            if mask[index / 8] >> (index % 8) & 1 == 1 {
                self.read_inner(below, at.wrapping_add(u64::from_le_bytes(*entry)), first)?;
                continue;
            }
            let value = f32::from_le_bytes([entry[0], entry[1], entry[2], entry[3]]);
            if value != self.nodes.background {
                self.nodes.tiles.push(Tile { first, side: 1 << level.cells, value });
            }
        }
        Ok(())
    }

    fn read_leaf(&mut self, at: u64, first: IVec3) -> Result<()> {
        let head = self.bytes.slice(at, self.kind.least_bytes(), "a leaf")?;
        let length = self.kind.bytes_of(head).ok_or_else(|| {
            self.bytes.error(at, ErrorKind::Syntax, "a leaf with codes of more than 16 bits")
        })?;
        let bytes = self.take(at, length, "a leaf")?;
        self.nodes.leaves.push(first);
        self.leaves.push(bytes);
        Ok(())
    }

    /// The bytes of a node, which no other one has.
    fn take(&mut self, at: u64, length: u64, what: &str) -> Result<&'a [u8]> {
        let node = self.bytes.slice(at, length, what)?;
        self.left = self.left.checked_sub(length).ok_or_else(|| {
            self.bytes.error(
                at,
                ErrorKind::Syntax,
                "more nodes than there are bytes: some are in several places",
            )
        })?;
        Ok(node)
    }
}
