//! Tables in text files: their lines, and whether they are complete.

use std::path::Path;

/// Reads a text file. A mark of the order of bytes, which some programs write first, is left out.
pub(crate) fn read(path: &Path) -> std::io::Result<String> {
    let text = std::fs::read_to_string(path)?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(text) => text.to_owned(),
        None => text,
    })
}

/// Lines that say something, with their numbers: neither empty nor remarks, which begin with #.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// Whether the last line may be cut off: a number that was cut in the middle still reads as a number.
pub(crate) fn is_cut_off(text: &str) -> bool {
    !text.ends_with('\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_numbers() {
        let found: Vec<_> = lines("a,b\n\n # remark\n 1,2 \n").collect();
        assert_eq!(found, [(1, "a,b"), (4, "1,2")]);
        assert!(is_cut_off("1,2") && !is_cut_off("1,2\n"));
    }
}
