//! The world: a scene compiled to flat arrays and integer ids, frozen.
//!
//! *Render space* is the world translated so that its origin is the position of the scene's camera: f32 is finest near
//! the camera. Views from elsewhere share it as long as they are precise ([`World::is_precise_from`]). After
//! [`World::compile`] a scene causes no further errors.

mod catcher;
mod class;
mod compile;
mod guide;
mod ignored;
mod instance;
mod instancing;
mod lights;
mod measured;
mod medium;
mod memory;
mod numbers;
mod objects;
mod origin;
mod place;
mod precision;
mod quality;
mod reflectance;
mod sides;

use class::Class;
pub(crate) use class::{HitClass, ShapeClass};
pub(crate) use compile::Kept;
pub(crate) use instance::Instance;
pub use instance::PlacedInstance;
pub(crate) use measured::MeasuredSurface;
use medium::EndOfSpace;
pub use objects::Objects;

use std::fmt;
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Bvh, Hit, NONE, OriginPrimitive, Ray};
use lookfrom_scene::Location;
use lookfrom_scene::scene::MediumId;
use lookfrom_scene::shape::Pieces;

use crate::core::spectrum::Spectrum;
use crate::light::{ChosenLight, IncompletePdf, Light, LightChoice, LightSample, LightSampleContext};
use crate::medium::Medium;
use crate::primitive::{Mesh, Primitives, SurfacePoint, VertexData};
use crate::shading::footprint::PixelFootprint;
use crate::shading::interaction::SurfaceInteraction;
use crate::shading::interior_stack::{InteriorStack, MediumInterface};
use crate::shading::material::{self, Material, MaterialKind, Relief, Shading, ShadingContext};
use crate::shading::texture::{
    PicturedFloat, SpectralMode, SpectrumTexture, SpectrumType, TexturePoint, Textures, spectrum_of,
};

/// A scene compiled for light transport: geometry, materials, media and lights.
///
/// A clone shares geometry and materials; only the lights are its own.
#[derive(Clone, Debug)]
pub struct World {
    /// The origin of render space, in the world.
    pub(crate) origin: DVec3,
    /// The BVH over everything that rays can hit.
    pub(crate) bvh: Arc<Bvh>,
    /// Primitives that are not instanced, by the kernel's geometry id.
    pub(crate) primitives: Arc<[Primitives]>,
    /// Objects, which instances repeat: primitives by geometry id.
    pub(crate) objects: Arc<[Vec<Primitives>]>,
    /// Classes of the primitives that are not instanced, by the kernel's geometry id.
    classes: Arc<[Class]>,
    /// The classes of the objects.
    object_classes: Arc<[Vec<Class>]>,
    /// Instances, by the kernel's instance id.
    pub(crate) instances: Arc<[Instance]>,
    /// Materials of surfaces.
    pub(crate) materials: Arc<[Material]>,
    /// Alpha textures, see [`MaterialBinding::alpha`](crate::primitive::MaterialBinding::alpha).
    pub(crate) alphas: Vec<PicturedFloat>,
    /// Media that fill bodies and space.
    pub(crate) media: Vec<Medium>,
    /// Whether media that fill space count
    /// ([`RenderSettings::media`](lookfrom_scene::settings::RenderSettings::media)).
    pub(crate) has_media: bool,
    /// Half the diagonal of the bounding box of all primitives.
    pub(crate) radius: f32,
    /// The end of media that fill space; `None` if they have none
    /// ([`RenderSettings::endless_media`](lookfrom_scene::settings::RenderSettings::endless_media)).
    pub(crate) end_of_space: Option<EndOfSpace>,
    /// Media on the two sides of surfaces, see
    /// [`MaterialBinding::medium_interface`](crate::primitive::MaterialBinding::medium_interface).
    pub(crate) medium_interfaces: Vec<MediumInterface>,
    /// Meshes with further texture coordinates or opacities, see
    /// [`MaterialBinding::vertex_data`](crate::primitive::MaterialBinding::vertex_data).
    pub(crate) vertex_data: Vec<Arc<Mesh>>,
    /// Textures.
    pub(crate) textures: Arc<Textures>,
    /// The lights.
    pub(crate) lights: Vec<Light>,
    /// The light sampler.
    pub(crate) light_choice: Arc<LightChoice>,
    /// Whitted's `I_a`.
    pub(crate) ambient: SpectrumTexture,
    /// Indices into `lights` of the environments, which rays that hit nothing see.
    pub(crate) environments: Vec<u32>,
    /// Whether any surface transmits light.
    pub(crate) transmissive: bool,
    /// Whether any surface is a pane ([`Material::is_pane`]).
    pub(crate) has_panes: bool,
    /// Whether rays from any direction may pass any surface as if it were not there: alpha, medium interfaces, hidden lights.
    pub(crate) has_holes: bool,
    /// Whether the camera sees no shapes that emit light
    /// ([`RenderSettings::hide_lights`](lookfrom_scene::settings::RenderSettings::hide_lights)).
    pub(crate) hides_lights: bool,
    /// Whether single-sided surfaces mostly face inward: then their fronts are open to light ([`World::is_open_front`]).
    pub(crate) has_open_fronts: bool,
    /// Unoccluded irradiance of the shadow catcher ([`MaterialKind::ShadowCatcher`]) from lights infinitely far away,
    /// in linear Rec. 709; `None` where there is no shadow catcher.
    pub(crate) catcher_irradiance: Option<[f32; 3]>,
    /// Names of the scene's materials, shapes and lights, for reports.
    pub(crate) names: Arc<Names>,
    /// The pixels of the camera that sees it, by which bump maps and filtered textures are read; `None` before there is one.
    pub(crate) footprint: Option<PixelFootprint>,
}

/// Names, for reports.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Names of materials, by index.
    pub materials: Vec<String>,
    /// Labels of shapes, by index.
    pub shapes: Vec<ShapeLabel>,
    /// Names of lights, by index.
    pub lights: Vec<String>,
    /// Names of objects, by index.
    pub objects: Vec<String>,
    /// Names of instances, by index; empty where the scene names none.
    pub instances: Vec<Option<Arc<String>>>,
}

/// The label of a shape, for reports and masks: every shape has one, which tells it from others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShapeLabel {
    /// Its name in the scene; of a shape without one, a name by its material and kind.
    pub name: String,
    /// The location of a shape without a name.
    pub at: Option<Location>,
    /// The pieces of its mesh that have names of their own.
    pub pieces: Pieces,
}

impl ShapeLabel {
    /// The label of one of its primitives: that of the shape, or the name of a piece.
    pub fn of(&self, primitive: u32) -> String {
        self.pieces.name_of(primitive).map_or_else(|| self.to_string(), str::to_owned)
    }
}

impl fmt::Display for ShapeLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.at {
            None => f.write_str(&self.name),
            Some(at) => write!(f, "{} ({at})", self.name),
        }
    }
}

impl World {
    /// The origin of render space, in the world.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The interior stack of a ray that starts in a medium, and in no body.
    pub(crate) fn space_of(&self, medium: Option<MediumId>) -> InteriorStack {
        InteriorStack::in_space(medium.filter(|_| self.has_media))
    }

    /// The BVH over everything that rays can hit.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The lights.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Names of materials, shapes and lights.
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// The light sampler.
    pub fn light_choice(&self) -> &LightChoice {
        &self.light_choice
    }

    /// The primitives that a hit belongs to.
    #[inline]
    pub(crate) fn primitives_of(&self, hit: &Hit) -> &Primitives {
        match hit.instance {
            NONE => &self.primitives[hit.geometry as usize],
            id => &self.objects[self.instances[id as usize].object as usize][hit.geometry as usize],
        }
    }

    /// The primitives that a hit belongs to and the instance, if it is in one, at a time of the shutter (0 … 1).
    ///
    /// # Panics
    /// As [`World::surface`].
    #[inline]
    pub fn primitives(&self, hit: &Hit, time: f32) -> (&Primitives, Option<PlacedInstance<'_>>) {
        let instance = (hit.instance != NONE).then(|| self.instance(hit.instance, time));
        (self.primitives_of(hit), instance)
    }

    /// The surface interaction of `ray` at `hit`; of what moves when the shutter opens.
    ///
    /// # Panics
    /// If the ray hit nothing ([`Hit::is_hit`]), or something of another world.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        self.surface_at(ray, hit, 0.0)
    }

    /// The point where `ray` met `hit` at a time of the shutter (0 … 1), in render space. Texture coordinates may be 0 where they are
    /// not wanted.
    pub(crate) fn surface_point(&self, ray: &Ray, hit: &Hit, time: f32, wants_uv: bool) -> SurfacePoint {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        match self.primitives(hit, time) {
            (primitives, None) => primitives.point(hit, [origin, direction], time, wants_uv),
            (primitives, Some(instance)) => {
                let (origin, direction) = instance.in_object(origin, direction);
                instance.place(primitives.point(hit, [origin, direction], time, wants_uv))
            }
        }
    }

    /// The surface interaction of `ray` at `hit` at a time of the shutter (0 … 1), at which the ray was traced.
    ///
    /// # Panics
    /// As [`World::surface`].
    pub fn surface_at(&self, ray: &Ray, hit: &Hit, time: f32) -> SurfaceInteraction {
        let SurfacePoint { point, ng, ns, uv, dpdu, dpdv, shading_dpdu, shading_dpdv, lift, color, binding } =
            self.surface_point(ray, hit, time, true);
        let wo = -Vec3::from_array(ray.direction).as_dvec3().normalize();
        SurfaceInteraction {
            point,
            ng,
            ns: ns.as_vec3(),
            uv,
            dpdu: dpdu.as_vec3(),
            dpdv: dpdv.as_vec3(),
            shading_dpdu: shading_dpdu.as_vec3(),
            shading_dpdv: shading_dpdv.as_vec3(),
            lift: lift.as_vec3(),
            color,
            wo: wo.as_vec3(),
            front: ng.dot(wo) > 0.0,
            material: binding.material,
            light: binding.light,
            single_sided: binding.single_sided,
            vertex_data: binding.vertex_data,
            alpha: binding.alpha.map(|index| self.alphas[index as usize].texture),
            medium_interface: binding.medium_interface.map(|index| self.medium_interfaces[index as usize]),
            shape: binding.shape,
            primitive: hit.primitive,
            origin_primitive: OriginPrimitive::of(hit),
            on_primitive: Vec2::new(hit.u, hit.v),
        }
    }

    /// The places, at other times and in render space, of the surface point that `ray` met at `hit` at a time of the shutter.
    pub(crate) fn point_at<const N: usize>(
        &self,
        ray: &Ray,
        hit: &Hit,
        time: f32,
        times: [f32; N],
    ) -> [DVec3; N] {
        let (primitives, instance) = self.primitives(hit, time);
        let still = || {
            let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
            let (origin, direction) =
                instance.map_or((origin, direction), |instance| instance.in_object(origin, direction));
            DVec3::from_array(primitives.point(hit, [origin, direction], time, false).point.position)
        };
        let in_object = match primitives {
            Primitives::Mesh(mesh) => {
                let weights = [1.0 - hit.u - hit.v, hit.u, hit.v].map(f64::from);
                times.map(|time| {
                    let corners = mesh.corners_at(hit.primitive as usize, time);
                    (0..3).map(|k| weights[k] * Vec3::from_array(corners[k]).as_dvec3()).sum()
                })
            }
            _ => [still(); N],
        };
        std::array::from_fn(|k| match instance {
            None => in_object[k],
            Some(_) => {
                self.instance(hit.instance, times[k]).render_from_object().transform_point3(in_object[k])
            }
        })
    }

    /// The inputs of texture evaluation at a surface.
    pub fn texture_point(&self, surface: &SurfaceInteraction) -> TexturePoint<'_> {
        let world = self.origin + DVec3::from_array(surface.point.position);
        let point = TexturePoint {
            uv: surface.uv,
            world,
            color: surface.color,
            n: surface.ng.as_vec3(),
            is_inside: !surface.front,
            ..TexturePoint::NOWHERE
        };
        let Some(index) = surface.vertex_data else { return point };
        let Vec2 { x: u, y: v } = surface.on_primitive;
        let mesh = &self.vertex_data[index as usize];
        let VertexData { more_uvs, opacity } = mesh.vertex_data(surface.primitive as usize, u, v);
        TexturePoint { more_uvs, opacity, ..point }
    }

    /// [`World::texture_point`] with the footprint of pixels, where the surface's material depends on it.
    #[inline]
    pub(crate) fn shading_point(&self, surface: &SurfaceInteraction) -> TexturePoint<'_> {
        let mut point = self.texture_point(surface);
        if let Some(pixels) = &self.footprint
            && self.materials[surface.material as usize].needs_footprint
        {
            point.footprint = Some(pixels.at(point.world, surface.ng, [surface.dpdu, surface.dpdv]));
        }
        point
    }

    /// [`World::texture_point`] of a hit on the outside of a surface without vertex data, by position and geometric normal, and texture coordinates.
    #[inline]
    pub(crate) fn texture_point_at(
        &self,
        (position, n): ([f64; 3], Vec3),
        uv: [f32; 2],
    ) -> TexturePoint<'static> {
        let world = self.origin + DVec3::from_array(position);
        TexturePoint { uv: uv.into(), world, n, ..TexturePoint::NOWHERE }
    }

    /// As [`World::texture_point_at`], with the vertex data of a mesh.
    #[inline]
    pub(crate) fn texture_point_on_mesh<'a>(
        &self,
        mesh: &Mesh,
        hit: &Hit,
        at: ([f64; 3], Vec3),
        uv: [f32; 2],
    ) -> TexturePoint<'a> {
        mesh.completed(self.texture_point_at(at, uv), hit.primitive as usize, hit.u, hit.v)
    }

    /// The alpha test: whether the surface exists where a ray hit it. Stochastic for alpha between 0 and 1, by `u ∈ [0,
    /// 1)`; none passes it for `u ≥ 1`.
    pub fn passes_alpha_test(&self, surface: &SurfaceInteraction, u: f32) -> bool {
        u < surface.alpha.map_or(1.0, |alpha| self.textures.float(alpha, &self.texture_point(surface)))
    }

    /// The part of the light that a surface does not let pass on the way from the camera, as if it were not there: 0 … 1.
    pub(crate) fn opacity(&self, surface: &SurfaceInteraction) -> f32 {
        let is_hidden = surface.single_sided && !surface.front || self.is_hidden_light(surface);
        if is_hidden || self.is_interface(surface) {
            return 0.0;
        }
        let alpha = surface.alpha.map(|alpha| self.textures.float(alpha, &self.texture_point(surface)));
        alpha.map_or(1.0, |alpha| alpha.clamp(0.0, 1.0))
    }

    /// Whether evaluating a surface needs random numbers: for its alpha, or for its material.
    pub fn is_stochastic(&self, surface: &SurfaceInteraction) -> bool {
        self.materials[surface.material as usize].is_stochastic()
            || surface.alpha.is_some()
            || self.is_open_front(surface)
    }

    /// Whether the BSDF of a surface takes a seed ([`ShadingContext::seed`]).
    pub(crate) fn takes_seed(&self, surface: &SurfaceInteraction) -> bool {
        self.materials[surface.material as usize].takes_seed()
    }

    /// Whether materials depend on the footprint of pixels.
    pub(crate) fn needs_footprint(&self) -> bool {
        self.materials.iter().any(|material| material.heights().is_some() || material.needs_footprint)
    }

    /// This world seen by a camera with these pixels.
    pub(crate) fn seen_by(self: Arc<Self>, footprint: PixelFootprint) -> Arc<Self> {
        match self.footprint == Some(footprint) {
            true => self,
            false => Arc::new(Self { footprint: Some(footprint), ..(*self).clone() }),
        }
    }

    /// Data that shading frames are bent by.
    pub(crate) fn relief(&self) -> Relief<'_> {
        Relief { textures: &self.textures, footprint: self.footprint.as_ref(), step: Relief::STEP }
    }

    /// Whether a surface emits light and the camera does not see it.
    pub(crate) fn is_hidden_light(&self, surface: &SurfaceInteraction) -> bool {
        self.hides_lights && surface.light.is_some()
    }

    /// Whether a surface is only an interface between media.
    pub fn is_interface(&self, surface: &SurfaceInteraction) -> bool {
        matches!(self.materials[surface.material as usize].kind, MaterialKind::Interface)
    }

    /// The BSDF of a surface: see [`material::shading`].
    pub fn shading(&self, surface: &SurfaceInteraction, arrival: ShadingContext<'_>) -> Option<Shading> {
        if self.is_catcher(surface) {
            return Some(Shading::matte(surface, self.catcher_reflectance(surface, arrival.mode)));
        }
        let point = self.shading_point(surface);
        material::shading(&self.materials, self.relief(), surface, &point, arrival)
    }

    /// Radiance that a surface emits toward `wo`.
    pub fn emitted(&self, surface: &SurfaceInteraction, mode: &SpectralMode) -> Spectrum {
        match surface.light.map(|index| &self.lights[index as usize]) {
            Some(Light::Area(light)) => {
                let cos = || surface.ns.dot(surface.wo);
                light.emitted(&self.textures, &self.texture_point(surface), surface.front, cos, mode)
            }
            _ => Spectrum::BLACK,
        }
    }

    /// The constant radiance of an unlit material; `None` for all others.
    pub fn unlit(&self, surface: &SurfaceInteraction, mode: &SpectralMode) -> Option<Spectrum> {
        let MaterialKind::Unlit { color, .. } = &self.materials[surface.material as usize].kind else {
            return None;
        };
        Some(self.textures.spectrum(color, &self.shading_point(surface), mode))
    }

    /// Radiance that arrives along a ray that hits nothing.
    pub fn sky(&self, ray: &Ray, mode: &SpectralMode) -> Spectrum {
        self.environments.iter().fold(Spectrum::BLACK, |sum, &index| sum + self.sky_of(index, ray, mode))
    }

    /// [`World::sky`], where it is the same along all rays.
    pub(crate) fn even_sky(&self, mode: &SpectralMode) -> Option<Spectrum> {
        self.environments.iter().try_fold(Spectrum::BLACK, |sum, &index| match &self.lights[index as usize] {
            Light::Environment(environment) => Some(sum + environment.even(&self.textures, mode)?),
            _ => Some(sum + Spectrum::BLACK),
        })
    }

    /// Radiance of one environment, by its light's index, along a ray that hits nothing.
    pub fn sky_of(&self, index: u32, ray: &Ray, mode: &SpectralMode) -> Spectrum {
        let [origin, direction] = [ray.origin, ray.direction].map(Vec3::from_array);
        match &self.lights[index as usize] {
            Light::Environment(environment) => {
                environment.radiance(&self.textures, origin.as_dvec3(), direction.normalize(), mode)
            }
            _ => Spectrum::BLACK,
        }
    }

    /// A sample of one of the lights from a point, by `u ∈ [0, 1)²`: the light's index and the sample, whose density includes
    /// that of the choice. `None` if no light arrives. Lights that only surround the scene evenly may be left to chance, as
    /// [`Self::light_pdf`] tells: it is 0 for their directions.
    pub fn sample_light(
        &self,
        at: &LightSampleContext,
        [which, v]: [f32; 2],
        mode: &SpectralMode,
    ) -> Option<(u32, LightSample)> {
        let ChosenLight { light, probability, rest } = self.light_choice.sample(at, which)?;
        let u = [rest, v];
        let sample =
            self.lights[light as usize].sample(&self.textures, at, u, mode, IncompletePdf::Allowed)?;
        Some((light, LightSample { pdf: probability * sample.pdf, ..sample }))
    }

    /// The solid angle density of the unit direction `wi` in light sampling, the choice of the light included. A ray in
    /// that direction hit `light` at `surface` (`None` for an environment).
    pub fn light_pdf(
        &self,
        light: u32,
        at: &LightSampleContext,
        wi: Vec3,
        surface: Option<&SurfaceInteraction>,
    ) -> f32 {
        let probability = self.light_choice.probability(at, light);
        if probability == 0.0 {
            return 0.0;
        }
        probability * self.lights[light as usize].pdf(at, wi, surface, IncompletePdf::Allowed)
    }

    /// This world with its environment maps rotated by `rotation`, in the world: geometry and materials are shared,
    /// no BVH is built.
    #[must_use]
    pub fn with_surroundings_turned(&self, rotation: &DMat3) -> Self {
        let turn = |light: &Light| match light {
            Light::Environment(environment) => {
                Light::Environment(environment.turned(rotation, &self.textures))
            }
            light => light.clone(),
        };
        let mut turned = Self { lights: self.lights.iter().map(turn).collect(), ..self.clone() };
        turned.catcher_irradiance = turned.unoccluded_irradiance();
        turned
    }

    /// Whitted's `I_a`.
    pub fn ambient(&self, mode: &SpectralMode) -> Spectrum {
        self.textures.spectrum(&self.ambient, &TexturePoint::NOWHERE, mode)
    }

    /// The illuminant spectrum of a colour.
    pub fn light_of(&self, rgb: [f32; 3], mode: &SpectralMode) -> Spectrum {
        spectrum_of(rgb, SpectrumType::Illuminant, mode)
    }
}
