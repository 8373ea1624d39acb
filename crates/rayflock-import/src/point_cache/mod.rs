//! Point caches: PC2 and MDD, the vertices of a mesh frame by frame.
//!
//! The mesh lies beside the cache and has its name: `cloth.pc2` moves `cloth.obj`, or else
//! `cloth.ply`, each also `.gz`. A cache has a point for each `v` of an OBJ file, or each vertex
//! of a PLY file. Its samples are frames, one each.
//!
//! Normals of a mesh that has some are computed anew in each frame: the mean, by area, of the
//! triangles around a point.
//!
//! **Source.** The layouts as the programs write them that exchange these files: PC2 of 3ds Max
//! (little-endian: `POINTCACHE2\0`, version 1, points, start frame, frames a sample, samples), MDD
//! of LightWave (big-endian: samples, points, the time of each sample in seconds). Positions
//! follow, sample by sample, three `f32` a point.
//!
//! **Departures.** The readers are our own, for want of a kept crate.
//!
//! **Invariants.** The size of the file is that which its header asks for at least. A frame is
//! read when it is shown.

mod base_mesh;
mod frames;
mod header;

#[cfg(test)]
mod tests;

use rayflock_scene::Scene;

use crate::ImportError;
use crate::job::Job;
use crate::sequence::add_stream;
use frames::CacheFrames;
use header::Header;

pub(crate) use base_mesh::mesh_file;

/// Reads the header of a PC2 file, and the mesh beside it.
pub(crate) fn load_pc2(job: &mut Job<'_>) -> Result<Scene, ImportError> {
    load(Header::pc2, job)
}

/// Reads the header of an MDD file, and the mesh beside it.
pub(crate) fn load_mdd(job: &mut Job<'_>) -> Result<Scene, ImportError> {
    load(Header::mdd, job)
}

fn load(
    read_header: fn(&mut Job<'_>) -> Result<Header, ImportError>,
    job: &mut Job<'_>,
) -> Result<Scene, ImportError> {
    let header = read_header(job)?;
    let (base, mut scene) = base_mesh::load(header.point_count, job)?;
    scene.frame_rate = header.frame_rate;
    add_stream(&mut scene, CacheFrames::new(job.file, header, base), job)?;
    Ok(scene)
}
