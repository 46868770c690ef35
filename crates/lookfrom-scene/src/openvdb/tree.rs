//! Trees of nodes: a root of any size, upper nodes of 32³ children or tiles, lower ones of 16³, leaves of 8³ values.
//!
//! First come masks and tiles of all nodes, from the root down, then the values of the leaves, in the same order.

use std::collections::BTreeSet;

use glam::IVec3;

use super::cursor::Cursor;
use super::mask::NodeMask;
use super::numbers::Precision;
use super::values::{NodeValues, Packing};
use crate::budget::Reservation;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::volume::nodes::{Nodes, Tile, check_near};

/// The logarithm of the number of cells along a side of an upper node.
const UPPER: u32 = 12;

/// Bytes of the mask of a leaf, and cells along its side.
const LEAF_MASK: u64 = 64;

/// The inner nodes below the root.
const LEVELS: [NodeLevel; 2] = [NodeLevel { children: 5, cells: 7 }, NodeLevel { children: 4, cells: 3 }];

/// A kind of inner nodes. Along a side: the logarithms of the number of children, and of the number of cells of a child.
struct NodeLevel {
    children: u32,
    cells: u32,
}

/// A tree, of which the values of the leaves are still to be read.
pub(super) struct OpenTree<'a> {
    pub(super) nodes: Nodes,
    /// The value masks of the leaves.
    pub(super) masks: Vec<NodeMask<'a>>,
    pub(super) values: NodeValues,
    /// At the leaves' values.
    pub(super) cursor: Cursor<'a>,
    /// The box of active values.
    bounds: Option<[IVec3; 2]>,
    /// The memory of the tiles.
    memory: Reservation,
}

impl<'a> OpenTree<'a> {
    /// Reads all but the values of the leaves.
    ///
    /// # Errors
    /// `Syntax` for broken ones; `Limit` for coordinates that are too large, and too many tiles.
    pub(super) fn new(
        mut cursor: Cursor<'a>,
        packing: Packing,
        precision: Precision,
        context: &LoadContext<'_>,
        at: &Location,
    ) -> Result<Self> {
        // The number of arrays of a leaf, which leaves say themselves where there may be more than one.
        cursor.u32()?;
        let values = NodeValues::new(&mut cursor, packing, precision)?;
        let mut tree = Self {
            nodes: Nodes { background: values.background(), ..Nodes::default() },
            masks: Vec::new(),
            values,
            cursor,
            bounds: None,
            memory: context.budget.reserve(0, "the tiles of the grid", at)?,
        };
        tree.read_root(context, at)?;
        tree.nodes.bounds = tree.bounds.unwrap_or_default();
        Ok(tree)
    }

    fn read_root(&mut self, context: &LoadContext<'_>, at: &Location) -> Result<()> {
        let [tiles, children] = [self.cursor.u32()?, self.cursor.u32()?];
        let mut known = BTreeSet::new();
        for index in 0..u64::from(tiles) + u64::from(children) {
            let place = self.cursor.at;
            let first = IVec3::new(self.cursor.i32()?, self.cursor.i32()?, self.cursor.i32()?);
            if (first & ((1 << UPPER) - 1)) != IVec3::ZERO || !known.insert(first.to_array()) {
                self.cursor.at = place;
                let message = format!("a node at the index {first}, expected multiples of 4096, each once");
                return Err(self.cursor.damaged(message));
            }
            if index >= u64::from(tiles) {
                check_near(first, self.cursor.bytes, place)?;
                self.read_inner(&LEVELS, first, context, at)?;
                continue;
            }
            let (value, is_active) = (self.values.single(&mut self.cursor)?, self.cursor.u8()? != 0);
            if is_active || value != self.nodes.background {
                check_near(first, self.cursor.bytes, place)?;
                self.tile(first, 1 << UPPER, value, is_active);
            }
        }
        Ok(())
    }

    fn read_inner(
        &mut self,
        levels: &[NodeLevel],
        first: IVec3,
        context: &LoadContext<'_>,
        at: &Location,
    ) -> Result<()> {
        let [level, below @ ..] = levels else { return self.read_leaf(first) };
        let side = 1_usize << level.children;
        let count = side * side * side;
        let mut mask = || Ok(NodeMask(self.cursor.slice(count as u64 / 8, "the mask of a node")?));
        let (children, active) = (mask()?, mask()?);
        let mut values = vec![0.0; count];
        self.values.read(&mut self.cursor, active, Some(children), &mut values)?;
        let is_tile = |index: usize, value: f32| {
            !children.has(index) && (active.has(index) || value != self.nodes.background)
        };
        let tiles: Vec<usize> = (0..count).filter(|&index| is_tile(index, values[index])).collect();
        let bytes = tiles.len() * size_of::<Tile>();
        self.memory.join(context.budget.reserve(bytes as u64, "the tiles of the grid", at)?);
        let first_of = |index: usize| {
            let place = [index / side / side, index / side % side, index % side];
            first + (IVec3::from_array(place.map(|place| place as i32)) << level.cells)
        };
        for index in tiles {
            self.tile(first_of(index), 1 << level.cells, values[index], active.has(index));
        }
        drop(values);
        for index in (0..count).filter(|&index| children.has(index)) {
            self.read_inner(below, first_of(index), context, at)?;
        }
        Ok(())
    }

    fn read_leaf(&mut self, first: IVec3) -> Result<()> {
        let mask = NodeMask(self.cursor.slice(LEAF_MASK, "a leaf")?);
        if let Some([low, end]) = mask.bounds_of_leaf() {
            self.enclose([first + low, first + end]);
        }
        self.nodes.leaves.push(first);
        self.masks.push(mask);
        Ok(())
    }

    fn tile(&mut self, first: IVec3, side: i32, value: f32, is_active: bool) {
        if is_active {
            self.enclose([first, first + side]);
        }
        if value != self.nodes.background {
            self.nodes.tiles.push(Tile { first, side, value });
        }
    }

    /// Makes the box of active values contain another one.
    fn enclose(&mut self, [low, end]: [IVec3; 2]) {
        let [least, most] = self.bounds.unwrap_or([low, end]);
        self.bounds = Some([least.min(low), most.max(end)]);
    }
}
