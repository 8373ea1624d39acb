// Stands for infinity, which WGSL does not have.
const LARGEST: f32 = 3.4028e38;
