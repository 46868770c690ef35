//! Lexer for pbrt scene files.
//!
//! Words, quoted strings and brackets, separated by white space and by comments from `#` to the end of the line. Words
//! are slices of the file; long lists of numbers are parsed directly into their buffers, on several threads if they are
//! very long.

use std::borrow::Cow;
use std::rc::Rc;

use super::text::{Place, Text};
use crate::error::{Error, Result};
use crate::model::number::{parse_f32, parse_f64};
use crate::parallel;

/// Minimum length in bytes of a list of numbers that is parsed on several threads.
const LONG_LIST: usize = 1 << 18;

/// A token of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A directive, a number, `true`.
    Word(&'a [u8]),
    /// The text between quotation marks, with escapes unresolved.
    Quoted(&'a [u8]),
    /// `[`
    Open,
    /// `]`
    Close,
}

/// A cursor into a file.
pub(super) struct Lexer<'a> {
    text: &'a Rc<Text>,
    bytes: &'a [u8],
    next: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a Rc<Text>) -> Self {
        let bytes = text.bytes();
        let next = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { text, bytes, next }
    }

    pub(super) fn place(&self, offset: usize) -> Place {
        Place::new(self.text, offset)
    }

    /// Offset of the next token.
    pub(super) fn here(&mut self) -> usize {
        self.skip_space();
        self.next
    }

    fn skip_space(&mut self) {
        while let Some(&byte) = self.bytes.get(self.next) {
            match byte {
                b' ' | b'\t' | b'\n' | b'\r' => self.next += 1,
                b'#' => {
                    let rest = &self.bytes[self.next..];
                    self.next += rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
                }
                _ => break,
            }
        }
    }

    /// The next token, if there is one, without consuming it.
    pub(super) fn peek(&mut self) -> Result<Option<Token<'a>>> {
        let before = self.here();
        let token = self.token();
        self.next = before;
        token
    }

    /// The next token, if there is one.
    pub(super) fn token(&mut self) -> Result<Option<Token<'a>>> {
        self.skip_space();
        let start = self.next;
        let Some(&first) = self.bytes.get(start) else { return Ok(None) };
        Ok(Some(match first {
            b'[' => {
                self.next += 1;
                Token::Open
            }
            b']' => {
                self.next += 1;
                Token::Close
            }
            b'"' => Token::Quoted(self.quoted()?),
            _ => Token::Word(self.word()),
        }))
    }

    /// The bytes up to the next one that cannot be part of a word.
    fn word(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.next..];
        let length = rest.iter().position(|&byte| ends_word(byte)).unwrap_or(rest.len());
        self.next += length;
        &rest[..length]
    }

    fn quoted(&mut self) -> Result<&'a [u8]> {
        let start = self.next;
        let mut end = start + 1;
        loop {
            match self.bytes.get(end) {
                Some(b'"') => break,
                Some(b'\\') if self.bytes.get(end + 1).is_some() => end += 2,
                None | Some(b'\n' | b'\\') => {
                    let error = self.place(start).syntax("this string has no end");
                    return Err(error.hint("close it with a `\"` on the same line"));
                }
                Some(_) => end += 1,
            }
        }
        self.next = end + 1;
        Ok(&self.bytes[start + 1..end])
    }

    /// The numbers up to the `]` that closes the list.
    pub(super) fn singles(&mut self) -> Result<Vec<f32>> {
        self.list(parse_single, "a number")
    }

    /// The whole numbers up to the `]` that closes the list.
    pub(super) fn integers(&mut self) -> Result<Vec<i32>> {
        self.list(parse_integer, "a whole number")
    }

    fn list<T: Send>(&mut self, parse: fn(&[u8]) -> Option<T>, expected: &str) -> Result<Vec<T>> {
        let rest = &self.bytes[self.next..];
        let end = rest.iter().position(|byte| matches!(byte, b']' | b'#' | b'"')).unwrap_or(rest.len());
        if end > LONG_LIST && rest[end..].first() == Some(&b']') {
            // Errors are found again below, where their location is known.
            if let Some(values) = in_pieces(&rest[..end], parse) {
                self.next += end + 1;
                return Ok(values);
            }
        }
        let mut values = Vec::with_capacity((end / 8).min(1 << 24));
        loop {
            let start = self.here();
            match self.bytes.get(start) {
                Some(b']') => {
                    self.next += 1;
                    return Ok(values);
                }
                Some(byte) if !ends_word(*byte) => {
                    let word = self.word();
                    values.push(parse(word).ok_or_else(|| self.wrong(start, expected))?);
                }
                _ => return Err(self.wrong(start, &format!("{expected} or `]`"))),
            }
        }
    }

    /// A single number.
    pub(super) fn double(&mut self) -> Result<f64> {
        let start = self.here();
        let number = match self.token()? {
            Some(Token::Word(word)) => parse_f64(word).filter(|number| number.is_finite()),
            _ => None,
        };
        number.ok_or_else(|| self.wrong(start, "a number"))
    }

    /// A quoted string.
    pub(super) fn string(&mut self, expected: &str) -> Result<String> {
        let start = self.here();
        match self.token()? {
            Some(Token::Quoted(raw)) => self.unescape(raw, start).map(Cow::into_owned),
            _ => Err(self.wrong(start, expected)),
        }
    }

    /// The text of the quoted string that starts at `start`.
    pub(super) fn unescape(&self, raw: &'a [u8], start: usize) -> Result<Cow<'a, str>> {
        if !raw.contains(&b'\\') {
            return Ok(String::from_utf8_lossy(raw));
        }
        let mut bytes = Vec::with_capacity(raw.len());
        let mut rest = raw;
        while let Some((&byte, tail)) = rest.split_first() {
            rest = tail;
            if byte != b'\\' {
                bytes.push(byte);
                continue;
            }
            let (&escaped, tail) = rest.split_first().unwrap_or((&b' ', &[]));
            rest = tail;
            bytes.push(match escaped {
                b'n' => b'\n',
                b't' => b'\t',
                b'r' => b'\r',
                b'b' => 8,
                b'f' => 12,
                b'\\' | b'\'' | b'"' => escaped,
                _ => {
                    let message = format!("`\\{}` is not a valid escape", char::from(escaped));
                    return Err(self.place(start).syntax(message).hint("write `\\\\` for a backslash"));
                }
            });
        }
        Ok(Cow::Owned(String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// The error that something else is expected at this offset.
    pub(super) fn wrong(&self, start: usize, expected: &str) -> Error {
        let mut probe = Lexer { next: start, ..*self };
        let short = |bytes: &[u8]| {
            let text = String::from_utf8_lossy(bytes);
            let cut: String = text.chars().take(40).collect();
            if cut.len() < text.len() { cut + "…" } else { cut }
        };
        let found = match probe.token() {
            Err(error) => return error,
            Ok(None) => "the end of the file".to_owned(),
            Ok(Some(Token::Open)) => "`[`".to_owned(),
            Ok(Some(Token::Close)) => "`]`".to_owned(),
            Ok(Some(Token::Word(word))) => format!("`{}`", short(word)),
            Ok(Some(Token::Quoted(raw))) => format!("\"{}\"", short(raw)),
        };
        self.place(start).syntax(format!("expected {expected}, found {found}"))
    }
}

fn ends_word(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | b'"' | b'[' | b']' | b'#')
}

/// A finite `f32`.
pub(super) fn parse_single(word: &[u8]) -> Option<f32> {
    parse_f32(word).filter(|number| number.is_finite())
}

/// A whole number, `-2.0` included.
pub(super) fn parse_integer(word: &[u8]) -> Option<i32> {
    let digits = word.strip_prefix(b"-").unwrap_or(word);
    if (1..=9).contains(&digits.len()) && digits.iter().all(u8::is_ascii_digit) {
        let magnitude = digits.iter().fold(0, |value, digit| value * 10 + i32::from(digit - b'0'));
        return Some(if digits.len() < word.len() { -magnitude } else { magnitude });
    }
    let number = parse_f64(word)?;
    let whole = number as i32;
    (f64::from(whole) == number).then_some(whole)
}

/// Parses numbers and white space in pieces that are split at white space; `None` for anything else.
fn in_pieces<T: Send>(list: &[u8], parse: fn(&[u8]) -> Option<T>) -> Option<Vec<T>> {
    let pieces = 4 * parallel::threads();
    let mut cuts = vec![0];
    for piece in 1..pieces {
        let from = (list.len() / pieces * piece).max(cuts[cuts.len() - 1]);
        cuts.push(list[from..].iter().position(|&byte| ends_word(byte)).map_or(list.len(), |gap| from + gap));
    }
    cuts.push(list.len());
    let read = |cut: &[usize]| -> Option<Vec<T>> {
        let words = list[cut[0]..cut[1]].split(|&byte| ends_word(byte)).filter(|word| !word.is_empty());
        words.map(parse).collect()
    };
    // A bracket is an error, which this function must not skip.
    if list.contains(&b'[') {
        return None;
    }
    let parts: Vec<Option<Vec<T>>> = parallel::map(cuts.windows(2).collect(), read);
    let parts: Vec<Vec<T>> = parts.into_iter().collect::<Option<_>>()?;
    let mut values = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    parts.into_iter().for_each(|part| values.extend(part));
    Some(values)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn text(content: &str) -> Rc<Text> {
        Text::new(Path::new("a.pbrt"), content.as_bytes().to_vec().into())
    }

    #[test]
    fn words_strings_brackets_and_comments() {
        let text = text("\u{feff}Shape\"a b\"[1 -2]# no \"words\"\n #\nTo#x\r\"q\\\"r\"");
        let mut lexer = Lexer::new(&text);
        let mut tokens = Vec::new();
        while let Some(token) = lexer.token().expect("good tokens") {
            tokens.push(token);
        }
        use Token::{Close, Open, Quoted, Word};
        assert_eq!(
            tokens,
            [
                Word(b"Shape"),
                Quoted(b"a b"),
                Open,
                Word(b"1"),
                Word(b"-2"),
                Close,
                Word(b"To"),
                Quoted(b"q\\\"r")
            ]
        );
        assert_eq!(lexer.unescape(b"q\\\"r\\n", 0).expect("known escapes"), "q\"r\n");
        assert!(lexer.unescape(b"\\q", 0).is_err());
    }

    #[test]
    fn strings_end_on_their_line() {
        for content in ["\"abc", "\"abc\n\"", "\"abc\\", "\"abc\\\""] {
            assert!(Lexer::new(&text(content)).token().is_err(), "{content}");
        }
    }

    #[test]
    fn whole_numbers() {
        let cases = [("7", Some(7)), ("-0", Some(0)), ("2.0", Some(2)), ("2147483647", Some(i32::MAX))];
        for (word, value) in
            cases.into_iter().chain([("2147483648", None), ("1.5", None), ("-", None), ("", None)])
        {
            assert_eq!(parse_integer(word.as_bytes()), value, "{word}");
        }
    }

    #[test]
    fn long_lists_are_read_as_short_ones() {
        let numbers: Vec<f32> = (0..200_000).map(|i| (i as f32 - 7e4) * 0.37).collect();
        let words: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        let long = text(&(words.join(" \n") + " ] after"));
        assert!(long.bytes().len() > 2 * LONG_LIST);
        let mut lexer = Lexer::new(&long);
        assert_eq!(lexer.singles().expect("numbers"), numbers);
        assert_eq!(lexer.token().expect("a word"), Some(Token::Word(b"after")));

        // The same list, parsed in one piece because it starts with a comment.
        let plain = text(&("# list\n".to_owned() + &words.join(" \n") + "]"));
        assert_eq!(Lexer::new(&plain).singles().expect("numbers"), numbers);

        let broken = text(&(words.join("\n") + " 1e999 ] after"));
        let error = Lexer::new(&broken).singles().expect_err("too large a number");
        assert_eq!((error.at.line, error.at.column), (200_000, words[199_999].len() as u32 + 2));
    }
}
