//! Names of what a document defines, each once, and of the files beside it.

use std::collections::BTreeSet;

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
        for (index, name) in given.iter().enumerate().filter(|(index, _)| used[*index]) {
            if names[index].is_none() {
                names[index] = Some(unused(&allowed(kind, name), &mut taken));
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

/// A name that a document can have where an expression, keyframes or a colour could stand, too.
pub(super) fn allowed(kind: &str, name: &str) -> String {
    match name {
        "" => kind.to_owned(),
        "keyframes" => format!("{kind} {name}"),
        _ if name.starts_with(['=', '#']) => format!("{kind} {name}"),
        _ => name.to_owned(),
    }
}

/// The name, with a number where it is taken.
fn unused(name: &str, taken: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{name} {number}"));
    let found = std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken.contains(name));
    let found = found.unwrap_or_default();
    taken.insert(found.clone());
    found
}

/// Names of files in one folder, whatever the case of letters means there.
#[derive(Default)]
pub(super) struct FileNames(BTreeSet<String>);

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
        let numbered = (2..).map(|number| format!("{stem}-{number}.{ending}"));
        let mut names = std::iter::once(format!("{stem}.{ending}")).chain(numbered);
        names.find(|name| self.0.insert(name.to_lowercase())).unwrap_or_default()
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
