//! Hits shaded in lanes from the hit on, or from its point on.

use glam::{DVec3, Vec3};
use lookfrom_bvh::{Hit, OriginPrimitive, Sphere};
use lookfrom_scene::material::BackFace;
use lookfrom_simd::LaneMask;

use super::Memory;
use super::by_class::MaterialHits;
use super::class_points::{ClassPoints, PointsKernel};
use super::vertices::VertexColumns;
use crate::aov::FirstSurfaceColumns;
use crate::core::lanes::{LANES, bitmask, by_lane, lanes_where, row, set_row};
use crate::core::points::StoredPlacement;
use crate::integrator::path::{Departure, HitBatch, Path, PathTracer, StepOutput};
use crate::integrator::wavefront::{Boundary, Eight};
use crate::integrator::{Event, Probe};
use crate::primitive::{MaterialBinding, Mesh, Primitives, SphereBinding};
use crate::shading::bsdf::{Bsdf, BsdfClass};
use crate::shading::footprint::PixelFootprint;
use crate::shading::material::{self, Material, Shading};
use crate::shading::texture::{LookUps, TexturePoint};
use crate::world::{HitClass, ShapeClass, World};

impl<'a> HitBatch<'a> {
    /// Whether a path travels in no medium and comes from no shadow catcher.
    #[inline]
    pub(in crate::integrator) fn is_in_vacuum(&self, index: usize) -> bool {
        let path = &self.paths[index];
        self.world.medium(path.interior).is_none() && !path.state.is_catcher
    }
}

/// A path that met a surface whose material has BSDFs of a class.
#[derive(Clone, Copy)]
pub(super) struct ClassHit<'a> {
    pub(super) path: &'a Path,
    pub(super) hit: &'a Hit,
    pub(super) binding: &'a MaterialBinding,
    /// The material: that of the binding, or one that this is mixed of.
    pub(super) material: &'a Material,
    /// Its index.
    pub(super) material_index: u32,
}

impl ClassHit<'_> {
    /// Whether its material varies, or it has an alpha.
    #[inline]
    fn varies(&self) -> bool {
        self.material.varies || self.binding.alpha.is_some()
    }

    /// Whether the material is one that the surface's is mixed of.
    #[inline]
    fn is_chosen(&self) -> bool {
        self.material_index != self.binding.material
    }

    /// Whether the path passes the surface where it hit the back of it.
    #[inline]
    fn passes_back_faces(&self) -> bool {
        self.binding.single_sided && !self.path.blurred
    }
}

/// Shapes of eight hits, all of one kind.
pub(super) enum Shapes<'a> {
    /// Meshes, and the placements of the instances that they are in.
    Meshes([(&'a Mesh, Option<StoredPlacement<'a>>); LANES]),
    Spheres([(&'a Sphere, &'a SphereBinding); LANES]),
    /// Others, and the times at which they were hit.
    Others([(&'a Primitives, f32); LANES]),
}

/// Eight hits on shapes of one kind. Unused lanes repeat the last hit.
pub(super) struct ClassHits<'a> {
    pub(super) hits: [ClassHit<'a>; LANES],
    pub(super) shapes: Shapes<'a>,
    /// Whether any material varies, or any surface has an alpha.
    pub(super) vary: bool,
    /// Lanes of camera rays whose surfaces AOVs need; without mixed materials, of which AOVs show the mean and not the chosen one.
    pub(super) are_first: u32,
    /// The pixels of the camera, if any material depends on their footprint.
    pub(super) pixels: Option<&'a PixelFootprint>,
}

impl PathTracer {
    /// The class of a path that met a surface whose material has BSDFs of a class, and is to go on from there.
    #[inline]
    pub(in crate::integrator::path) fn hit_class(
        &self,
        world: &World,
        path: &Path,
        hit: &Hit,
    ) -> Option<HitClass> {
        if path.depth < self.depth { world.hit_class(hit) } else { None }
    }

    /// Scatters up to eight paths of a batch that met shapes of one kind, of one class of BSDFs.
    pub(super) fn scatter_hits<P: Probe>(
        &self,
        (shape, class): (ShapeClass, BsdfClass),
        batch: &HitBatch<'_>,
        eight: &Eight<'_>,
        memory: &mut Memory,
        output: &mut StepOutput<'_, P>,
    ) {
        let world = batch.world;
        let Memory { points, scattered } = memory;
        let first_surfaces = &output.queues.first_surfaces;
        let is_first = |path: &Path| path.is_root() && first_surfaces.are_left_in(path.interior);
        let indices = (eight.paths, Some(eight.materials));
        let Some(class_hits) = ClassHits::of(batch, shape, indices, is_first, |path| output.time(path))
        else {
            return;
        };
        let hits = &class_hits.hits;

        // Find the points; paths from the camera pass the back faces of single-sided shapes.
        PointsKernel { world, class_hits: &class_hits, points }.set_points();
        let active = class_hits.pass_back_faces(eight.paths.len(), points, output);
        if active == 0 {
            return;
        }

        // Evaluate the materials, bend the frames, and scatter.
        let mut look_ups = None;
        let varying = class_hits.texture_points(world, points, &mut look_ups);
        let (varying, wants_shares) = (varying.as_ref(), output.light_paths.is_some());
        let materials = MaterialHits { tracer: self, batch, hits, varying, wants_shares };
        let mut told = [None; LANES];
        let listener = P::LISTENS.then_some(&mut told);
        let are_scattered = materials.scatter(class, points, &mut output.queues, scattered, listener);
        if P::LISTENS {
            tell_of_shading(world, (hits, active), &told, points, output);
        }
        let first = active & class_hits.are_first;
        if first != 0 {
            let opaque = class_hits.are_opaque(world, points);
            let block = output.queues.first_surfaces.block();
            class_hits.leave(world, first & opaque, varying, points, block);
            output.queues.first_surfaces.leave_block();
        }
        if !are_scattered {
            return;
        }

        // Go on, but from what is black from behind.
        let active = active & !class_hits.are_black(&points.surfaces);
        let front = points.front;
        let departure = |lane: usize| {
            let ClassHit { path, hit, binding, .. } = hits[lane];
            let origin_primitive = OriginPrimitive::of(hit);
            let MaterialBinding { material, medium_interface: interface, .. } = *binding;
            let boundary = Boundary::Bare { material, interface, front: front & 1 << lane != 0 };
            (Departure { path, origin_primitive, boundary }, false)
        };
        self.go_on(world, departure, active, scattered, output);
    }
}

impl<'a> ClassHits<'a> {
    /// Hits about which chance has still to decide, on shapes of one kind.
    pub(super) fn undecided(
        batch: &HitBatch<'a>,
        shape: ShapeClass,
        indices: &[u32],
        time: impl Fn(&Path) -> f32,
    ) -> Option<Self> {
        Self::of(batch, shape, (indices, None), |_| false, time)
    }

    /// Hits of paths of a batch, by their indices, on shapes of one kind, of materials by theirs: those of the surfaces, where they are
    /// not given.
    #[inline(always)]
    fn of(
        batch: &HitBatch<'a>,
        shape: ShapeClass,
        (indices, materials): (&[u32], Option<&[u32]>),
        is_first: impl Fn(&Path) -> bool,
        time: impl Fn(&Path) -> f32,
    ) -> Option<Self> {
        let index = |lane: usize| indices[lane.min(indices.len() - 1)] as usize;
        let (world, all) = (batch.world, batch.hits);
        let (shapes, bindings) = match shape {
            ShapeClass::Mesh => {
                let meshes = by_lane!(lane => world.mesh(&all[index(lane)])?);
                (Shapes::Meshes(meshes), by_lane!(lane => &meshes[lane].0.binding))
            }
            ShapeClass::Sphere => {
                let spheres = by_lane!(lane => world.sphere(&all[index(lane)])?);
                (Shapes::Spheres(spheres), by_lane!(lane => &spheres[lane].1.binding))
            }
            ShapeClass::Other => {
                let others = by_lane!(lane => {
                    (world.primitives_of(&all[index(lane)]), time(&batch.paths[index(lane)]))
                });
                let binding = |lane: usize| others[lane].0.binding(all[index(lane)].primitive as usize);
                (Shapes::Others(others), by_lane!(lane => binding(lane)))
            }
        };
        let material = |lane: usize| match materials {
            Some(materials) => materials[lane.min(indices.len() - 1)],
            None => bindings[lane].material,
        };
        let hits = by_lane!(lane => ClassHit {
            path: &batch.paths[index(lane)],
            hit: &all[index(lane)],
            binding: bindings[lane],
            material: &world.materials[material(lane) as usize],
            material_index: material(lane),
        });
        let vary = hits.iter().any(ClassHit::varies);
        let are_first = bitmask(&by_lane!(lane => !hits[lane].is_chosen() && is_first(hits[lane].path)));
        let needs_footprint = vary && hits.iter().any(|hit| hit.material.needs_footprint);
        let pixels = world.footprint.as_ref().filter(|_| needs_footprint);
        Some(Self { hits, shapes, vary, are_first, pixels })
    }

    /// Lets those of the first hits whose paths have met the back of a surface, and pass it there, go on. Returns the lanes of the others.
    #[inline(always)]
    pub(super) fn pass_back_faces<P: Probe>(
        &self,
        count: usize,
        points: &ClassPoints,
        output: &mut StepOutput<'_, P>,
    ) -> u32 {
        let active = (1 << count) - 1;
        let backs = lanes_where(active & !points.front, |lane| self.hits[lane].passes_back_faces());
        self.go_on_behind(backs, points, output);
        active & !backs
    }

    /// Whether texture coordinates are wanted.
    #[inline(always)]
    pub(super) fn wants_uvs(&self) -> bool {
        self.vary || self.are_first != 0
    }

    /// The lanes that see surfaces from behind which are black there.
    #[inline(always)]
    fn are_black(&self, surfaces: &VertexColumns) -> u32 {
        let black = bitmask(&by_lane!(lane => self.hits[lane].material.back_face == BackFace::Black));
        lanes_where(black, |lane| {
            let [wo, ns] = [surfaces.wo(lane), surfaces.ns(lane)].map(Vec3::from);
            wo.dot(ns) <= 0.0
        })
    }

    /// The alphas; 1 where there are none.
    pub(super) fn alphas(&self, world: &World, points: &ClassPoints) -> [f32; LANES] {
        if self.hits.iter().all(|hit| hit.binding.alpha.is_none()) {
            return [1.0; LANES];
        }
        let alphas =
            by_lane!(lane => self.hits[lane].binding.alpha.map(|alpha| &world.alphas[alpha as usize]));
        let mut at = self.points_alone(world, points);
        at.iter_mut().for_each(|point| point.footprint = None);
        let values = world.textures.floats(&alphas, &at);
        by_lane!(lane => if alphas[lane].is_some() { values[lane] } else { 1.0 })
    }

    /// The lanes that show nothing of what is behind.
    fn are_opaque(&self, world: &World, points: &ClassPoints) -> u32 {
        let alphas = self.alphas(world, points);
        bitmask(&by_lane!(lane => alphas[lane] >= 1.0))
    }

    /// The texture points of materials that vary, with what their pictures are there, if any does.
    #[inline(always)]
    fn texture_points<'b>(
        &'b self,
        world: &'b World,
        points: &ClassPoints,
        look_ups: &'b mut Option<LookUps>,
    ) -> Option<[TexturePoint<'b>; LANES]> {
        if !self.vary {
            return None;
        }
        let mut points = self.points_alone(world, points);
        let pictures = by_lane!(lane => &self.hits[lane].material.pictures);
        *look_ups = world.textures.look_up_lanes(&pictures, &points);
        if let Some(look_ups) = look_ups {
            for (lane, point) in points.iter_mut().enumerate() {
                point.looked_up = Some(look_ups.of(pictures[lane], lane));
            }
        }
        Some(points)
    }

    /// The texture points of hits that vary.
    #[inline(always)]
    pub(super) fn points_alone(
        &self,
        world: &World,
        ClassPoints { surfaces, uv, front, footprints, .. }: &ClassPoints,
    ) -> [TexturePoint<'a>; LANES] {
        let mut points = [TexturePoint::NOWHERE; LANES];
        for (lane, hit) in self.hits.iter().enumerate().filter(|(_, hit)| hit.varies()) {
            let at = (surfaces.position(lane), DVec3::from_array(surfaces.ng(lane)).as_vec3());
            points[lane] = match &self.shapes {
                Shapes::Meshes(meshes) => {
                    world.texture_point_on_mesh(meshes[lane].0, hit.hit, at, row(uv, lane))
                }
                Shapes::Spheres(_) => world.texture_point_at(at, row(uv, lane)),
                Shapes::Others(others) => match others[lane].0 {
                    Primitives::Mesh(mesh) => world.texture_point_on_mesh(mesh, hit.hit, at, row(uv, lane)),
                    _ => world.texture_point_at(at, row(uv, lane)),
                },
            };
            points[lane].is_inside = front & 1 << lane == 0;
            if self.pixels.is_some() && hit.material.needs_footprint {
                points[lane].footprint = Some(footprints.of(lane));
            }
        }
        points
    }

    /// Leaves the surfaces of camera rays, in the lanes of a mask, to AOVs.
    #[inline(never)]
    fn leave(
        &self,
        world: &World,
        lanes: u32,
        varying: Option<&[TexturePoint<'_>; LANES]>,
        ClassPoints { surfaces, uv, bent, .. }: &ClassPoints,
        first: &mut FirstSurfaceColumns,
    ) {
        surfaces.leave(first);
        (first.lanes, first.ns, first.uv) = (lanes, bent.ns, *uv);
        for lane in LaneMask(first.lanes) {
            let hit = &self.hits[lane];
            let point = varying.map_or(&TexturePoint::NOWHERE, |points| &points[lane]);
            let albedo = material::albedo(&world.materials, &world.textures, hit.material, point);
            set_row(&mut first.albedo, lane, albedo);
            if hit.material.has_bumps() {
                set_row(&mut first.ns, lane, surfaces.ns(lane));
            }
            first.slots[lane] = hit.path.slot;
        }
    }
}

/// Tells a probe of the surfaces and their BSDFs, in the frames of the lanes.
#[cold]
fn tell_of_shading<P: Probe>(
    world: &World,
    (hits, active): (&[ClassHit<'_>; LANES], u32),
    bsdfs: &[Option<Bsdf>; LANES],
    points: &ClassPoints,
    output: &mut StepOutput<'_, P>,
) {
    for lane in LaneMask(active) {
        let (ClassHit { path, hit, material, .. }, Some(bsdf)) = (&hits[lane], bsdfs[lane]) else { continue };
        let surface = world.surface_at(&path.ray, hit, output.time(path));
        let (axes, guard) = (points.surfaces.axes(lane), points.surfaces.guard(lane));
        output.probe.notice(|| Event::Shaded {
            address: path.address,
            shading: Box::new(Shading::in_frame(material, &surface, axes, guard, bsdf)),
            surface: Box::new(surface),
            beta: path.beta,
        });
    }
}
