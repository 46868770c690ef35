//! The choice of binary nodes that become children of wide nodes or leaves: Ylitie, Karras, Laine (2017).
//!
//! The cheapest choice under the surface area heuristic, by dynamic programming from the leaves up: Ylitie, Karras,
//! Laine (2017), "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.
//! `cost[n][i − 1]` is the least cost of the subtree of binary node n when it may take up to i slots of a wide node.

use crate::node::WIDTH;

use super::reference::{Reference, fits_a_leaf};
use super::sah::Binary;
use crate::parallel::{self, join};

/// Maximum number of slots for a child's subtree.
const PLACES: usize = WIDTH - 1;

/// The cost of a visit to a wide node.
const NODE: f32 = 1.0;

/// The cost of a visit to a leaf, relative to a node.
const LEAF: f32 = 1.0;

/// The choice for one binary node.
#[derive(Clone, Copy, Default)]
struct Choice {
    /// Number of slots of the left child when there are two to eight: `left[i − 2]`; 0 to use one slot less.
    left: [u8; PLACES],
    leaf: bool,
}

/// A choice with the costs by which those above it are made.
#[derive(Clone, Copy, Default)]
struct Costed {
    cost: [f32; PLACES],
    choice: Choice,
}

/// The choices for all binary nodes, without the costs, which are larger.
pub(super) struct Plan {
    choices: Vec<Choice>,
    cost: f32,
}

impl Plan {
    pub(super) fn new(binary: &[Binary], references: &[Reference]) -> Self {
        let mut costed = vec![Costed::default(); binary.len()];
        if !binary.is_empty() {
            choose_all(binary, references, &mut costed);
        }
        let cost = costed.first().map_or(0.0, |root| root.cost[0]);
        let choices = parallel::collect(costed.len(), parallel::GRAIN, |number| costed[number].choice);
        Self { choices, cost }
    }

    /// The expected cost of a ray, in units of box area.
    pub(super) fn cost(&self) -> f32 {
        self.cost
    }

    /// True if a binary node becomes a leaf.
    pub(super) fn is_leaf(&self, number: usize) -> bool {
        self.choices[number].leaf
    }

    /// The binary nodes that become the children of the wide node at `root`.
    pub(super) fn children(&self, binary: &[Binary], root: usize) -> ([usize; WIDTH], usize) {
        let mut children = [root; WIDTH];
        let mut count = 0;
        self.collect(binary, root, WIDTH, &mut children, &mut count);
        (children, count)
    }

    fn collect(
        &self,
        binary: &[Binary],
        number: usize,
        places: usize,
        children: &mut [usize; WIDTH],
        count: &mut usize,
    ) {
        let choice = &self.choices[number];
        let mut places = places;
        while places > 1 && choice.left[places - 2] == 0 {
            places -= 1;
        }
        if places == 1 {
            children[*count] = number;
            *count += 1;
            return;
        }
        let left = usize::from(choice.left[places - 2]);
        self.collect(binary, number + 1, left, children, count);
        self.collect(binary, number + binary[number].right as usize, places - left, children, count);
    }
}

/// Makes the choices for a binary node and all below it.
fn choose_all(binary: &[Binary], references: &[Reference], choices: &mut [Costed]) {
    let right = binary[0].right as usize;
    if binary.len() < parallel::GRAIN || right == 0 {
        // Children follow their parents.
        for number in (0..binary.len()).rev() {
            choices[number] = choose(&binary[number..], references, &choices[number..]);
        }
        return;
    }
    let (first, rest) = choices.split_at_mut(right);
    join(
        || choose_all(&binary[1..right], references, &mut first[1..]),
        || choose_all(&binary[right..], references, rest),
    );
    choices[0] = choose(binary, references, choices);
}

/// The choice for the first of some binary nodes, after those for its children are made.
fn choose(binary: &[Binary], references: &[Reference], choices: &[Costed]) -> Costed {
    let node = &binary[0];
    let area = node.bounds.half_area();
    let Costed { mut cost, mut choice } = Costed::default();
    let leaf = if fits_a_leaf(&references[node.first as usize..][..node.count as usize]) {
        LEAF * area
    } else {
        f32::INFINITY
    };
    if node.right == 0 {
        choice.leaf = true;
        return Costed { cost: [leaf; PLACES], choice };
    }

    // Distribute two to eight slots between the children; the last case is a wide node of its own.
    let (left, right) = (&choices[1].cost, &choices[node.right as usize].cost);
    let mut shared = [f32::INFINITY; WIDTH + 1];
    for places in 2..=WIDTH {
        for to_left in 1..places {
            let both = left[to_left - 1] + right[places - to_left - 1];
            if both < shared[places] {
                shared[places] = both;
                choice.left[places - 2] = to_left as u8;
            }
        }
    }
    let own_node = NODE * area + shared[WIDTH];
    choice.leaf = leaf <= own_node;
    cost[0] = leaf.min(own_node);
    for places in 2..=PLACES {
        cost[places - 1] = shared[places];
        if cost[places - 2] <= shared[places] {
            cost[places - 1] = cost[places - 2];
            choice.left[places - 2] = 0;
        }
    }
    Costed { cost, choice }
}
