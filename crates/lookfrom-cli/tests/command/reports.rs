//! The reports that the guide shows are those that the program prints.
//!
//! A file of the guide shows lines of a report in blocks of ```text. The reports are those of the commands `lookfrom inspect` in
//! the same file, indented or in a comment `<!-- lookfrom inspect … -->`. Lines of a block are lines of one report, in its order;
//! others may be left out, and `…` stands for some. With `LOOKFROM_ACCEPT=1` the lines are replaced by those that are printed now.

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The files that show reports: of the guide, and the first page.
fn files() -> Vec<PathBuf> {
    let guide = std::fs::read_dir(root().join("docs/guide")).unwrap().map(|entry| entry.unwrap().path());
    let texts = guide.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let mut files: Vec<PathBuf> = texts.chain([root().join("README.md")]).collect();
    files.retain(|path| std::fs::read_to_string(path).unwrap().contains("```text\n"));
    files.sort();
    files
}

/// The reports of the commands in a text.
fn reports(text: &str) -> Vec<Vec<String>> {
    let words = |line: &str| {
        let comment = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->"));
        let command = comment.or_else(|| line.strip_prefix("    ")).unwrap_or_default();
        let command = command.split(" #").next().unwrap_or_default().trim();
        let arguments = command.strip_prefix("lookfrom inspect ")?;
        // Drawings are files; the report is the same without.
        let mut words: Vec<String> = arguments.split_whitespace().map(str::to_owned).collect();
        if let Some(at) = words.iter().position(|word| word == "--svg") {
            words.drain(at..at + 2);
        }
        Some(words)
    };
    let mut commands: Vec<Vec<String>> = text.lines().filter_map(words).collect();
    commands.sort();
    commands.dedup();
    commands
        .iter()
        .map(|words| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_lookfrom"));
            let output = command.current_dir(root()).arg("inspect").args(words).output().unwrap();
            assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
        })
        .collect()
}

/// What a line is about, whatever its numbers are: the beginnings of its first words.
fn subject(line: &str) -> String {
    // The letter of an exponent is no word.
    let words = line.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty() && *word != "e");
    words.take(5).map(|word| word.chars().take(4).collect::<String>()).collect::<Vec<_>>().join(" ")
}

/// Whether a line of a block is one of a report, whatever its indentation, or the end of one.
fn is_same(printed: &str, shown: &str) -> bool {
    printed.trim_end().ends_with(shown.trim())
}

/// The lines of a report that a block shows now, in its order, as many as can be: for each line of the block the index of one
/// about the same. Lines of dots stand for others.
fn followed(block: &[&str], report: &[String], from: usize) -> Vec<Option<usize>> {
    let mut next = from;
    block
        .iter()
        .map(|line| {
            let wanted = subject(line);
            if is_ellipsis(line) {
                return None;
            }
            let exact = report[next..].iter().position(|other| is_same(other, line));
            let alike = || report[next..].iter().position(|other| subject(other) == wanted);
            let at = next + exact.or_else(alike)?;
            next = at + 1;
            Some(at)
        })
        .collect()
}

fn is_ellipsis(line: &str) -> bool {
    matches!(line.trim(), "" | "…")
}

/// The block as it is printed now: by the report, and the place in it, that agrees best.
fn printed(block: &[&str], reports: &[Vec<String>]) -> Vec<String> {
    let Some(first) = block.iter().find(|line| !is_ellipsis(line)) else { return Vec::new() };
    let mut best: Option<([i64; 3], Vec<String>)> = None;
    for report in reports {
        let begins = |line: &str| is_same(line, first) || subject(line) == subject(first);
        for start in (0..report.len()).filter(|start| begins(&report[*start])) {
            let places = followed(block, report, start);
            let found: Vec<usize> = places.iter().flatten().copied().collect();
            let same = |(place, line): &(&Option<usize>, &&str)| {
                place.is_some_and(|place| is_same(&report[place], line))
            };
            let exact = places.iter().zip(block).filter(same).count() as i64;
            let length = found.last().map_or(0, |last| last - start) as i64;
            let score = [exact, found.len() as i64, -length];
            if best.as_ref().is_none_or(|(known, _)| score > *known) {
                let line = |(place, line): (&Option<usize>, &&str)| match place {
                    Some(place) if !is_same(&report[*place], line) => {
                        let indent = line.len() - line.trim_start().len();
                        format!("{:indent$}{}", "", report[*place].trim_start())
                    }
                    _ => (*line).to_owned(),
                };
                best = Some((score, places.iter().zip(block).map(line).collect()));
            }
        }
    }
    best.map_or_else(|| block.iter().map(|line| (*line).to_owned()).collect(), |(_, lines)| lines)
}

#[test]
fn the_guide_shows_what_is_printed() {
    let mut wrong = Vec::new();
    let files = files();
    assert!(files.len() > 2, "{files:?}");
    for path in files {
        let file = path.file_name().unwrap().display();
        let text = std::fs::read_to_string(&path).unwrap();
        let reports = reports(&text);
        assert!(!reports.is_empty(), "{file} has no command");
        let (mut now, mut block, mut blocks): (Vec<String>, Option<Vec<&str>>, usize) = (Vec::new(), None, 0);
        for line in text.lines() {
            match (&mut block, line) {
                (None, "```text") => {
                    block = Some(Vec::new());
                    now.push(line.to_owned());
                }
                (Some(lines), "```") => {
                    let shown = printed(lines, &reports);
                    for (before, after) in lines.iter().zip(&shown) {
                        let is_there = |report: &Vec<String>| report.iter().any(|line| is_same(line, before));
                        if !is_ellipsis(before) && (before != after || !reports.iter().any(is_there)) {
                            wrong.push(format!("{file}: {before}\n     now: {after}"));
                        }
                    }
                    now.extend(shown);
                    now.push(line.to_owned());
                    (block, blocks) = (None, blocks + 1);
                }
                (Some(lines), line) => lines.push(line),
                (None, line) => now.push(line.to_owned()),
            }
        }
        assert!(blocks > 0 && block.is_none(), "{file}");
        if std::env::var_os("LOOKFROM_ACCEPT").is_some() {
            std::fs::write(&path, now.join("\n") + "\n").unwrap();
        }
    }
    let is_accepted = std::env::var_os("LOOKFROM_ACCEPT").is_some();
    assert!(
        is_accepted || wrong.is_empty(),
        "LOOKFROM_ACCEPT=1 writes what is printed:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_error_that_the_guide_shows_is_printed() {
    let guide = std::fs::read_to_string(root().join("docs/guide/command.md")).unwrap();
    let stage = super::stage::Stage::new("reports-error");
    let head = "[camera]\nlookfrom = [0, 1, 5]\nlookat = [0, 0, 0]\n\n[[sphere]]\nradius = 1\nmaterial = \"paint\"\n\n";
    stage.write(
        "scene.toml",
        &format!("{head}[materials.paint]\ntype = \"coated_diffuse\"\n\ncolor = [1, 0, 0]\n"),
    );
    let said = stage.run("render scene.toml").stderr;
    for line in said.lines().filter(|line| !line.trim().is_empty()) {
        assert!(guide.contains(line.trim_end()), "not in the guide: {line}");
    }
}
