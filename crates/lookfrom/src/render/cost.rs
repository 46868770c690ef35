//! The cost of samples: rays, and the nodes and primitives that the camera ray meets in the trees.

use lookfrom_bvh::Observer;

use super::start::Start;
use super::{Renderer, SampleId};
use crate::integrator::Event;

/// The cost of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Rays of its path or tree, without shadow rays: 1 is the camera ray.
    pub rays: u32,
    /// Nodes of the trees that the camera ray visits.
    pub nodes: u32,
    /// Primitives that the camera ray is tested against.
    pub candidates: u32,
}

impl Observer for Cost {
    fn node(&mut self, _instance: u32, _node: u32) {
        self.nodes += 1;
    }

    fn candidate(&mut self, _instance: u32, _geometry: u32, _primitive: u32) {
        self.candidates += 1;
    }
}

impl Renderer {
    /// The costs of samples, each traced by itself: packets share the visits of their rays.
    pub fn costs(&self, ids: &[SampleId]) -> Vec<Cost> {
        let mut start = Start::default();
        self.start(ids, &mut start);
        let query = |(slot, ray)| {
            let mut cost = Cost::default();
            self.world.bvh().query().time(start.times.of(slot)).observer(&mut cost).closest_hit(ray);
            cost
        };
        let mut costs: Vec<Cost> = start.rays.iter().enumerate().map(query).collect();
        let mut events = Vec::new();
        self.trace_events(ids, &mut events);
        for event in &events {
            if let Event::Hit { path, .. } = event {
                costs[path.slot as usize].rays += 1;
            }
        }
        costs
    }
}
