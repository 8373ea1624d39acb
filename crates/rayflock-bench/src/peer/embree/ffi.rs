//! Calls into Embree: the only module of the project with unsafe code.
//!
//! Outside of it, Embree is safe to use: a [`Scene`] owns the memory it shares with Embree, scenes
//! own those they instance, changing anything needs `&mut`, and only a scene that was committed
//! after its last change can be traced.
//!
//! **Invariants.** Handles are not null and are released once, devices after their scenes. A
//! shared buffer does not move or shrink while Embree may read it; what Embree reads past its
//! last element (sixteen bytes at a time) belongs to the buffer.
#![expect(unsafe_code, reason = "Embree is a foreign library, and tracing sets the FPU's mode")]

use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::layout::{
    Arguments, BUFFER_INDEX, BUFFER_VERTEX, Bounds, FORMAT_FLOAT3, FORMAT_FLOAT4, FORMAT_UINT3,
    GEOMETRY_INSTANCE, GEOMETRY_SPHERE_POINT, GEOMETRY_TRIANGLE, Ray, Ray16, RayHit, RayHit16,
    Valid,
};

/// A device, scene or geometry of Embree.
type Handle = *mut c_void;
/// Told about errors: user pointer, code, message.
type OnError = unsafe extern "C" fn(*mut c_void, c_int, *const c_char);
/// Told about memory: user pointer, bytes (negative when freed), whether it has happened.
type OnMemory = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// Declares the table of functions and how it is filled.
macro_rules! functions {
    ($($field:ident = $symbol:literal: fn($($arg:ty),*) $(-> $result:ty)?;)*) => {
        #[derive(Debug)]
        struct Functions {
            $($field: unsafe extern "C" fn($($arg),*) $(-> $result)?,)*
        }

        impl Functions {
            fn load(library: &libloading::Library) -> Result<Self, String> {
                $(
                    // SAFETY: the symbol, if it is there, is the function of Embree's C interface
                    // of that name, whose type is declared below after Embree's headers.
                    let $field = unsafe { library.get(concat!($symbol, "\0")) };
                    let $field = *$field.map_err(|_| {
                        concat!("it has no function ", $symbol).to_owned()
                    })?;
                )*
                Ok(Self { $($field,)* })
            }
        }
    };
}

functions! {
    new_device = "rtcNewDevice": fn(*const c_char) -> Handle;
    release_device = "rtcReleaseDevice": fn(Handle);
    device_error = "rtcGetDeviceError": fn(Handle) -> c_int;
    device_property = "rtcGetDeviceProperty": fn(Handle, u32) -> isize;
    set_error_function = "rtcSetDeviceErrorFunction": fn(Handle, OnError, *mut c_void);
    set_memory_function = "rtcSetDeviceMemoryMonitorFunction": fn(Handle, OnMemory, *mut c_void);
    new_scene = "rtcNewScene": fn(Handle) -> Handle;
    release_scene = "rtcReleaseScene": fn(Handle);
    set_scene_quality = "rtcSetSceneBuildQuality": fn(Handle, u32);
    set_scene_flags = "rtcSetSceneFlags": fn(Handle, u32);
    scene_bounds = "rtcGetSceneBounds": fn(Handle, *mut Bounds);
    commit_scene = "rtcCommitScene": fn(Handle);
    attach_geometry = "rtcAttachGeometryByID": fn(Handle, Handle, u32);
    detach_geometry = "rtcDetachGeometry": fn(Handle, u32);
    new_geometry = "rtcNewGeometry": fn(Handle, u32) -> Handle;
    release_geometry = "rtcReleaseGeometry": fn(Handle);
    commit_geometry = "rtcCommitGeometry": fn(Handle);
    enable_geometry = "rtcEnableGeometry": fn(Handle);
    disable_geometry = "rtcDisableGeometry": fn(Handle);
    set_geometry_mask = "rtcSetGeometryMask": fn(Handle, u32);
    set_geometry_quality = "rtcSetGeometryBuildQuality": fn(Handle, u32);
    set_shared_buffer = "rtcSetSharedGeometryBuffer":
        fn(Handle, u32, u32, u32, *const c_void, usize, usize, usize);
    update_buffer = "rtcUpdateGeometryBuffer": fn(Handle, u32, u32);
    set_instanced_scene = "rtcSetGeometryInstancedScene": fn(Handle, Handle);
    intersect_1 = "rtcIntersect1": fn(Handle, *mut RayHit, *const Arguments);
    intersect_16 = "rtcIntersect16": fn(*const Valid, Handle, *mut RayHit16, *const Arguments);
    occluded_1 = "rtcOccluded1": fn(Handle, *mut Ray, *const Arguments);
    occluded_16 = "rtcOccluded16": fn(*const Valid, Handle, *mut Ray16, *const Arguments);
}

/// Embree's functions.
#[derive(Debug)]
pub(super) struct Library {
    functions: Functions,
    /// Never unloaded: threads of Embree's task scheduler may still be at work.
    _library: ManuallyDrop<libloading::Library>,
}

impl Library {
    /// Loads the file; the error says why that cannot be done.
    pub(super) fn open(path: &Path) -> Result<Arc<Self>, String> {
        // SAFETY: what runs when the library is loaded is what the user asked for.
        let library = unsafe { libloading::Library::new(path) };
        let library = ManuallyDrop::new(library.map_err(|error| error.to_string())?);
        Ok(Arc::new(Self { functions: Functions::load(&library)?, _library: library }))
    }
}

/// What Embree tells a device's owner.
#[derive(Debug, Default)]
struct Reports {
    error: Mutex<Option<String>>,
    memory_bytes: AtomicIsize,
}

/// An Embree of its own, with its threads.
#[derive(Debug)]
pub(super) struct Device {
    library: Arc<Library>,
    handle: Handle,
    reports: Arc<Reports>,
}

// SAFETY: Embree's devices may be used and released from any thread; `Reports` is thread-safe.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    /// Starts Embree; the error says why it refuses.
    pub(super) fn new(library: &Arc<Library>, config: &CStr) -> Result<Self, String> {
        let (library, reports) = (Arc::clone(library), Arc::<Reports>::default());
        let functions = &library.functions;
        // SAFETY: `config` ends with a zero.
        let handle = unsafe { (functions.new_device)(config.as_ptr()) };
        if handle.is_null() {
            // SAFETY: the null device is allowed here: it stands for creating devices.
            let code = unsafe { (functions.device_error)(handle) };
            return Err(error_name(code).to_owned());
        }
        let user = Arc::as_ptr(&reports).cast_mut().cast::<c_void>();
        // SAFETY: the callbacks read `user` as the `Reports` that it is, only while the device
        // lives, which `drop` ends before the reports are gone.
        unsafe {
            (functions.set_error_function)(handle, on_error, user);
            (functions.set_memory_function)(handle, on_memory, user);
        }
        Ok(Self { library, handle, reports })
    }

    /// A property, by its number.
    pub(super) fn property(&self, property: u32) -> isize {
        // SAFETY: the handle is a living device; unknown properties are 0 or an error.
        unsafe { (self.library.functions.device_property)(self.handle, property) }
    }

    /// What went wrong since this was asked last.
    pub(super) fn take_error(&self) -> Option<String> {
        self.reports.error.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// Bytes that Embree holds for this device.
    pub(super) fn memory_usage(&self) -> usize {
        usize::try_from(self.reports.memory_bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the handle is released once; scenes keep the device alive.
        unsafe { (self.library.functions.release_device)(self.handle) }
    }
}

/// Notes the first error since the last was taken.
unsafe extern "C" fn on_error(user: *mut c_void, code: c_int, message: *const c_char) {
    // SAFETY: `user` is the `Reports` given with this function, alive as long as the device.
    let reports = unsafe { &*user.cast::<Reports>() };
    let mut text = error_name(code).to_owned();
    if !message.is_null() {
        // SAFETY: Embree's messages end with a zero.
        text = format!("{text}: {}", unsafe { CStr::from_ptr(message) }.to_string_lossy());
    }
    reports.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(text);
}

/// Counts memory; never refuses any.
unsafe extern "C" fn on_memory(user: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: as in `on_error`.
    let reports = unsafe { &*user.cast::<Reports>() };
    reports.memory_bytes.fetch_add(bytes, Ordering::Relaxed);
    true
}

fn error_name(code: c_int) -> &'static str {
    match code {
        0 => "no error",
        2 => "invalid argument",
        3 => "invalid operation",
        4 => "out of memory",
        5 => "the processor is not supported",
        6 => "cancelled",
        _ => "unknown error",
    }
}

/// A geometry and the memory it shares.
#[derive(Debug)]
struct Slot {
    handle: Handle,
    /// The scene that Embree was given to instance, or null.
    shown: Handle,
    /// Coordinates with room for a sixteen-byte read of the last vertex; empty for instances.
    vertices: Vec<f32>,
    /// Read by Embree alone.
    triangles: Vec<[u32; 3]>,
    /// The scene that an instance shows.
    scene: Option<Box<Scene>>,
}

impl Slot {
    /// A geometry that is no instance.
    fn new(handle: Handle, vertices: Vec<f32>, triangles: Vec<[u32; 3]>) -> Self {
        Self { handle, shown: ptr::null_mut(), vertices, triangles, scene: None }
    }

    /// Whether what Embree reads through this geometry is ready: the scene of an instance is
    /// committed, and still the one that Embree was given as `shown`.
    fn is_ready(&self) -> bool {
        let is_ready = |scene: &Scene| scene.is_committed && scene.handle == self.shown;
        self.scene.as_deref().is_none_or(is_ready)
    }
}

/// What can be hit.
#[derive(Debug)]
pub(super) struct Scene {
    device: Arc<Device>,
    handle: Handle,
    slots: BTreeMap<u32, Slot>,
    is_committed: bool,
}

// SAFETY: scenes and geometries of Embree may be used from any thread, one at a time; tracing,
// all that `&Scene` allows, from many at once.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Scene {
    /// An empty scene of this `RTCBuildQuality` with these `RTCSceneFlags`.
    pub(super) fn new(device: &Arc<Device>, quality: u32, flags: u32) -> Self {
        let functions = &device.library.functions;
        // SAFETY: the device is alive, and so is the scene until `drop`.
        let handle = unsafe {
            let handle = (functions.new_scene)(device.handle);
            (functions.set_scene_quality)(handle, quality);
            (functions.set_scene_flags)(handle, flags);
            handle
        };
        let device = Arc::clone(device);
        Self { device, handle, slots: BTreeMap::new(), is_committed: false }
    }

    /// Adds triangles as geometry `id`. `vertices` are three coordinates a vertex.
    ///
    /// # Panics
    /// When `id` is taken or a triangle names a vertex that is not there.
    pub(super) fn attach_triangles(
        &mut self,
        id: u32,
        mut vertices: Vec<f32>,
        triangles: Vec<[u32; 3]>,
    ) {
        let vertex_count = vertices.len() / 3;
        let in_range = |corners: &[u32; 3]| corners.iter().all(|&i| (i as usize) < vertex_count);
        assert!(triangles.iter().all(in_range), "triangles must name vertices that are there");
        vertices.push(0.0);
        let handle = self.new_geometry(GEOMETRY_TRIANGLE);
        // SAFETY: the slot owns both buffers and outlives Embree's use of them; their lengths are
        // `vertex_count` vertices plus one number, and `triangles.len()` triangles.
        unsafe {
            let set = self.device.library.functions.set_shared_buffer;
            let (data, count) = (vertices.as_ptr().cast(), vertex_count);
            set(handle, BUFFER_VERTEX, 0, FORMAT_FLOAT3, data, 0, 12, count);
            let (data, count) = (triangles.as_ptr().cast(), triangles.len());
            set(handle, BUFFER_INDEX, 0, FORMAT_UINT3, data, 0, 12, count);
        }
        self.attach(id, Slot::new(handle, vertices, triangles));
    }

    /// Adds spheres as geometry `id`: three coordinates and the radius each.
    ///
    /// # Panics
    /// When `id` is taken.
    pub(super) fn attach_spheres(&mut self, id: u32, spheres: Vec<f32>) {
        let handle = self.new_geometry(GEOMETRY_SPHERE_POINT);
        // SAFETY: the slot owns the buffer, which holds `len / 4` spheres of sixteen bytes.
        unsafe {
            let set = self.device.library.functions.set_shared_buffer;
            let (data, count) = (spheres.as_ptr().cast(), spheres.len() / 4);
            set(handle, BUFFER_VERTEX, 0, FORMAT_FLOAT4, data, 0, 16, count);
        }
        self.attach(id, Slot::new(handle, spheres, Vec::new()));
    }

    /// Adds an instance of `scene`, at its place and seen by all rays, as geometry `id`.
    ///
    /// # Panics
    /// When `id` is taken.
    pub(super) fn attach_scene(&mut self, id: u32, scene: Self) {
        let handle = self.new_geometry(GEOMETRY_INSTANCE);
        // SAFETY: both handles are alive; the slot owns the scene.
        unsafe { (self.device.library.functions.set_instanced_scene)(handle, scene.handle) }
        let shown = scene.handle;
        let slot = Slot::new(handle, Vec::new(), Vec::new());
        self.attach(id, Slot { shown, scene: Some(Box::new(scene)), ..slot });
        self.set_mask(id, u32::MAX);
    }

    fn new_geometry(&self, kind: u32) -> Handle {
        // SAFETY: the device is alive.
        unsafe { (self.device.library.functions.new_geometry)(self.device.handle, kind) }
    }

    fn attach(&mut self, id: u32, slot: Slot) {
        assert!(!self.slots.contains_key(&id), "a geometry's id must be free");
        // SAFETY: both handles are alive.
        unsafe {
            (self.device.library.functions.attach_geometry)(self.handle, slot.handle, id);
        }
        self.slots.insert(id, slot);
        self.is_committed = false;
    }

    /// Removes geometry `id`, if it is there.
    pub(super) fn detach(&mut self, id: u32) {
        let Some(slot) = self.slots.remove(&id) else { return };
        self.is_committed = false;
        let functions = &self.device.library.functions;
        // SAFETY: the geometry is attached as `id`; afterwards nothing can trace the scene until it
        // is committed without the geometry, so Embree reads its buffers no more.
        unsafe {
            (functions.detach_geometry)(self.handle, id);
            (functions.release_geometry)(slot.handle);
        }
    }

    /// Whether nothing is attached.
    pub(super) fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// The coordinates of geometry `id`, to be changed; then call [`Self::commit_vertices`].
    /// Behind those of triangles stands one number that means nothing.
    ///
    /// # Panics
    /// When there is no such geometry.
    pub(super) fn vertices_mut(&mut self, id: u32) -> &mut [f32] {
        self.is_committed = false;
        &mut self.slot_mut(id).vertices
    }

    /// The scene that instance `id` shows, to be changed; then call [`Self::commit_geometry`].
    ///
    /// # Panics
    /// When there is no such instance.
    pub(super) fn instanced_mut(&mut self, id: u32) -> &mut Self {
        self.is_committed = false;
        match &mut self.slot_mut(id).scene {
            Some(scene) => scene,
            None => panic!("geometry {id} must be an instance"),
        }
    }

    fn slot_mut(&mut self, id: u32) -> &mut Slot {
        match self.slots.get_mut(&id) {
            Some(slot) => slot,
            None => panic!("there must be a geometry {id}"),
        }
    }

    /// Calls a function of Embree that changes geometry `id`.
    fn change(&mut self, id: u32, call: impl FnOnce(&Functions, Handle)) {
        let handle = self.slot_mut(id).handle;
        call(&self.device.library.functions, handle);
        self.is_committed = false;
    }

    /// Sets which rays see geometry `id`; then call [`Self::commit_geometry`].
    pub(super) fn set_mask(&mut self, id: u32, mask: u32) {
        // SAFETY: the handle is alive.
        self.change(id, |embree, handle| unsafe { (embree.set_geometry_mask)(handle, mask) });
    }

    /// Sets the `RTCBuildQuality` of geometry `id`; then call [`Self::commit_geometry`].
    pub(super) fn set_quality(&mut self, id: u32, quality: u32) {
        // SAFETY: the handle is alive.
        self.change(id, |embree, handle| unsafe { (embree.set_geometry_quality)(handle, quality) });
    }

    /// Shows or hides geometry `id`.
    pub(super) fn set_enabled(&mut self, id: u32, enabled: bool) {
        self.change(id, |embree, handle| {
            let call = if enabled { embree.enable_geometry } else { embree.disable_geometry };
            // SAFETY: the handle is alive.
            unsafe { call(handle) }
        });
    }

    /// Makes changes of geometry `id` known, coordinates apart.
    pub(super) fn commit_geometry(&mut self, id: u32) {
        // SAFETY: the handle is alive.
        self.change(id, |embree, handle| unsafe { (embree.commit_geometry)(handle) });
    }

    /// Makes changed coordinates of geometry `id` known.
    pub(super) fn commit_vertices(&mut self, id: u32) {
        // SAFETY: the handle is alive and has a vertex buffer 0.
        self.change(id, |embree, handle| unsafe {
            (embree.update_buffer)(handle, BUFFER_VERTEX, 0);
            (embree.commit_geometry)(handle);
        });
    }

    /// Builds what tracing needs. Scenes shown by instances must be committed before.
    ///
    /// # Panics
    /// When such a scene is not.
    pub(super) fn commit(&mut self) {
        assert!(
            self.slots.values().all(Slot::is_ready),
            "instanced scenes must be committed first"
        );
        // SAFETY: all handles and buffers are alive, and `&mut` keeps others from tracing.
        unsafe { (self.device.library.functions.commit_scene)(self.handle) }
        self.is_committed = true;
    }

    /// The box around everything, as of the last commit.
    pub(super) fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::default();
        // SAFETY: the handle is alive; `bounds` has the layout and alignment Embree writes.
        unsafe { (self.device.library.functions.scene_bounds)(self.handle, &raw mut bounds) }
        bounds
    }

    /// The scene, ready to be traced.
    ///
    /// # Panics
    /// When it changed since it was committed.
    pub(super) fn tracer(&self) -> Tracer<'_> {
        assert!(self.is_committed, "only a committed scene can be traced");
        Tracer { functions: &self.device.library.functions, scene: self }
    }

    /// Bytes of the buffers shared with Embree, without those of instanced scenes.
    fn own_memory(&self) -> usize {
        let bytes = |slot: &Slot| 4 * slot.vertices.capacity() + 12 * slot.triangles.capacity();
        self.slots.values().map(bytes).sum()
    }

    /// Bytes of all buffers shared with Embree.
    pub(super) fn memory_usage(&self) -> usize {
        let instanced = self.slots.values().filter_map(|slot| slot.scene.as_ref());
        self.own_memory() + instanced.map(|scene| scene.memory_usage()).sum::<usize>()
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let functions = &self.device.library.functions;
        // SAFETY: every handle is released once; the scene goes before the geometries and
        // buffers it might read. Embree counts references, so an instanced scene stays until the
        // instance is gone.
        unsafe {
            (functions.release_scene)(self.handle);
            for slot in self.slots.values() {
                (functions.release_geometry)(slot.handle);
            }
        }
    }
}

/// A committed scene. Many threads may trace it at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracer<'a> {
    functions: &'a Functions,
    scene: &'a Scene,
}

impl Tracer<'_> {
    /// Finds the nearest hit of a ray; `hit.geom_id` must be invalid.
    #[inline(always)]
    pub(super) fn intersect(&self, hit: &mut RayHit, arguments: &Arguments) {
        // SAFETY: the scene is committed; layouts are Embree's; there are no callbacks.
        unsafe { (self.functions.intersect_1)(self.scene.handle, hit, arguments) }
    }

    /// Finds the nearest hits of a packet's valid rays; their `hit.geom_id` must be invalid.
    #[inline(always)]
    pub(super) fn intersect_16(&self, valid: &Valid, hit: &mut RayHit16, arguments: &Arguments) {
        // SAFETY: as in `intersect`.
        unsafe { (self.functions.intersect_16)(valid, self.scene.handle, hit, arguments) }
    }

    /// Sets `t_far` to `-inf` if anything lies in the ray's interval.
    #[inline(always)]
    pub(super) fn occluded(&self, ray: &mut Ray, arguments: &Arguments) {
        // SAFETY: as in `intersect`.
        unsafe { (self.functions.occluded_1)(self.scene.handle, ray, arguments) }
    }

    /// Sets `t_far` to `-inf` for valid rays with anything in their intervals.
    #[inline(always)]
    pub(super) fn occluded_16(&self, valid: &Valid, rays: &mut Ray16, arguments: &Arguments) {
        // SAFETY: as in `intersect`.
        unsafe { (self.functions.occluded_16)(valid, self.scene.handle, rays, arguments) }
    }
}

/// While it lives, this thread takes denormal numbers for zero, as Embree's manual asks for. Our
/// own engines need denormals, so it is given back at once.
#[derive(Debug)]
pub(super) struct DenormalsAreZero {
    /// The control register as it was.
    #[cfg(target_arch = "x86_64")]
    before: u32,
}

/// Denormal operands are zeros, denormal results become zeros.
#[cfg(target_arch = "x86_64")]
const DAZ_AND_FTZ: u32 = (1 << 6) | (1 << 15);

#[cfg(target_arch = "x86_64")]
impl DenormalsAreZero {
    /// Switches it on.
    pub(super) fn new() -> Self {
        let mut before = 0_u32;
        // SAFETY: the instruction writes four bytes to the address.
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack)) }
        set_mxcsr(before | DAZ_AND_FTZ);
        Self { before }
    }
}

#[cfg(target_arch = "x86_64")]
impl Drop for DenormalsAreZero {
    fn drop(&mut self) {
        set_mxcsr(self.before);
    }
}

#[cfg(target_arch = "x86_64")]
fn set_mxcsr(value: u32) {
    // SAFETY: the value is one the register had, with two defined bits set at most. Until the
    // guard is dropped this thread runs Embree's code, and of ours only copies and comparisons
    // that hold for denormals taken as zero.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack)) }
}

#[cfg(not(target_arch = "x86_64"))]
impl DenormalsAreZero {
    /// Does nothing on this architecture.
    pub(super) fn new() -> Self {
        Self {}
    }
}
