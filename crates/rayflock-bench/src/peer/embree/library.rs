//! Finds and loads the library, and checks that it is what this program was written for.

use std::env;
use std::ffi::CString;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::ffi::{Device, Library};
use super::layout::{PROPERTY_NATIVE_RAY8, PROPERTY_NATIVE_RAY16, PROPERTY_VERSION};
use crate::peer::PeerError;

/// The variable that says where the library is.
const VARIABLE: &str = "EMBREE_LIB";
/// The option that says where the library is.
const OPTION: &str = "--embree-lib";
/// Where `cargo xtask embree` puts the library, below the folder that cargo builds in.
const FETCHED: &str = "embree/4.4.0.post1/embreex.libs";
/// How the file's name begins.
const FILE_PREFIX: &str = "libembree4";

/// The library Embree 4, loaded. Cloning shares it.
#[derive(Clone, Debug)]
pub struct EmbreeLibrary {
    functions: Arc<Library>,
    path: PathBuf,
    version: String,
    isa: &'static str,
}

impl EmbreeLibrary {
    /// Loads the library at `path` (a file, or a folder that holds it), else at `EMBREE_LIB`, else
    /// where `cargo xtask embree` put it: in the folder that cargo builds in, looked for in and
    /// above the folders of this program and the working folder.
    ///
    /// # Errors
    /// [`PeerError`] when there is no library, or it is for another architecture, another library,
    /// or of another version than 4.
    pub fn load(path: Option<&Path>) -> Result<Self, PeerError> {
        let variable = env::var_os(VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
        let path = match (path, variable) {
            (Some(path), _) => given(path, OPTION)?,
            (None, Some(path)) => given(&path, VARIABLE)?,
            (None, None) => find_fetched()?,
        };
        // The library finds its task scheduler beside its real path.
        let path = path.canonicalize().unwrap_or(path);
        check_architecture(&path)?;
        let functions = Library::open(&path)
            .map_err(|reason| PeerError::NotALibrary { path: path.clone(), reason })?;
        let device = Device::new(&functions, &CString::default())
            .map_err(|reason| PeerError::Device { path: path.clone(), reason })?;
        let numbers = PROPERTY_VERSION.map(|property| device.property(property));
        let version = numbers.map(|number| number.to_string()).join(".");
        if numbers[0] != 4 {
            return Err(PeerError::Version { path, found: version });
        }
        Ok(Self { path, version, isa: isa(&device), functions })
    }

    /// The version, as `4.4.0`.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// The instruction set that Embree traces with here, `AVX-512` for example. Embree tells only
    /// how many rays fill a register; the rest follows from what the processor has, of which
    /// Embree takes the best.
    pub fn isa(&self) -> &str {
        self.isa
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it can do.
    pub(super) fn functions(&self) -> &Arc<Library> {
        &self.functions
    }
}

/// The library at a path that the user gave.
fn given(path: &Path, by: &'static str) -> Result<PathBuf, PeerError> {
    let found = if path.is_dir() { library_in(path) } else { Some(path.to_owned()) };
    found
        .filter(|path| path.is_file())
        .ok_or_else(|| PeerError::NoSuchFile { path: path.to_owned(), by })
}

/// The library that `cargo xtask embree` fetched.
fn find_fetched() -> Result<PathBuf, PeerError> {
    let program = env::current_exe().ok().and_then(|path| path.parent().map(Path::to_owned));
    let starts: Vec<_> = [program, env::current_dir().ok()].into_iter().flatten().collect();
    let target = env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    search(target.map(PathBuf::from), starts)
}

/// Looks in the folder that cargo builds in, if it is known, and upward from `starts`.
fn search(target: Option<PathBuf>, starts: Vec<PathBuf>) -> Result<PathBuf, PeerError> {
    let above = starts.iter().flat_map(|start| start.ancestors());
    let places = above.flat_map(|folder| [folder.to_owned(), folder.join("target")]);
    let found =
        target.into_iter().chain(places).find_map(|target| library_in(&target.join(FETCHED)));
    found.ok_or(PeerError::LibraryNotFound { looked_in: starts })
}

fn library_in(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?;
    let mut found: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(FILE_PREFIX))
        })
        .collect();
    found.sort();
    found.pop()
}

/// Says what is wrong where the system's loader would say that there is no such file. Files that
/// are not in the format of Linux are left to the loader.
fn check_architecture(path: &Path) -> Result<(), PeerError> {
    let mut header = [0_u8; 20];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut header));
    if read.is_err() || !header.starts_with(b"\x7fELF") {
        return Ok(());
    }
    let found = match u16::from_le_bytes([header[18], header[19]]) {
        0x03 => "x86".to_owned(),
        0x28 => "arm".to_owned(),
        0x3e => "x86_64".to_owned(),
        0xb7 => "aarch64".to_owned(),
        0xf3 => "riscv64".to_owned(),
        machine => format!("machine {machine:#x}"),
    };
    let expected = env::consts::ARCH;
    if found == expected {
        return Ok(());
    }
    Err(PeerError::Architecture { path: path.to_owned(), found, expected })
}

#[cfg(target_arch = "x86_64")]
fn isa(device: &Device) -> &'static str {
    let has = |property| device.property(property) != 0;
    if has(PROPERTY_NATIVE_RAY16) {
        "AVX-512"
    } else if has(PROPERTY_NATIVE_RAY8) && is_x86_feature_detected!("avx2") {
        "AVX2"
    } else if has(PROPERTY_NATIVE_RAY8) {
        "AVX"
    } else if is_x86_feature_detected!("sse4.2") {
        "SSE4.2"
    } else {
        "SSE2"
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn isa(device: &Device) -> &'static str {
    let has = |property| device.property(property) != 0;
    if has(PROPERTY_NATIVE_RAY16) {
        "16 lanes"
    } else if has(PROPERTY_NATIVE_RAY8) {
        "8 lanes"
    } else {
        "4 lanes"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fetched_library_is_found_from_below() {
        let root = tempfile::tempdir().unwrap();
        let program = root.path().join("target/release");
        let elsewhere = root.path().join("src/deep");
        fs::create_dir_all(&elsewhere).unwrap();
        let error = search(None, vec![elsewhere.clone()]).unwrap_err().to_string();
        for words in ["cargo xtask embree", "EMBREE_LIB", "--embree-lib", "src/deep"] {
            assert!(error.contains(words), "{error}");
        }

        let library = root.path().join("target").join(FETCHED).join("libembree4-0123.so.4");
        fs::create_dir_all(library.parent().unwrap()).unwrap();
        fs::write(library.with_file_name("libtbb.so"), "").unwrap();
        fs::write(&library, "").unwrap();
        for (target, start) in [
            (None, program),
            (None, elsewhere),
            (Some(root.path().join("target")), PathBuf::from("/")),
        ] {
            assert_eq!(search(target, vec![start]).unwrap(), library);
        }
    }

    #[test]
    fn paths_that_are_no_library_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let message = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, bytes).unwrap();
            let message = EmbreeLibrary::load(Some(&path)).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
            message
        };
        assert!(message("text.so", b"not a library").contains("cannot be loaded as Embree"));
        let mut elf = b"\x7fELF\x02\x01\x01".to_vec();
        elf.resize(64, 0);
        elf[18] = 0x16;
        assert!(message("other.so", &elf).contains("found a library for machine 0x16"));

        let message = EmbreeLibrary::load(Some(folder.path())).unwrap_err().to_string();
        assert!(message.contains("where --embree-lib says"), "{message}");
    }
}
