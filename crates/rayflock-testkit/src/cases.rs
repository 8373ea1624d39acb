//! Cases as data: small scenes, rays, and the hits that every engine must report.
//!
//! A case file is TOML: a list of `[[case]]`, each with `name`, `objects` and `rays`, or with
//! `frames` that hold `objects` and `rays`. Numbers may be `inf` and `nan`. Without `hit` a ray
//! must miss. Answers are exact: a case uses coordinates whose hits are representable.
//!
//! ```toml
//! [[case]]
//! name = "a triangle is hit"
//! objects = [{ id = 0, vertices = [[0, 0, 2], [4, 0, 2], [0, 4, 2]], triangles = [[0, 1, 2]] }]
//! rays = [
//!     { origin = [1, 1, 0], direction = [0, 0, 1], hit = { object = 0, prim = 0, t = 2 } },
//! ]
//! ```

use std::fs;
use std::path::{Path, PathBuf};

use glam::{Affine3A, Vec3};
use rayflock_geom::{
    Geometry, GeometryError, GeometryObject, Hit, Mesh, ObjectId, PrimId, Ray, Sphere,
};
use serde::Deserialize;
use thiserror::Error;

/// One case: frames that follow each other, with rays and answers for each.
#[derive(Clone, Debug)]
pub struct Case {
    /// The file it comes from, and its name there.
    pub name: String,
    /// The frames, in order.
    pub frames: Vec<CaseFrame>,
}

/// One frame of a case.
#[derive(Clone, Debug)]
pub struct CaseFrame {
    /// What can be hit.
    pub geometry: Geometry,
    /// Rays and what they must hit.
    pub rays: Vec<CaseRay>,
    /// How many primitives must be counted as ignored, when the case says so.
    pub ignored: Option<Ignored>,
    /// How many rays must be counted as invalid, when the case says so.
    pub invalid_rays: Option<u64>,
}

/// One ray of a case.
#[derive(Clone, Copy, Debug)]
pub struct CaseRay {
    /// The ray.
    pub ray: Ray,
    /// The answer, [`Hit::MISS`] for a miss.
    pub expected: Hit,
    /// Whether the case states `u` and `v` of the hit.
    pub has_uv: bool,
}

/// Primitives that a commit must ignore and count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ignored {
    /// With a coordinate that is not finite.
    #[serde(default)]
    pub non_finite: usize,
    /// Without area, or with a radius that is not positive.
    #[serde(default)]
    pub degenerate: usize,
}

/// Why case files cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CaseError {
    /// The folder or a file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// Which one.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not TOML of the expected form.
    #[error("{path}: {source}")]
    Form {
        /// Which one.
        path: PathBuf,
        /// Where and why.
        source: Box<toml::de::Error>,
    },
    /// The objects of a case do not make a geometry.
    #[error("case \"{case}\": {source}")]
    Geometry {
        /// Which case.
        case: String,
        /// Why.
        source: GeometryError,
    },
}

/// The folder of case files in this repository.
pub fn cases_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../testdata/cases")
}

/// Reads all cases of all `.toml` files in a folder, sorted by file name.
///
/// # Errors
/// [`CaseError`] names the file or the case that is wrong.
pub fn load_cases(folder: &Path) -> Result<Vec<Case>, CaseError> {
    let io = |source| CaseError::Io { path: folder.to_owned(), source };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            paths.push(path);
        }
    }
    paths.sort();
    let mut cases = Vec::new();
    for path in paths {
        let text = fs::read_to_string(&path)
            .map_err(|source| CaseError::Io { path: path.clone(), source })?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        cases.extend(parse_cases(&text, &path, &stem)?);
    }
    Ok(cases)
}

fn parse_cases(text: &str, path: &Path, stem: &str) -> Result<Vec<Case>, CaseError> {
    let file: FileForm = toml::from_str(text)
        .map_err(|source| CaseError::Form { path: path.to_owned(), source: Box::new(source) })?;
    file.case.into_iter().map(|case| case.build(stem)).collect()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileForm {
    case: Vec<CaseForm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CaseForm {
    name: String,
    #[serde(default)]
    objects: Vec<ObjectForm>,
    #[serde(default)]
    rays: Vec<RayForm>,
    #[serde(default)]
    frames: Vec<FrameForm>,
    ignored: Option<Ignored>,
    invalid_rays: Option<u64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameForm {
    #[serde(default)]
    objects: Vec<ObjectForm>,
    #[serde(default)]
    rays: Vec<RayForm>,
    ignored: Option<Ignored>,
    invalid_rays: Option<u64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectForm {
    id: u32,
    mask: Option<u32>,
    #[serde(default)]
    vertices: Vec<[f32; 3]>,
    #[serde(default)]
    triangles: Vec<[u32; 3]>,
    /// Centre and radius.
    #[serde(default)]
    spheres: Vec<[f32; 4]>,
    /// The images of the x, y and z axis, then the translation.
    transform: Option<[[f32; 3]; 4]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RayForm {
    origin: [f32; 3],
    direction: [f32; 3],
    #[serde(default)]
    t_min: f32,
    #[serde(default = "infinity")]
    t_max: f32,
    #[serde(default = "all_bits")]
    mask: u32,
    hit: Option<HitForm>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HitForm {
    object: u32,
    prim: u32,
    t: f32,
    uv: Option<[f32; 2]>,
}

const fn infinity() -> f32 {
    f32::INFINITY
}

const fn all_bits() -> u32 {
    u32::MAX
}

impl CaseForm {
    fn build(self, stem: &str) -> Result<Case, CaseError> {
        let name = format!("{stem}: {}", self.name);
        let mut frames = self.frames;
        if frames.is_empty() {
            frames.push(FrameForm {
                objects: self.objects,
                rays: self.rays,
                ignored: self.ignored,
                invalid_rays: self.invalid_rays,
            });
        }
        let frames: Result<_, _> = frames.into_iter().map(FrameForm::build).collect();
        match frames {
            Ok(frames) => Ok(Case { name, frames }),
            Err(source) => Err(CaseError::Geometry { case: name, source }),
        }
    }
}

impl FrameForm {
    fn build(self) -> Result<CaseFrame, GeometryError> {
        let objects: Result<Vec<_>, _> = self.objects.into_iter().map(ObjectForm::build).collect();
        Ok(CaseFrame {
            geometry: Geometry::new(objects?)?,
            rays: self.rays.iter().map(RayForm::build).collect(),
            ignored: self.ignored,
            invalid_rays: self.invalid_rays,
        })
    }
}

impl ObjectForm {
    fn build(self) -> Result<GeometryObject, GeometryError> {
        let vertices = self.vertices.into_iter().map(Vec3::from).collect();
        let spheres = self.spheres.iter().map(|&[x, y, z, r]| Sphere::new(Vec3::new(x, y, z), r));
        let mesh = Mesh::from_triangles(vertices, self.triangles)?.with_spheres(spheres.collect());
        let object = GeometryObject::new(ObjectId(self.id), mesh);
        let object = object.with_mask(self.mask.unwrap_or(u32::MAX));
        let Some(columns) = self.transform else { return Ok(object) };
        let [x, y, z, translation] = columns.map(Into::into);
        Ok(object.with_transform(Affine3A::from_cols(x, y, z, translation)))
    }
}

impl RayForm {
    fn build(&self) -> CaseRay {
        let ray = Ray {
            origin: self.origin.into(),
            direction: self.direction.into(),
            t_min: self.t_min,
            t_max: self.t_max,
            mask: self.mask,
        };
        let expected = self.hit.as_ref().map_or(Hit::MISS, |hit| {
            let [u, v] = hit.uv.unwrap_or_default();
            let (object_id, prim_id) = (ObjectId(hit.object), PrimId(hit.prim));
            Hit { t: hit.t, u, v, object_id, prim_id }
        });
        let has_uv = self.hit.as_ref().is_none_or(|hit| hit.uv.is_some());
        CaseRay { ray, expected, has_uv }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Oracle;

    #[test]
    fn the_oracle_accepts_every_case_of_this_repository() {
        let cases = load_cases(&cases_folder()).unwrap();
        assert!(cases.len() >= 20, "only {} cases found", cases.len());
        for case in &cases {
            for frame in &case.frames {
                let oracle = Oracle::new(&frame.geometry);
                for CaseRay { ray, expected, has_uv } in &frame.rays {
                    if *has_uv {
                        let verdict = oracle.judge(ray, expected);
                        assert_eq!(verdict, Ok(()), "{}: {ray:?}", case.name);
                    }
                }
            }
        }
    }

    #[test]
    fn errors_name_the_file_or_the_case() {
        let parse = |text: &str| parse_cases(text, Path::new("a.toml"), "a").unwrap_err();
        let unknown = parse("[[case]]\nname = 'x'\nrais = []").to_string();
        assert!(unknown.starts_with("a.toml: ") && unknown.contains("rais"), "{unknown}");
        let object = "{ id = 1, vertices = [], triangles = [[0, 1, 2]] }";
        let wrong = parse(&format!("[[case]]\nname = 'x'\nobjects = [{object}]")).to_string();
        assert!(wrong.starts_with("case \"a: x\": triangle 0 names vertex 0"), "{wrong}");
        let missing = load_cases(Path::new("no such folder")).unwrap_err().to_string();
        assert!(missing.starts_with("no such folder: "), "{missing}");
    }
}
