//! Numbers as people read them, and texts as pages take them.

use std::borrow::Cow;
use std::time::Duration;

/// At most `digits` digits, with a power of ten only where it is hard to read without.
#[must_use]
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    if (1e-3..1e5).contains(&value.abs()) {
        return scientific.parse::<f64>().map_or(scientific, |rounded| format!("{rounded}"));
    }
    match scientific.split_once('e') {
        Some((mantissa, exponent)) if mantissa.contains('.') => {
            format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => scientific,
    }
}

/// A whole number with its thousands set apart.
#[must_use]
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A decimal number with the thousands of its whole part set apart; what has none is left as it is.
#[must_use]
pub fn parted(number: &str) -> String {
    let (sign, digits) = number.strip_prefix('-').map_or(("", number), |digits| ("-", digits));
    let end = digits.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(digits.len());
    match digits[..end].parse() {
        // A power of ten tells how large it is.
        Ok(whole) if !digits.contains('e') => format!("{sign}{}{}", grouped(whole), &digits[end..]),
        _ => number.to_owned(),
    }
}

/// An amount of storage.
#[must_use]
pub fn bytes(amount: u64) -> String {
    let amount = amount as f64;
    let units = [(1e12, "TB"), (1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    match units.iter().find(|(size, _)| amount >= *size) {
        Some((size, unit)) => format!("{} {unit}", number(amount / size, 3)),
        None => format!("{amount} B"),
    }
}

/// A time on the clock.
#[must_use]
pub fn clock(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{} s", number(seconds, 2)),
        10..120 => format!("{whole} s"),
        120..7200 => format!("{} min {} s", whole / 60, whole % 60),
        7200..172_800 => format!("{} h {} min", whole / 3600, whole / 60 % 60),
        _ => format!("{} d {} h", whole / 86_400, whole / 3600 % 24),
    }
}

/// A text as a terminal shows it: what would move its cursor, change its colours or the direction of writing is spelled out. Ends
/// of lines and tabs stay.
#[must_use]
pub fn plain(text: &str) -> Cow<'_, str> {
    let acts = |letter: char| letter.is_control() && !matches!(letter, '\n' | '\t') || turns(letter);
    if !text.contains(acts) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len());
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        if acts(letter) && !(letter == '\r' && letters.peek() == Some(&'\n')) {
            safe.extend(letter.escape_unicode());
        } else {
            safe.push(letter);
        }
    }
    Cow::Owned(safe)
}

/// Whether a letter changes the direction of writing or is a line break of its own.
fn turns(letter: char) -> bool {
    matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text that is no longer than so many letters, and how much is left out.
#[must_use]
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => Cow::Borrowed(text),
        Some((end, _)) => {
            let left = text[end..].chars().count() as u64;
            Cow::Owned(format!("{} ... ({} more letters)", &text[..end], grouped(left)))
        }
    }
}

/// A text with everything marked that HTML would read as its own, also within attributes, and as [`plain`] has it.
#[must_use]
pub fn escape(text: &str) -> String {
    let text = plain(text);
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            _ => safe.push(letter),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_easy_to_read() {
        assert_eq!(
            [0.0, 1.0 / 3.0, 123_456.0, 1.5e-5, 2.0e9].map(|x| number(x, 4)),
            ["0", "0.3333", "1.235e5", "1.5e-5", "2e9"]
        );
        assert_eq!([0, 999, 8000, 1_362_944].map(grouped), ["0", "999", "8,000", "1,362,944"]);
        assert_eq!([12, 4_200, 3_700_000].map(bytes), ["12 B", "4.2 kB", "3.7 MB"]);
    }

    #[test]
    fn thousands_of_decimal_numbers_are_set_apart() {
        assert_eq!(
            ["-12345.678", "999", "1000", "0.0012345", "1.5e7", "NaN", "20280"].map(parted),
            ["-12,345.678", "999", "1,000", "0.0012345", "1.5e7", "NaN", "20,280"]
        );
    }

    #[test]
    fn times_on_the_clock_have_the_units_of_their_size() {
        let shown = [0.25, 42.0, 185.0, 7500.0, 200_000.0].map(|s| clock(Duration::from_secs_f64(s)));
        assert_eq!(shown, ["0.25 s", "42 s", "3 min 5 s", "2 h 5 min", "2 d 7 h"]);
    }

    #[test]
    fn what_html_would_read_is_marked() {
        assert_eq!(escape("a < b & \"c\" > 'd'"), "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;");
    }

    #[test]
    fn what_a_terminal_would_obey_is_spelled_out() {
        assert_eq!(plain("\u{1b}[2Jgone\r\u{9b}31m \u{202e}x"), "\\u{1b}[2Jgone\\u{d}\\u{9b}31m \\u{202e}x");
        assert!(matches!(plain("a\tb\nß \u{b5}m °C 中"), Cow::Borrowed(_)));
        assert_eq!(plain("a\r\nb\r"), "a\r\nb\\u{d}");
        assert_eq!(escape("<\u{7}>"), "&lt;\\u{7}&gt;");
    }

    #[test]
    fn a_long_text_says_how_much_is_left_out() {
        assert_eq!((cut("four", 4).as_ref(), cut("äöüß!", 2).as_ref()), ("four", "äö ... (3 more letters)"));
    }
}
