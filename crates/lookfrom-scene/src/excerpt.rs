//! The line of a text file at a [`Location`], with the columns to mark, for the display of errors.
//!
//! Readers keep no text in their errors: the line is read again for display. So every location in every text format has an
//! excerpt, even those found long after reading.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use unicode_width::UnicodeWidthChar;

use crate::budget::{Budget, Reserved};
use crate::error::Location;
use crate::files::{Files, Limits};
use crate::packed;

/// Maximum width of an excerpt in columns of a terminal.
const WIDEST: usize = 96;
/// The replacement of a tab.
const TAB: &str = "    ";
/// Maximum length of a file that is read again to show a line.
const LONGEST_FILE: u64 = 1 << 28;

/// A line, or a part of it, as it can be printed: tabs are spaces, control characters are replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The line without its end; `…` marks where it was cut.
    pub text: String,
    /// The columns of a terminal to mark, counted from 0; never empty.
    pub mark: Range<usize>,
}

/// The text, and carets under the mark below it.
impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.text.trim_end())?;
        write!(f, "{}{}", " ".repeat(self.mark.start), "^".repeat(self.mark.len()))
    }
}

/// Extracts excerpts from files; the last file is cached.
pub struct Excerpts<'a> {
    files: &'a dyn Files,
    last: Option<(Arc<str>, Reserved<Vec<u8>>)>,
}

impl<'a> Excerpts<'a> {
    /// Excerpts of these files.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, last: None }
    }

    /// The line at a location, or `None` if no line is known, the file cannot be read (again), or it is not text there.
    pub fn of(&mut self, at: &Location) -> Option<Excerpt> {
        let line_index = usize::try_from(at.line.checked_sub(1)?).ok()?;
        if self.last.as_ref().is_none_or(|(file, _)| *file != at.file) {
            let path = Path::new(&*at.file);
            let bytes = self.files.read(path, LONGEST_FILE).ok()?;
            let limits = Limits { file_bytes: LONGEST_FILE, ..Limits::default() };
            let bytes = packed::unpacked(bytes.into(), path, &limits, &Budget::default()).ok()?;
            self.last = Some((at.file.clone(), bytes));
        }
        let (_, bytes) = self.last.as_ref()?;
        let line = bytes.split(|&byte| byte == b'\n').nth(line_index)?;
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let line = if line_index == 0 { line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line) } else { line };
        (!line.contains(&0)).then(|| cut(&String::from_utf8_lossy(line), at.column as usize))
    }
}

/// The excerpt of a line that marks the token at a column, from 1; 0 marks the whole line.
fn cut(line: &str, column: usize) -> Excerpt {
    // A line may be the whole of a large file: text far from the mark is ignored.
    let skipped = column.saturating_sub(2 * WIDEST);
    let mut rest = line.chars().skip(skipped);
    let characters: Vec<char> = rest.by_ref().take(6 * WIDEST).collect();
    let (is_begun, is_left) = (skipped > 0, rest.next().is_some());
    let marked = match column.checked_sub(1 + skipped) {
        Some(first) => first.min(characters.len())..token_end(&characters, first),
        None => {
            let is_text = |c: &char| !c.is_whitespace();
            let first = characters.iter().position(is_text).unwrap_or(0);
            first..characters.iter().rposition(is_text).map_or(0, |last| last + 1)
        }
    };
    // The printed form of each character, and its column in the line before any cut.
    let mut printed = Vec::with_capacity(characters.len());
    let mut starts = vec![0];
    for &character in &characters {
        let text = match character {
            '\t' => TAB.to_owned(),
            c => harmless(c).to_string(),
        };
        let width: usize = text.chars().filter_map(UnicodeWidthChar::width).sum();
        starts.push(starts.last().unwrap_or(&0) + width);
        printed.push(text);
    }
    let end = characters.len();
    let mark = starts[marked.start]..starts[marked.end.min(end)].max(starts[marked.start] + 1);

    // A part of the line that contains the start of the mark, a third from its left if the line is cut there.
    let is_whole = starts[end] <= WIDEST && !is_begun && !is_left;
    let from = match is_whole || (mark.end < WIDEST && !is_begun) {
        true => 0,
        false => starts.partition_point(|&start| start + WIDEST / 3 < mark.start).min(marked.start),
    };
    let left = if from > 0 || is_begun { "…" } else { "" };
    let shown = |column: usize| column - starts[from] + left.chars().count();
    let fits = |index: &usize| shown(starts[index + 1]) < WIDEST;
    let to = if is_whole { end } else { (from..end).take_while(fits).last().map_or(from, |last| last + 1) };
    let right = if to < end || is_left { "…" } else { "" };
    let text = format!("{left}{}{right}", printed[from..to].concat());
    let shown_end = shown(starts[to]) + right.chars().count();
    let start = shown(mark.start);
    Excerpt { text, mark: start..shown(mark.end).min(shown_end).max(start + 1) }
}

/// A character as it can be printed. Control characters are commands to a terminal, and bidirectional ones must not reorder
/// the displayed text (Boucher & Anderson 2021).
fn harmless(character: char) -> char {
    match character {
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => char::REPLACEMENT_CHARACTER,
        c if c.is_control() => char::REPLACEMENT_CHARACTER,
        c => c,
    }
}

/// A text as it can be printed: names in it may have any characters. Lines and tabs stay.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if matches!(c, '\n' | '\t') { c } else { harmless(c) }).collect()
}

/// The end of the token that begins at a character: a word, a string, or brackets with their content.
fn token_end(line: &[char], first: usize) -> usize {
    let Some(&opening) = line.get(first) else { return first };
    let is_word = |c: char| !c.is_whitespace() && !"=,;()[]{}\"'".contains(c);
    match opening {
        '"' | '\'' => string_end(line, first).unwrap_or(line.len()),
        '[' | '{' => brackets_end(line, first).unwrap_or(first + 1),
        c if is_word(c) => first + line[first..].iter().take_while(|&&c| is_word(c)).count(),
        _ => first + 1,
    }
}

/// The end of a string, after its closing quote.
fn string_end(line: &[char], first: usize) -> Option<usize> {
    let mut index = first + 1;
    while let Some(&c) = line.get(index) {
        if c == line[first] {
            return Some(index + 1);
        }
        index += if c == '\\' { 2 } else { 1 };
    }
    None
}

/// The end of brackets that are closed in this line.
fn brackets_end(line: &[char], first: usize) -> Option<usize> {
    let (mut index, mut depth) = (first, 0_usize);
    while let Some(&c) = line.get(index) {
        match c {
            '"' | '\'' => {
                index = string_end(line, index)?;
                continue;
            }
            '[' | '{' => depth += 1,
            ']' | '}' if depth == 1 => return Some(index + 1),
            ']' | '}' => depth -= 1,
            _ => {}
        }
        index += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Memory;

    fn rows(line: &str, column: usize) -> [String; 2] {
        let shown = cut(line, column).to_string();
        let (text, mark) = shown.split_once('\n').expect("two rows");
        [text.to_owned(), mark.to_owned()]
    }

    #[test]
    fn tokens_are_marked_as_a_whole() {
        for (line, column, mark) in [
            ("color = [1, 0, 0]", 1, "^^^^^"),
            ("color = [1, 0, 0]", 9, "        ^^^^^^^^^"),
            ("color = [1, 0, 0]", 13, "            ^"),
            ("[[light]] # one", 1, "^^^^^^^^^"),
            ("name = \"a \\\" b\" # c", 8, "       ^^^^^^^^"),
            ("a = [\"]\", { b = 1 }]", 5, "    ^^^^^^^^^^^^^^^^"),
            ("a = [1,", 5, "    ^"),
            ("a = \"open", 5, "    ^^^^^"),
            ("end", 4, "   ^"),
            ("end", 40, "   ^"),
            ("", 1, "^"),
            ("  f 1 2 x  ", 0, "  ^^^^^^^"),
            ("", 0, "^"),
        ] {
            assert_eq!(rows(line, column)[1], mark, "{line} {column}");
        }
    }

    #[test]
    fn tabs_wide_and_combining_characters_and_control_characters_keep_the_mark_in_place() {
        assert_eq!(rows("\tä = é", 4), ["    ä = é".to_owned(), "      ^".to_owned()]);
        assert_eq!(rows("名前 = x", 6), ["名前 = x".to_owned(), "       ^".to_owned()]);
        assert_eq!(rows("名前 = x", 1)[1], "^^^^");
        assert_eq!(rows("e\u{301} = x", 6)[1], "    ^");
        assert_eq!(
            rows("a\u{1b}[31m\u{202e} = x", 9),
            ["a\u{fffd}[31m\u{fffd} = x".to_owned(), " ".repeat(8) + "^"]
        );
    }

    #[test]
    fn texts_give_a_terminal_no_commands() {
        let text = printable("a\u{1b}]0;b\u{7}\u{9b}31m\r\u{202e}\n\té");
        assert_eq!(text, "a\u{fffd}]0;b\u{fffd}\u{fffd}31m\u{fffd}\u{fffd}\n\té");
    }

    #[test]
    fn long_lines_are_cut_around_the_mark() {
        let mut line = vec!['a'; 5000];
        for place in [0, 1, 40, 90, 95, 96, 97, 200, 3000, 4990, 4999] {
            line.fill(' ');
            line[place] = '!';
            let [text, mark] = rows(&(line.iter().collect::<String>() + "b"), place + 1);
            let column = mark.chars().position(|c| c == '^').expect("a mark");
            assert_eq!(text.chars().nth(column), Some('!'), "{place}: {text}");
            assert!(text.chars().count() <= WIDEST + 1 && mark.chars().count() <= WIDEST + 1);
            assert_eq!(text.starts_with('…'), place >= 95);
        }
        // Zero-width characters take no columns, however many there are.
        let accents = "\u{301}".repeat(3000);
        let [text, mark] = rows(&format!("{accents}!{accents}"), 3001);
        assert!(text.starts_with('…') && text.ends_with('…') && text.contains('!') && mark.ends_with(" ^"));
        // A mark that is too long ends with the excerpt.
        let [text, mark] = rows(&format!("{}\"{}\"", " ".repeat(500), "x".repeat(500)), 501);
        assert!(mark.chars().count() <= text.chars().count() && text.ends_with('…'));
    }

    #[test]
    fn lines_end_with_or_without_a_carriage_return_and_files_may_be_gone() {
        let text = b"\xef\xbb\xbfone\r\ntwo \xff\r\n\r\nl\0st".to_vec();
        let files = Memory([("a.toml".into(), text)].into());
        let mut excerpts = Excerpts::new(&files);
        let whole = Location::file(Path::new("a.toml"));
        let mut text = |line, column| excerpts.of(&whole.at(line, column)).map(|excerpt| excerpt.text);
        assert_eq!(text(1, 1).as_deref(), Some("one"));
        assert_eq!(text(2, 5).as_deref(), Some("two \u{fffd}"));
        assert_eq!(text(3, 1).as_deref(), Some(""));
        assert_eq!([text(4, 1), text(5, 1), text(0, 0), text(u32::MAX, u32::MAX)], [None, None, None, None]);
        let gone = Location::file(Path::new("b.toml")).at(1, 1);
        assert_eq!(Excerpts::new(&files).of(&gone), None);
    }
}
