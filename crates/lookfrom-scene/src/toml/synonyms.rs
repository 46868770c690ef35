//! Words that other renderers, file formats and textbooks use, and ours for the same thing.
//!
//! A word leads to several of ours, for it depends on the table which of them there is: what is suggested is always one that
//! the table in question has.

mod choices;
mod keys;
#[cfg(test)]
mod tests;

use self::choices::CHOICES;
use self::keys::KEYS;

/// Our keys, of those that a table knows, for a word that it does not know; empty where there are none.
pub(super) fn keys(word: &str, known: &[&'static str]) -> &'static [&'static str] {
    let word = plain(word);
    KEYS.iter()
        .filter(|(words, _)| words.contains(&&*word))
        .flat_map(|(_, groups)| *groups)
        .find(|group| group.iter().all(|key| known.contains(key)))
        .copied()
        .unwrap_or_default()
}

/// What to choose, of what can be chosen, in place of a word that cannot: as the end of a sentence.
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

/// A word however it is joined: `pixelSamples`, `pixel_samples` and `pixel-samples` are one.
fn plain(word: &str) -> String {
    word.chars().filter(|c| !"_- ".contains(*c)).take(40).flat_map(char::to_lowercase).collect()
}
