//! How does a glTF 2.0 file become a scene? (Khronos, "glTF 2.0 Specification", 2021; ISO/IEC 12113:2022.)

mod accessor;
mod file;
mod json;
mod uri;
