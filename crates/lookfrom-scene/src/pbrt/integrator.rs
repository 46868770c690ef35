//! The `Integrator` and `Sampler` directives.

use super::Reader;
use super::lexer::{Lexer, Token};
use super::params::Parameters;
use super::state::Entity;
use super::text::Place;
use crate::error::Result;
use crate::settings::{Integrator, LightSampler, Sampler};
use crate::suggest::nearest;

/// Maximum number of samples per pixel.
const MOST_SAMPLES: i32 = 1 << 24;

const SAMPLERS: &[&str] =
    &["zsobol", "halton", "independent", "paddedsobol", "pmj02bn", "sobol", "stratified"];

const INTEGRATORS: &[&str] = &[
    "ambientocclusion",
    "bdpt",
    "function",
    "lightpath",
    "mlt",
    "path",
    "randomwalk",
    "simplepath",
    "simplevolpath",
    "sppm",
    "volpath",
];

/// Program options, and whether they would change the image.
const OPTIONS: &[(&str, bool)] = &[
    ("disablepixeljitter", true),
    ("disabletexturefiltering", false),
    ("disablewavelengthjitter", true),
    ("displacementedgescale", false),
    ("forcediffuse", true),
    ("msereferenceimage", false),
    ("msereferenceout", false),
    ("pixelstats", false),
    ("rendercoordsys", false),
    ("seed", false),
    ("wavefront", false),
];

impl Reader<'_, '_> {
    pub(super) fn sampler(&mut self, sampler: Option<&Entity>) -> Result<()> {
        let render = &mut self.scene.render;
        (render.samples, render.sampler) = (16, Sampler::Sobol);
        let Some(Entity { kind, parameters }) = sampler else { return Ok(()) };
        if !SAMPLERS.contains(&&**kind) {
            return Err(Self::unknown(&parameters.place, "sampler", kind, SAMPLERS.iter().copied()));
        }
        parameters.ignore(&["randomization", "jitter"]);
        render.samples = match &**kind {
            "stratified" => {
                let x = parameters.integer("xsamples", 4, 1, 1 << 12)?;
                let y = parameters.integer("ysamples", 4, 1, 1 << 12)?;
                (x * y) as u32
            }
            _ => parameters.integer("pixelsamples", 16, 1, MOST_SAMPLES)? as u32,
        };
        if kind == "independent" {
            render.sampler = Sampler::Independent;
        }
        if let Some(seed) = parameters.integer_or_none("seed")? {
            render.seed = u64::from(seed as u32);
        }
        Ok(())
    }

    pub(super) fn integrator(&mut self, integrator: Option<&Entity>) -> Result<()> {
        let render = &mut self.scene.render;
        (render.integrator, render.depth) = (Integrator::Path, 5);
        let Some(Entity { kind, parameters }) = integrator else { return Ok(()) };
        if !INTEGRATORS.contains(&&**kind) {
            return Err(Self::unknown(&parameters.place, "integrator", kind, INTEGRATORS.iter().copied()));
        }
        self.settle_media(kind, &parameters.place);
        let render = &mut self.scene.render;
        if kind != "ambientocclusion" {
            render.depth = parameters.integer("maxdepth", 5, 0, i32::MAX)? as u32;
        }
        self.scene.render.integrator = match &**kind {
            "simplepath" | "simplevolpath" => {
                for name in ["samplelights", "samplebsdf"] {
                    if !parameters.boolean(name, true)? {
                        let message =
                            format!("\"bool {name}\" false: both sampling techniques are used anyway");
                        self.context.notice(&parameters.place.location(), message);
                    }
                }
                Integrator::SimplePath
            }
            "randomwalk" => Integrator::RandomWalk,
            "ambientocclusion" => {
                let distance = parameters.positive("maxdistance", f32::INFINITY)?;
                self.scene.render.occlusion_distance = distance;
                Integrator::AmbientOcclusion { cosine: parameters.boolean("cossample", true)? }
            }
            "path" | "volpath" => {
                self.path(parameters)?;
                Integrator::Path
            }
            _ => {
                let other = if self.scene.render.media { "volpath" } else { "path" };
                let message = format!(
                    "the integrator {kind:?} is not supported: {other:?}, which computes the same light, is used instead"
                );
                self.context.notice(&parameters.place.location(), message);
                let theirs = [
                    "samplelights",
                    "samplebsdf",
                    "visualizestrategies",
                    "visualizeweights",
                    "bootstrapsamples",
                    "chains",
                    "mutationsperpixel",
                    "largestepprobability",
                    "sigma",
                    "photonsperiteration",
                    "radius",
                    "seed",
                    "iterations",
                    "function",
                    "skipbad",
                    "imagefilename",
                ];
                parameters.ignore(&theirs);
                self.path(parameters)?;
                Integrator::Path
            }
        };
        Ok(())
    }

    fn path(&mut self, parameters: &Parameters) -> Result<()> {
        let samplers = [
            ("bvh", LightSampler::Bvh),
            ("uniform", LightSampler::Uniform),
            ("power", LightSampler::Power),
            ("exhaustive", LightSampler::Bvh),
        ];
        self.scene.render.light_sampler = parameters.choice("lightsampler", LightSampler::Bvh, &samplers)?;
        self.scene.render.regularize = parameters.boolean("regularize", false)?;
        Ok(())
    }

    /// `Option "type name" value`, or without the type.
    pub(super) fn program_option(&mut self, place: &Place, lexer: &mut Lexer<'_>) -> Result<()> {
        let start = lexer.here();
        let declaration = lexer.string("a quoted name of an option")?;
        let name = declaration.split_ascii_whitespace().next_back().unwrap_or_default();
        // As pbrt compares them.
        let name = &*name.replace(['-', '_'], "").to_ascii_lowercase();
        let Some(&(_, matters)) = OPTIONS.iter().find(|option| option.0 == name) else {
            let error = lexer.place(start).invalid(format!("{name:?} is not a known option"));
            let words = || OPTIONS.iter().map(|option| option.0);
            return Err(match nearest(name, words()) {
                Some(meant) => error.hint(format!("did you mean {meant:?}?")),
                None => error.hint(format!("there are: {}", words().collect::<Vec<_>>().join(", "))),
            });
        };
        let is_list = lexer.peek()? == Some(Token::Open);
        if is_list {
            lexer.token()?;
        }
        let start = lexer.here();
        let value = lexer.token()?;
        match (name, value) {
            (_, None | Some(Token::Open | Token::Close)) => return Err(lexer.wrong(start, "a value")),
            ("seed", Some(Token::Word(word))) => {
                let seed =
                    super::lexer::parse_integer(word).ok_or_else(|| lexer.wrong(start, "a whole number"))?;
                self.scene.render.seed = u64::from(seed as u32);
            }
            ("displacementedgescale", Some(Token::Word(word))) => {
                let scale = super::lexer::parse_single(word).filter(|&scale| scale > 0.0);
                self.displacement_edge_scale =
                    scale.ok_or_else(|| lexer.wrong(start, "a positive number"))?;
            }
            (_, Some(Token::Word(b"true"))) if matters => {
                let message = format!("the option {name:?} makes no difference here");
                self.context.warn(&place.location(), message);
            }
            _ => {}
        }
        if is_list {
            let start = lexer.here();
            if lexer.token()? != Some(Token::Close) {
                return Err(lexer.wrong(start, "`]`"));
            }
        }
        Ok(())
    }
}
