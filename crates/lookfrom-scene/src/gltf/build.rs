//! Assembly of a scene from a file's nodes, meshes, materials, camera and lights.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};

use super::camera::{self, Cameras, Eye};
use super::choose::choose;
use super::contents::contents;
use super::file::Document;
use super::json::{Instancing, Primitive, Whole};
use super::light;
use super::material::{Colors, MaterialBinding, MaterialBindings, VertexColors};
use super::mesh;
use super::morph::morph;
use super::node::{Tree, placed};
use super::pose::{self, Pose};
use super::skin::Skin;
use crate::contents::Contents;
use crate::error::{Location, Result};
use crate::files::LoadContext;
use crate::light::Light;
use crate::load;
use crate::scene::{Instance, MeshId, Object, ObjectId, Scene};
use crate::shape::{Geometry, Mesh, Part, Shape};

/// The maximum number of triangles in copies of one mesh; with more, the copies become instances, which take less
/// memory but are slower to trace.
const MOST_REPEATED_TRIANGLES: usize = 1 << 18;

/// The parts of a scene that are not added directly: meshes, materials and images already are.
pub(super) struct Model {
    shapes: Vec<Shape>,
    objects: Vec<Object>,
    /// Instances of `objects`.
    instances: Vec<Instance>,
    eye: Option<Eye>,
    lights: Vec<Light>,
    contents: Contents,
}

impl Model {
    /// Moves everything into a scene that has no objects yet.
    pub(super) fn into_scene(self, scene: &mut Scene) {
        if let Some(Eye { camera, aspect }) = self.eye {
            scene.camera = Some(camera);
            if let Some(aspect) = aspect {
                (scene.image.width, scene.image.height) = size(aspect, scene.image.width);
            }
        }
        scene.shapes = self.shapes;
        scene.objects = self.objects;
        scene.instances = self.instances;
        scene.lights = self.lights;
        scene.contents = self.contents;
    }

    /// Everything as a part of another scene, which takes its instances one by one.
    pub(super) fn into_parts(self) -> load::Model {
        let repeated = self.instances.iter().flat_map(|instance| {
            let shapes = &self.objects[instance.object.index()].shapes;
            shapes.iter().map(|shape| {
                let part = part(shape, &instance.world_from_object);
                Part { name: instance.name.as_deref().cloned().or(part.name), ..part }
            })
        });
        let parts = self.shapes.iter().map(|shape| part(shape, &DMat4::IDENTITY)).chain(repeated).collect();
        load::Model { parts, is_gltf: true, camera: self.eye.map(|eye| eye.camera), lights: self.lights }
    }
}

fn part(shape: &Shape, world_from_object: &DMat4) -> Part {
    Part {
        material: Some(shape.material),
        emission: shape.emission,
        alpha: shape.alpha,
        single_sided: shape.single_sided,
        world_from_object: *world_from_object * shape.world_from_object,
        ..Part::new(shape.name.clone(), shape.geometry.clone())
    }
}

/// Width and height of an image of this aspect ratio, the larger of them `most`.
fn size(aspect: f64, most: u32) -> (u32, u32) {
    let smaller = |aspect: f64| ((f64::from(most) / aspect).round() as u32).max(1);
    if aspect >= 1.0 { (most, smaller(aspect)) } else { (smaller(1.0 / aspect), most) }
}

/// Reads everything, in the pose of the animation with this index if there is one; images are decoded last, in parallel.
pub(super) fn model(
    document: &Document,
    animation: Option<usize>,
    context: &mut LoadContext<'_>,
    scene: &mut Scene,
) -> Result<Model> {
    let Pose { local, weights } = pose::pose(document, animation, context)?;
    let tree = Tree::new(document, local, context)?;
    let cameras = Cameras::new(document, &tree)?;
    let variant = match (&context.import.variant, &document.root.extensions.variants) {
        (None, _) => None,
        (Some(name), variants) => {
            let variants = variants.as_ref().map_or(&[][..], |variants| &variants.variants);
            let names = variants.iter().map(|variant| variant.name.as_deref());
            Some(choose(document, "variant", "/extensions/KHR_materials_variants/variants", name, names)?)
        }
    };
    let mut builder = Builder {
        document,
        bindings: MaterialBindings::new(document),
        primitives: BTreeMap::new(),
        weights,
        variant,
        model: Model {
            shapes: Vec::new(),
            objects: Vec::new(),
            instances: Vec::new(),
            eye: camera::eye(&cameras, &tree, context)?,
            lights: light::lights(document, &tree, context)?,
            contents: contents(document, &tree, &cameras),
        },
        context,
        scene,
    };
    builder.nodes(&tree)?;
    let Builder { bindings, model, .. } = builder;
    bindings.decode(context, scene);
    if model.shapes.is_empty() && model.instances.is_empty() {
        context
            .warn(&document.at(""), "there is nothing to see: the scene has no triangles, lines or points");
    }
    Ok(model)
}

/// A primitive of a mesh, with its material.
#[derive(Clone)]
struct ConvertedPrimitive {
    pointer: Location,
    geometry: Geometry,
    binding: MaterialBinding,
    /// The world transform of a skinned mesh, which replaces that of its node.
    world_from_skinned: Option<DMat4>,
}

/// A mesh and its deformation: `node` is set where a node's own skin or morph weights deform it, and `None` for the
/// mesh that all other nodes share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct MeshVariant {
    mesh: usize,
    node: Option<usize>,
}

struct Builder<'b, 'd, 'f> {
    document: &'d Document,
    context: &'b mut LoadContext<'f>,
    scene: &'b mut Scene,
    bindings: MaterialBindings<'d>,
    /// The primitives of each mesh used so far.
    primitives: BTreeMap<MeshVariant, Vec<ConvertedPrimitive>>,
    /// Morph weights of nodes that override those of the mesh.
    weights: BTreeMap<usize, Vec<f64>>,
    variant: Option<usize>,
    model: Model,
}

impl Builder<'_, '_, '_> {
    fn nodes(&mut self, tree: &Tree) -> Result<()> {
        let nodes = &self.document.root.nodes;
        let mut uses: BTreeMap<MeshVariant, usize> = BTreeMap::new();
        for &node in &tree.shown {
            if let Some(mesh_variant) = self.mesh_variant(node) {
                *uses.entry(mesh_variant).or_default() += 1;
            }
        }
        let mut skins: BTreeMap<usize, Skin> = BTreeMap::new();
        let mut objects: BTreeMap<MeshVariant, ObjectId> = BTreeMap::new();
        if nodes.is_empty() && self.document.root.scenes.is_empty() {
            // A library of meshes: all are placed at the origin.
            for mesh in 0..self.document.root.meshes.len() {
                let primitives = self.mesh(MeshVariant { mesh, node: None }, None, "/meshes")?;
                let name = self.document.root.meshes[mesh].name.clone();
                for converted in &primitives {
                    self.shape(converted, &name, DMat4::IDENTITY)?;
                }
            }
        }
        for &node in &tree.shown {
            let Some(mesh_variant) = self.mesh_variant(node) else { continue };
            let skin = match nodes[node].skin.as_deref().copied() {
                Some(index) => {
                    if let Entry::Vacant(place) = skins.entry(index.index()) {
                        place.insert(Skin::new(self.document, index, &format!("/nodes/{node}/skin"), tree)?);
                    }
                    skins.get(&index.index())
                }
                None => None,
            };
            let primitives = self.mesh(mesh_variant, skin, &format!("/nodes/{node}/mesh"))?;
            let world_from_node = tree.world_from_node(node);
            let name = nodes[node]
                .name
                .clone()
                .or_else(|| self.document.root.meshes[mesh_variant.mesh].name.clone());
            if let Some(instancing) = nodes[node].instancing() {
                let places = self.places(instancing, node)?;
                let object = *objects.entry(mesh_variant).or_insert_with(|| self.object(&name, &primitives));
                let world_from_node = if skin.is_some() { DMat4::IDENTITY } else { world_from_node };
                let at = self.document.at(&format!("/nodes/{node}"));
                let memory = (places.len() * size_of::<Instance>()) as u64;
                self.context.keep(memory, "its instances", &at)?;
                for place in places {
                    self.instance(None, at.clone(), object, world_from_node * place);
                }
                continue;
            }
            let repeated = triangles(&primitives, self.scene).saturating_mul(uses[&mesh_variant] - 1);
            // Instances cannot be light sources.
            let shines = primitives.iter().any(|converted| converted.binding.emission.is_some());
            if repeated > MOST_REPEATED_TRIANGLES && !shines {
                let object = *objects.entry(mesh_variant).or_insert_with(|| self.object(&name, &primitives));
                // One location for all, which may be millions: that of the mesh.
                let at = self.model.objects[object.index()].at.clone();
                self.context.keep(size_of::<Instance>() as u64, "an instance", &at)?;
                let name = nodes[node].name.clone().map(Arc::new);
                self.instance(name, at, object, world_from_node);
                continue;
            }
            for converted in &primitives {
                self.shape(converted, &name, converted.world_from_skinned.unwrap_or(world_from_node))?;
            }
        }
        Ok(())
    }

    /// The mesh of a node, by itself where morph weights or a skin deform it.
    fn mesh_variant(&self, node: usize) -> Option<MeshVariant> {
        let root = &self.document.root;
        let index = root.nodes[node].mesh?.index();
        let has_targets = || {
            let primitives = root.meshes.get(index).map_or(&[][..], |mesh| &mesh.primitives);
            primitives.iter().any(|primitive| !primitive.targets.is_empty())
        };
        let is_own = root.nodes[node].skin.is_some() || (self.weights.contains_key(&node) && has_targets());
        Some(MeshVariant { mesh: index, node: is_own.then_some(node) })
    }

    /// The primitives of a mesh; each variant of it is built once.
    fn mesh(
        &mut self,
        mesh_variant: MeshVariant,
        skin: Option<&Skin>,
        asked: &str,
    ) -> Result<Vec<ConvertedPrimitive>> {
        let mesh = self.document.one_of(
            &self.document.root.meshes,
            Whole(mesh_variant.mesh as u64),
            "mesh",
            asked,
        )?;
        if let Some(primitives) = self.primitives.get(&mesh_variant) {
            return Ok(primitives.clone());
        }
        let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {}", mesh_variant.mesh));
        let weights = mesh_variant.node.and_then(|node| self.weights.get(&node).cloned());
        let weights = weights.or_else(|| mesh.weights.clone()).unwrap_or_default();
        let mut primitives = Vec::new();
        for (place, primitive) in mesh.primitives.iter().enumerate() {
            let pointer = format!("/meshes/{}/primitives/{place}", mesh_variant.mesh);
            primitives.extend(self.converted(primitive, &weights, skin, &name, &pointer)?);
        }
        self.primitives.insert(mesh_variant, primitives.clone());
        Ok(primitives)
    }

    fn converted(
        &mut self,
        primitive: &Primitive,
        weights: &[f64],
        skin: Option<&Skin>,
        name: &str,
        pointer: &str,
    ) -> Result<Vec<ConvertedPrimitive>> {
        let document = self.document;
        let at = document.at(pointer);
        let Some((mut vertices, mut memory)) = mesh::vertices(document, primitive, pointer, self.context)?
        else {
            return Ok(Vec::new());
        };
        if !primitive.targets.is_empty() {
            morph(document, &primitive.targets, weights, pointer, &mut vertices)?;
        }
        let mut world_from_skinned = None;
        if let Some(skin) = skin {
            let is_bent = skin.bend(document, primitive, pointer, &mut vertices)?;
            world_from_skinned = is_bent.then_some(skin.world_from_skinned);
        }
        let is_surface = mesh::is_surface(primitive);
        let vertex_colors = vertices.vertex_colors();
        let (material, asked) = self.material(primitive, pointer);
        if is_surface {
            vertices.grain =
                self.bindings.of_primitive(material, &asked, vertex_colors, self.context, self.scene)?.grain;
        }
        let mut primitives = Vec::new();
        let before = self.scene.meshes.len();
        memory.join(self.context.budget.reserve(mesh::memory(&vertices, primitive), "a primitive", &at)?);
        let geometries =
            mesh::geometry(document, primitive, vertices, name, pointer, self.context, self.scene)?;
        drop(memory);
        let meshes: u64 = self.scene.meshes[before..].iter().map(Mesh::bytes).sum();
        let others: u64 = geometries.iter().map(|(_, geometry)| geometry.bytes()).sum();
        self.context.keep(meshes + others, "a primitive", &at)?;
        for (color, geometry) in geometries {
            let colors = color.map_or(Colors::None, |color| Colors::One(color.map(f32::to_bits)));
            let vertex_colors =
                if is_surface { vertex_colors } else { VertexColors { colors, opacities: false } };
            let binding =
                self.bindings.of_primitive(material, &asked, vertex_colors, self.context, self.scene)?;
            primitives.push(ConvertedPrimitive {
                pointer: document.at(pointer),
                geometry,
                binding,
                world_from_skinned,
            });
        }
        Ok(primitives)
    }

    /// The material of a primitive in the selected variant, and the JSON pointer of its reference.
    fn material(&self, primitive: &Primitive, pointer: &str) -> (Option<Whole>, String) {
        if let (Some(variant), Some(own)) = (self.variant, &primitive.extensions.variants) {
            let is_meant = |variants: &[Whole]| variants.iter().any(|one| one.index() == variant);
            if let Some(place) = own.mappings.iter().position(|mapping| is_meant(&mapping.variants)) {
                let asked = format!("{pointer}/extensions/KHR_materials_variants/mappings/{place}/material");
                return (Some(own.mappings[place].material), asked);
            }
        }
        (primitive.material, format!("{pointer}/material"))
    }

    fn shape(
        &mut self,
        converted: &ConvertedPrimitive,
        name: &Option<String>,
        world_from_object: DMat4,
    ) -> Result<()> {
        let mut shape = shape(converted, name);
        if is_invertible(&world_from_object) {
            shape.world_from_object = world_from_object;
        } else {
            // Scaled by 0 along one axis, a mesh is flat, but still visible.
            let Geometry::Mesh(id) = converted.geometry else { return Ok(()) };
            let flat = mesh::flattened(&self.scene.meshes[id.index()], &world_from_object);
            if flat.triangles.is_empty() {
                return Ok(());
            }
            self.context.keep(flat.bytes(), "a flat copy of a mesh", &converted.pointer)?;
            shape.geometry = Geometry::Mesh(MeshId(self.scene.meshes.len() as u32));
            self.scene.meshes.push(flat);
        }
        self.context.keep(size_of::<Shape>() as u64, "a shape", &converted.pointer)?;
        self.model.shapes.push(shape);
        Ok(())
    }

    fn object(&mut self, name: &Option<String>, primitives: &[ConvertedPrimitive]) -> ObjectId {
        let id = ObjectId(self.model.objects.len() as u32);
        let at =
            primitives.first().map_or_else(|| self.document.at(""), |converted| converted.pointer.clone());
        let shapes = primitives.iter().map(|converted| shape(converted, name)).collect();
        self.model.objects.push(Object { name: name.clone().unwrap_or_default(), at, shapes });
        id
    }

    fn instance(
        &mut self,
        name: Option<Arc<String>>,
        at: Location,
        object: ObjectId,
        world_from_object: DMat4,
    ) {
        let is_empty = self.model.objects[object.index()].shapes.is_empty();
        if !is_empty && is_invertible(&world_from_object) {
            self.model.instances.push(Instance { name, ..Instance::new(at, object, world_from_object) });
        }
    }

    /// The transforms of `EXT_mesh_gpu_instancing`, applied before that of the node.
    fn places(&self, instancing: &Instancing, node: usize) -> Result<Vec<DMat4>> {
        let pointer =
            |name: &str| format!("/nodes/{node}/extensions/EXT_mesh_gpu_instancing/attributes/{name}");
        let find = |name: &str| instancing.attributes.get(name).copied();
        let vectors = |name: &str| {
            find(name).map(|index| self.document.vectors::<3>(index, &pointer(name))).transpose()
        };
        let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
        let rotations = find("ROTATION")
            .map(|index| self.document.vectors::<4>(index, &pointer("ROTATION")))
            .transpose()?;
        let counts = [
            translations.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
            rotations.as_ref().map(Vec::len),
        ];
        let count = counts.into_iter().flatten().min().unwrap_or(1);
        if counts.into_iter().flatten().any(|other| other != count) {
            return Err(self.document.invalid(
                pointer("").trim_end_matches('/'),
                "TRANSLATION, ROTATION and SCALE have different numbers of values",
            ));
        }
        let vector = |vectors: &Option<Vec<[f32; 3]>>, i: usize, otherwise: DVec3| {
            vectors.as_ref().map_or(otherwise, |all| DVec3::from_array(all[i].map(f64::from)))
        };
        let place = |i: usize| {
            let rotation =
                rotations.as_ref().map_or(DVec4::W, |all| DVec4::from_array(all[i].map(f64::from)));
            placed(vector(&translations, i, DVec3::ZERO), rotation, vector(&scales, i, DVec3::ONE))
        };
        let mut places: Vec<DMat4> = (0..count).map(place).collect();
        // A file of a few bytes can request millions of instances at one place, which no BVH can separate.
        places.dedup();
        Ok(places)
    }
}

fn shape(converted: &ConvertedPrimitive, name: &Option<String>) -> Shape {
    // Points and lines have no back side.
    let single_sided = converted.binding.single_sided && matches!(converted.geometry, Geometry::Mesh(_));
    Shape {
        name: name.clone(),
        emission: converted.binding.emission,
        alpha: converted.binding.alpha,
        single_sided,
        world_from_object: converted.world_from_skinned.unwrap_or(DMat4::IDENTITY),
        ..Shape::new(converted.pointer.clone(), converted.geometry.clone(), converted.binding.material)
    }
}

fn triangles(primitives: &[ConvertedPrimitive], scene: &Scene) -> usize {
    let of = |converted: &ConvertedPrimitive| match &converted.geometry {
        Geometry::Mesh(id) => scene.meshes[id.index()].triangles.len(),
        Geometry::Spheres(spheres) => spheres.len(),
        Geometry::Curves(strands) => strands.len(),
        _ => 0,
    };
    primitives.iter().map(of).sum()
}

/// Whether a matrix can be inverted.
fn is_invertible(matrix: &DMat4) -> bool {
    matrix.is_finite() && matrix.determinant().is_normal() && matrix.inverse().is_finite()
}
