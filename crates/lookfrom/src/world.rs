//! What light meets: a scene compiled to flat arrays and integer ids, frozen.
//!
//! *Render space* is the world translated so that its origin is the eye of the scene's camera: f32 is finest where the
//! picture looks closest.
//! After [`World::compile`] nothing fails but cancellation.

mod catcher;
mod compile;
mod lights;
mod place;
mod reflectance;

use std::sync::Arc;

use glam::{DMat4, DVec3, Vec2, Vec3};
use lookfrom_bvh::{Bvh, Hit, NONE, OriginPrimitive, Ray};
use lookfrom_scene::material::{Color, MaterialKind, Scalar};
use lookfrom_scene::medium::{Medium, Sides};
use lookfrom_scene::scene::MediumId;

use crate::light::{Coverage, Light, LightChoice, Reference};
use crate::material::{self, Arrival, InteriorStack, Material, Shading};
use crate::math;
use crate::shape::{Form, FormPoint, Mesh, VertexData};
use crate::spectrum::Spectrum;
use crate::surface::Surface;
use crate::texture::{Lanes, TexturePoint, Textures, Usage};

/// What light meets.
#[derive(Debug)]
pub struct World {
    /// Where the origin of render space lies in the world.
    pub(crate) origin: DVec3,
    /// Everything that rays can meet.
    pub(crate) bvh: Bvh,
    /// What stands in the world once, by the kernel's geometry id.
    pub(crate) forms: Vec<Form>,
    /// Objects, which instances repeat: forms by geometry id.
    pub(crate) objects: Vec<Vec<Form>>,
    /// By the kernel's instance id.
    pub(crate) instances: Vec<Instance>,
    /// Looks of surfaces.
    pub(crate) materials: Vec<Material>,
    /// Parts of surfaces that are there, see [`Look::alpha`](crate::shape::Look::alpha).
    pub(crate) alphas: Vec<Scalar>,
    /// What fills bodies and space.
    pub(crate) media: Vec<Medium>,
    /// Whether what fills space counts ([`RenderSettings::media`](lookfrom_scene::settings::RenderSettings::media)).
    pub(crate) has_media: bool,
    /// Half the diagonal of the box around everything that is placed.
    pub(crate) radius: f32,
    /// What surfaces say is on their sides, see [`Look::sides`](crate::shape::Look::sides).
    pub(crate) sides: Vec<Sides>,
    /// Meshes with further texture coordinates or opacities, see [`Look::vertex_data`](crate::shape::Look::vertex_data).
    pub(crate) vertex_data: Vec<Arc<Mesh>>,
    /// Colours over surfaces.
    pub(crate) textures: Textures,
    /// Lights to be sampled.
    pub(crate) lights: Vec<Light>,
    /// Which light is asked where only one is.
    pub(crate) light_choice: LightChoice,
    /// Whitted's `I_a`.
    pub(crate) ambient: [f32; 3],
    /// Indices into `lights` of those that are seen where a ray meets nothing.
    pub(crate) environments: Vec<u32>,
    /// Whether any material lets light through.
    pub(crate) transmissive: bool,
    /// Whether rays pass any surface without meeting it: alpha, interfaces.
    pub(crate) has_gaps: bool,
    /// What arrives on the floor of shadows ([`MaterialKind::ShadowCatcher`]) from infinitely far where nothing is in the
    /// way, in linear Rec. 709; `None` where there is no such floor.
    pub(crate) catcher_irradiance: Option<[f32; 3]>,
    /// Names of the scene's materials and shapes, for people.
    pub(crate) names: Names,
}

/// Names, for people.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// By material index.
    pub materials: Vec<String>,
    /// By shape number.
    pub shapes: Vec<String>,
    /// By light index.
    pub lights: Vec<String>,
}

/// A repetition of an object.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into the world's objects.
    pub object: u32,
    /// From the object's space to render space.
    pub render_from_object: DMat4,
    /// And back.
    pub object_from_render: DMat4,
    /// Takes the place of the materials in the object.
    pub material: Option<u32>,
}

impl World {
    /// Where the origin of render space lies in the world.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// What a ray is inside of that starts in a medium, and in no body.
    pub(crate) fn space_of(&self, medium: Option<MediumId>) -> InteriorStack {
        InteriorStack::in_space(medium.filter(|_| self.has_media))
    }

    /// Everything that rays can meet.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Lights to be sampled.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// How one of the lights is chosen to be sampled.
    pub fn light_choice(&self) -> &LightChoice {
        &self.light_choice
    }

    /// The form that a hit belongs to and its instance, where it is in one.
    pub fn form(&self, hit: &Hit) -> (&Form, Option<&Instance>) {
        if hit.instance == NONE {
            return (&self.forms[hit.geometry as usize], None);
        }
        let instance = &self.instances[hit.instance as usize];
        (&self.objects[instance.object as usize][hit.geometry as usize], Some(instance))
    }

    /// The surface that `ray` met.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let [origin, direction] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v).as_dvec3());
        let of_form = match self.form(hit) {
            (form, None) => form.point(hit, origin, direction),
            (form, Some(instance)) => {
                let (origin, direction) = instance.in_object(origin, direction);
                instance.place(form.point(hit, origin, direction))
            }
        };
        let wo = -direction.normalize();
        let FormPoint { point, ng, ns, uv, dpdu, dpdv, shading_dpdu, shading_dpdv, color, look } = of_form;
        Surface {
            point,
            ng,
            ns: ns.as_vec3(),
            uv,
            dpdu: dpdu.as_vec3(),
            dpdv: dpdv.as_vec3(),
            shading_dpdu: shading_dpdu.as_vec3(),
            shading_dpdv: shading_dpdv.as_vec3(),
            color,
            wo: wo.as_vec3(),
            front: ng.dot(wo) > 0.0,
            material: look.material,
            light: look.light,
            single_sided: look.single_sided,
            vertex_data: look.vertex_data,
            alpha: look.alpha.map(|index| self.alphas[index as usize]),
            sides: look.sides.map(|index| self.sides[index as usize]),
            shape: look.shape,
            primitive: hit.primitive,
            left: OriginPrimitive::of(hit),
            on_primitive: Vec2::new(hit.u, hit.v),
        }
    }

    /// What a texture may depend on at a surface.
    pub fn texture_point(&self, surface: &Surface) -> TexturePoint {
        let world = self.origin + DVec3::from_array(surface.point.position);
        let point = TexturePoint {
            uv: surface.uv,
            world,
            color: surface.color,
            n: surface.ng.as_vec3(),
            ..TexturePoint::NOWHERE
        };
        let Some(index) = surface.vertex_data else { return point };
        let Vec2 { x: u, y: v } = surface.on_primitive;
        let mesh = &self.vertex_data[index as usize];
        let VertexData { more_uvs, opacity } = mesh.vertex_data(surface.primitive as usize, u, v);
        TexturePoint { more_uvs, opacity, ..point }
    }

    /// Whether a surface is where a ray met it: by its alpha, where that is a matter of chance for `u ∈ [0, 1)`.
    pub fn is_there(&self, surface: &Surface, u: f32) -> bool {
        surface.alpha.is_none_or(|alpha| u < self.textures.scalar(alpha, &self.texture_point(surface)))
    }

    /// Whether chance has a say in what a surface is: by its alpha, or by its material.
    pub fn is_chancy(&self, surface: &Surface) -> bool {
        self.materials[surface.material as usize].is_chancy() || surface.alpha.is_some()
    }

    /// Whether a surface is only the border of a medium.
    pub fn is_interface(&self, surface: &Surface) -> bool {
        matches!(self.materials[surface.material as usize].kind, MaterialKind::Interface)
    }

    /// What a surface does with light: see [`material::shading`].
    pub fn shading(&self, surface: &Surface, arrival: Arrival<'_>) -> Option<Shading> {
        if self.catcher_irradiance.is_some() && self.is_catcher(surface) {
            return Some(Shading::matte(surface, self.catcher_reflectance(surface, arrival.lanes)));
        }
        let point = self.texture_point(surface);
        material::shading(&self.materials, &self.textures, surface, &point, arrival)
    }

    /// Radiance that a surface gives off toward `wo`.
    pub fn emitted(&self, surface: &Surface, lanes: &Lanes) -> Spectrum {
        match surface.light.map(|index| &self.lights[index as usize]) {
            Some(Light::Area(light)) => {
                let cos = || surface.ns.dot(surface.wo);
                light.emitted(&self.textures, &self.texture_point(surface), surface.front, cos, lanes)
            }
            _ => Spectrum::BLACK,
        }
    }

    /// Radiance that a surface is seen with, whatever the light, which no one asks for: `None` for all but unlit materials.
    pub fn unlit(&self, surface: &Surface, lanes: &Lanes) -> Option<Spectrum> {
        let MaterialKind::Unlit { color } = &self.materials[surface.material as usize].kind else {
            return None;
        };
        Some(self.textures.spectrum(*color, Usage::Illuminant, &self.texture_point(surface), lanes))
    }

    /// Radiance that arrives along a ray that meets nothing.
    pub fn sky(&self, ray: &Ray, lanes: &Lanes) -> Spectrum {
        self.environments.iter().fold(Spectrum::BLACK, |sum, &index| sum + self.sky_of(index, ray, lanes))
    }

    /// Radiance of one environment, by its light's index, along a ray that meets nothing.
    pub fn sky_of(&self, index: u32, ray: &Ray, lanes: &Lanes) -> Spectrum {
        let [origin, direction] = [ray.origin, ray.direction].map(Vec3::from_array);
        match &self.lights[index as usize] {
            Light::Environment(environment) => {
                environment.radiance(&self.textures, origin.as_dvec3(), direction.normalize(), lanes)
            }
            _ => Spectrum::BLACK,
        }
    }

    /// The density over solid angle with which asking one light from a place finds `light` in the unit direction `wi`, in
    /// which a ray met it at `surface` (nowhere for an environment).
    pub fn light_pdf(&self, light: u32, at: &Reference, wi: Vec3, surface: Option<&Surface>) -> f32 {
        let probability = self.light_choice.probability(at, light);
        if probability == 0.0 {
            return 0.0;
        }
        probability * self.lights[light as usize].pdf(at, wi, surface, Coverage::Incomplete)
    }

    /// What is left of light after `distance` in what it is inside of (Beer's law). After an infinite one nothing is left in
    /// space that is filled with what absorbs, and all in a body, which must end somewhere although its end was not met.
    #[inline]
    pub fn transmittance(&self, media: InteriorStack, distance: f32, lanes: &Lanes) -> Spectrum {
        if media.is_empty() { lanes.one() } else { self.transmittance_inside(media, distance, lanes) }
    }

    #[inline(never)]
    fn transmittance_inside(&self, media: InteriorStack, distance: f32, lanes: &Lanes) -> Spectrum {
        let medium = media.medium(&self.materials).and_then(|index| self.media.get(index as usize));
        let Some(medium) = medium else { return lanes.one() };
        if distance.is_infinite() && media.space().is_none() {
            return lanes.one();
        }
        let sigma =
            self.textures.spectrum(medium.absorption, Usage::Unbounded, &TexturePoint::NOWHERE, lanes);
        if medium.scale == 0.0 {
            return lanes.one();
        }
        let length = medium.scale * distance;
        lanes.one() * sigma.map(|sigma| if sigma == 0.0 { 1.0 } else { libm::expf(-sigma * length) })
    }

    /// Whitted's `I_a`.
    pub fn ambient(&self, lanes: &Lanes) -> Spectrum {
        self.light_of(self.ambient, lanes)
    }

    /// Light of a colour.
    pub fn light_of(&self, rgb: [f32; 3], lanes: &Lanes) -> Spectrum {
        self.textures.spectrum(Color::Value(rgb), Usage::Illuminant, &TexturePoint::NOWHERE, lanes)
    }
}

impl Instance {
    /// A ray's origin and direction in the object's space; its t stays the same.
    pub fn in_object(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        let to_object = &self.object_from_render;
        (to_object.transform_point3(origin), to_object.transform_vector3(direction))
    }

    /// A point of the object, in render space.
    fn place(&self, of_object: FormPoint) -> FormPoint {
        let vector = |v: DVec3| self.render_from_object.transform_vector3(v);
        let normal = |n: DVec3| math::transform_normal(&self.object_from_render, n).normalize();
        let mut look = of_object.look;
        look.material = self.material.unwrap_or(look.material);
        FormPoint {
            point: of_object.point.transformed(&math::affine(&self.render_from_object)),
            ng: normal(of_object.ng),
            ns: normal(of_object.ns),
            dpdu: vector(of_object.dpdu),
            dpdv: vector(of_object.dpdv),
            shading_dpdu: vector(of_object.shading_dpdu),
            shading_dpdv: vector(of_object.shading_dpdv),
            look,
            ..of_object
        }
    }
}
