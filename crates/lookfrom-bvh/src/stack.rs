//! The traversal stack: children still to be visited, nearest on top.

use std::cell::Cell;

use crate::collector::Collector;
use crate::node::{Child, Entered, LARGEST_DEPTH, Node, WIDTH};
use lookfrom_simd::Simd;

/// A child still to be visited: the distance at which the ray enters it (f32 bits) above the child. Positive
/// distances are ordered like these integers; the others only cost time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct StackEntry(u64);

impl StackEntry {
    const NONE: Self = Self(0);

    #[inline(always)]
    fn new(near: f32, child: Child) -> Self {
        Self(u64::from(near.to_bits()) << 32 | u64::from(child.0))
    }

    #[inline(always)]
    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }
}

/// The capacity: all children but one on each level of a tree, and of an instance's. A power of two.
const STACK: usize = (2 * LARGEST_DEPTH * (WIDTH - 1)).next_power_of_two();

/// Storage for the entries of any tree, so that traversal does not allocate.
pub(crate) type Stack = [StackEntry; STACK];

thread_local! {
    /// The last traversal's stack, kept so that a ray costs no allocation. Taken while in use, so a procedural
    /// shape that traces rays of its own gets a new one.
    static KEPT: Cell<Option<Box<Stack>>> = const { Cell::new(None) };
}

/// Runs `work` with a stack.
#[inline(always)]
pub(crate) fn with_stack<R>(work: impl FnOnce(&mut Stack) -> R) -> R {
    let mut stack = KEPT.take().unwrap_or_else(new_stack);
    let result = work(&mut stack);
    KEPT.set(Some(stack));
    result
}

#[cold]
fn new_stack() -> Box<Stack> {
    Box::new([StackEntry::NONE; STACK])
}

/// The entries of one tree, above those of the outer tree.
pub(crate) struct TraversalStack<'a> {
    pub(crate) entries: &'a mut Stack,
    pub(crate) bottom: usize,
    pub(crate) height: usize,
}

/// Number of rays in flight that share one stack, each with a segment of it.
pub(crate) const SEGMENTS: usize = 8;

/// Entries of a segment. An odd number of cache lines, so that the segments do not compete for the same places of a
/// cache.
pub(crate) const SEGMENT: usize = 31 * (64 / size_of::<StackEntry>());

/// Bottom of the rest of the stack, for what is traced alone beside the rays in flight.
pub(crate) const REST: usize = SEGMENTS * SEGMENT;

const _: () = assert!(REST + SEGMENT + LARGEST_DEPTH * (WIDTH - 1) <= STACK);

/// Whether the entries of a tree of this depth fit into a segment.
pub(crate) fn fits_a_segment(depth: usize) -> bool {
    depth * (WIDTH - 1) <= SEGMENT
}

impl<'a> TraversalStack<'a> {
    /// An empty stack above other entries.
    #[inline(always)]
    pub(crate) fn above(entries: &'a mut Stack, bottom: usize) -> Self {
        Self { entries, bottom, height: bottom }
    }

    /// The next child that is not beyond the end.
    #[inline(always)]
    pub(crate) fn pop(&mut self, end: f32) -> Option<Child> {
        while self.height > self.bottom {
            self.height -= 1;
            let entry = self.entries[self.height % STACK];
            if entry.near() <= end {
                return Some(entry.child());
            }
        }
        None
    }

    #[inline(always)]
    fn push(&mut self, entry: StackEntry) {
        self.entries[self.height % STACK] = entry;
        self.height += 1;
    }

    /// Pushes all entered children but the nearest, in order, the nearer ones on top, and returns the nearest.
    /// There must be at least one.
    #[inline(always)]
    pub(crate) fn push_all_but_nearest<S: Simd, C: Collector>(
        &mut self,
        node: &Node,
        entered: &Entered<S>,
    ) -> Child {
        let mut children = entered.children;
        let slot = next_slot(&mut children);
        if children == 0 {
            // Without its distance, for which the next visit would have to wait.
            return node.child(slot);
        }
        let first = StackEntry::new(entered.near[slot], node.child(slot));
        let second = next(node, entered, &mut children);
        let (mut nearest, farther) =
            if C::NEAREST_FIRST { (first.min(second), first.max(second)) } else { (first, second) };
        let bottom = self.height;
        self.push(farther);
        while children != 0 {
            let mut entry = next(node, entered, &mut children);
            if C::NEAREST_FIRST {
                (nearest, entry) = (nearest.min(entry), nearest.max(entry));
                // Insertion sort: farther entries stay below.
                let mut place = self.height;
                while place > bottom && self.entries[(place - 1) % STACK] < entry {
                    self.entries[place % STACK] = self.entries[(place - 1) % STACK];
                    place -= 1;
                }
                self.entries[place % STACK] = entry;
                self.height += 1;
            } else {
                self.push(entry);
            }
        }
        nearest.child()
    }
}

/// Removes the first child from a set.
#[inline(always)]
fn next<S: Simd>(node: &Node, entered: &Entered<S>, children: &mut u32) -> StackEntry {
    let slot = next_slot(children);
    StackEntry::new(entered.near[slot], node.child(slot))
}

/// Removes the first slot from a set of children.
#[inline(always)]
fn next_slot(children: &mut u32) -> usize {
    let slot = children.trailing_zeros() as usize % WIDTH;
    *children &= children.wrapping_sub(1);
    slot
}
