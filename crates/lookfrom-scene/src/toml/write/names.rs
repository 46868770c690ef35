//! Names of what a document defines, each once, and of the files beside it.

use std::collections::{BTreeMap, BTreeSet};

/// The longest name of a file in bytes, without its ending.
const LONGEST: usize = 60;

/// The names of things of one kind that are in use, by their numbers.
pub(super) struct Names(Vec<Option<String>>);

impl Names {
    /// The names of those that are used, each once, in the order of their numbers; `kind` is the name of one without any.
    pub(super) fn new<'a>(kind: &str, given: impl Iterator<Item = &'a str>, used: &[bool]) -> Self {
        let given: Vec<&str> = given.collect();
        let mut taken = BTreeSet::new();
        let mut names = vec![None; given.len()];
        // Those that need no change keep their names, whoever comes first.
        for (index, name) in given.iter().enumerate().filter(|(index, _)| used[*index]) {
            let allowed = allowed(kind, name);
            if allowed == *name && taken.insert(allowed.clone()) {
                names[index] = Some(allowed);
            }
        }
        let mut last = BTreeMap::new();
        for (index, name) in given.iter().enumerate().filter(|(index, _)| used[*index]) {
            if names[index].is_none() {
                let name = allowed(kind, name);
                let last = last.entry(name.clone()).or_insert(1);
                names[index] = Some(first(
                    last,
                    |number| numbered(&name, " ", number),
                    |name| taken.insert(name.to_owned()),
                ));
            }
        }
        Self(names)
    }

    /// The name of one that is used.
    pub(super) fn of(&self, index: usize) -> &str {
        self.0[index].as_deref().unwrap_or_default()
    }

    /// The numbers of those that are used, in the order of their names, as they are read again.
    pub(super) fn in_order(&self) -> Vec<usize> {
        let mut used: Vec<usize> = (0..self.0.len()).filter(|index| self.0[*index].is_some()).collect();
        used.sort_by_key(|index| &self.0[*index]);
        used
    }
}

/// A name that a table of a document can have, where keyframes or, of textures, a colour could stand, too.
fn allowed(kind: &str, name: &str) -> String {
    match name {
        "keyframes" => format!("{kind} {name}"),
        _ if name.starts_with('#') && kind == "texture" => format!("{kind} {name}"),
        _ => spoken(kind, name),
    }
}

/// A name that a value of a document can be, where an expression could stand, too.
pub(super) fn spoken(kind: &str, name: &str) -> String {
    match name {
        "" => kind.to_owned(),
        _ if name.starts_with('=') => format!("{kind} {name}"),
        _ => name.to_owned(),
    }
}

/// The name with a number from 2 on.
fn numbered(name: &str, between: &str, number: u32) -> String {
    if number == 1 { name.to_owned() } else { format!("{name}{between}{number}") }
}

/// The first name of a series that can be taken, from the last number on.
fn first(last: &mut u32, series: impl Fn(u32) -> String, mut take: impl FnMut(&str) -> bool) -> String {
    loop {
        let name = series(*last);
        *last += 1;
        if take(&name) {
            return name;
        }
    }
}

/// Names of files in one folder, whatever the case of letters means there.
#[derive(Default)]
pub(super) struct FileNames {
    /// In lower case.
    taken: BTreeSet<String>,
    /// By name without a number, the one after the last.
    last: BTreeMap<String, u32>,
}

impl FileNames {
    /// A new name with this ending: the last part of a path, in letters that every system has, with a number where it is taken.
    pub(super) fn new_name(&mut self, path: &str, ending: &str) -> String {
        let last = path.rsplit(['/', '\\']).next().unwrap_or_default();
        let stem = last.rsplit_once('.').map_or(last, |(stem, _)| stem);
        let plain = |character: char| {
            if character.is_ascii_alphanumeric() || character == '_' { character } else { '-' }
        };
        let stem: String = stem.chars().map(plain).take(LONGEST).collect();
        let stem = stem.trim_matches('-');
        let stem = if stem.is_empty() { "part" } else { stem };
        let last = self.last.entry(format!("{stem}.{ending}").to_lowercase()).or_insert(1);
        let taken = &mut self.taken;
        let series = |number| format!("{}.{ending}", numbered(stem, "-", number));
        first(last, series, |name| taken.insert(name.to_lowercase()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kept_where_they_can_be() {
        let given = ["red", "", "red", "=x", "keyframes", "red 2", "gone", "#f00"];
        let used = [true, true, true, true, true, true, false, true];
        let names = Names::new("texture", given.into_iter(), &used);
        let found: Vec<&str> = (0..given.len()).map(|index| names.of(index)).collect();
        assert_eq!(
            found,
            ["red", "texture", "red 3", "texture =x", "texture keyframes", "red 2", "", "texture #f00"]
        );
        assert_eq!(names.in_order(), [0, 5, 2, 1, 7, 3, 4]);
    }

    #[test]
    fn files_stay_in_their_folder() {
        let mut names = FileNames::default();
        let mut of = |path: &str| names.new_name(path, "ply");
        assert_eq!(of("a/../../etc/pass wd.obj"), "pass-wd.ply");
        assert_eq!(of("..\\PASS wd.x"), "PASS-wd-2.ply");
        assert_eq!(
            [of(".."), of("a/"), of("\0\n\""), of("ä")],
            ["part.ply", "part-2.ply", "part-3.ply", "part-4.ply"]
        );
        assert!(of(&"x".repeat(1000)).len() < 100);
    }
}
