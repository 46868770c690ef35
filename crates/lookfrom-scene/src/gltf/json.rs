//! Structures of the JSON of a glTF file, one for each object of the specification (Khronos 2021, §5) and of its
//! extensions. Other properties are ignored. Interpretation, defaults that depend on other properties, and checks are
//! left to the other modules.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::Visitor;
use serde::{Deserialize, Deserializer};

mod material;
mod parse;
mod pointer;

pub(crate) use material::{
    Iridescence, Material, MaterialExtensions, SpecularGlossiness, TextureInfo, Volume,
};
pub(super) use parse::{parse, text, version};

/// A whole number of at least 0: an index or a count. `3.0` is accepted, too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Whole(pub(crate) u64);

impl Whole {
    /// The number as an index; one that is too large for this machine becomes an index beyond every array.
    pub(crate) fn index(self) -> usize {
        usize::try_from(self.0).unwrap_or(usize::MAX)
    }
}

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Number;
        impl Visitor<'_> for Number {
            type Value = Whole;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number of at least 0")
            }
            fn visit_u64<E>(self, value: u64) -> Result<Whole, E> {
                Ok(Whole(value))
            }
            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Whole, E> {
                u64::try_from(value)
                    .map(Whole)
                    .map_err(|_| E::invalid_value(serde::de::Unexpected::Signed(value), &self))
            }
            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Whole, E> {
                if (0.0..9e15).contains(&value) && value.trunc() == value {
                    Ok(Whole(value as u64))
                } else {
                    Err(E::invalid_value(serde::de::Unexpected::Float(value), &self))
                }
            }
        }
        // By `deserialize_any`, a wrong array would be told at its first value.
        deserializer.deserialize_u64(Number)
    }
}

/// Bytes of an object of the file: of a node, of which there may be millions, with its place in the hierarchy.
const OBJECT: u64 = size_of::<Node>() as u64 + 140;

/// An estimate of the memory that parsing takes.
pub(crate) fn memory(text: &[u8]) -> u64 {
    text.iter().filter(|&&byte| byte == b'{').count() as u64 * OBJECT
}

/// A list that may be `null`, as some programs write it.
fn list<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    Option::<Vec<T>>::deserialize(deserializer).map(Option::unwrap_or_default)
}

/// A value with a default, which also stands for `null`.
fn or_default<'de, D: Deserializer<'de>, T: Deserialize<'de> + Default>(
    deserializer: D,
) -> Result<T, D::Error> {
    Option::<T>::deserialize(deserializer).map(Option::unwrap_or_default)
}

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Root {
    pub(crate) asset: Asset,
    #[serde(default, deserialize_with = "list")]
    pub(crate) extensions_used: Vec<String>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) extensions_required: Vec<String>,
    pub(crate) scene: Option<Whole>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) scenes: Vec<Scene>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) nodes: Vec<Node>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) meshes: Vec<Mesh>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) cameras: Vec<Camera>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) materials: Vec<Material>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) textures: Vec<Texture>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) images: Vec<Image>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) samplers: Vec<Sampler>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) accessors: Vec<Accessor>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) buffer_views: Vec<BufferView>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) buffers: Vec<Buffer>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) skins: Vec<Skin>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) animations: Vec<Animation>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: RootExtensions,
}

/// The format's version, and the minimum version that a reader needs.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Asset {
    pub(crate) version: String,
    pub(crate) min_version: Option<String>,
}

/// Extensions of the whole file.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(crate) lights: Option<Lights>,
    #[serde(rename = "KHR_materials_variants")]
    pub(crate) variants: Option<Variants>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Lights {
    #[serde(default, deserialize_with = "list")]
    pub(crate) lights: Vec<Light>,
}

/// `KHR_lights_punctual`.
#[derive(Debug, Deserialize)]
pub(crate) struct Light {
    pub(crate) name: Option<String>,
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) color: Option<[f64; 3]>,
    pub(crate) intensity: Option<f64>,
    pub(crate) spot: Option<Spot>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Spot {
    pub(crate) inner_cone_angle: Option<f64>,
    pub(crate) outer_cone_angle: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Variants {
    #[serde(default, deserialize_with = "list")]
    pub(crate) variants: Vec<Named>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Named {
    pub(crate) name: Option<String>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Scene {
    pub(crate) name: Option<String>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) nodes: Vec<Whole>,
}

/// There may be millions: what most nodes have not is elsewhere.
#[derive(Debug, Deserialize)]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) children: Vec<Whole>,
    /// In column-major order.
    pub(crate) matrix: Option<Box<[f64; 16]>>,
    pub(crate) translation: Option<Box<[f64; 3]>>,
    /// x, y, z, w.
    pub(crate) rotation: Option<Box<[f64; 4]>>,
    pub(crate) scale: Option<Box<[f64; 3]>>,
    pub(crate) mesh: Option<Whole>,
    pub(crate) camera: Option<Box<Whole>>,
    pub(crate) skin: Option<Box<Whole>>,
    pub(crate) weights: Option<Box<[f64]>>,
    extensions: Option<Box<NodeExtensions>>,
}

impl Node {
    /// The light that it places.
    pub(crate) fn light(&self) -> Option<&LightIndex> {
        self.extensions.as_ref()?.light.as_ref()
    }

    /// The places of its mesh, where it has several.
    pub(crate) fn instancing(&self) -> Option<&Instancing> {
        self.extensions.as_ref()?.instancing.as_ref()
    }

    /// Whether it and its children can be seen.
    pub(crate) fn is_visible(&self) -> bool {
        let visibility = self.extensions.as_ref().and_then(|extensions| extensions.visibility.as_ref());
        visibility.and_then(|visibility| visibility.visible).unwrap_or(true)
    }
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(crate) light: Option<LightIndex>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(crate) instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub(crate) visibility: Option<Visibility>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct LightIndex {
    pub(crate) light: Whole,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Visibility {
    pub(crate) visible: Option<bool>,
}

/// `EXT_mesh_gpu_instancing`: accessors by `TRANSLATION`, `ROTATION`, `SCALE` and others.
#[derive(Debug, Deserialize)]
pub(crate) struct Instancing {
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) attributes: BTreeMap<String, Whole>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Camera {
    pub(crate) name: Option<String>,
    pub(crate) perspective: Option<Perspective>,
    pub(crate) orthographic: Option<Orthographic>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Perspective {
    pub(crate) aspect_ratio: Option<f64>,
    pub(crate) yfov: f64,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Orthographic {
    pub(crate) xmag: f64,
    pub(crate) ymag: f64,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Mesh {
    pub(crate) name: Option<String>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) primitives: Vec<Primitive>,
    /// Default weights of the morph targets, for nodes that have none.
    pub(crate) weights: Option<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Primitive {
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) attributes: BTreeMap<String, Whole>,
    pub(crate) indices: Option<Whole>,
    pub(crate) material: Option<Whole>,
    pub(crate) mode: Option<Whole>,
    /// Morph targets: accessors of displacements by `POSITION`, `NORMAL`, `TANGENT` and others.
    #[serde(default, deserialize_with = "list")]
    pub(crate) targets: Vec<BTreeMap<String, Whole>>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: PrimitiveExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub(crate) draco: Option<Draco>,
    #[serde(rename = "KHR_materials_variants")]
    pub(crate) variants: Option<VariantMappings>,
}

/// `KHR_draco_mesh_compression`: attributes by their ids in the compressed data.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Draco {
    pub(crate) buffer_view: Whole,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) attributes: BTreeMap<String, Whole>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct VariantMappings {
    #[serde(default, deserialize_with = "list")]
    pub(crate) mappings: Vec<VariantMapping>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct VariantMapping {
    pub(crate) material: Whole,
    #[serde(default, deserialize_with = "list")]
    pub(crate) variants: Vec<Whole>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Texture {
    pub(crate) sampler: Option<Whole>,
    pub(crate) source: Option<Whole>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    pub(crate) webp: Option<OtherSource>,
    #[serde(rename = "KHR_texture_basisu")]
    pub(crate) basisu: Option<OtherSource>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct OtherSource {
    pub(crate) source: Option<Whole>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Image {
    pub(crate) uri: Option<String>,
    pub(crate) buffer_view: Option<Whole>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Sampler {
    pub(crate) mag_filter: Option<Whole>,
    pub(crate) wrap_s: Option<Whole>,
    pub(crate) wrap_t: Option<Whole>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub(crate) buffer_view: Option<Whole>,
    pub(crate) byte_offset: Option<Whole>,
    pub(crate) component_type: Whole,
    pub(crate) normalized: Option<bool>,
    pub(crate) count: Whole,
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Sparse {
    pub(crate) count: Whole,
    pub(crate) indices: SparseIndices,
    pub(crate) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseIndices {
    pub(crate) buffer_view: Whole,
    pub(crate) byte_offset: Option<Whole>,
    pub(crate) component_type: Whole,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparseValues {
    pub(crate) buffer_view: Whole,
    pub(crate) byte_offset: Option<Whole>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub(crate) buffer: Whole,
    pub(crate) byte_offset: Option<Whole>,
    pub(crate) byte_length: Whole,
    pub(crate) byte_stride: Option<Whole>,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: BufferViewExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    pub(crate) meshopt: Option<Meshopt>,
}

/// `EXT_meshopt_compression`.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Meshopt {
    pub(crate) buffer: Whole,
    pub(crate) byte_offset: Option<Whole>,
    pub(crate) byte_length: Whole,
    pub(crate) byte_stride: Whole,
    pub(crate) count: Whole,
    /// `ATTRIBUTES`, `TRIANGLES` or `INDICES`.
    pub(crate) mode: String,
    /// `NONE`, `OCTAHEDRAL`, `QUATERNION`, `EXPONENTIAL` …
    pub(crate) filter: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Buffer {
    pub(crate) uri: Option<String>,
    pub(crate) byte_length: Whole,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Skin {
    pub(crate) inverse_bind_matrices: Option<Whole>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) joints: Vec<Whole>,
}

#[derive(Debug, Deserialize)]
pub(crate) struct Animation {
    pub(crate) name: Option<String>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) channels: Vec<AnimationChannel>,
    #[serde(default, deserialize_with = "list")]
    pub(crate) samplers: Vec<AnimationSampler>,
}

impl Animation {
    /// Whether it changes properties by their JSON pointers.
    pub(crate) fn has_pointers(&self) -> bool {
        self.channels.iter().any(|channel| channel.target.extensions.pointer.is_some())
    }
}

#[derive(Debug, Deserialize)]
pub(crate) struct AnimationChannel {
    pub(crate) sampler: Whole,
    pub(crate) target: AnimationTarget,
}

#[derive(Debug, Deserialize)]
pub(crate) struct AnimationTarget {
    pub(crate) node: Option<Whole>,
    /// `translation`, `rotation`, `scale`, `weights`, or a word of an extension.
    pub(crate) path: String,
    #[serde(default, deserialize_with = "or_default")]
    pub(crate) extensions: AnimationTargetExtensions,
}

#[derive(Debug, Default, Deserialize)]
pub(crate) struct AnimationTargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub(crate) pointer: Option<AnimationPointer>,
}

/// Any property, in place of one of a node.
#[derive(Debug, Deserialize)]
pub(crate) struct AnimationPointer {
    /// A JSON pointer (RFC 6901).
    pub(crate) pointer: String,
}

#[derive(Debug, Deserialize)]
pub(crate) struct AnimationSampler {
    /// Accessor of times in seconds.
    pub(crate) input: Whole,
    /// `LINEAR` (the default), `STEP` or `CUBICSPLINE`.
    pub(crate) interpolation: Option<String>,
    /// Accessor of values.
    pub(crate) output: Whole,
}
