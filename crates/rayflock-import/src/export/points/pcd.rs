//! PCD: points for the Point Cloud Library, binary, in world space.

use std::io::{Cursor, Write};

use pcd_rs::{DataKind, DynRecord, DynWriter, Field, Schema, ValueKind, ViewPoint, WriterInit};

use super::{PointColumns, PointFileError};

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
pub(super) fn write(points: &PointColumns<'_>, out: &mut impl Write) -> Result<(), PointFileError> {
    // The writer panics when it is dropped unfinished, as it would be after an error. There is
    // none in memory.
    let mut bytes = Vec::new();
    let schema: Schema = FIELDS.iter().map(|(name, kind)| (*name, *kind, 1)).collect();
    let init = WriterInit {
        width: points.len() as u64,
        height: 1,
        viewpoint: ViewPoint::default(),
        data_kind: DataKind::Binary,
        schema: Some(schema),
        version: None,
    };
    let mut writer: DynWriter<_> = init.build_from_writer(Cursor::new(&mut bytes))?;
    let pushed = (0..points.len()).try_for_each(|idx| writer.push(&record(points, idx)));
    let finished = writer.finish();
    pushed.and(finished)?;
    Ok(out.write_all(&bytes)?)
}

fn record(points: &PointColumns<'_>, idx: usize) -> DynRecord {
    let (position, normal) = (points.position[idx], points.normal[idx]);
    let mut fields: Vec<Field> = [position.to_array(), normal.to_array()]
        .into_iter()
        .flatten()
        .chain([points.intensity[idx], points.range[idx]])
        .map(|value| Field::F32(vec![value]))
        .collect();
    fields.push(Field::F64(vec![points.time[idx]]));
    let ids = [points.object_id[idx], points.prim_id[idx], points.row[idx], points.column[idx]];
    fields.extend(ids.map(|value| Field::U32(vec![value])));
    let returns = [points.return_number[idx], points.return_count[idx]];
    fields.extend(returns.map(|value| Field::U8(vec![value])));
    DynRecord(fields)
}
