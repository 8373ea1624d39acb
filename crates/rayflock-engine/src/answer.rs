//! Hands what engines found over to the caller's columns.

use rayflock_geom::Hits;

use crate::packet::Nearest;
use crate::primitives::PrimitiveTable;

/// Offers the nearest hit of each ray, given with its position in the batch.
pub(crate) fn offer_hits(
    table: &PrimitiveTable,
    found: impl Iterator<Item = (usize, Nearest)>,
    hits: &mut Hits<'_>,
) {
    for (ray_idx, nearest) in found {
        if !nearest.is_none() {
            hits.offer(ray_idx, &table.hit(&nearest));
        }
    }
}
