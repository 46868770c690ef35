//! Learning of guides: by rays from visited points into all directions, first from few groups of them, then from many
//! into those directions in which the environment was seen.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::gain::{Lit, Moments, gain};
use super::octahedron::Direction;
use super::{CLASSES, Guide, Histogram, Node, SIDE, class_of};
use crate::core::hash;
use crate::core::warp;
use crate::light::{Environment, IncompletePdf, LightSampleContext};
use crate::shading::texture::{SpectralMode, Textures};

/// Points of a group from which all directions are tested.
const GROUP: usize = 512;

/// The least number of points of a leaf.
const LEAF: usize = 24;

/// Rays into each cell of directions, from a group and from a leaf.
const RAYS: u32 = 8;

/// The weight of a group's visibility in that of its leaves, in rays.
const PRIOR: f32 = 0.1;

/// Rays of a group or a leaf into directions that would be sampled without a guide.
const UNGUIDED_RAYS: u32 = 128;

/// The share of them that find the environment from which on a guide would not help: of a group, and of a leaf.
const OPEN: f32 = 0.4;
const BRIGHT: f32 = 0.15;

/// The least part of the samples that is worth a histogram.
const LEAST_SHARE: f32 = 0.1;

/// The part of the sphere that is as bright as its brightest direction, as far as histograms are concerned: what is brighter, like the
/// sun, is found without guides.
const BRIGHTEST: f64 = 0.01;

/// Directions along each side of a cell by which its brightness is known.
const PARTS: usize = 8;

/// A point that paths visit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GuidePoint {
    /// In render space.
    pub(crate) point: Vec3,
    /// The normal with which lights are sampled there; zero in a medium.
    pub(crate) n: Vec3,
    /// The normal to the side that the path came from; zero in a medium.
    pub(crate) facing: Vec3,
    /// Whether light from the other side counts as well.
    pub(crate) transmits: bool,
}

impl GuidePoint {
    /// A key by which points are in an order that does not depend on how they were found, and as if at random.
    pub(crate) fn key(&self) -> (u64, [u32; 10]) {
        let Self { point, n, facing, transmits } = *self;
        let [point, n, facing] = [point, n, facing].map(|v| v.to_array().map(f32::to_bits));
        let mut bits = [u32::from(transmits); 10];
        bits[1..].copy_from_slice(&[point, n, facing].concat());
        (hash::of_bytes(bits.iter().flat_map(|bits| bits.to_le_bytes())), bits)
    }
}

/// A ray whose visibility is asked for: the index of a point, and a unit direction.
pub(crate) type Query = (u32, Vec3);

/// The radiance of an environment by cells of directions, without the excess of its brightest directions.
struct CellLight {
    /// The integral of the radiance over the solid angle of each cell of directions.
    cells: Vec<f32>,
    /// The largest radiance that counts.
    most: f32,
}

/// Estimates of the irradiance by single samples of the environment without a guide.
struct Unguided {
    /// The share of samples that find the environment.
    found: f32,
    /// The moments of the estimates.
    all: Moments,
    /// The moments of the estimates by radiance above [`CellLight::most`].
    excess: Moments,
    /// The mean estimate by a sample that finds the environment, weighted by the estimate.
    of_one: f32,
}

struct Learner<'a> {
    environment: &'a Environment,
    textures: &'a Textures,
    points: &'a [GuidePoint],
    /// The part of the light from outside that arrives along each ray.
    visibility: &'a dyn Fn(&[Query]) -> Vec<f32>,
    /// The radiance of the environment by cells.
    light: CellLight,
    guide: Guide,
    /// The irradiance in leaves that see the environment.
    lit: Vec<Lit>,
    /// Number of random numbers taken.
    count: u64,
}

impl Guide {
    /// The guide to an environment from points that paths visit; `None` where its estimated gain is `least_gain` or less.
    pub(crate) fn learn(
        environment: &Environment,
        textures: &Textures,
        points: &[GuidePoint],
        visibility: &dyn Fn(&[Query]) -> Vec<f32>,
        least_gain: f32,
    ) -> Option<Self> {
        let light = CellLight::of(environment, textures);
        let guide = Self::default();
        let mut learner =
            Learner { environment, textures, points, visibility, light, guide, lit: Vec::new(), count: 0 };
        for class in 0..CLASSES {
            let is_of_class = |index: &u32| class_of(points[*index as usize].n) == class;
            let mut members: Vec<u32> = (0..points.len() as u32).filter(is_of_class).collect();
            if members.len() >= LEAF {
                learner.guide.roots[class] = Some(learner.branch(&mut members, None));
            }
        }
        (gain(&learner.lit, points.len()) > least_gain).then_some(learner.guide)
    }
}

impl Learner<'_> {
    /// Adds the subtree of these points, with the visibility from the group that they belong to, if they are of one. Returns its
    /// root.
    fn branch(&mut self, members: &mut [u32], of_group: Option<&[f32]>) -> u32 {
        let mut own = Vec::new();
        let of_group = of_group.or_else(|| {
            (members.len() <= GROUP).then(|| {
                own = self.visibility_of_group(members);
                own.as_slice()
            })
        });
        let node = self.guide.nodes.len() as u32;
        self.guide.nodes.push(Node::leaf(None));
        if of_group.is_some_and(<[f32]>::is_empty) {
            return node;
        }
        match self.split(members) {
            Some((axis, at, middle)) => {
                let (first, others) = members.split_at_mut(middle);
                self.branch(first, of_group);
                let second = self.branch(others, of_group);
                self.guide.nodes[node as usize] = Node::split(axis, at, second);
            }
            None => {
                let own;
                let of_group = match of_group {
                    Some(of_group) => of_group,
                    None => {
                        own = self.visibility_of_group(members);
                        &own
                    }
                };
                if let Some(histogram) = self.histogram(members, of_group) {
                    self.guide.nodes[node as usize] = Node::leaf(Some(self.guide.histograms.len() as u32));
                    self.guide.histograms.push(histogram);
                }
            }
        }
        node
    }

    /// Halves points along the longest side of their box where that is possible, else along another, and orders them; `None` where they
    /// are few, or in one place. Returns the axis, the coordinate from which on they are in the second half, and the number of the
    /// others.
    fn split(&self, members: &mut [u32]) -> Option<(usize, f32, usize)> {
        if members.len() < 2 * LEAF {
            return None;
        }
        let place = |index: u32| self.points[index as usize].point;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &index in members.iter() {
            (low, high) = (low.min(place(index)), high.max(place(index)));
        }
        let size = high - low;
        let mut axes = [0, 1, 2];
        axes.sort_by(|a, b| size[*b].total_cmp(&size[*a]));
        axes.into_iter().find_map(|axis| {
            let coordinate = |index: u32| place(index)[axis];
            members.sort_unstable_by(|a, b| coordinate(*a).total_cmp(&coordinate(*b)).then(a.cmp(b)));
            // Most of them may be on a wall, and few in front of it: a half then begins behind the wall, or at it.
            let middle = coordinate(members[members.len() / 2]);
            let begins = [
                members.partition_point(|&index| coordinate(index) < middle),
                members.partition_point(|&index| coordinate(index) <= middle),
            ];
            let begin = begins.into_iter().find(|begin| (LEAF..=members.len() - LEAF).contains(begin))?;
            Some((axis, coordinate(members[begin]), begin))
        })
    }

    /// The visibility of each cell of directions from a group, weighted by the cosine and blurred; empty where nothing is visible or a
    /// guide would not help.
    fn visibility_of_group(&mut self, members: &[u32]) -> Vec<f32> {
        let unguided = self.unguided(members);
        if unguided.found > OPEN {
            self.lit.push(Lit::without(members.len(), unguided.all));
            return Vec::new();
        }
        let mut sharp = vec![0.0; SIDE * SIDE];
        self.add_visibility(members, |_| true, &mut sharp);
        if sharp.iter().all(|seen| *seen == 0.0) {
            return Vec::new();
        }
        blurred(&sharp)
    }

    /// The histogram of a leaf, blurred: an opening is seen in other directions from its other points. Its part of the samples is
    /// in proportion to the light that it finds, as is that of the others: with one sample of two strata, this has the least variance.
    fn histogram(&mut self, members: &[u32], of_group: &[f32]) -> Option<Histogram> {
        if of_group.is_empty() {
            return None;
        }
        let unguided = self.unguided(members);
        if unguided.found > BRIGHT {
            self.lit.push(Lit::without(members.len(), unguided.all));
            return None;
        }
        let mut weights: Vec<f32> = of_group.iter().map(|prior| PRIOR * prior).collect();
        self.add_visibility(members, |cell| of_group[cell] > 0.0, &mut weights);
        let mut weights = blurred(&weights);
        weights.iter_mut().zip(&self.light.cells).for_each(|(weight, light)| *weight *= light);
        let irradiance = weights.iter().sum::<f32>() / (RAYS as f32 * (1.0 + PRIOR));
        let share = irradiance / (irradiance + unguided.excess.square.sqrt());
        if irradiance == 0.0 || share < LEAST_SHARE {
            self.lit.push(Lit::without(members.len(), unguided.all));
            return None;
        }
        let share = share.min(self.environment.most_guided());
        self.lit.push(Lit::with(members.len(), share, irradiance, unguided.of_one, unguided.excess));
        Histogram::new(&weights, share)
    }

    /// Adds to cells of directions how much of the environment rays see, times the cosine.
    fn add_visibility(&mut self, members: &[u32], is_tested: impl Fn(usize) -> bool, cells: &mut [f32]) {
        let (mut queries, mut weights) = (Vec::new(), Vec::new());
        for cell in (0..SIDE * SIDE).filter(|cell| is_tested(*cell)) {
            for _ in 0..RAYS {
                let (index, [s, t]) = self.any(members);
                let place = [(cell % SIDE) as f32 + s, (cell / SIDE) as f32 + t];
                let wi = Direction::of_square(place.map(|x| x / SIDE as f32 * 2.0 - 1.0)).unit();
                let weight = self.points[index as usize].cosine(wi);
                if weight > 0.0 {
                    queries.push((index, wi));
                    weights.push((cell, weight));
                }
            }
        }
        for ((cell, weight), seen) in weights.into_iter().zip((self.visibility)(&queries)) {
            cells[cell] += weight * seen;
        }
    }

    /// Estimates of the irradiance at points without a guide.
    fn unguided(&mut self, members: &[u32]) -> Unguided {
        let (queries, lights): (Vec<_>, Vec<_>) =
            (0..UNGUIDED_RAYS).filter_map(|_| self.unguided_ray(members)).unzip();
        let seen = (self.visibility)(&queries);
        let arrived = |of: usize| seen.iter().zip(&lights).map(move |(seen, light)| seen * light[of]);
        let unhindered = Moments::of(lights.iter().map(|[all, _]| *all), UNGUIDED_RAYS);
        Unguided {
            found: seen.iter().sum::<f32>() / UNGUIDED_RAYS as f32,
            all: Moments::of(arrived(0), UNGUIDED_RAYS),
            excess: Moments::of(arrived(1), UNGUIDED_RAYS),
            of_one: if unhindered.mean > 0.0 { unhindered.square / unhindered.mean } else { 0.0 },
        }
    }

    /// A ray into a direction that is sampled without a guide: as light samples, or, where they leave an environment to BSDFs, by the
    /// cosine. With the estimate of the irradiance by this ray, and that by its excess.
    fn unguided_ray(&mut self, members: &[u32]) -> Option<(Query, [f32; 2])> {
        let (index, u) = self.any(members);
        let point = &self.points[index as usize];
        let (wi, pdf) = match self.environment.is_uneven() {
            true => {
                let at = LightSampleContext { point: point.point.as_dvec3(), n: point.n, time: 0.0 };
                let (textures, mode) = (self.textures, SpectralMode::Rgb);
                let sample = self.environment.sample(textures, &at, u, &mode, IncompletePdf::Allowed)?;
                (sample.wi, sample.pdf)
            }
            false if point.facing == Vec3::ZERO => (warp::uniform_sphere(u), 0.25 * FRAC_1_PI),
            false => {
                let wi = warp::cosine_hemisphere(u, point.facing);
                (wi, point.cosine(wi) * FRAC_1_PI)
            }
        };
        let cos = point.cosine(wi);
        let li = brightness(self.environment, self.textures, wi);
        (cos > 0.0).then_some(((index, wi), [li, (li - self.light.most).max(0.0)].map(|li| li * cos / pdf)))
    }

    /// Any of these points, and two numbers in [0, 1).
    fn any(&mut self, members: &[u32]) -> (u32, [f32; 2]) {
        self.count += 1;
        let (which, u) = (hash::pair(self.count, 0), hash::pair(self.count, 1));
        let number = |bits: u64| (bits & 0xff_ffff) as f32 / 16_777_216.0;
        (members[(which % members.len() as u64) as usize], [number(u), number(u >> 32)])
    }
}

impl GuidePoint {
    /// Weight of light from a unit direction: the cosine, or 1 in a medium.
    fn cosine(&self, wi: Vec3) -> f32 {
        if self.facing == Vec3::ZERO {
            return 1.0;
        }
        let cos = self.facing.dot(wi);
        if self.transmits { cos.abs() } else { cos.max(0.0) }
    }
}

/// Cells of directions, each with a part of its neighbours: a quarter of those beside it along each side.
fn blurred(cells: &[f32]) -> Vec<f32> {
    let along = |cells: &[f32], step: usize| -> Vec<f32> {
        let place = |cell: usize| cell / step % SIDE;
        let part = |cell: usize| {
            let before = if place(cell) > 0 { cells[cell - step] } else { 0.0 };
            let after = if place(cell) + 1 < SIDE { cells[cell + step] } else { 0.0 };
            0.25 * (before + after) + 0.5 * cells[cell]
        };
        (0..SIDE * SIDE).map(part).collect()
    };
    along(&along(cells, 1), SIDE)
}

/// The radiance of an environment from a unit direction, of its brightest channel.
fn brightness(environment: &Environment, textures: &Textures, wi: Vec3) -> f32 {
    environment.color(textures, wi, &SpectralMode::Rgb).rgb().into_iter().fold(0.0, f32::max)
}

impl CellLight {
    fn of(environment: &Environment, textures: &Textures) -> Self {
        // The radiance from the middles of parts of cells, and the solid angles of those.
        const FINE: usize = SIDE * PARTS;
        const AREA: f64 = 4.0 / (FINE * FINE) as f64;
        let part = |index: usize| {
            let place = [index % FINE, index / FINE].map(|i| (i as f32 + 0.5) / FINE as f32 * 2.0 - 1.0);
            let direction = Direction::of_square(place);
            let length = f64::from(direction.length());
            (brightness(environment, textures, direction.unit()), AREA / (length * length * length))
        };
        let parts: Vec<(f32, f64)> = (0..FINE * FINE).map(part).collect();

        // The radiance that a part of the sphere exceeds.
        let mut by_brightness = parts.clone();
        by_brightness.sort_unstable_by(|(a, _), (b, _)| b.total_cmp(a));
        let mut left = BRIGHTEST * parts.iter().map(|(_, angle)| angle).sum::<f64>();
        let brightest = by_brightness.into_iter().find(|(_, angle)| {
            left -= angle;
            left <= 0.0
        });
        let most = brightest.map_or(0.0, |(brightness, _)| brightness);

        let mut cells = vec![0.0; SIDE * SIDE];
        for (index, (brightness, angle)) in parts.into_iter().enumerate() {
            let cell = index / FINE / PARTS * SIDE + index % FINE / PARTS;
            cells[cell] += brightness.min(most) * angle as f32;
        }
        Self { cells, most }
    }
}
