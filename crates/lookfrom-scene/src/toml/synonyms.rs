//! Synonyms: terms of other renderers, file formats and textbooks, and our words for them.
//!
//! A word may have several synonyms. The table in question decides between them: every suggestion is a key of that table.

mod choices;
mod keys;
#[cfg(test)]
mod tests;

use self::choices::CHOICES;
use self::keys::KEYS;

/// The synonyms of an unknown word among the keys of a table; empty if there are none.
pub(super) fn keys(word: &str, known: &[&'static str]) -> &'static [&'static str] {
    let word = plain(word);
    KEYS.iter()
        .filter(|(words, _)| words.contains(&&*word))
        .flat_map(|(_, groups)| *groups)
        .find(|group| group.iter().all(|key| known.contains(key)))
        .copied()
        .unwrap_or_default()
}

/// A suggestion of valid values in place of an unknown word, as the end of a sentence.
pub(super) fn choice(word: &str, known: &[&str]) -> Option<String> {
    let word = plain(word);
    CHOICES.iter().filter(|(words, ..)| words.contains(&&*word)).find_map(|(_, ours, besides)| {
        let there: Vec<String> =
            ours.iter().filter(|word| known.contains(word)).map(|word| format!("{word:?}")).collect();
        let last = there.last()?;
        let choice = match &there[..there.len() - 1] {
            [] => last.clone(),
            others => format!("{} or {last}", others.join(", ")),
        };
        Some(if besides.is_empty() {
            format!("did you mean {choice}?")
        } else {
            format!("write {choice}{besides}")
        })
    })
}

/// A word in normal form: `pixelSamples`, `pixel_samples` and `pixel-samples` are equal.
fn plain(word: &str) -> String {
    word.chars().filter(|c| !"_- ".contains(*c)).take(40).flat_map(char::to_lowercase).collect()
}
