//! Small files that claim to be large, or would be.

use zip::CompressionMethod;

use crate::samples::{gz, npy, npz, samples};

/// What is put in place of a sound count or size, in the sample of this name and number among
/// those of the name.
const CLAIMS: [(&str, usize, &[u8], &[u8]); 12] = [
    ("a.ply", 0, b"element vertex 3", b"element vertex 4000000000"),
    ("a.ply", 1, b"element vertex 3", b"element vertex 4000000000"),
    ("a.ply", 1, b"element face 1", b"element face 4000000000"),
    ("a.stl", 1, b"\x02\0\0\0\x3f", b"\xff\xff\xff\x7f\x3f"),
    ("a.gltf", 0, b"\"count\":3,\"type\":\"VEC3\"", b"\"count\":400000000,\"type\":\"VEC3\""),
    ("a.gltf", 0, b"\"byteLength\":140,", b"\"byteLength\":4000000000,"),
    ("a.aff", 0, b"vertices 3", b"vertices 2000000000"),
    ("a.vtk", 0, b"POINTS 4", b"POINTS 2000000000"),
    ("a.vtk", 1, b"CELLS 2 1", b"CELLS 2000000000 2000000000"),
    ("a.vtp", 0, b"NumberOfPoints=\"3\"", b"NumberOfPoints=\"2000000000\""),
    ("b.pc2", 0, b"\x02\0\0\0\x3f", b"\xff\xff\xff\x7f\x3f"),
    ("b.mdd", 0, b"\0\0\0\x02\0\0\0\x03", b"\x7f\xff\xff\xff\0\0\0\x03"),
];

/// A few kilobytes that unfold to 32 MiB.
pub(crate) fn bombs() -> Vec<(&'static str, Vec<u8>)> {
    let zeros = vec![0; 32 << 20];
    let array = npy("<f4", "(2796000, 3)", &zeros);
    let deflated = CompressionMethod::Deflated;
    vec![("a.stl.gz", gz(&zeros)), ("a.npz", npz(&[("vertices", array)], deflated))]
}

/// The samples with their claims, each with its name.
pub(crate) fn large_claims() -> Vec<(&'static str, Vec<u8>)> {
    let claim = |(name, idx, honest, claimed): (&'static str, usize, &[u8], &[u8])| {
        let mut named = samples().into_iter().filter(|(other, _)| *other == name);
        let (_, bytes) = named.nth(idx).expect("there is such a sample");
        let mut windows = bytes.windows(honest.len());
        let at = windows.position(|window| window == honest).expect("the sample has the count");
        let (before, behind) = (&bytes[..at], &bytes[at + honest.len()..]);
        (name, [before, claimed, behind].concat())
    };
    CLAIMS.into_iter().map(claim).collect()
}
