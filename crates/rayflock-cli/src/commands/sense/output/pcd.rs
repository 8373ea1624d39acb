//! PCD: points for the Point Cloud Library, binary, in world space.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use anyhow::Result;
use pcd_rs::{DataKind, DynRecord, DynWriter, Field, Schema, ValueKind, ViewPoint, WriterInit};
use rayflock::render::sensor::Sweep;

use crate::commands::sense::scan::Scan;

/// The fields of a point, called as the library calls those that it knows.
const FIELDS: [(&str, ValueKind); 15] = [
    ("x", ValueKind::F32),
    ("y", ValueKind::F32),
    ("z", ValueKind::F32),
    ("normal_x", ValueKind::F32),
    ("normal_y", ValueKind::F32),
    ("normal_z", ValueKind::F32),
    ("intensity", ValueKind::F32),
    ("range", ValueKind::F32),
    ("time", ValueKind::F64),
    ("object", ValueKind::U32),
    ("primitive", ValueKind::U32),
    ("ring", ValueKind::U32),
    ("column", ValueKind::U32),
    ("return_number", ValueKind::U8),
    ("return_count", ValueKind::U8),
];

/// Writes all points.
pub(super) fn write(path: &Path, scan: &Scan<'_>) -> Result<()> {
    // The writer panics when it is dropped unfinished, as it would be after an error. There is
    // none in memory.
    let mut bytes = Vec::new();
    let schema: Schema = FIELDS.iter().map(|(name, kind)| (*name, *kind, 1)).collect();
    let init = WriterInit {
        width: scan.sweep.len() as u64,
        height: 1,
        viewpoint: ViewPoint::default(),
        data_kind: DataKind::Binary,
        schema: Some(schema),
        version: None,
    };
    let mut writer: DynWriter<_> = init.build_from_writer(Cursor::new(&mut bytes))?;
    let pushed = (0..scan.sweep.len()).try_for_each(|idx| writer.push(&record(scan.sweep, idx)));
    let finished = writer.finish();
    pushed.and(finished)?;
    Ok(fs::write(path, bytes)?)
}

fn record(sweep: &Sweep, idx: usize) -> DynRecord {
    let (position, normal) = (sweep.position[idx], sweep.normal[idx]);
    let mut fields: Vec<Field> = [position.to_array(), normal.to_array()]
        .into_iter()
        .flatten()
        .chain([sweep.intensity[idx], sweep.range[idx]])
        .map(|value| Field::F32(vec![value]))
        .collect();
    fields.push(Field::F64(vec![sweep.time[idx]]));
    let ids = [sweep.object_id[idx], sweep.prim_id[idx], sweep.row[idx], sweep.column[idx]];
    fields.extend(ids.map(|value| Field::U32(vec![value])));
    let returns = [sweep.return_number[idx], sweep.return_count[idx]];
    fields.extend(returns.map(|value| Field::U8(vec![value])));
    DynRecord(fields)
}
