//! Suggestions for unknown words: the known word of the smallest edit distance (Damerau 1964, Levenshtein 1965).

/// The candidate with the smallest edit distance, if that is small enough for a typing error; among equals the first in
/// alphabetical order.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word: Vec<char> = word.chars().flat_map(char::to_lowercase).collect();
    let near_enough = (word.len() / 3).max(1);
    if word.len() > 64 {
        return None;
    }
    candidates
        .into_iter()
        .map(|candidate| (distance(&word, candidate), candidate))
        .filter(|&(edits, _)| edits <= near_enough)
        .min()
        .map(|(_, candidate)| candidate)
}

/// The edit distance: insertions, deletions, replacements and transpositions of neighbours.
fn distance(word: &[char], candidate: &str) -> usize {
    let candidate: Vec<char> = candidate.chars().flat_map(char::to_lowercase).collect();
    let columns = candidate.len() + 1;
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..columns).collect();
    for i in 1..=word.len() {
        let mut row = vec![i; columns];
        for j in 1..columns {
            let replaced = last[j - 1] + usize::from(word[i - 1] != candidate[j - 1]);
            row[j] = replaced.min(last[j] + 1).min(row[j - 1] + 1);
            let swapped =
                i > 1 && j > 1 && word[i - 1] == candidate[j - 2] && word[i - 2] == candidate[j - 1];
            if swapped {
                row[j] = row[j].min(before_last[j - 2] + 1);
            }
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[columns - 1]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        let known = ["center", "radius", "material", "red"];
        assert_eq!(nearest("raduis", known), Some("radius"));
        assert_eq!(nearest("centre", known), Some("center"));
        assert_eq!(nearest("Material", known), Some("material"));
        assert_eq!(nearest("rad", known), Some("red"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("", known), None);
    }
}
