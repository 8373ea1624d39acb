//! Seeded ray batches of every form and with every hint, aimed where intersection is hardest.

use glam::Vec3;
use rayflock_geom::{Column, Geometry, RayBatch, RayOrder};

use crate::Rng;
use crate::aim::Aim;

/// How the columns of a batch lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayForm {
    /// One origin, a direction a ray: a pinhole camera or a point light.
    UniformOrigin,
    /// One direction, an origin a ray: the sun.
    UniformDirection,
    /// Two packed columns.
    PerRay,
    /// One `(n, 6)` array.
    Rows,
    /// One `(n, 8)` array that also holds the interval.
    RowsWithInterval,
    /// Two packed columns in which each run of [`GROUP`] rays shares its origin, as hinted.
    Groups,
}

/// Rays that share an origin in [`RayForm::Groups`].
pub const GROUP: usize = 24;

impl RayForm {
    /// Every form.
    pub const ALL: [Self; 6] = [
        Self::UniformOrigin,
        Self::UniformDirection,
        Self::PerRay,
        Self::Rows,
        Self::RowsWithInterval,
        Self::Groups,
    ];
}

/// A column that is the same for all rays, or is not.
#[derive(Clone, Debug, PartialEq)]
enum Spread<T> {
    Uniform(T),
    PerRay(Vec<T>),
}

/// Rays that own their columns.
#[derive(Clone, Debug)]
pub struct RaySet {
    form: RayForm,
    /// One or `len`.
    origins: Vec<Vec3>,
    /// One or `len`.
    directions: Vec<Vec3>,
    /// The rows of the forms that have rows.
    rows: Vec<f32>,
    t_min: Spread<f32>,
    t_max: Spread<f32>,
    mask: Spread<u32>,
    /// A true hint, for sets that have one.
    order: RayOrder,
}

impl RaySet {
    /// `len` rays at `geometry`: at vertices, edges and silhouettes, along faces and axes, from
    /// near and far, with directions of any length; a few of them invalid or inactive.
    pub fn random(rng: &mut Rng, geometry: &Geometry, form: RayForm, len: usize) -> Self {
        let aim = Aim::at(geometry);
        let mut shared = aim.ray(rng);
        let mut origins = Vec::with_capacity(len);
        let mut directions = Vec::with_capacity(len);
        for idx in 0..len {
            if form == RayForm::Groups && idx % GROUP == 0 {
                shared = aim.ray(rng);
            }
            let (origin, direction) = match form {
                RayForm::UniformOrigin | RayForm::Groups => aim.ray_from(rng, shared.0),
                RayForm::UniformDirection => aim.ray_along(rng, shared.1),
                _ => aim.ray(rng),
            };
            let (origin, direction) = now_and_then_invalid(rng, origin, direction);
            origins.push(origin);
            directions.push(direction);
        }
        match form {
            RayForm::UniformOrigin => origins = vec![shared.0],
            RayForm::UniformDirection => directions = vec![shared.1],
            _ => {}
        }
        let mut set = Self::new(form, origins, directions);
        if form == RayForm::Groups {
            set.order = RayOrder::Groups(GROUP);
        }
        set.limit(rng, len, aim.size());
        set.mask = match rng.below(4) {
            0 => Spread::Uniform(1 << rng.below(4)),
            1 => Spread::PerRay((0..len).map(|_| rng.below(8) as u32).collect()),
            _ => Spread::Uniform(u32::MAX),
        };
        set.fill_rows();
        set
    }

    /// The rays of a pinhole camera that sees `geometry` from outside or from its middle; `tile`
    /// divides width and height, or is 0 for row by row.
    ///
    /// # Panics
    /// When `tile` is not 0 and does not divide both.
    pub fn pinhole(
        rng: &mut Rng,
        geometry: &Geometry,
        [width, height]: [usize; 2],
        tile: usize,
    ) -> Self {
        let side = if tile == 0 { width } else { tile };
        assert!(width % side.max(1) == 0 && (tile == 0 || height % tile == 0), "whole tiles");
        let aim = Aim::at(geometry);
        let distance = rng.pick(&[0.0, 1.5, 4.0]);
        let origin = aim.center() + distance * aim.size() * rng.on_sphere();
        let forward = if distance == 0.0 { rng.on_sphere() } else { aim.center() - origin };
        let forward = forward.normalize_or(Vec3::Z);
        let (right, up) = forward.any_orthonormal_pair();
        let direction = |idx: usize| {
            let [x, y] = pixel(idx, width, tile);
            let offset = |at: usize, count: usize| (at as f32 + 0.5) / count as f32 - 0.5;
            forward + offset(x, width) * right + offset(y, height) * up
        };
        let directions = (0..width * height).map(direction).collect();
        let mut set = Self::new(RayForm::UniformOrigin, vec![origin], directions);
        set.order = RayOrder::Image { width, height, tile };
        set
    }

    fn new(form: RayForm, origins: Vec<Vec3>, directions: Vec<Vec3>) -> Self {
        Self {
            form,
            origins,
            directions,
            rows: Vec::new(),
            t_min: Spread::Uniform(0.0),
            t_max: Spread::Uniform(f32::INFINITY),
            mask: Spread::Uniform(u32::MAX),
            order: RayOrder::Unordered,
        }
    }

    /// Gives the rays no interval, one for all, or one each, a few of them empty or NaN.
    fn limit(&mut self, rng: &mut Rng, len: usize, size: f32) {
        let per_ray = rng.one_in(2) || self.form == RayForm::RowsWithInterval;
        if !per_ray {
            self.t_max = Spread::Uniform(rng.pick(&[f32::INFINITY, 2.0, size]));
            return;
        }
        let mut t_min = |_| match rng.below(12) {
            0 => rng.pick(&[f32::NEG_INFINITY, -1.0, f32::NAN, f32::INFINITY]),
            1..4 => rng.between(0.0, 1.0),
            _ => 0.0,
        };
        self.t_min = Spread::PerRay((0..len).map(&mut t_min).collect());
        let mut t_max = |_| match rng.below(12) {
            0 => rng.pick(&[f32::NEG_INFINITY, -1.0, f32::NAN, 0.0]),
            1..6 => rng.between(0.5, 2.0),
            _ => f32::INFINITY,
        };
        self.t_max = Spread::PerRay((0..len).map(&mut t_max).collect());
    }

    fn fill_rows(&mut self) {
        let Some(stride) = self.stride() else { return };
        for i in 0..self.origins.len() {
            self.rows.extend(self.origins[i].to_array());
            self.rows.extend(self.directions[i].to_array());
            if let (8, Spread::PerRay(t_min), Spread::PerRay(t_max)) =
                (stride, &self.t_min, &self.t_max)
            {
                self.rows.extend([t_min[i], t_max[i]]);
            }
        }
    }

    const fn stride(&self) -> Option<usize> {
        match self.form {
            RayForm::Rows => Some(6),
            RayForm::RowsWithInterval => Some(8),
            _ => None,
        }
    }

    /// How the columns lie in memory.
    pub const fn form(&self) -> RayForm {
        self.form
    }

    /// The batch that borrows these columns, with a true hint.
    pub fn batch(&self) -> RayBatch<'_> {
        match self.try_batch() {
            Ok(batch) => batch.with_order(self.order),
            Err(error) => unreachable!("all columns have the length of the set: {error}"),
        }
    }

    fn try_batch(&self) -> Result<RayBatch<'_>, rayflock_geom::RayBatchError> {
        let (t_min, t_max) = (column(&self.t_min), column(&self.t_max));
        let batch = match (self.form, self.stride()) {
            (RayForm::UniformOrigin, _) => RayBatch::new(self.origins[0], &self.directions),
            (RayForm::UniformDirection, _) => RayBatch::new(&self.origins, self.directions[0]),
            (_, Some(stride)) => RayBatch::new(
                Column::strided(&self.rows, stride),
                Column::strided(self.rows.get(3..).unwrap_or_default(), stride),
            ),
            _ => RayBatch::new(&self.origins, &self.directions),
        }?;
        let from = |start: usize| Column::strided(self.rows.get(start..).unwrap_or_default(), 8);
        let batch = match self.form {
            RayForm::RowsWithInterval => batch.with_interval(from(6), from(7)),
            _ => batch.with_interval(t_min, t_max),
        }?;
        match &self.mask {
            Spread::Uniform(mask) => batch.with_mask(*mask),
            Spread::PerRay(masks) => batch.with_mask(masks),
        }
    }
}

fn column(spread: &Spread<f32>) -> Column<'_, f32> {
    match spread {
        Spread::Uniform(value) => Column::Uniform(*value),
        Spread::PerRay(values) => Column::packed(values),
    }
}

/// The pixel of ray `idx` in an image whose rays come row by row or tile by tile.
const fn pixel(idx: usize, width: usize, tile: usize) -> [usize; 2] {
    if tile == 0 {
        return [idx % width, idx / width];
    }
    let (tile_idx, within) = (idx / (tile * tile), idx % (tile * tile));
    let tiles_a_row = width / tile;
    [tile_idx % tiles_a_row * tile + within % tile, tile_idx / tiles_a_row * tile + within / tile]
}

fn now_and_then_invalid(rng: &mut Rng, origin: Vec3, direction: Vec3) -> (Vec3, Vec3) {
    match rng.below(120) {
        0 => (origin, Vec3::ZERO),
        1 => (Vec3::new(f32::NAN, 0.0, 0.0), direction),
        2 => (origin, Vec3::new(0.0, f32::INFINITY, 0.0)),
        3 => (origin, Vec3::NAN),
        _ => (origin, direction),
    }
}

/// Every hint for a batch of `len` rays: true and false ones, none of which may change an answer.
pub fn every_order(len: usize) -> Vec<RayOrder> {
    let image = |width, height, tile| RayOrder::Image { width, height, tile };
    vec![
        RayOrder::Unordered,
        RayOrder::Coherent,
        RayOrder::Groups(1),
        RayOrder::Groups(7),
        RayOrder::Groups(0),
        RayOrder::Groups(usize::MAX),
        image(len, 1, 0),
        image(1, len, 0),
        image(len / 2, 2, 0),
        image(len / 8, 8, 8),
        image(16, len / 16, 4),
        image(7, 3, 0),
        image(len, len, 5),
        image(0, 0, 0),
        image(usize::MAX, usize::MAX, usize::MAX),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::SceneRecipe;

    fn scene() -> Geometry {
        SceneRecipe { seed: 3, object_count: 4, prim_count: 10, size: 1.0, offset: 0.0 }.geometry()
    }

    #[test]
    fn every_form_makes_a_batch_of_its_length() {
        let mut rng = Rng::new(2);
        for form in RayForm::ALL {
            for len in [0, 1, 5, 333] {
                let set = RaySet::random(&mut rng, &scene(), form, len);
                assert_eq!(set.batch().len(), len, "{form:?}");
            }
        }
    }

    #[test]
    fn rows_hold_what_the_columns_hold() {
        let mut rng = Rng::new(4);
        let set = RaySet::random(&mut rng, &scene(), RayForm::RowsWithInterval, 50);
        let (batch, Spread::PerRay(t_max)) = (set.batch(), &set.t_max) else {
            panic!("rows with intervals have one for each ray");
        };
        for (i, t_max) in t_max.iter().enumerate() {
            let ray = batch.ray(i);
            assert_eq!(
                ray.origin.to_array().map(f32::to_bits),
                set.origins[i].to_array().map(f32::to_bits)
            );
            assert_eq!(ray.t_max.to_bits(), t_max.to_bits());
        }
    }

    #[test]
    fn tiles_visit_every_pixel_once() {
        let mut seen: Vec<[usize; 2]> = (0..96).map(|idx| pixel(idx, 12, 4)).collect();
        assert_eq!([seen[3], seen[4], seen[16]], [[3, 0], [0, 1], [4, 0]]);
        seen.sort_unstable();
        seen.dedup();
        assert_eq!((seen.len(), seen[95]), (96, [11, 7]));
    }
}
