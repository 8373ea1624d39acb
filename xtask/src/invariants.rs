//! The rules of the code map that the compiler does not check.
//!
//! 1. Every crate forbids unsafe code; one that has a module with unsafe code denies it, and only
//!    the modules listed here and in `docs/architecture.md` have any.
//! 2. Our crates depend on each other in one direction.
//! 3. Dependencies with a gatekeeper are named by that crate alone: file formats by
//!    `rayflock-import`, the SIMD crate by `rayflock-geom`, and there by `simd` alone, the graphics
//!    card by `rayflock-gpu`.
//! 4. `geom`, `scene`, `engine` and `render` do no input or output, so that they run in a browser.
//!
//! Dependencies of tests are free.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// Which of our crates each of them may depend on.
const ALLOWED: [(&str, &[&str]); 13] = [
    ("rayflock-geom", &[]),
    ("rayflock-scene", &["rayflock-geom"]),
    ("rayflock-engine", &["rayflock-geom"]),
    ("rayflock-import", &["rayflock-geom", "rayflock-scene"]),
    ("rayflock-render", &["rayflock-geom", "rayflock-scene", "rayflock-engine"]),
    ("rayflock-gpu", &["rayflock-geom", "rayflock-scene", "rayflock-engine", "rayflock-render"]),
    ("rayflock-oracle", &["rayflock-geom"]),
    (
        "rayflock-testkit",
        &["rayflock-geom", "rayflock-engine", "rayflock-scene", "rayflock-oracle"],
    ),
    (
        "rayflock",
        &[
            "rayflock-geom",
            "rayflock-scene",
            "rayflock-engine",
            "rayflock-import",
            "rayflock-render",
            "rayflock-gpu",
        ],
    ),
    ("rayflock-bench", &["rayflock", "rayflock-oracle"]),
    ("rayflock-cli", &["rayflock", "rayflock-bench"]),
    ("rayflock-python", &["rayflock", "rayflock-cli"]),
    ("xtask", &[]),
];

/// Modules with unsafe code, by crate.
const UNSAFE_MODULES: [(&str, &str); 2] =
    [("rayflock-bench", "src/peer/embree/ffi.rs"), ("rayflock-geom", "src/prefetch.rs")];

/// Dependencies that few crates may name. The program writes PLY, so it may name that crate too.
const GATEKEEPERS: [(&str, &[&str]); 13] = [
    ("fearless_simd", &["rayflock-geom"]),
    ("gltf", &["rayflock-import"]),
    ("tobj", &["rayflock-import"]),
    ("ply-rs-bw", &["rayflock-import", "rayflock-cli"]),
    ("stl_io", &["rayflock-import"]),
    ("ndarray-npy", &["rayflock-import", "rayflock-cli"]),
    ("roxmltree", &["rayflock-import"]),
    ("zip", &["rayflock-import"]),
    ("libloading", &["rayflock-bench"]),
    ("obvhs", &["rayflock-bench"]),
    ("pcd-rs", &["rayflock-import"]),
    ("webp-animation", &["rayflock-cli"]),
    ("wgpu", &["rayflock-gpu"]),
];

/// Crates that do no input or output, and what would be some.
const PURE: [&str; 4] = ["rayflock-geom", "rayflock-scene", "rayflock-engine", "rayflock-render"];
const IMPURE: [&str; 4] = ["std::fs", "std::net", "std::process", "std::io::std"];

/// Checks every crate of the repository and reports all that is wrong.
pub(crate) fn check(root: &Path) -> Result<()> {
    let mut wrongs = Vec::new();
    for member in members(root)? {
        wrongs.extend(check_crate(&member)?);
    }
    if wrongs.is_empty() { Ok(()) } else { bail!("invariants broken:\n  {}", wrongs.join("\n  ")) }
}

fn members(root: &Path) -> Result<Vec<PathBuf>> {
    let mut members = vec![root.join("xtask")];
    for entry in fs::read_dir(root.join("crates")).context("cannot list crates/")? {
        members.push(entry?.path());
    }
    members.sort();
    Ok(members)
}

fn check_crate(member: &Path) -> Result<Vec<String>> {
    let name = member.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let read = |path: &Path| {
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))
    };
    let manifest = read(&member.join("Cargo.toml"))?;
    let mut wrongs = wrong_dependencies(&name, &dependencies(&manifest));
    for source in sources(&member.join("src"))? {
        let inside = source.strip_prefix(member).unwrap_or(&source).to_string_lossy().into_owned();
        wrongs.extend(wrong_source(&name, &inside, &read(&source)?));
    }
    Ok(wrongs)
}

/// All Rust files below `folder`.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in
        fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?
    {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The names under `[dependencies]`. Manifests here write a dependency a line.
fn dependencies(manifest: &str) -> Vec<&str> {
    let lines = manifest.lines().map(str::trim);
    let section = lines.skip_while(|line| *line != "[dependencies]").skip(1);
    let entries = section.take_while(|line| !line.starts_with('['));
    let name = |line: &'_ str| line.find(['.', '=', ' ']).unwrap_or(0);
    entries.map(|line| &line[..name(line)]).filter(|name| !name.is_empty()).collect()
}

fn wrong_dependencies(name: &str, dependencies: &[&str]) -> Vec<String> {
    let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
        return vec![format!("{name}: not in the table of dependencies of xtask's invariants.rs")];
    };
    let ours = dependencies.iter().filter(|dependency| dependency.starts_with("rayflock"));
    let against_direction = ours
        .filter(|dependency| !allowed.contains(dependency))
        .map(|dependency| format!("{name}: must not depend on {dependency}"));
    let past_gatekeeper = GATEKEEPERS
        .iter()
        .filter(|(dependency, keepers)| {
            !keepers.contains(&name) && dependencies.contains(dependency)
        })
        .map(|(dependency, keepers)| {
            format!("{name}: only {} may depend on {dependency}", keepers.join(" and "))
        });
    against_direction.chain(past_gatekeeper).collect()
}

/// What is wrong with the source file `path` (from the crate's folder) of crate `name`.
fn wrong_source(name: &str, path: &str, text: &str) -> Vec<String> {
    let mut wrongs = Vec::new();
    let is_root = ["src/lib.rs", "src/main.rs"].contains(&path);
    let has_exception = UNSAFE_MODULES.iter().any(|(exception, _)| *exception == name);
    let level = if has_exception { "#![deny(unsafe_code)]" } else { "#![forbid(unsafe_code)]" };
    if is_root && !text.contains(&format!("\n{level}\n")) {
        wrongs.push(format!("{name}/{path}: lacks {level}"));
    }
    let excepts =
        ["expect", "allow"].iter().any(|word| text.contains(&format!("{word}(unsafe_code")));
    if excepts && !UNSAFE_MODULES.contains(&(name, path)) {
        wrongs.push(format!("{name}/{path}: is no listed module with unsafe code"));
    }
    let is_simd = path == "src/simd.rs" || path.starts_with("src/simd/");
    if name == "rayflock-geom" && !is_simd && text.contains("fearless_simd") {
        wrongs.push(format!("{name}/{path}: only src/simd.rs and src/simd/ name fearless_simd"));
    }
    if PURE.contains(&name) {
        let impure = IMPURE.iter().filter(|impure| text.contains(**impure));
        wrongs
            .extend(impure.map(|impure| format!("{name}/{path}: does no I/O, yet uses {impure}")));
    }
    wrongs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_repository_keeps_its_invariants() {
        check(crate::root()).unwrap();
    }

    #[test]
    fn dependencies_end_where_the_next_section_begins() {
        let manifest = "[package]\nname = \"x\"\n\n[dependencies]\nglam.workspace = true\n\
                        rayon = \"1\"\n\n[dev-dependencies]\ngltf = \"1\"\n";
        assert_eq!(dependencies(manifest), ["glam", "rayon"]);
    }

    #[test]
    fn a_dependency_against_the_direction_is_found() {
        let wrongs = wrong_dependencies("rayflock-engine", &["rayflock-scene", "gltf", "glam"]);
        assert_eq!(wrongs.len(), 2, "{wrongs:?}");
        assert_eq!(wrong_dependencies("rayflock-new", &[]).len(), 1);
    }

    #[test]
    fn unsafe_roots_input_and_stray_simd_are_found() {
        let wrongs = |name, path, text: &str| wrong_source(name, path, text).len();
        assert_eq!(wrongs("rayflock", "src/lib.rs", "//! Front.\n"), 1);
        assert_eq!(wrongs("rayflock", "src/lib.rs", "//! x\n#![forbid(unsafe_code)]\n"), 0);
        assert_eq!(wrongs("rayflock-bench", "src/lib.rs", "//! x\n#![deny(unsafe_code)]\n"), 0);
        let expect = concat!("#![expect", "(unsafe_code, reason = \"x\")]");
        assert_eq!(wrongs("rayflock-bench", "src/peer/embree/ffi.rs", expect), 0);
        assert_eq!(wrongs("rayflock-bench", "src/peer.rs", expect), 1);
        assert_eq!(wrongs("rayflock-geom", "src/ray.rs", "use fearless_simd::f32x16;"), 1);
        assert_eq!(wrongs("rayflock-geom", "src/simd/x.rs", "use fearless_simd::f32x16;"), 0);
        assert_eq!(wrongs("rayflock-scene", "src/x.rs", "use std::fs;"), 1);
        assert_eq!(wrongs("rayflock-import", "src/x.rs", "use std::fs;"), 0);
    }
}
