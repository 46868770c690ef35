//! Texture mappings: by surface coordinates, in space, or projected.

use glam::{DMat4, DVec3, DVec4, Vec3};

use super::table::Table;
use super::transform::{invertible_rows, scale_rotate_translate};
use super::value::Value;
use crate::error::Result;
use crate::texture::Mapping;

/// The keys of mappings.
pub(super) const KEYS: &[&str] = &[
    "space",
    "scale",
    "offset",
    "size",
    "rotate",
    "translate",
    "axis_u",
    "axis_v",
    "texture_from_world",
    "uv_set",
    "uv_matrix",
];

/// The words for `space`.
pub(super) const SPACES: [&str; 5] = ["uv", "world", "spherical", "cylindrical", "planar"];

/// The mapping, with `default` if `space` is absent.
pub(super) fn mapping(table: &Table<'_>, default: &str) -> Result<Mapping> {
    let words = SPACES.map(|word| (word, word));
    let space = table.find("space").map_or(Ok(default), |value| value.choice(&words))?;
    let for_others: &[(&str, &[&str])] = &[
        ("uv", &["offset", "uv_set", "uv_matrix"]),
        ("planar", &["offset", "axis_u", "axis_v", "size", "rotate", "translate", "texture_from_world"]),
        ("world", &["size", "rotate", "translate", "texture_from_world"]),
        ("spherical", &["size", "rotate", "translate", "texture_from_world"]),
        ("cylindrical", &["size", "rotate", "translate", "texture_from_world"]),
    ];
    for key in KEYS[2..].iter().filter_map(|key| table.find(key)) {
        let has = |word: &str| for_others.iter().any(|other| other.0 == word && other.1.contains(&key.key()));
        if !has(space) {
            let spaces = words.map(|word| word.0).into_iter().filter(|word| has(word));
            let spaces = spaces.map(|word| format!("{word:?}")).collect::<Vec<_>>().join(" or ");
            let error = key.error(format!("`{}` has no meaning in space = {space:?}", key.key()));
            key.note(error.hint(format!("leave it out, or give space = {spaces}")));
        }
    }
    if space == "uv" {
        if table.has("uv_matrix") || table.has("uv_set") {
            return Ok(affine(table));
        }
        let scale = table.or("scale", [1.0; 2], pair);
        return Ok(Mapping::Uv { scale, offset: offset(table) });
    }
    let axes =
        || [("axis_u", Vec3::X), ("axis_v", Vec3::Y)].map(|(key, default)| table.or(key, default, axis));
    if table.has("texture_from_world") {
        for key in ["size", "scale", "rotate", "translate"] {
            table.one_of(&["texture_from_world", key]);
        }
        let texture_from_world = table.or("texture_from_world", DMat4::IDENTITY, invertible_rows);
        return Ok(match space {
            "world" => Mapping::World { texture_from_world },
            "spherical" => Mapping::Spherical { texture_from_world },
            "cylindrical" => Mapping::Cylindrical { texture_from_world },
            _ => Mapping::Planar { texture_from_world, axes: axes(), offset: offset(table) },
        });
    }
    let size = table.or("size", 1.0, Value::positive);
    let world_from_texture = scale_rotate_translate(table) * DMat4::from_scale(DVec3::splat(size));
    let texture_from_world = world_from_texture.inverse();
    if !texture_from_world.is_finite() {
        return Err(table
            .error("the pattern is too small or too large to compute with")
            .hint("change `size` or `scale`"));
    }
    // Up is y here; the poles of the mappings are on z.
    let turned = pole_on_z() * texture_from_world;
    Ok(match space {
        "world" => Mapping::World { texture_from_world },
        "spherical" => Mapping::Spherical { texture_from_world: turned },
        "cylindrical" => Mapping::Cylindrical { texture_from_world: turned },
        _ => Mapping::Planar { texture_from_world, axes: axes(), offset: offset(table) },
    })
}

/// The turn to a space whose pole is z, from one whose pole is y.
pub(super) fn pole_on_z() -> DMat4 {
    DMat4::from_cols(DVec4::X, DVec4::Z, -DVec4::Y, DVec4::W)
}

/// An affine map of a set of texture coordinates.
fn affine(table: &Table<'_>) -> Mapping {
    for key in ["scale", "offset"] {
        table.one_of(&["uv_matrix", key]);
    }
    let row = |value: Value<'_>| value.singles::<3>("three numbers, the factors of u, v and 1");
    let rows = |value: Value<'_>| {
        let [s, t] = value.list_of("two rows of three numbers")?;
        Ok([row(s)?, row(t)?])
    };
    Mapping::Affine {
        set: table.or("uv_set", 0, |value| Ok(value.integer(0, u32::MAX.into())? as u32)),
        matrix: table.or("uv_matrix", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], rows),
    }
}

/// A non-zero vector that is finite as `f32`.
fn axis(value: Value<'_>) -> Result<Vec3> {
    value.direction()?;
    super::shape::point(value)
}

fn offset(table: &Table<'_>) -> [f32; 2] {
    table.or("offset", [0.0; 2], |value| value.singles("two numbers, [u, v]"))
}

/// One number for both directions, or one for each.
fn pair(value: Value<'_>) -> Result<[f32; 2]> {
    if value.is_number() { value.single().map(|both| [both; 2]) } else { value.singles("a number or [u, v]") }
}
