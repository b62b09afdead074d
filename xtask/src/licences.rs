//! Licences of dependencies, on every platform, and of fonts: only those that let anybody use `tdem` under its own.

use crate::command::Failure;
use crate::tidy::tracked;
use crate::workspace::Workspace;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Licences that ask for nothing but a notice. BSL-1.0 is that of Boost. Weak copyleft (MPL-2.0) would do too, but
/// nothing needs it so far.
const ALLOWED: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

pub(crate) fn check(workspace: &Workspace) -> Result<(), Failure> {
    fonts(workspace)?;
    let wrong: Vec<String> = workspace
        .packages
        .iter()
        .filter(|package| !package.license.as_deref().is_some_and(allowed))
        .map(|p| format!("\n  {} {}: {}", p.name, p.version, p.license.as_deref().unwrap_or("no licence stated")))
        .collect();
    if wrong.is_empty() {
        println!("{} packages", workspace.packages.len());
        Ok(())
    } else {
        Err(Failure(format!("licences to look at, see xtask/src/licences.rs:{}", wrong.concat())))
    }
}

/// Fonts that are part of the program: the file, the licence beside it, and words of that licence that let anybody use it.
const FONTS: &[(&str, &str, &str)] = &[(
    "crates/results/fonts/DejaVuSans.ttf",
    "crates/results/fonts/LICENSE-DejaVu.txt",
    "Permission is hereby granted, free of charge, to any person obtaining a copy",
)];

/// That every font has a licence that lets anybody use it, and that there are no others.
fn fonts(workspace: &Workspace) -> Result<(), Failure> {
    let mut wrong = String::new();
    for file in tracked(workspace)? {
        let ending = file.extension().unwrap_or_default();
        if ["ttf", "otf", "woff", "woff2"].iter().any(|font| ending == *font) {
            let known = FONTS.iter().find(|(font, _, _)| file == Path::new(font));
            let licensed = known.is_some_and(|(_, licence, words)| {
                fs::read_to_string(workspace.root.join(licence)).is_ok_and(|text| text.contains(words))
            });
            if !licensed {
                let _ = write!(wrong, "\n  {}: no licence that is known lies beside it", file.display());
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(Failure(format!("fonts to look at, see xtask/src/licences.rs:{wrong}"))) }
}

/// Whether an SPDX expression leaves a choice of allowed licences.
fn allowed(expression: &str) -> bool {
    let text = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let mut words = text.split_whitespace().peekable();
    any(&mut words) && words.next().is_none()
}

type Words<'t> = std::iter::Peekable<std::str::SplitWhitespace<'t>>;

fn any(words: &mut Words<'_>) -> bool {
    let mut good = all(words);
    while words.next_if_eq(&"OR").is_some() {
        good |= all(words);
    }
    good
}

fn all(words: &mut Words<'_>) -> bool {
    let mut good = one(words);
    while words.next_if_eq(&"AND").is_some() {
        good &= one(words);
    }
    good
}

fn one(words: &mut Words<'_>) -> bool {
    if words.next_if_eq(&"(").is_some() {
        let good = any(words);
        return words.next() == Some(")") && good;
    }
    let good = words.next().is_some_and(|word| ALLOWED.contains(&word));
    if words.next_if_eq(&"WITH").is_some() {
        // An exception only adds rights.
        words.next();
    }
    good
}

#[cfg(test)]
mod tests {
    use super::allowed;

    #[test]
    fn expressions() {
        for good in [
            "MIT",
            "MIT/Apache-2.0",
            "GPL-3.0 OR MIT",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception OR Apache-2.0 OR MIT",
        ] {
            assert!(allowed(good), "{good}");
        }
        for bad in ["", "GPL-3.0", "MIT AND GPL-3.0", "(MIT OR GPL-3.0) AND GPL-3.0", "MIT MIT", "(MIT", "LGPL-2.1"] {
            assert!(!allowed(bad), "{bad}");
        }
    }
}
