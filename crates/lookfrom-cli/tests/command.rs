//! The command as a person runs it: files in, pictures, words and exit codes out.

mod command {
    mod compare;
    mod convert;
    mod denoise;
    mod enough;
    mod errors;
    mod farm;
    mod film;
    mod guide;
    mod help;
    mod info;
    mod inputs;
    mod inspect;
    #[cfg(unix)]
    mod interrupt;
    mod json;
    mod layers;
    mod library;
    mod memory;
    mod models;
    mod naming;
    mod pinned;
    mod pipes;
    mod render;
    mod reports;
    mod schema;
    mod series;
    mod stage;
    mod terminal;
    mod variables;
    #[cfg(all(unix, feature = "view"))]
    mod view;
    #[cfg(unix)]
    mod watch;
}
