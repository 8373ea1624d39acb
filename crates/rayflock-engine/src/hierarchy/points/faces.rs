//! Chooses the faces on which the rays of a batch become points.
//!
//! One face where rays that share an origin stay within 50 degrees of its normal, which is that of
//! the image plane where they are a camera's, otherwise their mean direction; if they do not, the
//! six sides of a cube around the origin; one face across a shared direction. The choice follows
//! from a sample, or the corners of the image; whether each ray has a place on a face is asked when
//! the ray is looked at.

use glam::{DVec3, Vec3};
use rayflock_geom::simd::face::{Face, FaceKind};
use rayflock_geom::{Ray, RayBatch, RayState};

use super::super::arrange::Image;

/// Rays of the sample.
const SAMPLE: usize = 128;

/// Cosine of the largest angle to the mean direction of a sample that goes onto one face.
const WIDEST_COS: f64 = 0.64;

/// Faces of one batch.
#[derive(Clone, Debug, Default)]
pub(super) struct Faces {
    pub(super) faces: Vec<Face>,
}

impl Faces {
    /// Chooses faces. Returns false where rays share nothing, or nothing finite.
    pub(super) fn choose(&mut self, batch: &RayBatch<'_>) -> bool {
        self.faces.clear();
        if let Some(direction) = batch.direction().uniform() {
            return self.choose_parallel(batch, direction);
        }
        let Some(origin) = batch.origin().uniform().filter(|origin| origin.is_finite()) else {
            return false;
        };
        if let Some(rows) = image_rows(batch) {
            self.faces.push(central(origin, rows));
            return true;
        }
        let mean: DVec3 = sample(batch).map(|ray| unit(ray.direction)).sum();
        let mean = mean.normalize_or_zero();
        let is_narrow = sample(batch).all(|ray| unit(ray.direction).dot(mean) > WIDEST_COS);
        if is_narrow && mean != DVec3::ZERO {
            let along = row_axis(batch, |ray| unit(ray.direction));
            self.faces.push(central(origin, across(mean, along)));
        } else {
            self.choose_cube(origin);
        }
        true
    }

    /// The six sides of a cube around the shared origin.
    pub(super) fn choose_cube(&mut self, origin: Vec3) {
        self.faces.clear();
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                let rows = [Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]];
                self.faces.push(central(origin, [rows[0], rows[1], sign * Vec3::AXES[axis]]));
            }
        }
    }

    fn choose_parallel(&mut self, batch: &RayBatch<'_>, direction: Vec3) -> bool {
        if !direction.is_finite() || direction == Vec3::ZERO {
            return false;
        }
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for ray in sample(batch) {
            (low, high) = (low.min(ray.origin), high.max(ray.origin));
        }
        let center = 0.5 * low + 0.5 * high;
        let center = if center.is_finite() { center } else { Vec3::ZERO };
        let along = row_axis(batch, |ray| ray.origin.as_dvec3());
        let rows = across(unit(direction), along);
        self.faces.push(Face { kind: FaceKind::Parallel { reach: 0.0 }, center, rows });
        true
    }

    /// Whether rays share a direction.
    pub(super) fn is_parallel(&self) -> bool {
        matches!(self.faces.first(), Some(Face { kind: FaceKind::Parallel { .. }, .. }))
    }
}

fn central(center: Vec3, rows: [Vec3; 3]) -> Face {
    Face { kind: FaceKind::Central, center, rows }
}

/// Axes of a face across `normal`, the first of them near `along` if there is such.
fn across(normal: DVec3, along: Option<DVec3>) -> [Vec3; 3] {
    let along = along.map(|along| along.reject_from_normalized(normal).normalize_or_zero());
    let first = match along {
        Some(along) if along != DVec3::ZERO => along,
        _ => normal.any_orthonormal_vector(),
    };
    [first, normal.cross(first), normal].map(DVec3::as_vec3)
}

/// The way along the first row of an image.
fn row_axis(batch: &RayBatch<'_>, place: impl Fn(&Ray) -> DVec3) -> Option<DVec3> {
    let [first, last, ..] = image_corners(batch)?;
    let along = place(&last) - place(&first);
    (along.is_finite() && along != DVec3::ZERO).then_some(along)
}

/// The first and the last ray of the first row of an image, and those of the last row.
fn image_corners(batch: &RayBatch<'_>) -> Option<[Ray; 4]> {
    let image = Image::of(batch)?;
    let (right, bottom) = (image.width - 1, image.height - 1);
    let corner = |x, y| Some(batch.ray(image.ray_idx(x, y)? as usize));
    let corners = [corner(0, 0)?, corner(right, 0)?, corner(0, bottom)?, corner(right, bottom)?];
    corners.iter().all(|ray| ray.state() == RayState::Active).then_some(corners)
}

/// Axes of the face on which the rays of a camera's image make a lattice: that in which four
/// points of the corners' rays make a parallelogram. `None` if it is too wide for one face.
fn image_rows(batch: &RayBatch<'_>) -> Option<[Vec3; 3]> {
    let [a, b, c, d] = image_corners(batch)?.map(|ray| unit(ray.direction));
    // a / w_a + d / w_d = b / w_b + c / w_c, by Cramer's rule.
    let volume = |a: DVec3, b: DVec3, c: DVec3| a.cross(b).dot(c);
    let weights = [volume(b, c, d), volume(a, c, d), -volume(a, b, d)];
    let sign = weights[0].signum();
    let [origin, right, bottom] = [a * weights[0], b * weights[1], c * weights[2]];
    let (along, down) = (sign * (right - origin), sign * (bottom - origin));
    let normal = along.cross(down).normalize_or_zero();
    let normal = if normal.dot(d) < 0.0 { -normal } else { normal };
    let is_narrow = [a, b, c, d].iter().all(|corner| corner.dot(normal) > WIDEST_COS);
    let rows = across(normal, Some(along));
    (is_narrow && normal != DVec3::ZERO).then_some(rows)
}

/// Some active rays from all over the batch.
fn sample<'a>(batch: &'a RayBatch<'_>) -> impl Iterator<Item = Ray> + 'a {
    let rays = spread_positions(batch.len(), SAMPLE).map(|ray_idx| batch.ray(ray_idx));
    rays.filter(|ray| ray.state() == RayState::Active)
}

/// Some positions from all over `len`, spread by the golden ratio: evenly, yet in step with no
/// rows and tiles.
pub(super) fn spread_positions(len: usize, count: usize) -> impl Iterator<Item = usize> {
    const GOLDEN: u64 = 0x9e37_79b9;
    let count = count.min(len) as u64;
    (0..count).map(move |idx| ((((idx * GOLDEN) & 0xffff_ffff) * len as u64) >> 32) as usize)
}

fn unit(direction: Vec3) -> DVec3 {
    direction.as_dvec3().normalize_or_zero()
}
