//! Meshes frame by frame from a source that is asked when a frame is wanted: files, caches,
//! simulations of any length.
//!
//! **Invariants.** A stream holds [`FRAMES_KEPT`] frames at most, however many its source has.
//! Frames shown one after the other share their triangles where these are equal.
//!
//! **Cost.** A frame that is not among those held is loaded, its triangles are compared with those
//! of the others, and where they are equal its vertices are copied.

use std::fmt::Debug;
use std::sync::{Arc, Mutex, PoisonError};

use crate::blend::blended;
use crate::key_times::{TOLERANCE_SECONDS, check_times};
use crate::{AnimatedMesh, MotionKind, SceneError, SurfaceMesh};

/// Frames held by a stream: the one shown, and the next where it shows something in between, or
/// the one before to compare triangles with.
pub const FRAMES_KEPT: usize = 2;

/// Where the frames of a [`FrameStream`] come from.
pub trait FrameSource: Debug + Send + Sync {
    /// Number of frames.
    fn frame_count(&self) -> usize;

    /// How frames differ from each other, where that is known without looking: for information,
    /// not for correctness.
    fn motion(&self) -> MotionKind {
        MotionKind::Topology
    }

    /// Frame `frame_idx`, less than [`frame_count`](Self::frame_count). It has to be the same each
    /// time, in any order, and should not be kept.
    ///
    /// # Errors
    /// A message for the user when the frame cannot be had, such as a file gone or damaged.
    fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String>;
}

/// What is shown between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InBetweens {
    /// The frame before.
    #[default]
    Held,
    /// Triangles whose vertices are on a straight way from the frame before to the next, where
    /// both have the same triangles; or else the frame before.
    Linear,
}

/// A mesh that is frame `i` of a source at time `i / frame_rate`.
#[derive(Debug)]
pub struct FrameStream {
    source: Box<dyn FrameSource>,
    /// Frames a second.
    frame_rate: f64,
    in_betweens: InBetweens,
    /// Frames with their numbers, the one used last in front.
    recent: Mutex<Vec<(usize, SurfaceMesh)>>,
}

impl FrameStream {
    /// Streams the frames of `source`, `frame_rate` a second.
    ///
    /// # Errors
    /// [`SceneError::Empty`] when there are no frames, [`SceneError::KeyTime`] when the rate is no
    /// positive number.
    pub fn new(
        source: impl FrameSource + 'static,
        frame_rate: f64,
        in_betweens: InBetweens,
    ) -> Result<Self, SceneError> {
        let first_times = [0.0, 1.0 / frame_rate];
        check_times("frame stream", first_times.into_iter().take(2 * source.frame_count()))?;
        let (source, recent) = (Box::new(source), Mutex::default());
        Ok(Self { source, frame_rate, in_betweens, recent })
    }

    /// The frame at or before `time`, and how far the time is from it to the next, from 0 to 1.
    fn place(&self, time: f64) -> (usize, f32) {
        let last = self.source.frame_count().saturating_sub(1);
        let position = (time * self.frame_rate).max(0.0).min(last as f64);
        let tolerance = (TOLERANCE_SECONDS * self.frame_rate).min(0.5);
        let before = (position + tolerance) as usize;
        let share = position - before as f64;
        (before, if share > tolerance { share as f32 } else { 0.0 })
    }

    /// Frame `frame_idx`, held or loaded.
    fn frame(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
        // The list is in order at every moment, so a panic elsewhere does not spoil it.
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = recent.iter().position(|(held_idx, _)| *held_idx == frame_idx) {
            recent.swap(0, place);
            return Ok(recent[0].1.clone());
        }
        // Make room first, so that no more are held while one is loaded.
        recent.truncate(FRAMES_KEPT - 1);
        let loaded = self.source.load(frame_idx)?;
        let frame = recent.iter().fold(loaded, |frame, (_, known)| shared(frame, known));
        recent.insert(0, (frame_idx, frame.clone()));
        Ok(frame)
    }
}

impl AnimatedMesh for FrameStream {
    fn time_range(&self) -> (f64, f64) {
        (0.0, self.source.frame_count().saturating_sub(1) as f64 / self.frame_rate)
    }

    fn motion(&self) -> MotionKind {
        if self.source.frame_count() == 1 { MotionKind::Static } else { self.source.motion() }
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        let (before, share) = self.place(time);
        let surface = self.frame(before)?;
        if share == 0.0 || self.in_betweens == InBetweens::Held {
            return Ok(surface);
        }
        let next = self.frame(before + 1)?;
        // Spheres of two frames need not be the same particles, even where they are as many.
        let belongs = next.mesh.has_topology_of(&surface.mesh) && next.mesh.spheres().is_empty();
        Ok(if belongs { blended(&surface, &next, share) } else { surface })
    }
}

/// `surface` with the triangles of `known`, if these are equal.
fn shared(surface: SurfaceMesh, known: &SurfaceMesh) -> SurfaceMesh {
    let (mesh, known) = (&surface.mesh, &known.mesh);
    let is_settled = mesh.has_topology_of(known) || mesh.user().is_some() || known.user().is_some();
    if is_settled || mesh.triangles() != known.triangles() {
        return surface;
    }
    match known.with_vertices(mesh.vertices().to_vec()) {
        Ok(moved) => {
            let mesh = Arc::new(moved.with_spheres(mesh.spheres().to_vec()));
            SurfaceMesh { mesh, ..surface }
        }
        // Another number of vertices.
        Err(_) => surface,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Weak;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use glam::Vec3;
    use rayflock_geom::{Mesh, Sphere};

    use super::*;
    use crate::MaterialIdx;

    /// Frame i has a triangle with a corner at x = i, `copies(i)` times.
    #[derive(Debug, Default)]
    struct Counting {
        frame_count: usize,
        same_triangles: bool,
        loads: Arc<AtomicUsize>,
        /// Every mesh that was ever handed out.
        meshes: Arc<Mutex<Vec<Weak<Mesh>>>>,
    }

    impl Counting {
        fn of(frame_count: usize, same_triangles: bool) -> Self {
            Self { frame_count, same_triangles, ..Self::default() }
        }
    }

    impl FrameSource for Counting {
        fn frame_count(&self) -> usize {
            self.frame_count
        }

        fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
            if frame_idx == 13 {
                return Err("frame 13 is damaged".to_owned());
            }
            self.loads.fetch_add(1, Ordering::Relaxed);
            let copies = if self.same_triangles { 1 } else { 1 + frame_idx % 7 };
            let vertices = vec![Vec3::ZERO, Vec3::X * frame_idx as f32, Vec3::Y];
            let mesh = Mesh::from_triangles(vertices, vec![[0, 1, 2]; copies]).unwrap();
            let surface = SurfaceMesh::new(mesh, MaterialIdx(0));
            self.meshes.lock().unwrap().push(Arc::downgrade(&surface.mesh));
            Ok(surface)
        }
    }

    fn stream(source: Counting, in_betweens: InBetweens) -> FrameStream {
        FrameStream::new(source, 10.0, in_betweens).unwrap()
    }

    fn x(stream: &FrameStream, time: f64) -> f32 {
        stream.at(time).unwrap().mesh.vertices()[1].x
    }

    #[test]
    fn a_frame_is_held_until_the_next() {
        let stream = stream(Counting::of(5, true), InBetweens::Held);
        let times = [0.0, 0.09, 0.1, 0.3 - 1e-9, 0.4, 9.0, -1.0, f64::NAN];
        assert_eq!(times.map(|time| x(&stream, time)), [0.0, 0.0, 1.0, 3.0, 4.0, 4.0, 0.0, 0.0]);
        assert_eq!(stream.time_range(), (0.0, 0.4));
    }

    #[test]
    fn vertices_between_frames_are_on_their_way_if_the_triangles_stay() {
        let linear = stream(Counting::of(5, true), InBetweens::Linear);
        let near = |time: f64, expected: f32| (x(&linear, time) - expected).abs() < 1e-5;
        assert!(near(0.05, 0.5) && near(0.175, 1.75) && near(0.1, 1.0) && near(0.4, 4.0));
        let changing = stream(Counting::of(5, false), InBetweens::Linear);
        assert_eq!([0.05, 0.175].map(|time| x(&changing, time)), [0.0, 1.0]);
    }

    #[test]
    fn spheres_between_frames_are_held() {
        #[derive(Debug)]
        struct Drops;
        impl FrameSource for Drops {
            fn frame_count(&self) -> usize {
                2
            }
            fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
                let spheres = vec![Sphere::new(Vec3::X * frame_idx as f32, 1.0)];
                Ok(SurfaceMesh::new(Mesh::from_spheres(spheres), MaterialIdx(0)))
            }
        }
        let stream = FrameStream::new(Drops, 1.0, InBetweens::Linear).unwrap();
        assert_eq!(stream.at(0.5).unwrap().mesh.spheres()[0].center, Vec3::ZERO);
    }

    #[test]
    fn equal_triangles_are_shared_and_others_are_not() {
        for same_triangles in [true, false] {
            let stream = stream(Counting::of(5, same_triangles), InBetweens::Held);
            let [a, b] = [0.0, 0.1].map(|time| stream.at(time).unwrap().mesh);
            assert_eq!(b.has_topology_of(&a), same_triangles);
        }
    }

    #[test]
    fn thousands_of_frames_take_the_room_of_a_few() {
        for (in_betweens, step, loaded) in
            [(InBetweens::Held, 1.0, 4999), (InBetweens::Linear, 0.5, 4500)]
        {
            let source = Counting::of(5000, false);
            let (meshes, loads) = (Arc::clone(&source.meshes), Arc::clone(&source.loads));
            let stream = stream(source, in_betweens);
            let mut most = 0;
            for tick in 0..9000 {
                // One frame is damaged.
                let _ = stream.at(f64::from(tick) * step / 10.0);
                let mut meshes = meshes.lock().unwrap();
                meshes.retain(|mesh| mesh.strong_count() > 0);
                most = most.max(meshes.len());
            }
            assert_eq!(most, FRAMES_KEPT);
            assert_eq!(loads.load(Ordering::Relaxed), loaded, "each frame once");
        }
    }

    #[test]
    fn a_frame_that_cannot_be_had_leaves_the_others() {
        let stream = stream(Counting::of(20, true), InBetweens::Linear);
        assert_eq!(stream.at(1.3).unwrap_err(), "frame 13 is damaged");
        assert_eq!(stream.at(1.25).unwrap_err(), "frame 13 is damaged");
        assert_eq!((x(&stream, 1.2), x(&stream, 1.4)), (12.0, 14.0));
    }

    #[test]
    fn there_must_be_frames_and_a_rate() {
        let message = |frame_count, rate| {
            let source = Counting::of(frame_count, true);
            FrameStream::new(source, rate, InBetweens::Held).unwrap_err().to_string()
        };
        assert_eq!(message(0, 24.0), "frame stream has no keys");
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(message(3, rate).starts_with("frame stream: key 1"), "{rate}");
        }
    }

    #[test]
    fn one_frame_rests() {
        let stream = stream(Counting::of(1, true), InBetweens::Linear);
        assert_eq!((stream.motion(), stream.time_range()), (MotionKind::Static, (0.0, 0.0)));
    }
}
