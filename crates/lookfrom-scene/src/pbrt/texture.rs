//! The `Texture` directive, and texture mappings.

use glam::DVec3;

use super::lexer::Lexer;
use super::params::{Parameter, ParameterType, Parameters};
use super::picture::encoding_of;
use super::spectra::Meaning::Unbounded;
use super::text::Place;
use super::{NamedTexture, Reader, transform};
use crate::error::Result;
use crate::material::{Color, Scalar};
use crate::scene::TextureId;
use crate::texture::{Channel, Mapping, MipFilter, TexelFilter, Texture, TextureKind, Wrap};
use crate::warning::Warning;

const KINDS: &[&str] = &[
    "bilerp",
    "checkerboard",
    "constant",
    "directionmix",
    "dots",
    "fbm",
    "imagemap",
    "marble",
    "mix",
    "ptex",
    "scale",
    "windy",
    "wrinkled",
];

impl Reader<'_, '_> {
    /// The spectrum texture that a parameter names.
    pub(super) fn spectrum_texture(&mut self, parameter: &Parameter) -> Result<Color> {
        self.texture_named(parameter, false)
    }

    /// The float texture that a parameter names.
    pub(super) fn float_texture(&mut self, parameter: &Parameter) -> Result<Scalar> {
        Ok(match self.texture_named(parameter, true)? {
            Color::Value([value, ..]) => Scalar::Value(value),
            Color::Texture(id) => Scalar::Texture(id),
            Color::Curve(_) => Scalar::Value(0.0),
        })
    }

    fn texture_named(&mut self, parameter: &Parameter, is_float: bool) -> Result<Color> {
        let [name] = parameter.strings() else {
            return Err(parameter.wrong(format!("one name, found {}", parameter.strings().len())));
        };
        let key = (is_float, name.clone());
        match self.textures.get(&key) {
            Some(named) if named.is_made || !self.only_earlier => return Ok(named.color),
            None if !self.only_earlier => {}
            _ => {
                let known =
                    self.textures.iter().filter(|((float, _), named)| *float == is_float && named.is_made);
                let known: Vec<&str> = known.map(|((_, name), _)| &**name).collect();
                let what = if is_float { "float texture" } else { "spectrum texture" };
                let error = Self::unknown(&parameter.place, what, name, known);
                return Err(match self.textures.contains_key(&(!is_float, name.clone())) {
                    true if is_float => {
                        error.hint("there is a spectrum texture of that name, but numbers are needed")
                    }
                    true => error.hint("there is a float texture of that name, but colours are needed"),
                    false => error,
                });
            }
        }
        // The definition may follow: reserve the texture.
        let color = self.push_texture(name, &parameter.place, TextureKind::VertexColor { tint: [1.0; 3] });
        self.textures.insert(key, NamedTexture { color, first: parameter.place.clone(), is_made: false });
        Ok(color)
    }

    fn push_texture(&mut self, name: &str, place: &Place, kind: TextureKind) -> Color {
        self.scene.textures.push(Texture { name: name.to_owned(), at: place.location(), kind });
        Color::Texture(TextureId(self.scene.textures.len() as u32 - 1))
    }

    /// `Texture "name" "float" "kind" …`
    pub(super) fn texture_directive(&mut self, place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        let start = lexer.here();
        let name = lexer.string("a quoted name of the texture")?;
        let name_place = lexer.place(start);
        let start = lexer.here();
        let values = lexer.string("\"float\" or \"spectrum\"")?;
        self.note_texture_kind(&values, &lexer.place(start))?;
        let is_float = match &*values {
            "float" => true,
            "spectrum" | "color" => false,
            _ => return Err(lexer.wrong(start, "\"float\" or \"spectrum\"")),
        };
        let start = lexer.here();
        let (kind, parameters) = self.entity(b"Texture", place, lexer, Some(4))?;
        let key = (is_float, name.clone());
        if self.is_old() && self.textures.get(&key).is_some_and(|named| named.is_made) {
            // It is defined again, for what comes after.
            self.textures.remove(&key);
        }
        if let Some(before) = self.textures.get(&key).filter(|named| named.is_made) {
            let at = before.first.location();
            let error = name_place.invalid(format!("{values} texture {name:?} is already defined, at {at}"));
            return Err(error.hint("give one of them another name"));
        }
        // No texture may be part of itself.
        self.only_earlier = true;
        let made = self.pattern(&kind, &parameters, is_float, &lexer.place(start));
        self.only_earlier = false;
        let made = made?;
        let reserved = self.textures.get(&key).and_then(NamedTexture::id);
        let color = match (reserved, made) {
            (
                None,
                TextureKind::Scale {
                    color: color @ (Color::Value(_) | Color::Curve(_)),
                    by: Scalar::Value(1.0),
                },
            ) => color,
            (None, kind) => self.push_texture(&name, place, kind),
            (Some(id), kind) => {
                let texture = &mut self.scene.textures[id.index()];
                (texture.kind, texture.at) = (kind, place.location());
                Color::Texture(id)
            }
        };
        self.textures.insert(key, NamedTexture { color, first: name_place, is_made: true });
        parameters.finish(self.context);
        Ok(())
    }

    /// A colour or float parameter of the texture, as a colour.
    fn part(&mut self, p: &Parameters, name: &'static str, default: f32, is_float: bool) -> Result<Color> {
        if !is_float {
            return self.color(p, name, Color::gray(default), Unbounded);
        }
        Ok(match self.scalar(p, name, default)? {
            Scalar::Value(value) => Color::gray(value),
            Scalar::Texture(id) => Color::Texture(id),
        })
    }

    fn pattern(
        &mut self,
        kind: &str,
        p: &Parameters,
        is_float: bool,
        kind_place: &Place,
    ) -> Result<TextureKind> {
        let octaves = |p: &Parameters| {
            p.integer("octaves", TextureKind::OCTAVES as i32, 1, 16).map(|octaves| octaves as u32)
        };
        let footprint = TexelFilter::PBRT_FOOTPRINT;
        Ok(match kind {
            "constant" => uniform(self.part(p, "value", 1.0, is_float)?),
            "scale" if self.is_old() => match is_float {
                true => TextureKind::Scale {
                    color: self.part(p, "tex1", 1.0, is_float)?,
                    by: self.scalar(p, "tex2", 1.0)?,
                },
                false => TextureKind::Product {
                    a: self.part(p, "tex1", 1.0, is_float)?,
                    b: self.part(p, "tex2", 1.0, is_float)?,
                },
            },
            "uv" if self.is_old() => TextureKind::Bilinear {
                corners: [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
                    .map(|[u, v]| Color::Value([u, v, 0.0])),
                mapping: self.mapping(p)?,
            },
            "scale" => TextureKind::Scale {
                color: self.part(p, "tex", 1.0, is_float)?,
                by: self.scalar(p, "scale", 1.0)?,
            },
            "mix" => TextureKind::Mix {
                low: self.part(p, "tex1", 0.0, is_float)?,
                high: self.part(p, "tex2", 1.0, is_float)?,
                amount: self.scalar(p, "amount", TextureKind::MIX_AMOUNT)?,
            },
            "directionmix" => {
                let direction = p.vector("dir", ParameterType::Vector3, DVec3::Y)?;
                let direction = self.state.matrix.transform_vector3(direction).try_normalize();
                let direction = direction.ok_or_else(|| p.refuse("dir", "a vector other than 0"))?;
                TextureKind::DirectionMix {
                    low: self.part(p, "tex2", 1.0, is_float)?,
                    high: self.part(p, "tex1", 0.0, is_float)?,
                    direction: direction.as_vec3(),
                }
            }
            "bilerp" => TextureKind::Bilinear {
                corners: [
                    self.part(p, "v00", 0.0, is_float)?,
                    self.part(p, "v01", 1.0, is_float)?,
                    self.part(p, "v10", 0.0, is_float)?,
                    self.part(p, "v11", 1.0, is_float)?,
                ],
                mapping: self.mapping(p)?,
            },
            "checkerboard" => {
                let dimension = p.integer("dimension", 2, 2, 3)?;
                TextureKind::Checker {
                    even: self.part(p, "tex1", 1.0, is_float)?,
                    odd: self.part(p, "tex2", 0.0, is_float)?,
                    footprint,
                    mapping: if dimension == 2 { self.mapping(p)? } else { self.in_space(p)? },
                }
            }
            "dots" => TextureKind::Dots {
                inside: self.part(p, "inside", 1.0, is_float)?,
                outside: self.part(p, "outside", 0.0, is_float)?,
                mapping: self.mapping(p)?,
            },
            "imagemap" => self.imagemap(p, is_float)?,
            "fbm" if is_float || self.is_old() => TextureKind::Fbm {
                octaves: octaves(p)?,
                roughness: p.float("roughness", TextureKind::ROUGHNESS)?,
                footprint,
                mapping: self.in_space(p)?,
            },
            "wrinkled" if is_float || self.is_old() => TextureKind::Wrinkled {
                octaves: octaves(p)?,
                roughness: p.float("roughness", TextureKind::ROUGHNESS)?,
                footprint,
                mapping: self.in_space(p)?,
            },
            "windy" if is_float || self.is_old() => {
                TextureKind::Windy { footprint, mapping: self.in_space(p)? }
            }
            "marble" if !is_float => TextureKind::PbrtMarble {
                octaves: octaves(p)?,
                roughness: p.float("roughness", TextureKind::ROUGHNESS)?,
                scale: p.float("scale", 1.0)?,
                variation: p.float("variation", 0.2)?,
                footprint,
                mapping: self.in_space(p)?,
            },
            "fbm" | "wrinkled" | "windy" | "marble" => {
                let (there, here) = if is_float { ("spectrum", "float") } else { ("float", "spectrum") };
                let error =
                    kind_place.invalid(format!("{kind:?} is a {there} texture, not a {here} texture"));
                return Err(error.hint(format!("write {there:?} between the name and {kind:?}")));
            }
            "ptex" => {
                if self.warned.insert("ptex".to_owned()) {
                    let message = "textures of the type \"ptex\" are not supported: they are gray";
                    let remedy = "give the mesh texture coordinates, bake the Ptex file to a picture, and write \"imagemap\"";
                    let warning = Warning::new(&p.place.location(), message);
                    self.context.warnings.push(warning.remedy(remedy.into()));
                }
                p.ignore(&["filename", "encoding", "scale"]);
                uniform(Color::gray(0.5))
            }
            _ => return Err(Self::unknown(kind_place, "texture", kind, KINDS.iter().copied())),
        })
    }

    fn imagemap(&mut self, p: &Parameters, is_float: bool) -> Result<TextureKind> {
        let parameter = p.find("filename", &[ParameterType::String])?;
        let place = parameter.map_or(&p.place, |parameter| &parameter.place);
        let Some(name) = p.string("filename")? else {
            return Err(place
                .invalid(format!("{} has no \"string filename\"", p.title))
                .hint("name a picture"));
        };
        let encoding = encoding_of(name, p.string("encoding")?);
        let anisotropy = p.float("maxanisotropy", MipFilter::ANISOTROPY)?;
        let ewa = MipFilter::Ewa { anisotropy: anisotropy.clamp(1.0, MipFilter::MOST_ANISOTROPY) };
        let filters = [
            ("bilinear", MipFilter::Bilinear),
            ("trilinear", MipFilter::Trilinear),
            ("ewa", ewa),
            ("EWA", ewa),
            ("point", MipFilter::Nearest),
        ];
        let wraps = [
            ("repeat", Wrap::Repeat),
            ("clamp", Wrap::Clamp),
            ("black", Wrap::Black),
            ("octahedralsphere", Wrap::Clamp),
        ];
        Ok(TextureKind::Image {
            // A picture of numbers is its colours' in version 3, whatever its alpha.
            image: match is_float && !self.is_old() {
                true => self.number_picture(name, &encoding, place)?,
                false => self.picture(name, &encoding, place)?,
            },
            mapping: self.mapping(p)?,
            wrap: [p.choice("wrap", Wrap::Repeat, &wraps)?; 2],
            filter: TexelFilter::Mip {
                filter: p.choice("filter", MipFilter::Bilinear, &filters)?,
                footprint: TexelFilter::PBRT_FOOTPRINT,
            },
            channel: Channel::Rgb,
            scale: p.float("scale", 1.0)?,
            invert: p.boolean("invert", false)?,
        })
    }

    /// The texture space of a 3D pattern: the object space at its definition.
    fn in_space(&self, p: &Parameters) -> Result<Mapping> {
        Ok(Mapping::World { texture_from_world: self.texture_from_world(p)? })
    }

    fn texture_from_world(&self, p: &Parameters) -> Result<glam::DMat4> {
        if !transform::is_invertible(&self.state.matrix) {
            return Err(p
                .place
                .invalid("the current transform is singular: a texture needs an invertible one"));
        }
        Ok(self.state.matrix.inverse())
    }

    fn mapping(&self, p: &Parameters) -> Result<Mapping> {
        let kind =
            p.choice("mapping", 0, &[("uv", 0), ("spherical", 1), ("cylindrical", 2), ("planar", 3)])?;
        let offset = [p.float("udelta", 0.0)?, p.float("vdelta", 0.0)?];
        let scale = [p.float("uscale", 1.0)?, p.float("vscale", 1.0)?];
        Ok(match kind {
            0 => Mapping::Uv { scale, offset },
            1 => Mapping::Spherical { texture_from_world: self.texture_from_world(p)? },
            2 => Mapping::Cylindrical { texture_from_world: self.texture_from_world(p)? },
            _ => Mapping::Planar {
                texture_from_world: self.texture_from_world(p)?,
                axes: [
                    p.vector("v1", ParameterType::Vector3, DVec3::X)?.as_vec3(),
                    p.vector("v2", ParameterType::Vector3, DVec3::Y)?.as_vec3(),
                ],
                offset,
            },
        })
    }

    /// The image of an area light, over the uv of its shape.
    pub(super) fn shown_picture(&mut self, name: &str, place: &Place) -> Result<Color> {
        let image = self.emitted_picture(name, place)?;
        let kind = TextureKind::Image {
            image,
            mapping: Mapping::UV,
            wrap: [Wrap::Clamp; 2],
            filter: TexelFilter::Bilinear,
            channel: Channel::Rgb,
            scale: 1.0,
            invert: false,
        };
        Ok(self.push_texture(name, place, kind))
    }
}

/// A constant texture.
fn uniform(color: Color) -> TextureKind {
    TextureKind::Scale { color, by: Scalar::Value(1.0) }
}
