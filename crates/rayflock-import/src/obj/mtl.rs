//! MTL: materials of the illumination models of 1995, which ours descend from.
//!
//! | Ours | From |
//! |---|---|
//! | `diffuse`, `ambient` | `Kd`, times opacity; `Ka` is ignored, exporters fill it at random |
//! | `diffuse_texture` | `map_Kd` |
//! | `specular`, `shininess` | `Ks`, `Ns`, for `illum` 2 and up or none |
//! | `mirror` | `Ks` for `illum` 3 to 9; Schlick's Fresnel for 5 |
//! | `transmission` | `illum` 4, 6, 7 and 9 are glass of `Ni`: `Tf`, else `1 - d`, else all light |
//! | | other models let `1 - d` (or `Tr`) straight through |
//! | `emission` | `Ke` |
//!
//! **Departures.** Read by a parser of our own: that of the tobj crate panics on a colour of two
//! numbers and gives up a whole file for one bad line. Here a bad line is a warning, and
//! very many are a few.

use std::collections::HashMap;

use glam::Vec3;
use rayflock_scene::{Fresnel, Material};

use super::statement::{Statement, statements};
use crate::job::Job;
use crate::texture_files::TextureFiles;

/// Statements that are not understood and told of each; of others, how many there are.
const MOST_TOLD: usize = 8;

/// A material as its file defines it.
#[derive(Clone, Debug, Default)]
pub(super) struct Definition {
    diffuse: Option<Vec3>,
    specular: Vec3,
    emission: Vec3,
    filter: Option<Vec3>,
    shininess: f32,
    ior: Option<f32>,
    opacity: Option<f32>,
    illum: Option<u8>,
    /// Relative to the folder of the OBJ file.
    diffuse_map: Option<String>,
}

/// Adds the definitions of an MTL file that lies at `path` beside the OBJ file.
pub(super) fn parse(
    path: &str,
    bytes: &[u8],
    library: &mut HashMap<String, Definition>,
    job: &mut Job<'_>,
) {
    let (mut name, mut ignored) = (None, 0_usize);
    for statement in statements(bytes) {
        if statement.keyword() == "newmtl" {
            library.insert(statement.rest().to_owned(), Definition::default());
            name = Some(statement.rest().to_owned());
            continue;
        }
        let definition = name.as_ref().and_then(|name| library.get_mut(name));
        let Some(definition) = definition else { continue };
        if definition.read(&statement, path).is_some() {
            continue;
        }
        ignored += 1;
        if ignored <= MOST_TOLD {
            let element = format!("{path} line {}", statement.line);
            job.warn(element, format!("{} is not understood; it is ignored", statement.quote()));
        }
    }
    if ignored > MOST_TOLD {
        let more = ignored - MOST_TOLD;
        job.warn(path, format!("{more} more statements are not understood; they are ignored"));
    }
}

impl Definition {
    /// Takes in a statement; `None` when its arguments make no sense.
    fn read(&mut self, statement: &Statement<'_>, path: &str) -> Option<()> {
        match statement.keyword() {
            "Kd" => self.diffuse = Some(color(statement)?),
            "Ks" => self.specular = color(statement)?,
            "Ke" => self.emission = color(statement)?,
            "Tf" => self.filter = Some(color(statement)?),
            "Ns" => self.shininess = number(statement)?,
            "Ni" => self.ior = Some(number(statement)?.max(1.0)),
            "d" => self.opacity = Some(number(statement)?.min(1.0)),
            "Tr" => self.opacity = Some(1.0 - number(statement)?.min(1.0)),
            "illum" => self.illum = Some(statement.arguments().next()?.parse().ok()?),
            "map_Kd" => self.diffuse_map = Some(map_path(statement.rest(), path)?),
            _ => {}
        }
        Some(())
    }

    /// The material of this name.
    pub(super) fn material(
        &self,
        name: &str,
        textures: &mut TextureFiles,
        job: &mut Job<'_>,
    ) -> Material {
        let illum = self.illum.unwrap_or(2);
        let is_glass = matches!(illum, 4 | 6 | 7 | 9);
        let opacity = self.opacity.unwrap_or(1.0);
        let transmission = match self.filter {
            _ if !is_glass => Vec3::splat(1.0 - opacity),
            Some(filter) => filter,
            None if opacity < 1.0 => Vec3::splat(1.0 - opacity),
            None => Vec3::ONE,
        };
        let diffuse = self.diffuse.unwrap_or(Vec3::splat(0.7)) * opacity;
        Material {
            name: name.to_owned(),
            ambient: diffuse,
            diffuse,
            diffuse_texture: self.diffuse_map.as_ref().and_then(|path| textures.load(path, job)),
            specular: if illum >= 2 { self.specular } else { Vec3::ZERO },
            shininess: self.shininess.clamp(1.0, 1000.0),
            mirror: if illum >= 3 { self.specular.min(Vec3::ONE) } else { Vec3::ZERO },
            transmission: transmission.min(Vec3::ONE),
            ior: if is_glass { self.ior.unwrap_or(1.5) } else { 1.0 },
            fresnel: match illum {
                _ if is_glass => Fresnel::Dielectric,
                5 => Fresnel::Schlick,
                _ => Fresnel::Constant,
            },
            emission: self.emission,
            ..Material::default()
        }
    }
}

/// One number for grey or three; none negative.
fn color(statement: &Statement<'_>) -> Option<Vec3> {
    let color = match *statement.numbers().ok()?.as_slice() {
        [grey] => Vec3::splat(grey),
        [r, g, b] => Vec3::new(r, g, b),
        _ => return None,
    };
    (color.is_finite() && color.min_element() >= 0.0).then_some(color)
}

/// The last argument, as `d -halo` has an option before it; not negative.
fn number(statement: &Statement<'_>) -> Option<f32> {
    let number: f32 = statement.arguments().last()?.parse().ok()?;
    (number.is_finite() && number >= 0.0).then_some(number)
}

/// The file name behind the options of a map, relative to the folder of the OBJ file.
fn map_path(arguments: &str, mtl_path: &str) -> Option<String> {
    let mut rest = arguments;
    while let Some(option) = rest.strip_prefix('-') {
        let (option, behind) = option.split_once(char::is_whitespace)?;
        rest = behind.trim_start();
        // Options such as -s take one to three numbers, the others one word.
        let may_have_more = matches!(option, "o" | "s" | "t" | "mm");
        for argument_idx in 0..if may_have_more { 3 } else { 1 } {
            let (word, behind) = rest.split_once(char::is_whitespace)?;
            if argument_idx > 0 && word.parse::<f32>().is_err() {
                break;
            }
            rest = behind.trim_start();
        }
    }
    let folder = mtl_path.rsplit_once(['/', '\\']).map(|(folder, _)| format!("{folder}/"));
    (!rest.is_empty()).then(|| folder.unwrap_or_default() + rest)
}
