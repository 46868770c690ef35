//! Tests of primitives as text: the inputs, exactly, then each number.

use std::fmt::{self, Write};

use super::{exact, full, full64};
use crate::inspect::{Candidate, Number, RayReport, Test, TestNumbers, TraversalReport};

/// The ray as it is tested: exactly.
pub(super) fn write_traced(f: &mut String, ray: &RayReport, pad: &str) -> fmt::Result {
    if ray.candidates.is_empty() {
        return Ok(());
    }
    let TraversalReport { nodes, culled, tests } = ray.traversal;
    writeln!(
        f,
        "{pad}  visits {nodes} nodes of the BVH, culls {culled} boxes, is tested against {tests} primitives"
    )?;
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
        writeln!(f, "{pad}  … and {hidden} more candidates, all rejected or farther (--json shows them)")?;
    }
    Ok(())
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
    writeln!(f, "{pad}    {:<14} {:>16} {:>24} {:>14}", "", "f32", "f64", "matching bits")?;
    for (name, Number { f32, f64, bits }) in numbers {
        let (f32, f64) = (full(*f32), full64(*f64));
        writeln!(f, "{pad}    {name:<14} {f32:>16} {f64:>24} {bits:>14}")?;
    }
    Ok(())
}
