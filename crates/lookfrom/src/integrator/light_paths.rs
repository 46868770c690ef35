//! Light-path expressions: regular expressions over what light did on its way from the camera to where it comes from. A
//! layer of the picture has the contributions whose ways its expression describes.
//!
//! Heckbert (1990), "Adaptive Radiosity Textures for Bidirectional Ray Tracing", for the letters; the notation is that of
//! Open Shading Language (see `grammar`). All expressions are compiled to one finite automaton, whose state paths carry.

mod grammar;

use lookfrom_scene::settings::{CHANNEL_NAME, LightPathLayer, is_channel_name};
use lookfrom_scene::suggest;
use lookfrom_scene::{Error, Location, Result};
use regex_automata::Anchored;
use regex_automata::MatchKind;
use regex_automata::dfa::{Automaton, StartKind, dense};
use regex_automata::nfa::thompson;
use regex_automata::util::primitives::StateID;
use regex_automata::util::syntax;

use super::Term;
use crate::core::spectrum::Spectrum;
use crate::shading::bsdf::lobes::Lobes;
use grammar::{Ending, Labels, Symbol, is_transmittance, pattern};

/// Names that channels of other contents have.
const TAKEN: &[&str] = &[
    "A", "Albedo", "B", "G", "N", "Ns", "P", "R", "Variance", "Z", "band", "depth", "film", "motion",
    "noisy", "u", "v",
];

/// Maximum number of layers.
const MOST_LAYERS: usize = 64;

/// Largest automaton, in bytes.
const LARGEST: usize = 4 << 20;

/// State of a path in the automaton of light-path expressions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightPathState(u32);

/// Compiled light-path expressions, one for each layer.
#[derive(Debug)]
pub struct LightPaths {
    automaton: dense::DFA<Vec<u32>>,
    start: LightPathState,
    /// The symbol of each light, by its index.
    lights: Vec<Symbol>,
    /// For each layer whether it has the transmittance of media.
    are_transmittances: Vec<bool>,
}

/// The two ways on which light of a light that was sampled may have been scattered last, and their shares.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastScattering {
    /// The states after a diffuse and after a glossy lobe.
    states: [LightPathState; 2],
    /// The share of the diffuse lobes in the contribution, 0 … 1 by lane; the glossy ones have the rest.
    diffuse: Spectrum,
}

impl LightPaths {
    /// Compiles the expressions of layers. `lights` are the lights' names, by index, and whether each is an environment.
    ///
    /// # Errors
    /// `Invalid` for an expression that is not one, or too large; for a name that is taken, used twice or not a word; for
    /// a light that is not there; for more than 64 layers.
    pub fn new<'a>(
        layers: &[LightPathLayer],
        lights: impl Iterator<Item = (&'a str, bool)> + Clone,
    ) -> Result<Self> {
        if layers.len() > MOST_LAYERS {
            let message = format!("{} light-path layers; at most {MOST_LAYERS} are possible", layers.len());
            return Err(Error::invalid(&layers[MOST_LAYERS].at, message));
        }
        for (index, LightPathLayer { name, at, .. }) in layers.iter().enumerate() {
            check_name(name, at)?;
            if layers[..index].iter().any(|other| other.name == *name) {
                return Err(Error::invalid(at, format!("two light-path layers are named {name:?}")));
            }
        }

        // Only names that occur in expressions tell lights apart.
        let mut labels = Labels::default();
        let patterns = layers
            .iter()
            .map(|layer| pattern(&layer.expression, &mut labels).map_err(|error| error.of(layer)))
            .collect::<Result<Vec<String>>>()?;
        let label_of = |name: &str| labels.iter().position(|label| is_called(name, label));
        let symbol = |(name, is_environment)| {
            let ending = if is_environment { Ending::Background } else { Ending::Light };
            Symbol::ending(ending, label_of(name))
        };
        let symbols = lights.clone().map(symbol).collect();
        for (number, label) in labels.iter().enumerate() {
            if !lights.clone().any(|(name, _)| label_of(name) == Some(number)) {
                return Err(no_light(label, layers, lights.map(|(name, _)| name)));
            }
        }

        let too_large = |_| {
            Error::invalid(&Location::default(), "the light-path expressions have too many states together")
                .hint("use less repetition by numbers, {n,m}")
        };
        let automaton = dense::Builder::new()
            .configure(
                dense::Config::new()
                    .start_kind(StartKind::Anchored)
                    .match_kind(MatchKind::All)
                    .dfa_size_limit(Some(LARGEST))
                    .determinize_size_limit(Some(LARGEST)),
            )
            .syntax(syntax::Config::new().unicode(false).utf8(false))
            .thompson(thompson::Config::new().nfa_size_limit(Some(LARGEST)))
            .build_many(&patterns)
            .map_err(too_large)?;
        let start = automaton.universal_start_state(Anchored::Yes).unwrap_or_default();
        let are_transmittances = layers.iter().map(|layer| is_transmittance(&layer.expression)).collect();
        Ok(Self { automaton, start: state(start), lights: symbols, are_transmittances })
    }

    /// Number of layers.
    pub fn count(&self) -> usize {
        self.are_transmittances.len()
    }

    /// Sets the layers of transmittance of a sample, as light whose colour white has.
    pub(super) fn set_transmittance(&self, value: Spectrum, layers: &mut [Spectrum]) {
        let transmittances = layers.iter_mut().zip(&self.are_transmittances).filter(|(_, is)| **is);
        transmittances.for_each(|(layer, _)| *layer = value);
    }

    /// The state of a path that leaves the camera.
    pub(crate) fn start(&self) -> LightPathState {
        self.start
    }

    /// The state after light was scattered by one lobe. Cold: few pictures have layers of light paths.
    #[cold]
    pub(super) fn scattered(&self, from: LightPathState, lobe: Lobes) -> LightPathState {
        self.next(from, Symbol::scattering(lobe))
    }

    /// The ways of light that a light sends to a surface, which scatters it to one side: by diffuse lobes, of which this is
    /// the share, or by glossy ones.
    pub(super) fn last_scattering(
        &self,
        from: LightPathState,
        is_transmission: bool,
        diffuse: Spectrum,
    ) -> LastScattering {
        let state = |is_diffuse| self.scattered(from, Lobes::sampled(false, is_diffuse, is_transmission));
        LastScattering { states: [state(true), state(false)], diffuse }
    }

    /// Adds a pane that a shadow ray has passed to the way of its light.
    #[cold]
    pub(super) fn pass_pane(&self, last: &mut LastScattering) {
        let lobe = Lobes::sampled(true, false, true);
        last.states = last.states.map(|state| self.scattered(state, lobe));
    }

    /// The state after a medium has scattered light.
    #[cold]
    pub(super) fn scattered_in_medium(&self, from: LightPathState) -> LightPathState {
        self.next(from, Symbol::MEDIUM)
    }

    /// The way of light that a light sends to a point of a medium; `whole` is a share of 1.
    pub(super) fn last_scattering_in_medium(&self, from: LightPathState, whole: Spectrum) -> LastScattering {
        LastScattering { states: [self.scattered_in_medium(from); 2], diffuse: whole }
    }

    /// Adds a contribution to the layers that have it.
    pub(super) fn add(&self, from: LightPathState, term: Term, value: Spectrum, layers: &mut [Spectrum]) {
        let symbol = match term {
            Term::Light(light) | Term::Found { light, .. } => self.lights[light as usize],
            Term::Sky => Symbol::ending(Ending::Background, None),
            Term::Emission | Term::Medium => Symbol::ending(Ending::Object, None),
            Term::Ambient => Symbol::ending(Ending::Ambient, None),
            Term::Unoccluded | Term::View => return,
        };
        let end = self.automaton.next_eoi_state(id(self.next(from, symbol)));
        if self.automaton.is_match_state(end) {
            for index in 0..self.automaton.match_len(end) {
                layers[self.automaton.match_pattern(end, index).as_usize()] += value;
            }
        }
    }

    /// Adds the contribution of a light that was sampled, which has passed its shadow ray.
    pub(super) fn add_sampled(
        &self,
        last: &LastScattering,
        term: Term,
        value: Spectrum,
        layers: &mut [Spectrum],
    ) {
        let diffuse = value * last.diffuse;
        for (state, part) in last.states.into_iter().zip([diffuse, value - diffuse]) {
            if !part.is_black() {
                self.add(state, term, part, layers);
            }
        }
    }

    fn next(&self, from: LightPathState, symbol: Symbol) -> LightPathState {
        state(self.automaton.next_state(id(from), symbol.byte()))
    }
}

fn state(id: StateID) -> LightPathState {
    LightPathState(id.as_u32())
}

/// The inverse of [`state`].
fn id(LightPathState(state): LightPathState) -> StateID {
    StateID::new_unchecked(state as usize)
}

/// Whether a label of an expression is the name of a light, which may be followed by its place in a file.
fn is_called(name: &str, label: &str) -> bool {
    name.strip_prefix(label).is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("))
}

/// The error for a label that is the name of no light.
fn no_light<'a>(label: &str, layers: &[LightPathLayer], lights: impl Iterator<Item = &'a str>) -> Error {
    let quoted = format!("'{label}'");
    let layer = layers.iter().find(|layer| layer.expression.contains(&quoted));
    let at = layer.map(|layer| layer.at.clone()).unwrap_or_default();
    Error::invalid(&at, format!("no light is named {label:?}")).hint(match suggest::nearest(label, lights) {
        Some(near) => format!("did you mean {near:?}?"),
        None => "`lookfrom info` lists the lights of a scene".to_owned(),
    })
}

fn check_name(name: &str, at: &Location) -> Result<()> {
    if !is_channel_name(name) {
        let message = format!("{name:?} is no name of a layer; expected {CHANNEL_NAME}");
        return Err(Error::invalid(at, message));
    }
    if TAKEN.contains(&name) {
        return Err(Error::invalid(at, format!("the name {name:?} is that of another channel"))
            .hint("give the layer another name"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
