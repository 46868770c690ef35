//! Execution of directives.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::lexer::{Lexer, Token};
use super::params::{self, Inherited, Parameters};
use super::spectra::Space;
use super::state::{Entity, Opened, Options, TARGETS};
use super::text::Place;
use super::{Reader, transform};
use crate::camera::Target;
use crate::error::{ErrorKind, Location, Result};
use crate::motion::Motion;
use crate::scene::{Instance, MaterialId, Object, ObjectId};
use crate::spectrum::space;
use crate::suggest::nearest;

/// The maximum nesting depth of attributes.
const DEEPEST: usize = 1 << 16;

pub(super) const DIRECTIVES: &[&str] = &[
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "TransformTimes",
    "Translate",
    "WorldBegin",
];

impl Reader<'_, '_> {
    /// Executes a directive; the lexer is after its first word.
    pub(super) fn directive(&mut self, word: &[u8], place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        match word {
            b"Shape" => {
                let (kind, parameters) = self.world_entity(word, place, lexer, 0)?;
                self.shape(&kind, &parameters)?;
                parameters.finish(self.context);
            }
            b"AttributeBegin" => {
                self.in_world_only(word, place)?;
                self.begin("Attribute", place)?;
            }
            b"AttributeEnd" => self.end("Attribute", place)?,
            b"TransformBegin" | b"TransformEnd" => {
                let word = String::from_utf8_lossy(word);
                if !self.is_old() {
                    let meant = word.replace("Transform", "Attribute");
                    let message = format!("{word} is an old word for {meant}, as in pbrt-v4");
                    self.context.notice(&place.location(), message);
                }
                if word.ends_with("Begin") {
                    self.begin("Attribute", place)?;
                } else {
                    self.end("Attribute", place)?;
                }
            }
            b"ReverseOrientation" => {
                self.in_world_only(word, place)?;
                self.state.reverse_orientation = !self.state.reverse_orientation;
            }
            b"Attribute" => self.attribute(place, lexer)?,

            // Transforms.
            b"Identity" => self.set_matrices([DMat4::IDENTITY; 2]),
            b"Translate" => {
                let offset = transform::numbers(lexer)?;
                self.concatenate(DMat4::from_translation(DVec3::from_array(offset)));
            }
            b"Scale" => {
                let factors = transform::numbers(lexer)?;
                self.concatenate(DMat4::from_scale(DVec3::from_array(factors)));
            }
            b"Rotate" => {
                let turn = transform::numbers(lexer)?;
                self.concatenate(transform::rotate(turn, place)?);
            }
            b"LookAt" => {
                let view = transform::numbers(lexer)?;
                self.concatenate(transform::look_at(view, place)?);
                let [_, _, _, x, y, z, ux, uy, uz] = view;
                let target = Target { lookat: DVec3::new(x, y, z), up: DVec3::new(ux, uy, uz) };
                self.options.look = self.state.at_start.then(|| target.transformed(&self.state.matrix));
            }
            b"Transform" => {
                let matrix = transform::matrix(lexer, place)?;
                self.set_matrices([matrix; 2]);
            }
            b"ConcatTransform" => {
                let matrix = transform::matrix(lexer, place)?;
                self.concatenate(matrix);
            }
            b"CoordinateSystem" => {
                let name = lexer.string("a quoted name of a coordinate system")?;
                self.coordinate_systems.insert(name, self.state.matrices());
            }
            b"CoordSysTransform" => {
                let name = lexer.string("a quoted name of a coordinate system")?;
                match self.coordinate_systems.get(&name) {
                    Some(&matrices) => self.set_matrices(matrices),
                    None => {
                        let known = self.coordinate_systems.keys().map(String::as_str);
                        let hint = nearest(&name, known).map(|meant| format!("; did you mean {meant:?}?"));
                        let message = format!(
                            "there is no coordinate system {name:?}: nothing is changed{}",
                            hint.unwrap_or_default()
                        );
                        self.context.warn(&place.location(), message);
                    }
                }
            }
            b"ActiveTransform" => self.active_transform(lexer)?,
            b"TransformTimes" => {
                self.before_world_only(word, place)?;
                self.transform_times = transform::numbers(lexer)?;
            }

            // Materials, textures and lights.
            b"Material" => {
                let (kind, parameters) = self.entity(word, place, lexer, Some(2))?;
                self.state.material = self.material(&kind, &parameters)?;
                parameters.finish(self.context);
            }
            b"MakeNamedMaterial" => self.make_named_material(place, lexer)?,
            b"NamedMaterial" => {
                let start = lexer.here();
                let name = lexer.string("a quoted name of a material")?;
                self.state.material = self.material_named(&name, &lexer.place(start));
            }
            b"Texture" => self.texture_directive(place, lexer)?,
            b"LightSource" => {
                let (kind, parameters) = self.world_entity(word, place, lexer, 1)?;
                self.light(&kind, &parameters)?;
                parameters.finish(self.context);
            }
            b"AreaLightSource" => {
                let (kind, parameters) = self.world_entity(word, place, lexer, 1)?;
                self.state.emission = Some(self.area_light(&kind, &parameters)?);
                parameters.finish(self.context);
            }
            b"MakeNamedMedium" => {
                let (name, parameters) = self.entity(word, place, lexer, Some(3))?;
                self.make_medium(&name, &parameters)?;
                parameters.finish(self.context);
            }
            b"MediumInterface" => self.medium_interface(lexer)?,

            // Objects.
            b"ObjectBegin" => self.object_begin(place, lexer)?,
            b"ObjectEnd" => self.end("Object", place)?,
            b"ObjectInstance" => {
                self.in_world_only(word, place)?;
                let start = lexer.here();
                let name = lexer.string("a quoted name of an object")?;
                if self.object.is_some() {
                    let error = place.invalid("an ObjectInstance cannot be in an object");
                    return Err(error.hint("end the object with ObjectEnd before it"));
                }
                self.instances.push((name, lexer.place(start), self.state.matrices()));
            }

            // Before the world.
            b"Camera" => {
                let entity = self.option(word, place, lexer)?;
                let matrices @ [matrix, _] = self.state.matrices();
                if !matrices.iter().all(transform::is_invertible) {
                    return Err(
                        place.invalid("the current transform is singular: a camera needs an invertible one")
                    );
                }
                self.coordinate_systems.insert("camera".to_owned(), matrices.map(|matrix| matrix.inverse()));
                self.options.target = self.options.look.map(|look| look.transformed(&matrix.inverse()));
                self.options.camera = Some((entity, matrices));
                let media = self.state.media.as_deref();
                self.options.camera_medium = media.map(|[_, outside]| outside.clone()).unwrap_or_default();
            }
            b"Film" => self.options.film = Some(self.option(word, place, lexer)?),
            b"PixelFilter" => self.options.filter = Some(self.option(word, place, lexer)?),
            b"Sampler" => self.options.sampler = Some(self.option(word, place, lexer)?),
            b"Integrator" => self.options.integrator = Some(self.option(word, place, lexer)?),
            b"Accelerator" => drop(self.option(word, place, lexer)?),
            b"Option" => self.program_option(place, lexer)?,
            b"ColorSpace" => {
                let start = lexer.here();
                let name = lexer.string("a quoted name of a colour space")?;
                self.state.space = color_space(&name, &lexer.place(start))?;
            }
            b"WorldBegin" => self.world_begin(place)?,

            // Other files.
            b"Include" => {
                let start = lexer.here();
                let name = lexer.string("a quoted name of a file")?;
                self.include(&name, &lexer.place(start))?;
            }
            b"Import" => {
                self.in_world_only(word, place)?;
                let start = lexer.here();
                let name = lexer.string("a quoted name of a file")?;
                let state = self.state.clone();
                self.include(&name, &lexer.place(start))?;
                self.state = state;
            }
            _ => {
                if self.note_directive(word, place)? {
                    return Ok(());
                }
                let word = String::from_utf8_lossy(word);
                let short: String = word.chars().take(40).collect();
                let error = place.syntax(format!("expected a directive, found `{short}`"));
                return Err(match nearest(&word, DIRECTIVES.iter().copied()) {
                    Some(meant) => error.hint(format!("did you mean `{meant}`?")),
                    None => error.hint("directives are Shape, Material, Translate, AttributeBegin, …"),
                });
            }
        }
        Ok(())
    }

    fn in_world_only(&self, word: &[u8], place: &Place) -> Result<()> {
        if self.in_world {
            return Ok(());
        }
        let error =
            place.invalid(format!("{} is only allowed after WorldBegin", String::from_utf8_lossy(word)));
        Err(error.hint("write `WorldBegin` between the camera and film and the first shape or light"))
    }

    fn before_world_only(&self, word: &[u8], place: &Place) -> Result<()> {
        if !self.in_world {
            return Ok(());
        }
        let error =
            place.invalid(format!("{} is only allowed before WorldBegin", String::from_utf8_lossy(word)));
        Err(error.hint("move it to the beginning of the scene"))
    }

    /// A quoted type and its parameters.
    pub(super) fn entity(
        &mut self,
        word: &[u8],
        place: &Place,
        lexer: &mut Lexer<'_>,
        target: Option<usize>,
    ) -> Result<(String, Parameters)> {
        let start = lexer.here();
        let mut kind = lexer.string("a quoted kind")?;
        let directive = String::from_utf8_lossy(word);
        self.note_word(&directive, &kind, &lexer.place(start))?;
        let mut own = params::read(lexer)?;
        own.iter().try_for_each(|parameter| self.note_parameter(&directive, parameter))?;
        // What is before the world waits until it is known for which version it is written.
        if self.is_old() && target.is_some() {
            self.translate((&directive, place), &mut kind, &mut own);
        }
        let none = Inherited::default();
        let inherited = target.map_or(&none, |target| &self.state.attributes[target]);
        let title = format!("{directive} {kind:?}");
        Ok((kind, Parameters::new(title, place.clone(), self.state.space, own, inherited)))
    }

    fn world_entity(
        &mut self,
        word: &[u8],
        place: &Place,
        lexer: &mut Lexer<'_>,
        target: usize,
    ) -> Result<(String, Parameters)> {
        self.in_world_only(word, place)?;
        self.entity(word, place, lexer, Some(target))
    }

    fn option(&mut self, word: &[u8], place: &Place, lexer: &mut Lexer<'_>) -> Result<Entity> {
        self.before_world_only(word, place)?;
        let (kind, parameters) = self.entity(word, place, lexer, None)?;
        Ok(Entity { kind, parameters })
    }

    fn begin(&mut self, word: &'static str, place: &Place) -> Result<()> {
        if self.stack.len() >= DEEPEST {
            let message = format!("attributes nest deeper than the limit of {DEEPEST}");
            return Err(place
                .error(ErrorKind::Limit, message)
                .hint("end each AttributeBegin with an AttributeEnd"));
        }
        self.stack.push(Opened { word, place: place.clone(), state: self.state.clone() });
        Ok(())
    }

    fn end(&mut self, word: &'static str, place: &Place) -> Result<()> {
        let Some(opened) = self.stack.pop() else {
            let error = place.syntax(format!("this {word}End ends nothing"));
            return Err(error.hint(format!("take it out, or begin with {word}Begin")));
        };
        if opened.word != word {
            let (begun, at) = (opened.word, opened.place.location());
            let error = place.syntax(format!("{word}End where {begun}Begin, at {at}, is still open"));
            return Err(error.hint(format!("write {begun}End before it")));
        }
        self.state = opened.state;
        if word == "Object" {
            self.object = None;
        }
        Ok(())
    }

    fn attribute(&mut self, place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        let start = lexer.here();
        let name = lexer.string("the target of the parameters, such as \"shape\"")?;
        let target = TARGETS.iter().position(|&target| target == name);
        let target = target
            .ok_or_else(|| Self::unknown(&lexer.place(start), "target of Attribute", &name, TARGETS))?;
        let own = params::read(lexer)?;
        own.iter().try_for_each(|parameter| self.note_parameter("Attribute", parameter))?;
        // The colour space of rgb values is that of their definition, not that of their use.
        let parameters =
            Parameters::new(String::new(), place.clone(), self.state.space, own, &Inherited::default());
        for parameter in parameters.into_own() {
            parameter.space.set(Some(self.state.space));
            self.state.attributes[target].push(parameter);
        }
        Ok(())
    }

    fn concatenate(&mut self, matrix: DMat4) {
        let look = self.options.look;
        self.set_matrices(self.state.matrices().map(|before| before * matrix));
        self.options.look = look;
    }

    /// Sets the matrices at those times that are active.
    fn set_matrices(&mut self, [start, end]: [DMat4; 2]) {
        if self.state.at_start {
            self.state.matrix = start;
            self.options.look = None;
        }
        if self.state.at_end {
            self.state.end_matrix = end;
        }
    }

    fn active_transform(&mut self, lexer: &mut Lexer<'_>) -> Result<()> {
        let start = lexer.here();
        (self.state.at_start, self.state.at_end) = match lexer.token()? {
            Some(Token::Word(b"StartTime")) => (true, false),
            Some(Token::Word(b"EndTime")) => (false, true),
            Some(Token::Word(b"All")) => (true, true),
            _ => return Err(lexer.wrong(start, "StartTime, EndTime or All")),
        };
        Ok(())
    }

    fn object_begin(&mut self, place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        self.in_world_only(b"ObjectBegin", place)?;
        let start = lexer.here();
        let name = lexer.string("a quoted name of an object")?;
        if self.object.is_some() {
            return Err(place.invalid("objects cannot be nested").hint("write ObjectEnd before it"));
        }
        if let Some(id) = self.objects.get(&name) {
            let before = &self.scene.objects[id.index()].at;
            let error =
                lexer.place(start).invalid(format!("object {name:?} is already defined, at {before}"));
            return Err(error.hint("give one of them another name"));
        }
        self.begin("Object", place)?;
        let id = ObjectId(self.scene.objects.len() as u32);
        self.scene.objects.push(Object { name: name.clone(), at: place.location(), shapes: Vec::new() });
        self.objects.insert(name, id);
        self.object = Some(id);
        Ok(())
    }

    pub(super) fn place_instances(&mut self) -> Result<()> {
        for (name, place, matrices) in std::mem::take(&mut self.instances) {
            let Some(&object) = self.objects.get(&name) else {
                return Err(Self::unknown(&place, "object", &name, self.objects.keys().map(String::as_str)));
            };
            if !matrices.iter().all(transform::is_invertible) {
                self.context.warn(&place.location(), "left out: its transform flattens it to nothing");
                continue;
            }
            self.push_instance(place.location(), object, matrices);
        }
        Ok(())
    }

    /// Places an object by its matrices at the start and the end of the transform times.
    pub(super) fn push_instance(&mut self, at: Location, object: ObjectId, [start, end]: [DMat4; 2]) {
        let motion = Motion::between(&start, &end, self.shutter_fractions());
        for (part, inner) in self.moving.get(&object).into_iter().flatten() {
            let outer = motion.clone().unwrap_or_else(|| Motion::standing(start));
            let motion = Some(Arc::new(outer.of(inner)));
            let world_from_object = motion.as_ref().map_or(start, |motion| motion.at_opening());
            let instance = Instance { motion, ..Instance::new(at.clone(), *part, world_from_object) };
            self.scene.instances.push(instance);
        }
        let motion = motion.map(Arc::new);
        let world_from_object = motion.as_ref().map_or(start, |motion| motion.at_opening());
        self.scene.instances.push(Instance { motion, ..Instance::new(at, object, world_from_object) });
    }

    /// The opening and the closing of the shutter as fractions of the transform times.
    pub(super) fn shutter_fractions(&self) -> [f64; 2] {
        let [start, end] = self.transform_times;
        self.shutter.map(|time| (f64::from(time) - start) / (end - start))
    }

    /// The material with this name, which may be defined later.
    pub(super) fn material_named(&mut self, name: &str, place: &Place) -> MaterialId {
        if let Some(named) = self.materials.get(name) {
            return named.id;
        }
        self.reserve_material(name, place)
    }

    fn world_begin(&mut self, place: &Place) -> Result<()> {
        self.before_world_only(b"WorldBegin", place)?;
        if let Some(opened) = self.stack.last() {
            let error = place.syntax(format!("WorldBegin while {}Begin is still open", opened.word));
            return Err(error.hint(format!("write {}End before it", opened.word)));
        }
        self.in_world = true;
        (self.state.matrix, self.state.end_matrix) = (DMat4::IDENTITY, DMat4::IDENTITY);
        (self.state.at_start, self.state.at_end) = (true, true);
        self.coordinate_systems.insert("world".to_owned(), [DMat4::IDENTITY; 2]);
        self.settle_options()
    }

    /// Sets camera, film and the other options before the world, or their defaults.
    fn settle_options(&mut self) -> Result<()> {
        let mut options = std::mem::take(&mut self.options);
        if self.is_old() {
            let Options { film, filter, sampler, integrator, camera, .. } = &mut options;
            let camera = camera.as_mut().map(|(entity, _)| entity);
            let entities = [film.as_mut(), filter.as_mut(), sampler.as_mut(), integrator.as_mut(), camera];
            let words = ["Film", "PixelFilter", "Sampler", "Integrator", "Camera"];
            for (word, entity) in words.into_iter().zip(entities) {
                if let Some(Entity { kind, parameters }) = entity {
                    let place = parameters.place.clone();
                    self.translate((word, &place), kind, parameters.own_mut());
                }
            }
        }
        self.film(options.film.as_ref(), options.camera.as_ref().map(|(entity, _)| entity))?;
        self.filter(options.filter.as_ref())?;
        self.sampler(options.sampler.as_ref())?;
        self.integrator(options.integrator.as_ref())?;
        self.camera(options.camera.as_ref(), &options.camera_medium)?;
        if let Some(camera) = &mut self.scene.camera {
            camera.target = options.target;
        }
        let entities = [options.film, options.filter, options.sampler, options.integrator];
        let entities = entities.into_iter().chain([options.camera.map(|(entity, _)| entity)]).flatten();
        entities.for_each(|entity| entity.parameters.finish(self.context));
        Ok(())
    }
}

/// The colour space with this name.
pub(super) fn color_space(name: &str, place: &Place) -> Result<Space> {
    let known = || space::names();
    let found = known().find(|known| known.eq_ignore_ascii_case(name));
    found.ok_or_else(|| {
        let words: Vec<&str> = known().collect();
        let error = place.invalid(format!("{name:?} is not a known colour space"));
        error.hint(format!("there are: {}", words.join(", ")))
    })
}
