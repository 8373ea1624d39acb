//! What each pixel of a picture sees of the hours.

use rayflock_geom::{Hit, HitBuffer, PrimKind};
use tracing::debug_span;

use super::{Sampling, SunMeter};
use crate::View;
use crate::stages::camera_rays::camera_rays;
use crate::wave::Wave;
use crate::whitted::bands;

/// Rays traced at once.
const BATCH_RAYS: usize = 1 << 17;

/// What a pixel sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Seen {
    /// What lies behind everything.
    #[default]
    Nothing,
    /// Something that has no samples: a sphere or a user primitive.
    Unmeasured,
    /// A surface that was lit for so many seconds: those of the face, or between the vertices.
    Seconds(f64),
}

impl SunMeter {
    /// What each pixel of a picture of the committed frame sees through its sample `sample_idx`,
    /// rows from the top; `width * height` entries.
    pub fn see(
        &mut self,
        view: &View,
        (width, height): (usize, usize),
        sample_idx: u32,
    ) -> Vec<Seen> {
        let _span = debug_span!("see_hours").entered();
        let first_samples = self.first_samples();
        let (mut wave, mut hits) = (Wave::default(), HitBuffer::default());
        let mut picture = vec![Seen::Nothing; width * height];
        for rows in bands((width, height), BATCH_RAYS) {
            let first_pixel = rows.start * width;
            camera_rays(view, (width, height), rows, sample_idx, &mut wave);
            hits.reset(wave.len());
            self.engine.closest_hit(&wave.batch(), &mut hits.as_hits());
            for (ray_idx, path) in wave.paths.iter().enumerate() {
                picture[first_pixel + path.pixel_idx as usize] =
                    self.seen(&hits.get(ray_idx), &first_samples);
            }
        }
        picture
    }

    /// Where the samples of each object begin.
    fn first_samples(&self) -> Vec<usize> {
        let objects = self.geometry.objects().iter();
        let counts = objects.map(|object| match self.sampling {
            Sampling::Faces => object.shape.triangles().len(),
            Sampling::Vertices => object.shape.vertices().len(),
        });
        counts
            .scan(0, |next, count| {
                let first = *next;
                *next += count;
                Some(first)
            })
            .collect()
    }

    fn seen(&self, hit: &Hit, first_samples: &[usize]) -> Seen {
        let objects = self.geometry.objects();
        let found = objects.binary_search_by_key(&hit.object_id, |object| object.id);
        let Ok(object_idx) = found else { return Seen::Nothing };
        let (shape, first_sample) = (&objects[object_idx].shape, first_samples[object_idx]);
        let PrimKind::Triangle(triangle_idx) = shape.prim_kind(hit.prim_id) else {
            return Seen::Unmeasured;
        };
        Seen::Seconds(match self.sampling {
            Sampling::Faces => self.seconds[first_sample + triangle_idx],
            Sampling::Vertices => {
                // In `f64`, so that shares add up to one.
                let [u, v] = [hit.u, hit.v].map(f64::from);
                let shares = [1.0 - u - v, u, v];
                let corners = shape.triangles()[triangle_idx].map(|idx| idx as usize);
                let seconds = corners.map(|idx| self.seconds[first_sample + idx]);
                shares.iter().zip(seconds).map(|(share, seconds)| share * seconds).sum()
            }
        })
    }
}
