//! Names of files from labels.

/// The text with `-` in place of every character that is no letter or digit of ASCII, dot, `_` or `-`:
/// what stands in the name of a file for a label.
///
/// ```
/// use unilateral::study::file_name;
/// assert_eq!(file_name("wopsip:facet-means@eta=1e5"), "wopsip-facet-means-eta-1e5");
/// ```
pub fn file_name(label: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    label.chars().map(|c| if is_plain(c) { c } else { '-' }).collect()
}
