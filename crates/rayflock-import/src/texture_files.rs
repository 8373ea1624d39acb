//! Textures that a format names by file.

use std::collections::HashMap;

use rayflock_scene::{Texture, TextureIdx};

use crate::job::Job;
use crate::texture;

/// Textures by path, each loaded once.
#[derive(Debug, Default)]
pub(crate) struct TextureFiles {
    pub(crate) textures: Vec<Texture>,
    loaded: HashMap<String, Option<TextureIdx>>,
}

impl TextureFiles {
    /// The texture at a path beside the job's file. One that cannot be had is a warning.
    pub(crate) fn load(&mut self, path: &str, job: &mut Job<'_>) -> Option<TextureIdx> {
        if let Some(loaded) = self.loaded.get(path) {
            return *loaded;
        }
        let bytes = job.read_neighbour(path);
        let image = bytes.and_then(|bytes| texture::decode(&bytes, &mut job.pixels_left));
        let loaded = match image {
            Ok(image) => {
                self.textures.push(texture::texture(path.to_owned(), &image));
                Some(TextureIdx(self.textures.len() as u32 - 1))
            }
            Err(reason) => {
                let message = format!("{reason}; materials do without it");
                job.warn(format!("texture \"{path}\""), message);
                None
            }
        };
        self.loaded.insert(path.to_owned(), loaded);
        loaded
    }
}
