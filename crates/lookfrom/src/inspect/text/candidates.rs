//! Tests of primitives as text: the inputs, exactly, then each number.

use std::fmt::{self, Write};

use lookfrom_scene::plural::counted;

use super::{exact, full, full64};
use crate::inspect::{Candidate, Number, RayReport, Test, TestNumbers, TraversalReport};

/// The ray as it is tested: exactly.
pub(super) fn write_traced(f: &mut String, ray: &RayReport, pad: &str) -> fmt::Result {
    if ray.candidates.is_empty() {
        return Ok(());
    }
    writeln!(f, "{pad}  {}", work(&ray.traversal, " of the BVH"))?;
    let d = ray.direction.map(f64::from);
    writeln!(f, "{pad}  for the tests, relative to the render origin, in f32:")?;
    writeln!(f, "{pad}    a = {}", exact(&ray.origin.map(f64::from)))?;
    writeln!(f, "{pad}    d = {}", exact(&d))
}

pub(super) fn write_candidates(f: &mut String, ray: &RayReport, others: usize, pad: &str) -> fmt::Result {
    let (shown, hidden) = chosen(&ray.candidates, others);
    for candidate in shown {
        writeln!(f, "{pad}  tested {}: {}", candidate.name, candidate.verdict)?;
        write_test(f, &candidate.test, pad)?;
    }
    if hidden > 0 {
        let hidden = counted(hidden, "more candidate");
        writeln!(f, "{pad}  … and {hidden}, all rejected or farther")?;
    }
    Ok(())
}

/// The work of a traversal, with `of` behind its nodes.
pub(super) fn work(&TraversalReport { nodes, culled, tests }: &TraversalReport, of: &str) -> String {
    let [nodes, culled, tests] = [(nodes, "node"), (culled, "box"), (tests, "primitive")]
        .map(|(count, noun)| counted(count, noun).to_string());
    format!("visits {nodes}{of}, culls {culled}, is tested against {tests}")
}

/// The nearest hit and the first few others, and the number of those left out.
fn chosen(candidates: &[Candidate], others: usize) -> (Vec<&Candidate>, usize) {
    let mut shown: Vec<&Candidate> = candidates.iter().filter(|candidate| candidate.is_nearest).collect();
    shown.extend(candidates.iter().filter(|candidate| !candidate.is_nearest).take(others));
    let hidden = candidates.len() - shown.len();
    (shown, hidden)
}

/// The inputs of a test, exactly, then each of its numbers. The ray's own numbers are the ray's.
fn write_test(f: &mut String, test: &Test, pad: &str) -> fmt::Result {
    let TestNumbers { inputs, numbers } = test.numbers();
    for (name, value) in inputs.iter().filter(|(name, _)| !matches!(*name, "a" | "d")) {
        writeln!(f, "{pad}    {name} = {}", exact(value))?;
    }
    if numbers.is_empty() {
        return Ok(());
    }
    let width = numbers.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(14);
    writeln!(f, "{pad}    {:<width$} {:>16} {:>24} {:>14}", "", "f32", "f64", "matching bits")?;
    for (name, Number { f32, f64, bits }) in numbers {
        let (f32, f64) = (full(*f32), full64(*f64));
        writeln!(f, "{pad}    {name:<width$} {f32:>16} {f64:>24} {bits:>14}")?;
    }
    Ok(())
}
