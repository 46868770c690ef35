//! Scenes, sessions, pictures and films for Python. The Python code checks what users pass and gives results their shape; here
//! are the calls of the library, without the GIL.

pub(crate) mod command;
mod error;
mod files;
mod film;
mod labels;
mod page;
mod parts;
mod picture;
pub(crate) mod replace;
mod session;
mod view;

pub(crate) use error::SceneError;
pub(crate) use film::Film;
pub(crate) use page::Page;
pub(crate) use picture::Picture;
pub(crate) use session::Session;
