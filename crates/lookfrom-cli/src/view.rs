//! `lookfrom view`: a server for a browser. Everything it serves is the library's.

use std::io;
use std::net::{IpAddr, Ipv4Addr};
use std::process::{Command, Stdio};

use lookfrom_scene::load::has_known_name;
use lookfrom_scene::{Error, ErrorKind, Location};
use lookfrom_view::{Server, Settings};

use crate::args::ViewArguments;
use crate::exit::{Failure, INTERRUPTED, answer, say};
use crate::output::folder_or_here;
use crate::{interrupt, prepare};

/// Serves until Ctrl-C, and returns the exit code. `typed` are the arguments by which `render` opens the same session.
pub(crate) fn run(arguments: &ViewArguments, typed: &[String]) -> u8 {
    serve(arguments, typed).map_or_else(|failure| failure.report(), |()| INTERRUPTED)
}

fn serve(arguments: &ViewArguments, typed: &[String]) -> Result<(), Failure> {
    let ViewArguments { scene, host, port, open, reference, common, overrides } = arguments;
    prepare::use_threads(common)?;
    // What is wrong in a file may be mended while the page is open, and a new file may be saved; but not without a folder.
    if !scene.is_file() {
        let is_new = !scene.exists() && has_known_name(scene) && folder_or_here(scene.parent()).is_dir();
        if !is_new {
            let at = Location::file(scene);
            return Err(Failure::Scene(
                Error::new(ErrorKind::Io, &at, "no such file").hint("check the name"),
            ));
        }
        say(&format!("{} is not there yet: the page shows it as soon as it is saved", scene.display()));
    }
    let host = host.unwrap_or(IpAddr::V4(Ipv4Addr::LOCALHOST));
    let settings = Settings {
        scene: scene.clone(),
        options: overrides.options(common, None),
        environment: overrides.model.environment.clone(),
        reference: reference.clone(),
        typed: typed.to_vec(),
        host,
        port: *port,
        may_be_framed: false,
    };
    let refused = |error: io::Error| Failure::Output(format!("cannot serve at {host}, port {port}: {error}"));
    let server = Server::bind(settings).map_err(refused)?;
    let url = server.url();
    answer(&url)?;
    if !host.is_loopback() {
        say(
            "warning: --host makes the scene and its pictures available to whoever can reach this machine and learns the address",
        );
    }
    if *open && let Err(error) = open_browser(&url) {
        say(&format!("warning: no browser could be opened: {error}"));
    }
    interrupt::listen();
    interrupt::keeping(|| server.run(interrupt::asked)).map_err(refused)
}

/// Opens an address in the user's browser.
fn open_browser(url: &str) -> io::Result<()> {
    let mut command = match std::env::consts::OS {
        "macos" => Command::new("open"),
        "windows" => {
            let mut command = Command::new("cmd");
            command.args(["/C", "start", ""]);
            command
        }
        _ => Command::new("xdg-open"),
    };
    let quiet = command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.spawn().map(|_| ())
}
