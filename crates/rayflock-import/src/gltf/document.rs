//! From bytes to JSON objects whose cross references hold.

use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked, Error as Fault, Validate};
use gltf::json::{Path as JsonPath, Root, deserialize};

use super::label;
use crate::ImportError;
use crate::job::Job;

/// Bytes before the first chunk of a `.glb`: magic, version, length.
const GLB_HEADER_SIZE: usize = 12;

/// The JSON and, from a `.glb`, its binary chunk.
pub(super) fn parse(
    bytes: &[u8],
    job: &mut Job<'_>,
) -> Result<(Root, Option<Vec<u8>>), ImportError> {
    let (root, blob) = if bytes.starts_with(b"glTF") {
        let bytes = check_glb_header(bytes, job)?;
        let chunks = gltf::Glb::from_slice(bytes)
            .map_err(|error| job.invalid("GLB chunks", describe(&error), "a JSON, then a BIN"))?;
        (parse_json(&chunks.json, job)?, chunks.bin.map(std::borrow::Cow::into_owned))
    } else {
        (parse_json(bytes, job)?, None)
    };
    check_version(&root, job)?;
    check_positions(&root, job)?;
    validate(&root, job)?;
    Ok((root, blob))
}

fn describe(error: &gltf::Error) -> String {
    match error {
        gltf::Error::Binary(error) => error.to_string(),
        other => other.to_string(),
    }
}

/// Checks what the crate's reader subtracts without looking, and cuts what lies behind the end.
fn check_glb_header<'a>(bytes: &'a [u8], job: &mut Job<'_>) -> Result<&'a [u8], ImportError> {
    let stated = bytes.get(8..GLB_HEADER_SIZE).and_then(|length| length.first_chunk());
    let Some(stated) = stated.map(|length| u32::from_le_bytes(*length) as usize) else {
        let found = format!("{} bytes", bytes.len());
        return Err(job.invalid("GLB header", found, format!("{GLB_HEADER_SIZE} bytes or more")));
    };
    if stated < GLB_HEADER_SIZE || stated > bytes.len() {
        let expected = format!("{GLB_HEADER_SIZE} to {} bytes, the size of it", bytes.len());
        return Err(job.invalid("GLB header", format!("a length of {stated} bytes"), expected));
    }
    if stated < bytes.len() {
        let rest = bytes.len() - stated;
        job.warn("GLB header", format!("{rest} bytes follow the stated end; they are ignored"));
    }
    Ok(&bytes[..stated])
}

fn parse_json(json: &[u8], job: &Job<'_>) -> Result<Root, ImportError> {
    // A byte order mark is against the rules but common.
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    deserialize::from_slice(json)
        .map_err(|error| job.invalid("JSON", error.to_string(), "a glTF 2.0 document"))
}

fn check_version(root: &Root, job: &Job<'_>) -> Result<(), ImportError> {
    let version = &root.asset.version;
    if version.split('.').next() == Some("2") {
        return Ok(());
    }
    Err(ImportError::Unsupported {
        file: job.file.to_owned(),
        element: "asset".to_owned(),
        found: format!("version \"{}\"", crate::error::shorten(version)),
        expected: "version 2.0".to_owned(),
    })
}

/// Checks the indices that the crate's validation itself uses unchecked.
fn check_positions(root: &Root, job: &Job<'_>) -> Result<(), ImportError> {
    let count = root.accessors.len();
    for (mesh_idx, mesh) in root.meshes.iter().enumerate() {
        for (primitive_idx, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            let Some(accessor) = position.filter(|accessor| accessor.value() >= count) else {
                continue;
            };
            let mesh = label("mesh", mesh_idx, mesh.name.as_ref());
            let element = format!("{mesh} primitive {primitive_idx} POSITION");
            let found = format!("accessor {}", accessor.value());
            return Err(job.invalid(element, found, format!("one of {count} accessors")));
        }
    }
    Ok(())
}

/// Runs the crate's validation, which guarantees indices in range and known enumerations.
fn validate(root: &Root, job: &mut Job<'_>) -> Result<(), ImportError> {
    let mut faults = Vec::new();
    root.validate(root, JsonPath::new, &mut |path, fault| {
        faults.push((path().as_str().to_owned(), fault));
    });
    for (path, fault) in faults {
        // Bounds of positions are obligatory, but nothing here depends on them.
        if path.ends_with(".min") || path.ends_with(".max") {
            job.warn(path, "bounds are missing or wrong; they are not needed");
            continue;
        }
        let (found, expected) = match fault {
            Fault::IndexOutOfBounds => ("an index out of range", "an index of what is there"),
            Fault::Invalid => ("a value that is not allowed", "a value that glTF 2.0 lists"),
            Fault::Missing => ("nothing", "a value"),
            Fault::Oversize => ("a size beyond this machine", "a smaller size"),
            Fault::Unsupported => {
                return Err(ImportError::Unsupported {
                    file: job.file.to_owned(),
                    element: crate::error::shorten(&path),
                    found: "this required extension".to_owned(),
                    expected: "a file that needs none, or lights, texture transforms and the \
                               transmission, ior, unlit and emissive strength of materials,"
                        .to_owned(),
                });
            }
        };
        return Err(job.invalid(crate::error::shorten(&path), found, expected));
    }
    Ok(())
}
