//! Numbers as colours: the scale, and the bar beside a picture that explains it.

pub(crate) mod color_bar;
mod color_scale;

pub(crate) use color_scale::ColorScale;
