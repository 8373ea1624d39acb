//! A batch is sorted by direction; what occurs is brought up to date, each once, all in parallel;
//! then rays are traced.
//!
//! **Departures.** The paper does it when a ray first wants a subfield, under a lock
//! ([`Locked`](super::locked::Locked)); here no ray waits, and all threads build.

use super::Policy;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;
use crate::subfields::asked::{Asked, RayList};
use crate::subfields::fields::Fields;

pub(super) struct OnDemand;

impl Policy for OnDemand {
    fn begin_frame(&self, _: &mut Fields, _: &PrimitiveTable) {}

    fn trace(
        &self,
        fields: &mut Fields,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
    ) -> TraceStats {
        fields.choose_set(rays.len());
        fields.trace_sorted(held, asked, rays)
    }
}
