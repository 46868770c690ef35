//! Lens systems against the lens maker's equation, a slow tracer, and brute force.
use super::*;
