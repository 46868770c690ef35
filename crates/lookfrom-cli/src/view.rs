//! `lookfrom view`: a server for a browser. Everything it serves is the library's.

use std::io;
use std::net::{IpAddr, Ipv4Addr};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use lookfrom_scene::load::has_known_name;
use lookfrom_scene::settings::Allocation;
use lookfrom_scene::{Disk, Error, ErrorKind, Inputs, Location};
use lookfrom_view::{Address, Server, Settings, handout};

use crate::args::ViewArguments;
use crate::exit::{DONE, Failure, INTERRUPTED, answer, in_scene, say};
use crate::output::{folder_or_here, replace_file};
use crate::{interrupt, prepare};

/// Serves until Ctrl-C, and returns the exit code. `typed` are the arguments by which `render` opens the same session.
pub(crate) fn run(arguments: &ViewArguments, typed: &[String]) -> u8 {
    if arguments.overrides.allocation == Some(Allocation::Adaptive) {
        say("warning: --allocation adaptive is not followed: a picture in a window gets finer everywhere");
    }
    if let Some(page) = &arguments.export {
        return export(arguments, typed, page).map_or_else(|failure| failure.report(), |()| DONE);
    }
    serve(arguments, typed).map_or_else(|failure| failure.report(), |()| INTERRUPTED)
}

/// Writes a hand-out.
fn export(arguments: &ViewArguments, typed: &[String], page: &Path) -> Result<(), Failure> {
    prepare::use_threads(&arguments.common)?;
    let html = handout(settings(arguments, typed), Arc::new(Disk), arguments.pixel, arguments.sample)
        .map_err(in_scene(&arguments.scene))?;
    let is_file = page.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html"));
    let page = if is_file { page.to_owned() } else { page.join("index.html") };
    if !is_file {
        let folder = folder_or_here(page.parent());
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Output(format!("{}: {error}", folder.display())))?;
    }
    replace_file(&page, html.as_bytes(), &Inputs::default(), "--export")?;
    answer(&page.display().to_string())
}

fn settings(arguments: &ViewArguments, typed: &[String]) -> Settings {
    let ViewArguments { scene, reference, common, overrides, .. } = arguments;
    Settings {
        scene: scene.clone(),
        options: overrides.options(common, None),
        environment: overrides.model.environment.clone(),
        reference: reference.clone(),
        typed: typed.to_vec(),
    }
}

fn serve(arguments: &ViewArguments, typed: &[String]) -> Result<(), Failure> {
    let ViewArguments { scene, host, port, open, common, .. } = arguments;
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
    let address = Address { host, port: *port, may_be_framed: false };
    let refused = |error: io::Error| Failure::Output(format!("cannot serve at {host}, port {port}: {error}"));
    let server = Server::bind(settings(arguments, typed), address).map_err(refused)?;
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
