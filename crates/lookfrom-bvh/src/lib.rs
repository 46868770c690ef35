//! Rays against geometry.
