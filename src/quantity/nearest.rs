//! "Did you mean": the known word nearest to one that is unknown.

/// The candidate nearest to `word`, if it is near enough to be what was meant.
///
/// Another case of the same letters wins; otherwise the fewest edits (Damerau-Levenshtein, at most one for
/// words up to three characters, then a third of the length). Ties are broken by the fewest edits that mind the case,
/// then by a beginning that is shared.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    let lower = word.to_lowercase();
    let limit = if length <= 3 { 1 } else { 1 + length / 3 };
    let mut best: Option<([usize; 3], &str)> = None;
    for candidate in candidates {
        if candidate == word {
            continue;
        }
        let candidate_lower = candidate.to_lowercase();
        let edits = strsim::damerau_levenshtein(&lower, &candidate_lower);
        // All letters replaced is no likeness; a long word may still be cut short.
        let cut = length >= 3 && candidate_lower.starts_with(&lower);
        if edits > 0 && (edits > limit || edits >= length.max(candidate.chars().count())) && !cut {
            continue;
        }
        let shared = lower.chars().zip(candidate_lower.chars()).take_while(|(a, b)| a == b).count();
        let key = [edits, strsim::damerau_levenshtein(word, candidate), usize::MAX - shared];
        if best.is_none_or(|(least, _)| key < least) {
            best = Some((key, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// `did you mean "x"?`, or nothing.
#[must_use]
pub fn did_you_mean<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, candidates).map_or_else(String::new, |near| format!("did you mean \"{near}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let keys = ["diffusion", "only_in", "representation", "R"];
        assert_eq!(nearest("difusion", keys), Some("diffusion"));
        assert_eq!(nearest("onlyin", keys), Some("only_in"));
        assert_eq!(nearest("r", keys), Some("R"));
        assert_eq!(nearest("Q", keys), None);
        assert_eq!(nearest("viscosity", keys), None);
        assert_eq!(nearest("represent", keys), Some("representation"));
        let units = ["mPa", "MPa", "Pa"];
        assert_eq!([nearest("MPaa", units), nearest("mPaa", units)], [Some("MPa"), Some("mPa")]);
        assert_eq!([nearest("Mpa", units), nearest("pa", units)], [Some("MPa"), Some("Pa")]);
    }
}
