//! Tells the program of which commit it is: as `git` knows it, or as `cargo package` noted it; else nothing is said.

#![allow(clippy::print_stdout, reason = "a build script talks to cargo by printing")]

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Digits of a commit that are shown.
const DIGITS: usize = 10;

fn main() {
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    // A package that lies within another repository is not of the commit of that one.
    let noted = package.join(".cargo_vcs_info.json");
    let commit = if noted.exists() { of_package(&noted) } else { package.ancestors().nth(2).and_then(of_repository) };
    let commit = commit.filter(|commit| commit.len() >= DIGITS && commit.bytes().all(|byte| byte.is_ascii_hexdigit()));
    let version = commit.map_or(version.clone(), |commit| format!("{version} ({})", &commit[..DIGITS]));
    println!("cargo::rustc-env=TDEM_VERSION={version}");
    println!("cargo::rerun-if-changed=build.rs");
}

/// What `cargo package` noted: `{"git": {"sha1": "..."}}`.
fn of_package(noted: &Path) -> Option<String> {
    println!("cargo::rerun-if-changed={}", noted.display());
    let text = fs::read_to_string(noted).ok()?;
    Some(text.split_once("\"sha1\"")?.1.split('"').nth(1)?.to_owned())
}

/// The commit that is checked out in the repository of a folder.
fn of_repository(root: &Path) -> Option<String> {
    let entry = root.join(".git");
    // In a worktree a file says where the folder is.
    let folder = if entry.is_dir() {
        entry
    } else {
        root.join(fs::read_to_string(&entry).ok()?.strip_prefix("gitdir:")?.trim())
    };
    let common = fs::read_to_string(folder.join("commondir"));
    let common = common.map_or_else(|_| folder.clone(), |path| folder.join(path.trim()));
    let read = |path: &Path| {
        println!("cargo::rerun-if-changed={}", path.display());
        fs::read_to_string(path).ok()
    };
    let head = read(&folder.join("HEAD"))?;
    let Some(reference) = head.strip_prefix("ref:").map(str::trim) else { return Some(head.trim().to_owned()) };
    let loose = common.join(reference);
    // A file that is not there would have everything built anew each time.
    let commit = if loose.exists() { read(&loose) } else { None };
    commit.map(|commit| commit.trim().to_owned()).or_else(|| {
        let packed = read(&common.join("packed-refs"))?;
        let line = packed.lines().find(|line| line.ends_with(&format!(" {reference}")))?;
        line.split(' ').next().map(str::to_owned)
    })
}
