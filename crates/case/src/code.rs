//! Stable codes, each with its explanation beside it.

use crate::problem::Severity;

/// A stable code and what it means. There is no problem without one, so that whatever is shown can be explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// Such as `tdem::case::unknown-key`.
    pub name: &'static str,
    /// How bad what has this code is.
    pub severity: Severity,
    /// Paragraphs in Markdown: what it means, then what to do.
    pub explanation: &'static str,
}

impl Code {
    /// Whether a user means this code: by all of its name, or by its end, such as `unknown-key`.
    #[must_use]
    pub fn answers_to(&self, name: &str) -> bool {
        self.name == name || self.name.strip_suffix(name).is_some_and(|rest| rest.ends_with("::"))
    }

    /// The paragraphs of the explanation, each as one line.
    pub fn paragraphs(&self) -> impl Iterator<Item = String> {
        let paragraphs = self.explanation.split("\n\n");
        paragraphs.map(|paragraph| paragraph.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

/// Declares codes. The documentation of each is its explanation, and `ALL` lists them.
///
/// ```
/// mod codes {
///     tdem_case::codes! {
///         /// The kettle is empty.
///         ///
///         /// Fill it.
///         error KETTLE_EMPTY = "kitchen::kettle-empty";
///     }
/// }
/// assert_eq!(codes::KETTLE_EMPTY.name, "kitchen::kettle-empty");
/// assert_eq!(codes::ALL[0].paragraphs().collect::<Vec<_>>(), ["The kettle is empty.", "Fill it."]);
/// ```
#[macro_export]
macro_rules! codes {
    ($($(#[doc = $line:literal])+ $severity:ident $name:ident = $code:literal;)+) => {
        $(
            $(#[doc = $line])+
            pub const $name: $crate::Code = $crate::Code {
                name: $code,
                severity: $crate::codes!(@ $severity),
                explanation: concat!($($line, "\n"),+),
            };
        )+
        /// All codes of this module.
        pub const ALL: &[$crate::Code] = &[$($name),+];
    };
    (@ error) => { $crate::Severity::Error };
    (@ warning) => { $crate::Severity::Warning };
}
