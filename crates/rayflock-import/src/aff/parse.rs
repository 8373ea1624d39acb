//! From words to a document: one command after another.
//!
//! The fill that is in force, the transforms that are open and the level of detail are one state
//! for all files: an included file goes on with that of the file that includes it, and leaves it
//! changed. Only blocks end in the file that they begin in.

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::Sphere;
use rayflock_scene::LocalTransform;

use super::curved::{self, ConeEnd};
use super::document::{Document, LightSource, Mover, Place};
use super::includes::{Includes, too_large};
use super::keys;
use super::looks::{self, Fill};
use super::oddities::Oddities;
use super::part::{Part, Setting};
use super::patch::{self, Patch};
use super::reader::Reader;
use super::words::Word;
use crate::ImportError;
use crate::job::Job;

/// Reads a file and all that it includes.
pub(super) fn parse(bytes: &[u8], job: &mut Job<'_>) -> Result<Document, ImportError> {
    if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
        return Err(job.invalid("text", format!("a zero byte at offset {at}"), "an AFF file"));
    }
    let file = FileInForce { file_idx: 0, name: job.name() };
    let mut parser = Parser {
        includes: Includes::new(job),
        document: Document::new(),
        place: Place::WORLD,
        fill: Fill::white(),
        fill_name: "white".to_owned(),
        // Everything, until the file says otherwise.
        detail: job.options.detail.map_or(i64::MAX, i64::from),
        file,
        curved_count: 0,
        odd: Oddities::default(),
        job,
    };
    let mut reader = Reader::new(parser.job.file, None, bytes);
    parser.read_file(&mut reader)?;
    let Parser { document, odd, job, .. } = parser;
    odd.report(job)?;
    Ok(document)
}

/// Which file draws.
#[derive(Clone, Debug)]
struct FileInForce {
    /// 0 for the file that was asked for, then counted by inclusion.
    file_idx: usize,
    /// Without extension.
    name: String,
}

struct Parser<'p, 'j> {
    job: &'p mut Job<'j>,
    includes: Includes,
    document: Document,
    place: Place,
    fill: Fill,
    fill_name: String,
    /// Files of a higher level are not included.
    detail: i64,
    file: FileInForce,
    curved_count: usize,
    odd: Oddities,
}

impl Parser<'_, '_> {
    fn read_file(&mut self, reader: &mut Reader<'_>) -> Result<(), ImportError> {
        // The line that opened each block, and the place outside it.
        let mut blocks: Vec<(usize, Place)> = Vec::new();
        while let Some(command) = reader.next_command() {
            match command.bytes {
                b"x" | b"xs" => {
                    let outside = self.place;
                    self.place = self.read_transform(command, reader)?;
                    reader.expect("{")?;
                    blocks.push((command.line, outside));
                }
                b"}" => {
                    let Some((_, outside)) = blocks.pop() else {
                        return Err(reader.invalid("\"}\"", "a block that it ends"));
                    };
                    self.place = outside;
                }
                _ => self.read_command(command, reader)?,
            }
        }
        match blocks.first() {
            None => Ok(()),
            Some(&(line, _)) => {
                Err(reader.invalid_at(line, "a block without an end", "a \"}\" in the same file"))
            }
        }
    }

    /// Reads a command that opens or ends no block.
    fn read_command(
        &mut self,
        command: Word<'_>,
        reader: &mut Reader<'_>,
    ) -> Result<(), ImportError> {
        self.odd.known_commands += 1;
        match command.bytes {
            b"v" => self.document.view = Some(looks::read_view(reader)?),
            b"b" => self.document.background = looks::read_background(reader)?,
            b"am" => self.document.ambient = reader.vector()?.max(Vec3::ZERO),
            b"a" => self.document.interval = Some(looks::read_interval(reader)?),
            b"k" => self.read_keys(reader)?,
            b"l" => self.read_light(reader, None)?,
            b"la" => {
                let name = reader.name("the name of a light")?;
                self.read_light(reader, Some(name))?;
            }
            b"f" => self.set_fill(looks::read_nff_fill(reader)?, reader),
            b"fm" => self.set_fill(looks::read_fill(reader)?, reader),
            b"i" => self.include(reader)?,
            b"d" => {
                let detail = reader.integer()?;
                self.detail = self.job.options.detail.map_or(detail, i64::from);
            }
            _ => return self.read_shape(command, reader),
        }
        Ok(())
    }

    fn read_shape(
        &mut self,
        command: Word<'_>,
        reader: &mut Reader<'_>,
    ) -> Result<(), ImportError> {
        match command.bytes {
            b"p" => self.add_polygon(&patch::read_polygon(reader, false)?),
            b"pp" => self.add_polygon(&patch::read_polygon(reader, true)?),
            b"tt" => {
                let (patch, texture) = patch::read_textured_triangle(reader, false)?;
                self.add_patch(&patch, Some(&texture));
            }
            b"ttp" | b"ttpp" | b"tpp" => {
                let (patch, texture) = patch::read_textured_triangle(reader, true)?;
                self.add_patch(&patch, Some(&texture));
            }
            b"m" => {
                let (patch, texture) = patch::read_mesh(reader)?;
                self.add_patch(&patch, texture.as_deref());
            }
            b"tpa" => {
                let keys = patch::read_animated_triangle(reader)?;
                let setting = self.setting(None);
                self.part().add_animated(&keys, &setting);
            }
            b"s" => self.add_sphere(reader)?,
            b"c" => self.add_cone(reader)?,
            _ => self.skip(command, reader),
        }
        Ok(())
    }

    /// Leaves out a command that is not known, with its line.
    fn skip(&mut self, command: Word<'_>, reader: &mut Reader<'_>) {
        self.odd.known_commands -= 1;
        if command.number().is_some() {
            self.odd.stray_numbers += 1;
            return;
        }
        self.odd.add_unknown(command);
        reader.skip_line();
    }

    /// Reads the transform of a block; returns the place inside.
    fn read_transform(
        &mut self,
        command: Word<'_>,
        reader: &mut Reader<'_>,
    ) -> Result<Place, ImportError> {
        self.odd.known_commands += 1;
        if command.bytes == b"x" {
            let name = reader.name("the name of a transform")?;
            let rest = LocalTransform::IDENTITY;
            return Ok(Place { mover: Some(self.add_mover(name, rest)), ..Place::WORLD });
        }
        let scale = reader.vector()?;
        let [x, y, z, degrees] = reader.numbers()?.map(|number| number as f32);
        let translation = reader.vector()?;
        let axis = Vec3::new(x, y, z).try_normalize();
        let turn = |axis| Quat::from_axis_angle(axis, degrees.to_radians());
        let rotation = axis.map_or(Quat::IDENTITY, turn);
        let inside = Affine3A::from_scale_rotation_translation(scale, rotation, translation);
        Ok(Place { mover_from_here: self.place.mover_from_here * inside, ..self.place })
    }

    /// Adds something that keys may move, at the place in force.
    fn add_mover(&mut self, name: String, rest: LocalTransform) -> usize {
        let movers = &mut self.document.movers;
        movers.push(Mover { name, place: self.place, rest });
        movers.len() - 1
    }

    fn read_keys(&mut self, reader: &mut Reader<'_>) -> Result<(), ImportError> {
        let name = reader.name("the name of what moves")?;
        let motion = keys::read_motion(reader)?;
        if motion.left_out > 0 {
            let count = motion.left_out;
            let message = format!("{count} keys of \"{name}\" go back in time; they are left out");
            self.job.warn(reader.element(), message);
        }
        let known = self.document.motions.get(&name);
        if known.is_some_and(|known| *known != motion) {
            let message = format!("there are keys for \"{name}\" already; these replace them");
            self.job.warn(reader.element(), message);
        }
        self.document.motions.insert(name, motion);
        Ok(())
    }

    /// Reads a light; one with a name may be moved by keys.
    fn read_light(
        &mut self,
        reader: &mut Reader<'_>,
        name: Option<String>,
    ) -> Result<(), ImportError> {
        let (position, color) = looks::read_light(reader)?;
        let here = self.place;
        let light = match name {
            Some(name) => {
                let (rotation, scale) = (Quat::IDENTITY, Vec3::ONE);
                let rest = LocalTransform::Parts { translation: position, rotation, scale };
                let mover = Some(self.add_mover(name.clone(), rest));
                LightSource { name, mover, position: Vec3::ZERO, color }
            }
            None => {
                let name = format!("light {}", self.document.lights.len());
                let position = here.mover_from_here.transform_point3(position);
                LightSource { name, mover: here.mover, position, color }
            }
        };
        self.document.lights.push(light);
        Ok(())
    }

    fn set_fill(&mut self, fill: Fill, reader: &Reader<'_>) {
        self.fill = fill;
        self.fill_name = format!("{} line {}", self.file.name, reader.line());
    }

    /// Reads a level of detail and a file, and what the file holds if its level is wanted.
    fn include(&mut self, reader: &mut Reader<'_>) -> Result<(), ImportError> {
        let level = reader.integer()?;
        let name = reader.name("the name of an AFF file")?;
        if level > self.detail {
            self.odd.skipped_includes += 1;
            return Ok(());
        }
        let content = self.includes.open(&name, reader, self.job)?;
        let file_idx = self.includes.count();
        let file = FileInForce { file_idx, name: file_stem(&name).to_owned() };
        let outside = std::mem::replace(&mut self.file, file);
        self.read_file(&mut Reader::new(self.job.file, Some(&name), &content))?;
        self.file = outside;
        self.includes.close();
        Ok(())
    }

    /// Where the file draws now.
    fn part(&mut self) -> &mut Part {
        self.document.part(self.file.file_idx, &self.file.name, self.place.mover)
    }

    /// Where and of what the next shape is.
    fn setting(&mut self, texture: Option<&str>) -> Setting {
        let texture = texture.and_then(|path| self.document.textures.load(path, self.job));
        let fill = self.fill.with_texture(texture);
        let material = self.document.material(&fill, &self.fill_name);
        Setting { part_from_block: self.place.mover_from_here, material }
    }

    fn add_patch(&mut self, patch: &Patch, texture: Option<&str>) {
        let setting = self.setting(texture);
        self.part().add_patch(patch, &setting);
    }

    fn add_polygon(&mut self, polygon: &Patch) {
        if polygon.triangles.is_empty() {
            self.odd.small_polygons += 1;
        } else {
            self.add_patch(polygon, None);
        }
    }

    fn add_sphere(&mut self, reader: &mut Reader<'_>) -> Result<(), ImportError> {
        let (center, radius) = (reader.vector()?, reader.number()? as f32);
        let setting = self.setting(None);
        if self.part().add_sphere(Sphere::new(center, radius.abs()), &setting) {
            self.odd.stretched_spheres += 1;
            self.count_curved(curved::SPHERE_TRIANGLES, reader)?;
        }
        Ok(())
    }

    fn add_cone(&mut self, reader: &mut Reader<'_>) -> Result<(), ImportError> {
        let mut end = || -> Result<ConeEnd, ImportError> {
            Ok(ConeEnd { center: reader.vector()?, radius: reader.number()? as f32 })
        };
        let (base, apex) = (end()?, end()?);
        match curved::cone(base, apex) {
            Some(cone) => self.add_patch(&cone, None),
            None => self.odd.pointless_cones += 1,
        }
        self.count_curved(curved::CONE_TRIANGLES, reader)
    }

    /// Limits the triangles that short commands may become.
    fn count_curved(
        &mut self,
        triangle_count: usize,
        reader: &Reader<'_>,
    ) -> Result<(), ImportError> {
        self.curved_count += triangle_count;
        if self.curved_count <= curved::LIMIT {
            return Ok(());
        }
        let found = format!("{} triangles of cones and stretched spheres", self.curved_count);
        Err(too_large(reader, self.job, found, curved::LIMIT.to_string()))
    }
}

/// The name of a file without folder and extensions.
fn file_stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.split('.').find(|part| !part.is_empty()).unwrap_or(file)
}
