//! Writes the spheres and user primitives of one object: few, one by one.

use rayflock_geom::simd::LANES;
use rayflock_geom::{GeometryObject, RayTransform, Sphere, transform_sphere};

use glam::Vec3;

use super::ignored::Ignored;
use super::span::ObjectSpan;
use super::table::{PrimitiveTable, UserSlot};

/// A bounding sphere that nothing touches.
const UNTOUCHABLE: Sphere = Sphere::new(Vec3::ZERO, f32::NEG_INFINITY);

impl PrimitiveTable {
    /// Writes the spheres and user primitives of object `object_idx`, bounds included.
    pub(super) fn write_others(&mut self, object_idx: usize) {
        let span = self.layout.spans[object_idx];
        self.others_ignored[object_idx] = Ignored::default();
        if span.count.spheres + span.count.users == 0 {
            return;
        }
        let object = self.geometry.objects()[object_idx].clone();
        let ignored = self.write_spheres(&span, &object) + self.write_users(&span, &object);
        self.others_ignored[object_idx] = ignored;
    }

    fn write_spheres(&mut self, span: &ObjectSpan, object: &GeometryObject) -> Ignored {
        let mut ignored = Ignored::default();
        for (slot, sphere) in span.sphere_slots().zip(object.shape.spheres()) {
            let transform = object.world_from_object.as_ref();
            let sphere = transform.map_or(*sphere, |transform| transform_sphere(transform, sphere));
            self.spheres[slot - self.layout.begin.spheres] = sphere;
            let (mut bound, mut mask) = (sphere, object.mask);
            if !sphere.is_valid() {
                ignored += Ignored::of_sphere(&sphere);
                (bound, mask) = (UNTOUCHABLE, 0);
            }
            self.write_slot(slot, &bound, mask);
        }
        ignored
    }

    fn write_users(&mut self, span: &ObjectSpan, object: &GeometryObject) -> Ignored {
        let Some(primitives) = object.shape.user() else { return Ignored::default() };
        let mut ignored = Ignored::default();
        let transform = object.world_from_object.as_ref().and_then(RayTransform::new);
        for (prim_idx, slot) in span.user_slots().enumerate() {
            let mut bound = primitives.bounding_sphere(prim_idx);
            if let Some(world_from_object) = &object.world_from_object {
                // A transform without an inverse leaves no extent.
                let flat = Sphere::new(Vec3::ZERO, -1.0);
                bound = transform
                    .map_or(flat, |transform| transform.sphere_in_world(world_from_object, &bound));
            }
            let mut mask = object.mask;
            if !(bound.center.is_finite() && bound.radius.is_finite() && bound.radius >= 0.0) {
                ignored += Ignored::of_sphere(&bound);
                (bound, mask) = (UNTOUCHABLE, 0);
            }
            let user = UserSlot { primitives: primitives.clone(), prim_idx, transform };
            match self.users.get_mut(slot - self.layout.begin.users) {
                Some(place) => *place = user,
                None => self.users.push(user),
            }
            self.write_slot(slot, &bound, mask);
        }
        ignored
    }

    fn write_slot(&mut self, slot: usize, bound: &Sphere, mask: u32) {
        let (block, lane) = (slot / LANES, slot % LANES);
        self.bounds[block].set(lane, bound);
        self.masks[block][lane] = mask;
    }
}
