//! What readers of volumes share: [NanoVDB](crate::nanovdb) and OpenVDB.

pub(crate) mod blosc;
pub(crate) mod bytes;
pub(crate) mod zip;
