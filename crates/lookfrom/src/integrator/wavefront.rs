//! Paths of a batch side by side: what the integrators share that shade eight at a time.

pub(super) mod bare_hits;
mod bins;
mod departure;
mod interfaces;
mod light_samples;
mod modes;
mod rounds;
mod surfaces;

use lookfrom_bvh::Hit;

pub(super) use bare_hits::BareHits;
pub(super) use bins::{Bins, Eight};
pub(super) use departure::{Boundary, Departure};
pub(super) use interfaces::{Behind, InterfaceKind, Interfaces};
pub(super) use light_samples::{LightSamples, Receivers};
pub(super) use modes::Modes;
pub(super) use rounds::Rounds;
pub(super) use surfaces::Surfaces;

use super::{BatchStreams, Path};
use crate::world::World;

/// A batch of paths and what they have hit.
#[derive(Clone, Copy)]
pub(super) struct HitBatch<'a, S = ()> {
    pub(super) world: &'a World,
    pub(super) streams: &'a BatchStreams<'a>,
    pub(super) paths: &'a [Path<S>],
    pub(super) hits: &'a [Hit],
}
