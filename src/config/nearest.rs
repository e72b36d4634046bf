//! The word that was probably meant.

/// The one of `words` nearest to `word`, if any is near: spelled alike but for a third of its
/// letters, or begun by it. Case, `_` and `-` do not count.
pub fn nearest<'a>(word: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > 64 {
        return None;
    }
    let word = word.to_lowercase().replace(['_', ' '], "-");
    words
        .into_iter()
        .filter_map(|w| {
            let distance = strsim::osa_distance(&word, w);
            let begun = word.len() >= 3 && w.starts_with(&word);
            (distance * 3 <= w.chars().count() || begun).then_some((distance, w))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, w)| w)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let words = ["rate-hz", "quiet-ms", "address", "bus"];
        for (typed, meant) in [
            ("rate_hz", Some("rate-hz")),
            ("Rate-Hz", Some("rate-hz")),
            ("rate", Some("rate-hz")),
            ("adress", Some("address")),
            ("bsu", Some("bus")),
            ("colour", None),
            ("", None),
            ("a", None),
        ] {
            assert_eq!(nearest(typed, words), meant, "{typed}");
        }
        assert_eq!(nearest(&"a".repeat(1_000_000), words), None);
    }
}
