//! Where pictures and films go.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`Target`] | the path after `-o` is to be understood |
//! | [`FrameNames`] | a frame needs its path |
//! | [`picture`] | one frame is written: PNG, EXR |
//! | [`film`] | finished frames become one file: GIF, WebP, MP4 |
//! | [`atomic`] | any file is written |

pub(crate) mod atomic;
mod exr;
pub(crate) mod film;
mod gif;
mod mp4;
mod names;
pub(crate) mod picture;
mod png;
mod target;
mod webp;

pub(crate) use film::Container;
pub(crate) use names::{FrameNames, folder_of};
pub(crate) use picture::{Look, PictureFormat};
pub(crate) use target::{Target, create_folder};
