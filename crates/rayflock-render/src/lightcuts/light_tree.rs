//! A binary tree over virtual lights.
//!
//! ```text
//!   nodes of m lights: [ cluster | nodes of the first m/2 lights | nodes of the others ]
//! ```
//!
//! Lights are halved across the widest of six extents: of positions, and of normals scaled to the
//! size of the scene. So clusters are close and face alike. Distant lights have a tree of their own,
//! where directions are positions.

use std::f32::consts::PI;

use glam::Vec3;
use rayflock_geom::Aabb;

use crate::shading::luminance::luminance;
use crate::shading::sampling::{hash, unit_float};
use crate::vpl::VirtualLights;

/// The extent of unlike normals counts as this share of the size of the scene.
const NORMAL_SHARE: f32 = 0.25;

/// Clusters of more lights are built by two threads.
const LIGHTS_PER_TASK: usize = 1024;

/// A cluster of lights, or one light.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightCluster {
    /// Around the positions; around the unit directions to distant lights.
    pub(super) bounds: Aabb,
    /// Normals deviate from `axis` by at most an angle with this cosine and sine; not bounded where
    /// the cosine is -1.
    pub(super) axis: Vec3,
    pub(super) cos: f32,
    pub(super) sin: f32,
    /// What the lights send at most, in all, along their normals and into their highlights;
    /// irradiance of distant ones.
    pub(super) intensity: Vec3,
    /// The light that speaks for all.
    pub(super) light_idx: u32,
    /// Number of lights.
    pub(super) light_count: u32,
}

/// Clusters over all lights.
#[derive(Debug, Default)]
pub(super) struct LightTree {
    nodes: Vec<LightCluster>,
    /// Of the lights without and with highlights, and of the distant ones.
    roots: [Option<u32>; 3],
    /// Working memory.
    order: Vec<u32>,
}

impl LightCluster {
    const NOTHING: Self = Self {
        bounds: Aabb::EMPTY,
        axis: Vec3::ZERO,
        cos: -1.0,
        sin: 0.0,
        intensity: Vec3::ZERO,
        light_idx: 0,
        light_count: 0,
    };

    fn of_light(lights: &VirtualLights, light_idx: u32) -> Self {
        let light = lights.get(light_idx as usize);
        let faces = light.normal != Vec3::ZERO && light.evenness == 0.0;
        let highlight = lights.lobe(light_idx as usize).map_or(Vec3::ZERO, |lobe| lobe.highlight);
        Self {
            bounds: Aabb { min: light.position, max: light.position },
            axis: light.normal,
            cos: if faces { 1.0 } else { -1.0 },
            sin: 0.0,
            intensity: light.intensity + highlight,
            light_idx,
            light_count: 1,
        }
    }

    /// Both clusters as one; `chance` from 0 to 1 chooses who speaks for it.
    fn union(&self, other: &Self, chance: f32) -> Self {
        let (axis, cos, sin) = normals_of_both(self, other);
        let (weight, other_weight) = (luminance(self.intensity), luminance(other.intensity));
        let spokes_first = chance * (weight + other_weight) < weight || other_weight <= 0.0;
        Self {
            bounds: self.bounds.union(&other.bounds),
            axis,
            cos,
            sin,
            intensity: self.intensity + other.intensity,
            light_idx: if spokes_first { self.light_idx } else { other.light_idx },
            light_count: self.light_count + other.light_count,
        }
    }
}

/// The cone around two cones of normals: axis, and cosine and sine of the half angle.
fn normals_of_both(a: &LightCluster, b: &LightCluster) -> (Vec3, f32, f32) {
    let axis = (a.axis + b.axis).normalize_or_zero();
    let half_angle = |cluster: &LightCluster| {
        let across = (cluster.axis - cluster.axis.dot(axis) * axis).length();
        across.atan2(cluster.axis.dot(axis)) + cluster.sin.atan2(cluster.cos) + 1e-5
    };
    let angle = half_angle(a).max(half_angle(b));
    if a.cos <= -1.0 || b.cos <= -1.0 || axis == Vec3::ZERO || angle >= PI {
        return (Vec3::ZERO, -1.0, 0.0);
    }
    (axis, angle.cos(), angle.sin())
}

impl LightTree {
    /// Makes this the tree of `lights`, keeping its memory.
    pub(super) fn build(&mut self, lights: &VirtualLights) {
        self.nodes.clear();
        self.roots = [None; 3];
        let ranges = [lights.plain(), lights.lobed(), lights.distant()];
        for (root, range) in self.roots.iter_mut().zip(ranges) {
            if range.is_empty() {
                continue;
            }
            self.order.clear();
            self.order.extend(range.map(|light_idx| light_idx as u32));
            let first = self.nodes.len();
            self.nodes.resize(first + 2 * self.order.len() - 1, LightCluster::NOTHING);
            *root = Some(first as u32);
            let places = self.order.iter().map(|&idx| lights.positions()[idx as usize]);
            let scale = NORMAL_SHARE * Aabb::around(places).size().length();
            build_nodes(lights, scale, &mut self.order, &mut self.nodes[first..]);
        }
    }

    /// The clusters that hold all lights.
    pub(super) fn roots(&self) -> impl Iterator<Item = u32> + '_ {
        self.roots.iter().flatten().copied()
    }

    pub(super) fn cluster(&self, node_idx: u32) -> &LightCluster {
        &self.nodes[node_idx as usize]
    }

    /// The halves of a cluster; `None` for one light.
    pub(super) fn children(&self, node_idx: u32) -> Option<[u32; 2]> {
        let first_count = self.cluster(node_idx).light_count / 2;
        (first_count > 0).then(|| [node_idx + 1, node_idx + 2 * first_count])
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.nodes.capacity() * size_of::<LightCluster>() + self.order.capacity() * size_of::<u32>()
    }
}

/// Writes the nodes of the lights `order`; `nodes.len() == 2 * order.len() - 1`.
fn build_nodes(
    lights: &VirtualLights,
    normal_scale: f32,
    order: &mut [u32],
    nodes: &mut [LightCluster],
) {
    if let [light_idx] = *order {
        nodes[0] = LightCluster::of_light(lights, light_idx);
        return;
    }
    let chance = chance_of(order[0], order.len());
    let middle = order.len() / 2;
    halve(lights, normal_scale, order, middle);
    let (first, second) = order.split_at_mut(middle);
    let (root, below) = nodes.split_at_mut(1);
    let (first_nodes, second_nodes) = below.split_at_mut(2 * middle - 1);
    if first.len() + second.len() > LIGHTS_PER_TASK {
        rayon::join(
            || build_nodes(lights, normal_scale, first, first_nodes),
            || build_nodes(lights, normal_scale, second, second_nodes),
        );
    } else {
        build_nodes(lights, normal_scale, first, first_nodes);
        build_nodes(lights, normal_scale, second, second_nodes);
    }
    root[0] = first_nodes[0].union(&second_nodes[0], chance);
}

/// Brings the lower half along the widest extent to the front.
fn halve(lights: &VirtualLights, normal_scale: f32, order: &mut [u32], middle: usize) {
    let position = |idx: u32| lights.positions()[idx as usize];
    let normal = |idx: u32| normal_scale * lights.normals()[idx as usize];
    let extent = Aabb::around(order.iter().map(|&idx| position(idx))).size();
    let turn = Aabb::around(order.iter().map(|&idx| normal(idx))).size();
    let by_place = extent.max_element() >= turn.max_element();
    let axis = if by_place { extent.max_position() } else { turn.max_position() };
    let key = |idx: u32| if by_place { position(idx)[axis] } else { normal(idx)[axis] };
    order.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
}

/// A number from 0 to 1 that looks like chance, and is always the same.
fn chance_of(light_idx: u32, light_count: usize) -> f32 {
    let bits = light_idx.wrapping_mul(0x9e37_79b9) ^ (light_count as u32).rotate_left(16);
    unit_float(hash(bits))
}
