//! BART's AFF, the animated file format, and NFF, of which it is an extension.
//!
//! | Command | What it gives |
//! |---|---|
//! | `v`, `b`, `am` | the camera, the background, ambient light |
//! | `l`, `la` | point lights, with a name if keys may move them |
//! | `f`, `fm` | the material of what follows |
//! | `p`, `pp`, `tt`, `ttp`, `m` | polygons and meshes, flat or smooth, textured or not |
//! | `s`, `c` | spheres; cones and cylinders, as triangles |
//! | `tpa` | triangles whose corners have keys |
//! | `x`, `xs`, `{`, `}` | blocks that keys or static transforms move |
//! | `k` | keys: splines of places, turns and scales, and visibility |
//! | `a` | the interval and how many frames it has |
//! | `i`, `d` | other files, up to a level of detail |
//!
//! Words go through [`words`], [`reader`] and [`parse`] into a [`document`], which [`assemble`]
//! makes a scene of; [`kochanek_bartels`] turns keys into channels. A scene has an object for each
//! file, moving block and kind of surface, named after the file.
//!
//! **Source.** J. Lext, U. Assarsson and T. Moller, "AFF - Animated File Format", with "BART: A
//! Benchmark for Animated Ray Tracing", Technical Report 00-14, Chalmers, 2000; E. Haines,
//! "Neutral File Format" 3.1, 1987, in the Standard Procedural Databases.
//!
//! **Departures.** Without `d`, files of every level of detail are included (AFF: only level 0).
//! Keys of a light or of the camera replace its place, keys of a block move the block. A command
//! that is not known is left out with its line.

mod assemble;
mod curved;
mod document;
mod includes;
mod keys;
mod kochanek_bartels;
mod looks;
mod oddities;
mod parse;
mod part;
mod patch;
mod reader;
mod words;

#[cfg(test)]
mod tests;

use rayflock_scene::Scene;

use crate::ImportError;
use crate::job::Job;

/// Reads an AFF or NFF file and the files that it includes.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let document = parse::parse(&bytes, job)?;
    drop(bytes);
    assemble::assemble(document, job)
}
