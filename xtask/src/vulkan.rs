//! Software drivers that stand in for a graphics card: two of them, because what one does is easily
//! taken for what all do.
//!
//! Mesa's lavapipe is among the drivers that Vulkan finds by itself; SwiftShader comes with
//! Debian's Chromium and is named in the environment. A card that is there is tested as well.

use std::fs;
use std::path::Path;

use crate::tools::{can_install, install};

/// Where Vulkan looks for drivers.
const DRIVERS: &str = "/usr/share/vulkan/icd.d";
const SWIFTSHADER: &str = "/usr/lib/chromium/vk_swiftshader_icd.json";

/// Finds or installs both drivers; returns the environment in which tests find them, and which
/// tells how many there must be. Without drivers, tests on devices are skipped.
pub(crate) fn want_drivers() -> Vec<(&'static str, String)> {
    let mut environment = Vec::new();
    let mut adapter_count = 0;
    if want("mesa-vulkan-drivers", "lavapipe", has_lavapipe) {
        adapter_count += 1;
    }
    if want("chromium", "SwiftShader", || Path::new(SWIFTSHADER).exists()) {
        adapter_count += 1;
        environment.push(("VK_ADD_DRIVER_FILES", SWIFTSHADER.to_owned()));
    }
    environment.push(("RAYFLOCK_GPU_ADAPTERS", adapter_count.to_string()));
    environment
}

/// Whether the driver is there, after installing its package where that can be done unasked.
fn want(package: &str, driver: &str, is_there: impl Fn() -> bool) -> bool {
    let found = is_there() || (can_install() && install(package) && is_there());
    if found {
        println!("== tools: the software graphics driver {driver}");
    } else {
        println!(
            "== tools: the software graphics driver {driver} is not there and cannot be installed \
             (package {package}); the engines on the graphics card are not tested on it"
        );
    }
    found
}

fn has_lavapipe() -> bool {
    let files = fs::read_dir(DRIVERS).into_iter().flatten().flatten();
    files.map(|file| file.file_name()).any(|name| name.to_string_lossy().starts_with("lvp_icd"))
}
