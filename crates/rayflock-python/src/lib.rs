//! The compiled part of the Python package `rayflock`.
//!
//! It converts, releases the interpreter lock, calls the library and converts back; there is no
//! algorithm here. Arguments are checked for the user in `python/rayflock/`, which is all that
//! anybody imports; what is wrong all the same is an exception, not a panic.
//!
//! | Part | What it does |
//! |---|---|
//! | `scene` | the class `Scene`: what can be hit, questions about it |
//! | `world` | what such a scene holds: objects, engines and the frame they know |
//! | `question`, `answer`, `arrays` | NumPy arrays as columns of rays and hits, in place |
//! | `hit_arrays` | lists of hits as NumPy arrays |
//! | `meshes` | the rows of arrays as meshes |
//! | `source` | files that move objects |
//! | `picture` | pictures of scenes |
//! | `sense` | sensors in scenes that move: `sensor_options`, `sensor_pattern` say what they are |
//! | `sweep_arrays`, `false_colors` | what sensors saw as NumPy arrays, and in colours |
//! | `point_files` | what sensors saw as files |
//! | `program` | the program, for `python -m rayflock` |
//! | `stage` | scenes as pictures and sensors take them |
//! | `errors` | which exception tells of what |
//! | `pool` | threads that survive a fork |
//! | `stats` | what a scene tells about itself |
//!
//! **Threads.** A scene is shared by all Python threads. It lies behind one lock, which is taken
//! only after the interpreter lock is released, so that no thread waits for one while it holds the
//! other. One question runs at a time in each scene, on all threads of its pool.
#![forbid(unsafe_code)]

mod answer;
mod arrays;
mod errors;
mod false_colors;
mod hit_arrays;
mod meshes;
mod picture;
mod point_files;
mod pool;
mod program;
mod question;
mod scene;
mod sense;
mod sensor_options;
mod sensor_pattern;
mod source;
mod stage;
mod stats;
mod sweep_arrays;
mod world;

/// Engines, scenes, pictures and sensors, for the Python package that wraps them.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::false_colors::false_colors;
    #[pymodule_export]
    use super::picture::encode_png;
    #[pymodule_export]
    use super::point_files::save_points;
    #[pymodule_export]
    use super::program::run_program;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::sensor_options::describe_sensor;

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
