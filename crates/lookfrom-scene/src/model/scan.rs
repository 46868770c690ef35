//! Scanner for line-oriented text formats.
//!
//! It handles line ends of all kinds (LF, CR LF, CR) and the locations of words; readers of the formats interpret the
//! words.

use crate::error::Location;

/// A cursor over the words and lines of a text.
#[derive(Clone)]
pub(crate) struct Scanner<'a> {
    bytes: &'a [u8],
    position: usize,
    line: u32,
    line_start: usize,
    word_start: usize,
    /// Whether a backslash before a line end continues the line.
    joins_lines: bool,
}

impl<'a> Scanner<'a> {
    /// A scanner at the start of `bytes`, which is line 1.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0, line: 1, line_start: 0, word_start: 0, joins_lines: false }
    }

    /// A scanner for formats in which a backslash at the end of a line, before blanks or not, continues the line.
    pub(crate) fn joining_lines(bytes: &'a [u8]) -> Self {
        Self { joins_lines: true, ..Self::new(bytes) }
    }

    /// Number of the line, from 1.
    pub(crate) fn line(&self) -> u32 {
        self.line
    }

    /// Number of bytes before the cursor.
    pub(crate) fn position(&self) -> usize {
        self.position
    }

    /// The location of the last word (or rest of a line) that was read.
    pub(crate) fn at(&self, file: &Location) -> Location {
        let before = &self.bytes[self.line_start.min(self.word_start)..self.word_start];
        let column = String::from_utf8_lossy(before).chars().count() + 1;
        file.at(self.line, u32::try_from(column).unwrap_or(0))
    }

    /// The next word of this line; empty at the end of the line.
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        self.word_start = self.position;
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&byte| byte <= b' ').unwrap_or(rest.len());
        self.position += length;
        // A backslash that continues the line is not part of the word before it.
        if self.joins_lines && length > 0 && rest[length - 1] == b'\\' && self.continued(self.position) > 0 {
            self.position -= 1;
            return &rest[..length - 1];
        }
        &rest[..length]
    }

    /// The next word of this line or of following lines; empty at the end of the text.
    pub(crate) fn word_across_lines(&mut self) -> &'a [u8] {
        loop {
            let word = self.word();
            if !word.is_empty() || !self.next_line() {
                return word;
            }
        }
    }

    /// The rest of this line, trimmed; the cursor stays on the line.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        self.skip_blanks();
        self.word_start = self.position;
        let rest = &self.bytes[self.position..];
        let length = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(rest.len());
        self.position += length;
        rest[..length].trim_ascii()
    }

    /// Moves to the start of the next line; false at the end of the text.
    pub(crate) fn next_line(&mut self) -> bool {
        let rest = &self.bytes[self.position..];
        match rest.iter().position(|&byte| byte == b'\n' || byte == b'\r') {
            Some(length) => {
                self.position += length;
                self.pass_line_end(self.line_end(self.position));
                self.position < self.bytes.len()
            }
            None => {
                self.position = self.bytes.len();
                false
            }
        }
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position) {
            let joined =
                if self.joins_lines && byte == b'\\' { self.continued(self.position + 1) } else { 0 };
            if joined > 0 {
                self.pass_line_end(1 + joined);
            } else if byte <= b' ' && byte != b'\n' && byte != b'\r' {
                self.position += 1;
            } else {
                break;
            }
        }
    }

    /// The length in bytes of the line end at `position`; 0 where there is none.
    fn line_end(&self, position: usize) -> usize {
        match self.bytes.get(position) {
            Some(b'\n') => 1,
            Some(b'\r') => 1 + usize::from(self.bytes.get(position + 1) == Some(&b'\n')),
            _ => 0,
        }
    }

    /// The length in bytes of the line end behind a backslash at `position - 1`, and of blanks before it; 0 where there is none.
    fn continued(&self, position: usize) -> usize {
        let rest = &self.bytes[position.min(self.bytes.len())..];
        let blanks = rest.iter().take_while(|&&byte| byte == b' ' || byte == b'\t').count();
        match self.line_end(position + blanks) {
            0 => 0,
            length => blanks + length,
        }
    }

    fn pass_line_end(&mut self, length: usize) {
        self.position += length;
        self.line = self.line.saturating_add(1);
        self.line_start = self.position;
        self.word_start = self.position;
    }
}

/// A word for messages: at most 40 characters of it.
pub(crate) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(200)]);
    let mut short: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if short.len() < text.len() && text.chars().count() > 40 {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_line_ends_count_once() {
        let mut scanner = Scanner::new(b"a\nb\r\nc\rd");
        let mut seen = Vec::new();
        loop {
            seen.push((scanner.word()[0], scanner.line()));
            if !scanner.next_line() {
                break;
            }
        }
        assert_eq!(seen, [(b'a', 1), (b'b', 2), (b'c', 3), (b'd', 4)]);
    }

    #[test]
    fn joined_lines_keep_their_numbers() {
        let mut scanner = Scanner::joining_lines(b"f 1\\\r\n 2 \\\n3\nx\\y");
        let words: Vec<_> =
            std::iter::from_fn(|| Some(scanner.word()).filter(|word| !word.is_empty())).collect();
        assert_eq!(words, [b"f", b"1", b"2", b"3"]);
        assert_eq!(scanner.line(), 3);
        assert!(scanner.next_line());
        assert_eq!(scanner.word(), b"x\\y");
    }

    #[test]
    fn blanks_behind_a_backslash_change_nothing() {
        let mut scanner = Scanner::joining_lines(b"f 1 \\ \t\n2\\  \r\n3 \\ 4\n");
        let words: Vec<_> =
            std::iter::from_fn(|| Some(scanner.word()).filter(|word| !word.is_empty())).collect();
        assert_eq!(words, [&b"f"[..], b"1", b"2", b"3", b"\\", b"4"]);
        assert_eq!(scanner.line(), 3);
    }

    #[test]
    fn columns_count_characters() {
        let mut scanner = Scanner::new("é b".as_bytes());
        scanner.word();
        scanner.word();
        assert_eq!(scanner.at(&Location::default()).column, 3);
    }
}
