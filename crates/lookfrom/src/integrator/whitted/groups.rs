//! Groups of shaded hits, up to eight in each: their ambient light, light of sources and branches, in memory that is reused.

use lookfrom_bvh::Ray;

use super::told::Told;
use crate::core::lanes::LANES;
use crate::core::spectrum::Spectrum;

/// Groups, and the light on them.
#[derive(Debug, Default)]
pub(super) struct Groups {
    groups: Vec<Group>,
    /// Number of groups that count.
    count: usize,
    lights: Vec<FromLight>,
    /// Number of those that count.
    light_count: usize,
    /// The events of each group, for a probe.
    told: Vec<Told>,
}

/// An end of the list of groups, and of that of lights.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub(super) groups: usize,
    lights: usize,
}

/// The rays of a branch of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct BranchRays {
    /// Bit i for lane i: whether there is a ray at all.
    pub(super) exist: u32,
    /// The throughputs of the paths that go on.
    pub(super) beta: [Spectrum; LANES],
    pub(super) rays: [Ray; LANES],
}

/// The steps of eight paths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    /// `k_a I_a` times the throughput.
    pub(super) ambient: [Spectrum; LANES],
    /// The first of the lights that illuminate any of them, and the end.
    pub(super) lights: [usize; 2],
    /// The reflected rays, and the refracted ones.
    pub(super) branches: [BranchRays; 2],
    pub(super) materials: [u32; LANES],
    /// Bit i for lane i: whether the ray hit the outside.
    pub(super) front: u32,
}

/// The light of one source on eight surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromLight {
    pub(super) light: u32,
    /// Bit i for lane i: whether it contributes light, unless it is occluded.
    pub(super) lit: u32,
    pub(super) contribution: [Spectrum; LANES],
    /// The shares of diffuse reflection, where layers need them.
    pub(super) diffuse: [Spectrum; LANES],
    /// To the light.
    pub(super) rays: [Ray; LANES],
}

/// The end of the list of lights, for those of the next group.
pub(super) struct NextLights<'a> {
    lights: &'a mut Vec<FromLight>,
    count: &'a mut usize,
}

impl NextLights<'_> {
    /// Number of the next one.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        *self.count
    }

    /// The next one.
    #[inline(always)]
    pub(super) fn add(&mut self) -> &mut FromLight {
        next(self.lights, self.count, FromLight::NONE)
    }
}

impl Groups {
    /// Removes all.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.rewind(End { groups: 0, lights: 0 });
    }

    /// The end of the list of groups.
    #[inline(always)]
    pub(super) fn end(&self) -> End {
        End { groups: self.count, lights: self.light_count }
    }

    /// Removes the groups from an end on.
    #[inline(always)]
    pub(super) fn rewind(&mut self, end: End) {
        (self.count, self.light_count) = (end.groups, end.lights);
        self.told.truncate(end.groups);
    }

    /// Number of groups.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// A group, the lights on it and what is told of it, if there is a group of this number.
    #[inline(always)]
    pub(super) fn get(&self, number: usize) -> Option<(&Group, &[FromLight], Option<&Told>)> {
        let group = self.groups.get(number)?;
        let [first, end] = group.lights;
        Some((group, &self.lights[first..end], self.told.get(number)))
    }

    /// The next group to be computed, and the lights on it.
    #[inline(always)]
    pub(super) fn next(&mut self) -> (&mut Group, NextLights<'_>) {
        let Self { groups, count, lights, light_count, .. } = self;
        (next(groups, count, Group::EMPTY), NextLights { lights, count: light_count })
    }

    /// Adds what a probe is told of the last group.
    pub(super) fn tell(&mut self, told: Told) {
        self.told.push(told);
    }
}

/// The next of the values of a memory that is reused.
#[inline(always)]
fn next<'a, T: Copy>(memory: &'a mut Vec<T>, count: &mut usize, empty: T) -> &'a mut T {
    if *count == memory.len() {
        memory.push(empty);
    }
    *count += 1;
    &mut memory[*count - 1]
}

impl BranchRays {
    const NONE: Self =
        Self { exist: 0, beta: [Spectrum::BLACK; LANES], rays: [Ray::new([0.0; 3], [0.0; 3]); LANES] };
}

impl Group {
    const EMPTY: Self = Self {
        ambient: [Spectrum::BLACK; LANES],
        lights: [0; 2],
        branches: [BranchRays::NONE; 2],
        materials: [0; LANES],
        front: 0,
    };
}

impl FromLight {
    const NONE: Self = Self {
        light: 0,
        lit: 0,
        contribution: [Spectrum::BLACK; LANES],
        diffuse: [Spectrum::BLACK; LANES],
        rays: [Ray::new([0.0; 3], [0.0; 3]); LANES],
    };
}
