//! Images behind material slots. One that is missing or unreadable is a warning.

use std::collections::HashMap;

use glam::Vec3;
use gltf::json::{Root, texture::Info};
use image::RgbImage;
use rayflock_scene::{Texture, TextureIdx};

use super::{buffers, label};
use crate::job::Job;
use crate::texture;

/// Loads the images that materials ask for, each once a use.
#[derive(Debug)]
pub(super) struct Images<'a> {
    root: &'a Root,
    buffers: &'a [Vec<u8>],
    textures: Vec<Texture>,
    loaded: HashMap<usize, Option<TextureIdx>>,
    means: HashMap<usize, Option<Vec3>>,
}

impl<'a> Images<'a> {
    pub(super) fn new(root: &'a Root, buffers: &'a [Vec<u8>]) -> Self {
        let (textures, loaded, means) = Default::default();
        Self { root, buffers, textures, loaded, means }
    }

    /// The texture for a colour slot.
    pub(super) fn color(&mut self, info: &Info, job: &mut Job<'_>) -> Option<TextureIdx> {
        let image_idx = self.image_idx(info);
        if let Some(loaded) = self.loaded.get(&image_idx) {
            return *loaded;
        }
        let loaded = self.decode(image_idx, job).map(|image| {
            let json = &self.root.images[image_idx];
            let name = json.name.clone().or(json.uri.clone().filter(|uri| uri.len() < 100));
            let name = name.unwrap_or_else(|| format!("image {image_idx}"));
            self.textures.push(texture::texture(name, &image));
            TextureIdx(self.textures.len() as u32 - 1)
        });
        self.loaded.insert(image_idx, loaded);
        loaded
    }

    /// The mean of the image in a data slot, 0 to 1 a channel.
    pub(super) fn mean(&mut self, info: &Info, job: &mut Job<'_>) -> Option<Vec3> {
        let image_idx = self.image_idx(info);
        if let Some(mean) = self.means.get(&image_idx) {
            return *mean;
        }
        let mean = self.decode(image_idx, job).map(|image| texture::mean(&image));
        self.means.insert(image_idx, mean);
        mean
    }

    /// The textures that were loaded, in the order of their indices.
    pub(super) fn into_textures(self) -> Vec<Texture> {
        self.textures
    }

    /// The image of a slot; out of range when the texture has none that is read.
    fn image_idx(&self, info: &Info) -> usize {
        self.root.textures.get(info.index.value()).map_or(usize::MAX, |it| it.source.value())
    }

    fn decode(&self, image_idx: usize, job: &mut Job<'_>) -> Option<RgbImage> {
        let Some(json) = self.root.images.get(image_idx) else {
            job.warn("textures", "a texture has no PNG or JPEG image; it is left out");
            return None;
        };
        let bytes = match (&json.uri, json.buffer_view) {
            (Some(uri), _) => buffers::fetch(uri, job),
            (None, Some(view)) => buffers::view(self.root, self.buffers, view).map(<[u8]>::to_vec),
            (None, None) => Err("neither a URI nor a buffer view".to_owned()),
        };
        match bytes.and_then(|bytes| texture::decode(&bytes, &mut job.pixels_left)) {
            Ok(image) => Some(image),
            Err(reason) => {
                let element = label("image", image_idx, json.name.as_ref());
                job.warn(element, format!("{reason}; materials do without it"));
                None
            }
        }
    }
}
