//! Pictures of scenes.

use glam::{Affine3A, Mat3A, Vec3};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use rayflock::engine::{EngineKind, create};
use rayflock::geom::FrameChanges;
use rayflock::render::tonemap::{ToneMap, to_srgb8};
use rayflock::render::{Film, FrameRenderer, RenderSettings, View, WhittedRenderer};
use rayflock::scene::{Background, Projection, frame_bounds};

use crate::arrays::{readable, rows};
use crate::errors::Failure;
use crate::pool;
use crate::stage::Stage;
use crate::world::World;

/// How a picture is made.
pub(crate) struct PictureSettings {
    width: usize,
    height: usize,
    camera: CameraChoice,
    settings: RenderSettings,
    exposure: f32,
    tone_map: ToneMap,
    /// Linear light in place of what a screen shows.
    is_linear: bool,
    engine: Option<EngineKind>,
    threads: Option<usize>,
}

/// Where a picture is seen from.
enum CameraChoice {
    /// The camera of this name; without a name the first one, or one that sees everything.
    Named(Option<String>),
    /// One that stands at a point and looks at another.
    Placed { eye: Vec3, center: Vec3, up: Vec3, fov_deg: f32 },
}

/// The pixels of a picture, three values each, rows from the top.
pub(crate) enum Pixels {
    /// As a screen shows them.
    Screen(Vec<u8>),
    /// As they are.
    Linear(Vec<f32>),
}

impl PictureSettings {
    /// Takes the dictionary that Python hands over, which has an item for each of these names.
    pub(crate) fn new(given: &Bound<'_, PyDict>) -> PyResult<Self> {
        let item = |name| given.as_any().get_item(name);
        let camera = match item("eye")?.extract::<Option<[f32; 3]>>()? {
            None => CameraChoice::Named(item("camera")?.extract()?),
            Some(eye) => CameraChoice::Placed {
                eye: eye.into(),
                center: item("center")?.extract::<[f32; 3]>()?.into(),
                up: item("up")?.extract::<[f32; 3]>()?.into(),
                fov_deg: item("fov_deg")?.extract()?,
            },
        };
        let background: Option<[f32; 3]> = item("background")?.extract()?;
        let tone_map: String = item("tone_map")?.extract()?;
        let engine: Option<String> = item("engine")?.extract()?;
        let tone_map: Result<ToneMap, _> = tone_map.parse();
        Ok(Self {
            width: item("width")?.extract()?,
            height: item("height")?.extract()?,
            camera,
            settings: RenderSettings {
                samples_per_pixel: item("samples")?.extract()?,
                depth: item("depth")?.extract()?,
                shadows: item("shadows")?.extract()?,
                background: background.map(|color| Background::Uniform(color.into())),
                ..RenderSettings::default()
            },
            exposure: item("exposure")?.extract()?,
            tone_map: tone_map.map_err(|error| PyValueError::new_err(error.to_string()))?,
            is_linear: item("linear")?.extract()?,
            engine: engine.as_deref().map(str::parse).transpose().map_err(Failure::from)?,
            threads: item("threads")?.extract()?,
        })
    }

    fn aspect(&self) -> f32 {
        self.width as f32 / self.height.max(1) as f32
    }
}

/// Renders the world as it is now.
pub(crate) fn render(world: &mut World, picture: &PictureSettings) -> Result<Pixels, Failure> {
    let pool = pool::with_threads(picture.threads.unwrap_or(world.threads))?;
    let view = view(world, picture)?;
    let stage = Stage::of(world);
    let of_file = world.source().map(|source| source.frame().clone());
    let mut frame = stage.dress(of_file.unwrap_or_default())?;
    frame.changes = FrameChanges::all();
    let engine = create(picture.engine.unwrap_or(world.engine));
    let mut film = Film::new(picture.width, picture.height);
    pool.install(|| {
        let mut renderer = WhittedRenderer::new(engine);
        let committed = renderer.commit(&stage.scene, &frame);
        committed.map_err(|error| Failure::value(error.to_string()))?;
        renderer.render(&view, &picture.settings, &mut film);
        Ok(if picture.is_linear {
            Pixels::Linear(film.pixels().as_flattened().to_vec())
        } else {
            Pixels::Screen(to_srgb8(&film, picture.exposure, picture.tone_map))
        })
    })
}

/// Where the picture is seen from.
fn view(world: &mut World, picture: &PictureSettings) -> Result<View, Failure> {
    match &picture.camera {
        CameraChoice::Placed { eye, center, up, fov_deg } => {
            let tan_right = (0.5 * fov_deg.to_radians()).tan();
            let vertical_fov = 2.0 * (tan_right / picture.aspect()).atan();
            let projection = Projection::Perspective { vertical_fov };
            Ok(View::new(looking(*eye, *center, *up), projection))
        }
        CameraChoice::Named(name) => {
            let camera_idx = world.camera_idx(name.as_deref())?;
            if let (Some(idx), Some(source)) = (camera_idx, world.source()) {
                let projection = source.scene().cameras[idx].projection;
                return Ok(View::new(source.frame().cameras[idx], projection));
            }
            let (camera, projection) = frame_bounds(&world.bounds()?, picture.aspect());
            Ok(View::new(camera, projection))
        }
    }
}

/// A camera at `eye` that looks to `center`, with `up` upward.
fn looking(eye: Vec3, center: Vec3, up: Vec3) -> Affine3A {
    let back = (eye - center).normalize_or_zero();
    let right = up.cross(back).normalize_or_zero();
    let axes = Mat3A::from_cols(right.into(), back.cross(right).into(), back.into());
    Affine3A { matrix3: axes, translation: eye.into() }
}

impl Pixels {
    /// The pixels as a flat array.
    pub(crate) fn into_array(self, py: Python<'_>) -> Bound<'_, PyAny> {
        match self {
            Self::Screen(bytes) => PyArray1::from_vec(py, bytes).into_any(),
            Self::Linear(values) => PyArray1::from_vec(py, values).into_any(),
        }
    }
}

/// A picture as a PNG file: rows of pixels of three bytes, flat, `width` pixels a row.
#[pyfunction]
pub(crate) fn encode_png<'py>(
    py: Python<'py>,
    pixels: &Bound<'py, PyAny>,
    width: u32,
) -> PyResult<Bound<'py, PyBytes>> {
    let pixels = readable(pixels, "pixels")?;
    let pixels = rows::<u8, 3>(&pixels)?;
    let row = width as usize;
    let height = pixels.len().checked_div(row).filter(|height| height * row == pixels.len());
    let Some(height) = height.and_then(|height| u32::try_from(height).ok()) else {
        let count = pixels.len();
        return Err(Failure::value(format!("{count} pixels are no rows of {width}")).into());
    };
    let encoded = py.detach(|| {
        let mut file = Vec::new();
        let encoder = PngEncoder::new(&mut file);
        let color = image::ExtendedColorType::Rgb8;
        encoder.write_image(pixels.as_flattened(), width, height, color).map(|()| file)
    });
    let file = encoded.map_err(|error| PyValueError::new_err(format!("no PNG: {error}")))?;
    Ok(PyBytes::new(py, &file))
}
