//! What cargo says about the workspace and its dependencies.

use crate::command::{Failure, cargo};
use serde_json::Value;
use std::path::PathBuf;

/// The workspace and all that it depends on.
pub(crate) struct Workspace {
    pub(crate) root: PathBuf,
    pub(crate) target: PathBuf,
    pub(crate) packages: Vec<Package>,
}

/// A crate of the workspace, or a dependency on any platform.
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) version: String,
    pub(crate) license: Option<String>,
    pub(crate) manifest: PathBuf,
    /// Whether it is ours.
    pub(crate) member: bool,
    /// Names of what it asks for, in whatever role.
    pub(crate) dependencies: Vec<String>,
}

impl Workspace {
    pub(crate) fn load() -> Result<Self, Failure> {
        let text = cargo("metadata --format-version 1 --locked --all-features").output()?;
        let metadata: Value = serde_json::from_str(&text).map_err(|e| Failure(format!("cargo metadata: {e}")))?;
        let members: Vec<String> = array(&metadata["workspace_members"]).map(string).collect();
        let packages = array(&metadata["packages"])
            .map(|package| Package {
                name: string(&package["name"]),
                version: string(&package["version"]),
                license: package["license"].as_str().map(str::to_owned),
                manifest: string(&package["manifest_path"]).into(),
                member: members.contains(&string(&package["id"])),
                dependencies: array(&package["dependencies"]).map(|d| string(&d["name"])).collect(),
            })
            .collect();
        Ok(Workspace {
            root: string(&metadata["workspace_root"]).into(),
            target: string(&metadata["target_directory"]).into(),
            packages,
        })
    }
    /// The crates of the workspace.
    pub(crate) fn members(&self) -> impl Iterator<Item = &Package> {
        self.packages.iter().filter(|package| package.member)
    }
}

fn array(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn string(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}
