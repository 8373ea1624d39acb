//! When subfields are brought up to date, and who waits for whom.

mod eager;
mod locked;
mod on_demand;

use super::asked::{Asked, RayList};
use super::config::UpdatePolicy;
use super::fields::Fields;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;

/// A way to keep subfields up to date, for rays that do not share a direction. `held` is the table
/// whose primitives are in the subfields.
pub(super) trait Policy {
    /// Does what is to be done when a frame begins.
    fn begin_frame(&self, fields: &mut Fields, held: &PrimitiveTable);

    /// Answers some rays of a batch.
    fn trace(
        &self,
        fields: &mut Fields,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
    ) -> TraceStats;
}

impl UpdatePolicy {
    pub(super) const fn policy(self) -> &'static dyn Policy {
        match self {
            Self::OnDemand => &on_demand::OnDemand,
            Self::Eager => &eager::Eager,
            Self::Locked => &locked::Locked,
        }
    }
}
