//! All subfields are brought up to date when a frame begins, whether a ray will want them or not.
//!
//! Before the first batch there is no set of directions, so that of a frame is the one of the frame
//! before.

use super::Policy;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;
use crate::subfields::asked::{Asked, RayList};
use crate::subfields::fields::Fields;

pub(super) struct Eager;

impl Policy for Eager {
    fn begin_frame(&self, fields: &mut Fields, held: &PrimitiveTable) {
        fields.refresh(held);
    }

    fn trace(
        &self,
        fields: &mut Fields,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
    ) -> TraceStats {
        fields.choose_set(rays.len());
        fields.prepare_set(held);
        fields.trace_sorted(held, asked, rays)
    }
}
