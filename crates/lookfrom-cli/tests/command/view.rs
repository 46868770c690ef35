//! `lookfrom view`: the address, the page, the end.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Command, Stdio};

use super::stage::Stage;

#[test]
fn the_first_line_is_the_address_of_the_page_and_an_interrupt_ends_it() {
    let stage = Stage::new("view");
    let mut child = stage.command("view scene.toml").stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let (host, path) = line.trim().strip_prefix("http://").and_then(|url| url.split_once('/')).unwrap();
    assert!(host.starts_with("127.0.0.1:") && path.starts_with("?token="), "{line}");
    for (path, expected) in [(format!("/{path}"), "200"), ("/?token=0".to_owned(), "403")] {
        let mut stream = TcpStream::connect(host).unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.lines().next().unwrap().contains(expected), "{path}: {answer}");
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn what_cannot_be_served_is_refused() {
    let stage = Stage::new("view-refused");
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    for (typed, code, says) in [
        ("view nowhere/missing.toml", 1, "missing.toml: no such file"),
        ("view missing.png", 1, "missing.png: no such file"),
        ("view scene.toml --port 70000", 2, "--port"),
        ("view scene.toml --host example.org", 2, "--host"),
        (&format!("view scene.toml --port {port}"), 3, "cannot serve at 127.0.0.1"),
    ] {
        let run = stage.run(typed);
        assert_eq!(run.code, Some(code), "{typed}: {}", run.stderr);
        assert!(run.stderr.contains(says) && run.stdout.is_empty(), "{typed}: {}", run.stderr);
    }
}

#[test]
fn an_allocation_that_a_window_does_not_follow_is_told() {
    let stage = Stage::new("view-allocation");
    let warns = |options: &str| {
        let run = stage.run(&format!("view scene.toml --export page.html --samples 8 {options}"));
        assert_eq!(run.code, Some(0), "{options}: {}", run.stderr);
        run.stderr.contains("warning: --allocation adaptive is not followed")
    };
    assert!(warns("--allocation adaptive"));
    assert!(!warns("--allocation uniform") && !warns(""));
}
