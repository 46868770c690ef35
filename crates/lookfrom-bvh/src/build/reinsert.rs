//! Optimisation of a binary tree by reinsertion: subtrees are removed and inserted where they
//! enlarge the tree least.
//!
//! Meister, Bittner (2018), "Parallel Reinsertion for Bounding Volume Hierarchy Optimization": better positions for
//! the largest nodes are searched, all in the current state of the tree; then the nodes are moved, those with the
//! largest gain first, unless another move has changed the nodes involved. The search is branch and bound. The
//! result does not depend on the number of threads.

use crate::aabb::Aabb;
use crate::node::LARGEST_DEPTH;
use crate::parallel;

use super::reference::Reference;
use super::sah::Binary;

/// Maximum number of rounds of search and moves.
const ROUNDS: usize = 12;

/// A round that saves less than this fraction of the cost is the last. Scanned meshes are done after one to three
/// rounds, the long, crossing triangles of a room after eight.
const WORTHWHILE: f64 = 1.0 / 256.0;

/// One of this many nodes is moved in a round.
const SHARE: usize = 8;

/// Maximum number of nodes visited by the search for one move. Scanned meshes and rooms need fewer; where all boxes
/// overlap, this keeps the time from growing with the square of their number.
const VISITS: usize = 200;

const NONE: u32 = u32::MAX;

/// A node while the tree changes.
#[derive(Clone, Copy)]
struct Spot {
    bounds: Aabb,
    area: f32,
    parent: u32,
    /// [`NONE`] for a leaf.
    left: u32,
    /// Index of the reference, of a leaf.
    right: u32,
}

/// The insertion of a subtree as the sibling of another node.
#[derive(Clone, Copy)]
struct Move {
    node: u32,
    to: u32,
    gain: f32,
}

/// The optimised tree of single references, and the references in its order. `None` where it would be too deep.
pub(super) fn reinsert(tree: &[Binary], references: &[Reference]) -> Option<(Vec<Binary>, Vec<Reference>)> {
    if tree.len() < 8 {
        return None;
    }
    let mut spots = Spots::new(tree);
    let mut cost = spots.cost();
    for _ in 0..ROUNDS {
        let moves = spots.find_moves();
        spots.make_moves(&moves);
        let before = cost;
        cost = spots.cost();
        if before - cost < WORTHWHILE * before {
            break;
        }
    }
    let (better, order) = spots.binary()?;
    let sorted = order.iter().map(|&place| references[place as usize]).collect();
    Some((better, sorted))
}

struct Spots(Vec<Spot>);

impl Spots {
    fn new(tree: &[Binary]) -> Self {
        let mut spots: Vec<Spot> = tree
            .iter()
            .enumerate()
            .map(|(number, node)| Spot {
                bounds: node.bounds,
                area: node.bounds.half_area(),
                parent: NONE,
                left: if node.right == 0 { NONE } else { number as u32 + 1 },
                right: if node.right == 0 { node.first } else { number as u32 + node.right },
            })
            .collect();
        for number in 0..spots.len() {
            if spots[number].left != NONE {
                let Spot { left, right, .. } = spots[number];
                spots[left as usize].parent = number as u32;
                spots[right as usize].parent = number as u32;
            }
        }
        Self(spots)
    }

    /// The expected number of visits by a ray: the sum of the inner nodes' areas.
    fn cost(&self) -> f64 {
        self.0.iter().filter(|spot| spot.left != NONE).map(|spot| f64::from(spot.area)).sum()
    }

    fn at(&self, number: u32) -> &Spot {
        &self.0[number as usize]
    }

    fn sibling(&self, number: u32) -> u32 {
        let parent = self.at(self.at(number).parent);
        if parent.left == number { parent.right } else { parent.left }
    }

    /// The best move of each of the largest nodes, in order of decreasing gain.
    fn find_moves(&self) -> Vec<Move> {
        // The root and its children stay. Areas are not negative, so their bits have the same order; of equal
        // ones the first node comes first.
        let by_area = |n: u32| u64::from(!self.at(n).area.to_bits()) << 32 | u64::from(n);
        let nodes = 1..self.0.len() as u32;
        let mut largest: Vec<u64> = nodes.filter(|&n| self.at(n).parent != 0).map(by_area).collect();
        let count = (self.0.len() / SHARE).max(1).min(largest.len());
        if count == 0 {
            return Vec::new();
        }
        largest.select_nth_unstable(count - 1);
        largest.truncate(count);
        let find = |place: usize| self.find_move(largest[place] as u32);
        let found = parallel::collect(largest.len(), 256, find);
        let mut moves: Vec<Move> = found.into_iter().flatten().collect();
        moves.sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        moves
    }

    /// The cheapest position for a subtree, if it is cheaper than the current one.
    fn find_move(&self, node: u32) -> Option<Move> {
        let moved = self.at(node);
        let parent = moved.parent;
        let mut best = Move { node, to: NONE, gain: 0.0 };

        // Ascend, and at each step search the subtree on the other side. `saved` is the area saved by removing the
        // node: its parent's, and that by which its ancestors shrink.
        let mut saved = self.at(parent).area;
        let mut other = self.sibling(node);
        let mut pivot = parent;
        let mut shrunk = self.at(other).bounds;
        let mut stack = Vec::with_capacity(64);
        let mut visits = 0;
        loop {
            stack.push((saved, other));
            while visits < VISITS
                && let Some((saved, to)) = stack.pop()
            {
                if saved - moved.area <= best.gain {
                    continue;
                }
                visits += 1;
                let spot = self.at(to);
                let mut merged = spot.bounds;
                merged.unite(&moved.bounds);
                let gain = saved - merged.half_area();
                if gain > best.gain {
                    best = Move { node, to, gain };
                }
                let below = gain + spot.area;
                if spot.left != NONE && below - moved.area > best.gain {
                    stack.push((below, spot.left));
                    stack.push((below, spot.right));
                }
            }
            if pivot != parent {
                shrunk.unite(&self.at(other).bounds);
                saved += self.at(pivot).area - shrunk.half_area();
            }
            if pivot == 0 || visits == VISITS {
                break;
            }
            other = self.sibling(pivot);
            pivot = self.at(pivot).parent;
        }
        let stays = best.to == NONE || best.to == parent || best.to == self.sibling(node);
        (!stays).then_some(best)
    }

    fn make_moves(&mut self, moves: &[Move]) {
        let mut touched = vec![false; self.0.len()];
        for &Move { node, to, .. } in moves {
            let parent = self.at(node).parent;
            let sibling = self.sibling(node);
            let above = self.at(parent).parent;
            let above_to = self.at(to).parent;
            let changed = [node, parent, sibling, above, to, above_to];
            if changed.iter().any(|&n| n == NONE || touched[n as usize]) {
                continue;
            }
            changed.iter().for_each(|&n| touched[n as usize] = true);

            // The sibling takes the parent's place, and the parent moves with the node.
            self.replace_child(above, parent, sibling);
            self.replace_child(above_to, to, parent);
            self.0[parent as usize].left = node;
            self.0[parent as usize].right = to;
            self.0[to as usize].parent = parent;
            self.refit(above);
            self.refit(parent);
        }
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        let spot = &mut self.0[parent as usize];
        if spot.left == old {
            spot.left = new;
        } else {
            spot.right = new;
        }
        self.0[new as usize].parent = parent;
    }

    /// Refits the boxes from a node upwards until nothing changes.
    fn refit(&mut self, from: u32) {
        let mut number = from;
        while number != NONE {
            let spot = self.at(number);
            let mut bounds = self.at(spot.left).bounds;
            bounds.unite(&self.at(spot.right).bounds);
            if number != from && bounds == spot.bounds {
                break;
            }
            let parent = spot.parent;
            let spot = &mut self.0[number as usize];
            spot.bounds = bounds;
            spot.area = bounds.half_area();
            number = parent;
        }
    }

    /// The tree in depth-first order, and the references in that order. `None` where it has become too deep.
    fn binary(&self) -> Option<(Vec<Binary>, Vec<u32>)> {
        let mut tree: Vec<Binary> = Vec::with_capacity(self.0.len());
        let mut order = Vec::with_capacity(self.0.len() / 2 + 1);
        // The entries still to be written: a node, its depth, and the index of its parent if it is
        // a right child.
        let mut stack = vec![(0_u32, 0_u32, None::<usize>)];
        while let Some((number, depth, right_of)) = stack.pop() {
            if depth as usize > LARGEST_DEPTH {
                return None;
            }
            let here = tree.len();
            if let Some(parent) = right_of {
                tree[parent].right = (here - parent) as u32;
            }
            let spot = self.at(number);
            let leaf = spot.left == NONE;
            tree.push(Binary { bounds: spot.bounds, right: 0, first: order.len() as u32, count: 1 });
            if leaf {
                order.push(spot.right);
            } else {
                stack.push((spot.right, depth + 1, Some(here)));
                stack.push((spot.left, depth + 1, None));
            }
        }
        // Children follow their parents.
        for number in (0..tree.len()).rev() {
            if tree[number].right != 0 {
                tree[number].count =
                    tree[number + 1].count + tree[number + tree[number].right as usize].count;
            }
        }
        Some((tree, order))
    }
}
