// Light that mirrors and glass throw, on its way to the points that gather it.

struct Photon {
    // Off the surface, where points that lights may light are too.
    position: vec3f,
    unused_a: u32,
    // What it brings.
    flux: vec3f,
    unused_b: u32,
    // Shading normal of the surface, on the side where it arrives.
    normal: vec3f,
    unused_c: u32,
    // Where it travels, of unit length.
    direction: vec3f,
    unused_d: u32,
}

// Photons in the order in which they were left.
struct PhotonStore {
    // Those included for which there was no room.
    count: atomic<u32>,
    // Of those that are sorted, how many have a place.
    placed: atomic<u32>,
    unused_a: u32,
    unused_b: u32,
    photons: array<Photon>,
}
