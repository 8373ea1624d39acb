//! Finds and loads the library.

use std::path::{Path, PathBuf};

use crate::peer::PeerError;

/// The library Embree 4, loaded. Cloning shares it.
#[derive(Clone, Debug)]
pub struct EmbreeLibrary {
    path: PathBuf,
}

impl EmbreeLibrary {
    /// Loads the library at `path`, else at `EMBREE_LIB`, else where `cargo xtask embree` put it.
    ///
    /// # Errors
    /// [`PeerError`] when there is no library or another one than Embree 4.
    pub fn load(path: Option<&Path>) -> Result<Self, PeerError> {
        let looked_in = path.map(Path::to_owned).into_iter().collect();
        Err(PeerError::LibraryNotFound { looked_in })
    }

    /// The version, as `4.4.0`.
    pub fn version(&self) -> &str {
        ""
    }

    /// The instruction set that Embree traces with here: `AVX-512`, `AVX2`, ...
    pub fn isa(&self) -> &str {
        ""
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}
