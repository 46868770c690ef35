//! Reachable parts of a scene's arenas: those that shapes, lights and cameras use. The rest is not written.

use super::roughness::squared;
use crate::material::{Color, Material, MaterialKind, Scalar};
use crate::medium::Density;
use crate::scene::{MaterialId, MediumId, Scene, TextureId};
use crate::shape::{Geometry, Shape};

/// By number, whether it is used.
pub(super) struct Reached {
    pub(super) objects: Vec<bool>,
    pub(super) materials: Vec<bool>,
    pub(super) textures: Vec<bool>,
    pub(super) media: Vec<bool>,
}

impl Reached {
    pub(super) fn of(scene: &Scene) -> Self {
        let mut reached = Self {
            objects: vec![false; scene.objects.len()],
            materials: vec![false; scene.materials.len()],
            textures: vec![false; scene.textures.len()],
            media: vec![false; scene.media.len()],
        };
        for instance in &scene.instances {
            let object = instance.object.index();
            // An instance of nothing is nothing.
            reached.objects[object] = !scene.objects[object].shapes.is_empty();
            instance.material.into_iter().for_each(|material| reached.material(scene, material));
        }
        scene.shapes.iter().for_each(|shape| reached.shape(scene, shape));
        for (object, _) in scene.objects.iter().zip(reached.objects.clone()).filter(|(_, is_used)| *is_used) {
            object.shapes.iter().for_each(|shape| reached.shape(scene, shape));
        }
        reached.medium(scene, scene.camera.as_ref().and_then(|camera| camera.medium));
        reached
    }

    fn shape(&mut self, scene: &Scene, shape: &Shape) {
        self.material(scene, shape.material);
        let emission = shape.emission.map(|emission| emission.radiance);
        emission.into_iter().for_each(|color| self.color(scene, color));
        shape.alpha.into_iter().for_each(|alpha| self.scalar(scene, alpha));
        let sides = shape.sides.map(|sides| [sides.inside, sides.outside]);
        sides.into_iter().flatten().for_each(|medium| self.medium(scene, medium));
        if let Geometry::Mesh(mesh) = shape.geometry {
            let displacement = scene.meshes[mesh.index()].displacement;
            displacement.into_iter().for_each(|height| self.scalar(scene, height));
        }
    }

    fn material(&mut self, scene: &Scene, id: MaterialId) {
        if std::mem::replace(&mut self.materials[id.index()], true) {
            return;
        }
        let material: &Material = &scene.materials[id.index()];
        material.textures().into_iter().for_each(|texture| self.texture(scene, texture));
        self.medium(scene, material.medium);
        if let MaterialKind::Mix { materials, .. } = &material.kind {
            materials.iter().for_each(|part| self.material(scene, *part));
        }
    }

    fn texture(&mut self, scene: &Scene, id: TextureId) {
        let id = squared(scene, id).unwrap_or(id);
        if std::mem::replace(&mut self.textures[id.index()], true) {
            return;
        }
        scene.textures[id.index()].kind.parts().into_iter().for_each(|part| self.color(scene, part));
    }

    fn color(&mut self, scene: &Scene, color: Color) {
        if let Color::Texture(id) = color {
            self.texture(scene, id);
        }
    }

    fn scalar(&mut self, scene: &Scene, scalar: Scalar) {
        if let Scalar::Texture(id) = scalar {
            self.texture(scene, id);
        }
    }

    fn medium(&mut self, scene: &Scene, id: Option<MediumId>) {
        let Some(id) = id else { return };
        if std::mem::replace(&mut self.media[id.index()], true) {
            return;
        }
        if let Some(variation) = &scene.media[id.index()].variation
            && let Density::Texture { of, .. } = variation.density
        {
            self.scalar(scene, of);
        }
    }
}
