//! Refuses values that cannot be measured.

use std::fmt::Debug;
use std::path::Path;

use rayflock::prelude::Vec3;

use super::{Definition, Phase, Room};
use crate::BenchError;

/// The most moving triangles: three vertices each are counted by 32 bits.
const MOST_TRIANGLES: usize = 1 << 28;
/// The most cells along an edge of the room.
const MOST_CELLS: usize = 1 << 10;

/// Checks all values of `definition`, which came from `path`.
pub(super) fn check(definition: &Definition, path: &Path) -> Result<(), BenchError> {
    let checker = Checker { path };
    checker.lists(definition)?;
    for (idx, phase) in definition.phases.iter().enumerate() {
        checker.phase(idx, phase)?;
    }
    checker.room(&definition.room)?;
    checker.shapes(definition)?;
    checker.camera_and_lights(definition)?;
    checker.rays(definition)
}

struct Checker<'a> {
    path: &'a Path,
}

impl Checker<'_> {
    fn demand(
        &self,
        holds: bool,
        key: &str,
        found: &dyn Debug,
        expected: &str,
    ) -> Result<(), BenchError> {
        if holds {
            return Ok(());
        }
        Err(BenchError::DefinitionValue {
            path: self.path.to_owned(),
            key: key.to_owned(),
            found: format!("{found:?}"),
            expected: expected.to_owned(),
        })
    }

    fn lists(&self, definition: &Definition) -> Result<(), BenchError> {
        let Definition { triangles, rays, kinds, phases, .. } = definition;
        let lengths = [
            ("triangles", triangles.len()),
            ("rays", rays.len()),
            ("kinds", kinds.len()),
            ("phases", phases.len()),
        ];
        for (key, len) in lengths {
            self.demand(len > 0, key, &[(); 0], "at least one entry")?;
        }
        for (idx, &count) in triangles.iter().enumerate() {
            let key = format!("triangles[{idx}]");
            self.demand(count <= MOST_TRIANGLES, &key, &count, "at most 256M")?;
        }
        Ok(())
    }

    fn phase(&self, idx: usize, phase: &Phase) -> Result<(), BenchError> {
        let Phase { name, frames, before } = phase;
        let key = |field: &str| format!("phases[{idx}].{field}");
        self.demand(!name.is_empty(), &key("name"), name, "a name")?;
        let usable = !frames.is_empty() && frames.iter().all(|frame| frame.is_finite());
        self.demand(usable, &key("frames"), frames, "at least one finite number")?;
        self.demand(before.is_finite(), &key("before"), before, "a finite number")
    }

    fn room(&self, room: &Room) -> Result<(), BenchError> {
        let Room { size, cells, skylight } = room;
        self.demand(size.iter().all(|&edge| is_size(edge)), "room.size", size, SIZES)?;
        let usable = cells.iter().all(|count| (1..=MOST_CELLS).contains(count));
        self.demand(usable, "room.cells", cells, "three whole numbers from 1 to 1024")?;
        let fits = |count: usize| *skylight <= count && (count - skylight).is_multiple_of(2);
        self.demand(
            fits(cells[0]) && fits(cells[2]),
            "room.skylight",
            skylight,
            "at most the cells along x and z, and odd where they are odd",
        )
    }

    fn shapes(&self, definition: &Definition) -> Result<(), BenchError> {
        let shapes = &definition.shapes;
        let apart = shapes.frames_apart;
        let is_time = apart.is_finite() && apart > 0.0;
        self.demand(is_time, "shapes.frames_apart", &apart, "a finite number above 0")?;
        self.point("shapes.center", shapes.center)?;
        self.size("shapes.area", shapes.area)?;
        self.size("shapes.cloud_radius", shapes.cloud_radius)?;
        self.size("shapes.pyramid_height", shapes.pyramid_height)
    }

    fn camera_and_lights(&self, definition: &Definition) -> Result<(), BenchError> {
        let (camera, lights) = (&definition.camera, &definition.lights);
        self.point("camera.position", camera.position)?;
        self.point("camera.target", camera.target)?;
        let axis = Vec3::from(camera.target) - Vec3::from(camera.position);
        let is_upright = axis.cross(Vec3::Y).length() > 1e-3 * axis.length();
        self.demand(is_upright, "camera.target", &camera.target, "a place not above or below it")?;
        let (fov, key) = (camera.vertical_fov_degrees, "camera.vertical_fov_degrees");
        self.demand(fov > 0.0 && fov < 179.0, key, &fov, "an angle between 0 and 179")?;
        self.point("lights.point", lights.point)?;
        let sun = Vec3::from(lights.to_sun).try_normalize();
        self.demand(sun.is_some(), "lights.to_sun", &lights.to_sun, "a direction")
    }

    fn rays(&self, definition: &Definition) -> Result<(), BenchError> {
        let (secondary, lidar) = (&definition.secondary, &definition.lidar);
        let (offset, end) = (secondary.offset, secondary.shadow_end);
        let is_offset = offset.is_finite() && offset >= 0.0;
        self.demand(is_offset, "secondary.offset", &offset, "a finite number, 0 or above")?;
        let is_share = end > 0.0 && end <= 1.0;
        self.demand(is_share, "secondary.shadow_end", &end, "a number above 0 and up to 1")?;
        self.size("secondary.ao_reach", secondary.ao_reach)?;
        self.point("orthographic.position", definition.orthographic.position)?;
        self.size("orthographic.edge", definition.orthographic.edge)?;
        self.point("lidar.position", lidar.position)?;
        let [low, high] = lidar.elevation_degrees;
        let (usable, key) =
            (-90.0 <= low && low <= high && high <= 90.0, "lidar.elevation_degrees");
        self.demand(usable, key, &lidar.elevation_degrees, "two angles from -90 to 90, rising")
    }

    fn size(&self, key: &str, size: f32) -> Result<(), BenchError> {
        self.demand(is_size(size), key, &size, "a finite number above 0")
    }

    fn point(&self, key: &str, point: [f32; 3]) -> Result<(), BenchError> {
        self.demand(Vec3::from(point).is_finite(), key, &point, "three finite numbers")
    }
}

const SIZES: &str = "three finite numbers above 0";

fn is_size(value: f32) -> bool {
    value.is_finite() && value > 0.0
}
