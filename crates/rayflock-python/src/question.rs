//! A batch of rays made of NumPy arrays, which are read in place.

use glam::Vec3;
use numpy::{Element, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::EngineKind;
use rayflock::geom::{Column, ColumnElement, RayBatch, RayOrder};

use crate::arrays::{numbers, readable, rows};
use crate::errors::Failure;

/// What is asked.
pub(crate) struct Question<'py> {
    /// Origins and directions, six numbers a row; then the two others are `None`.
    rays: Option<PyReadonlyArray2<'py, f32>>,
    origin: Option<Points<'py>>,
    direction: Option<Points<'py>>,
    t_min: Numbers<'py, f32>,
    t_max: Numbers<'py, f32>,
    mask: Numbers<'py, u32>,
    /// Rays a row of an image, and rows, where the rays are one.
    image: Option<(usize, usize)>,
    engine: Option<String>,
    threads: Option<usize>,
}

/// A point or direction for all rays, or one for each.
enum Points<'py> {
    All([f32; 3]),
    Each(PyReadonlyArray2<'py, f32>),
}

/// A number for all rays, or one for each.
enum Numbers<'py, T: Element> {
    All(T),
    Each(PyReadonlyArray1<'py, T>),
}

impl<'py> Question<'py> {
    /// Takes the dictionary that Python hands over, which has an item for each field.
    pub(crate) fn new(given: &Bound<'py, PyDict>) -> PyResult<Self> {
        let item = |name| given.as_any().get_item(name);
        let rays = item("rays")?;
        Ok(Self {
            rays: if rays.is_none() { None } else { Some(readable(&rays, "rays")?) },
            origin: Points::new(&item("origin")?, "origin")?,
            direction: Points::new(&item("direction")?, "direction")?,
            t_min: Numbers::new(&item("t_min")?, "t_min")?,
            t_max: Numbers::new(&item("t_max")?, "t_max")?,
            mask: Numbers::new(&item("mask")?, "mask")?,
            image: item("image")?.extract()?,
            engine: item("engine")?.extract()?,
            threads: item("threads")?.extract()?,
        })
    }
}

impl Question<'_> {
    /// The rays. Those that share an origin or a direction say so, even where the arrays do not.
    pub(crate) fn batch(&self) -> Result<RayBatch<'_>, Failure> {
        let (origin, direction) = match (&self.rays, &self.origin, &self.direction) {
            (Some(rays), None, None) => {
                let scalars = rows::<_, 6>(rays)?.as_flattened();
                let directions = scalars.get(3..).unwrap_or_default();
                (Column::strided(scalars, 6), Column::strided(directions, 6))
            }
            (None, Some(origin), Some(direction)) => (origin.column()?, direction.column()?),
            _ => return Err(Failure::value("expected rays, or an origin and a direction")),
        };
        let order = match self.image {
            Some((width, height)) => RayOrder::Image { width, height, tile: 0 },
            None => RayOrder::Unordered,
        };
        let batch = RayBatch::new(origin, direction)?;
        let batch = batch.with_interval(self.t_min.column()?, self.t_max.column()?)?;
        Ok(batch.with_mask(self.mask.column()?)?.with_order(order).unified())
    }

    /// The engine asked for, if it is not the scene's own.
    pub(crate) fn engine(&self) -> Result<Option<EngineKind>, Failure> {
        Ok(self.engine.as_deref().map(str::parse).transpose()?)
    }

    /// The number of threads asked for, if it is not the scene's own.
    pub(crate) const fn threads(&self) -> Option<usize> {
        self.threads
    }
}

impl<'py> Points<'py> {
    fn new(given: &Bound<'py, PyAny>, name: &str) -> PyResult<Option<Self>> {
        Ok(if given.is_none() {
            None
        } else if let Ok((x, y, z)) = given.extract() {
            Some(Self::All([x, y, z]))
        } else {
            Some(Self::Each(readable(given, name)?))
        })
    }

    fn column(&self) -> Result<Column<'_, Vec3>, Failure> {
        Ok(match self {
            Self::All(point) => Column::Uniform(Vec3::from(*point)),
            Self::Each(points) => Column::from(rows::<_, 3>(points)?),
        })
    }
}

impl<'py, T> Numbers<'py, T>
where
    T: Element + ColumnElement<Scalar = T> + for<'a> FromPyObject<'a, 'py>,
{
    fn new(given: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        Ok(match given.extract() {
            Ok(number) => Self::All(number),
            Err(_) => Self::Each(readable(given, name)?),
        })
    }

    fn column(&self) -> Result<Column<'_, T>, Failure> {
        Ok(match self {
            Self::All(number) => Column::Uniform(*number),
            Self::Each(each) => Column::from(numbers(each)?),
        })
    }
}
