//! WGSL without a device: all of it is valid, and what the host writes is what it reads.

use std::collections::BTreeSet;
use std::mem::offset_of;
use std::path::Path;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Literal, Module, TypeInner};
use rayflock_geom::simd::segment_spheres::{AT_END, DARK, RISE};

use super::{ALL, GATHER_LIGHTS, Shader};
use crate::compute::{
    BLOCK_CHUNKS, CELLS_EACH, CHUNK_PRIMS, FAN_OUT, FIRST_NODE, FIRST_ROOT, PLACERS,
};
use crate::frame::{
    BLOCK_SPHERES, FOLLOWED, HAS_NORMALS, HAS_UVS, INFLUENCE_WORDS, IS_MIRRORED, JOINT_WORDS,
    KEY_BITS, MIRRORED, SHADOW, SUM_PLACES, TARGET_WORDS,
};
use crate::layout::virtual_lights::{
    DISTANT, DeviceSoftSphere, DeviceVirtualLight, DeviceWall, GatherParams, LOBED, PLAIN,
};
use crate::layout::{
    Attributes, BUCKET_BYTES, CellParams, Cone, Counters, DEFORMED_VERTEX_BYTES, DIRECTIONAL,
    DeformedObject, DeviceEmitter, DeviceHit, DeviceLight, DevicePrimitive, DeviceRay, EMITTERS,
    FrameParams, NO_RANK, NOWHERE, PATH_BYTES, PHOTON_BYTES, PHOTONS_OFFSET, POINT, POINT_BYTES,
    Pair, Params, PhotonParams, SPHERE, SPOT, ScanCounters, ScanParams, Subfield, SubfieldCounters,
    SubfieldParams, TRIANGLE, TileRange,
};
use crate::method::Question;
use crate::primitives::BOUNDED_AT_ONCE;
use crate::ray_textures::EDGE;
use crate::slots::TILE_RAYS;
use crate::subfields::{MOST_CELLS, PRIM_BITS};
use crate::twins::LitPoint;

fn parse(shader: &Shader) -> Module {
    naga::front::wgsl::parse_str(shader.source)
        .unwrap_or_else(|error| panic!("{}: {}", shader.name, error.emit_to_string(shader.source)))
}

#[test]
fn every_shader_is_valid() {
    for shader in ALL {
        let module = parse(shader);
        // Nothing beyond what WebGPU has.
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(error) = validator.validate(&module) {
            panic!("{}: {}", shader.name, error.emit_to_string(shader.source));
        }
    }
}

/// Of each stage, so that programs run on whatever has WebGPU.
#[test]
fn no_stage_binds_more_than_eight_storage_buffers() {
    for shader in ALL {
        let module = parse(shader);
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, variable)| matches!(variable.space, naga::AddressSpace::Storage { .. }));
        assert!(storage.count() <= 8, "{}", shader.name);
    }
}

#[test]
fn every_file_is_part_of_a_program() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shader");
    let named: BTreeSet<_> = ALL.iter().map(|shader| shader.name.to_owned()).collect();
    let mut found = BTreeSet::new();
    for engine in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
        for file in std::fs::read_dir(&engine).unwrap().map(|entry| entry.unwrap().path()) {
            let name = file.with_extension("");
            let name = name.strip_prefix(&folder).unwrap().to_string_lossy().replace('\\', "/");
            let text = std::fs::read_to_string(&file).unwrap();
            let is_used = ALL.iter().any(|shader| shader.source.contains(&text));
            assert!(is_used, "{name}.wgsl is part of no program");
            if text.contains("@compute") || text.contains("@fragment") {
                found.insert(name);
            }
        }
    }
    assert_eq!(found, named);
}

/// Size, and name and offset of each member, of a structure.
fn structure(name: &str) -> (u32, Vec<(String, u32)>) {
    let modules = ALL.iter().map(parse);
    let find = |module: Module| {
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
        let TypeInner::Struct { members, span } = &found.1.inner else { return None };
        let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset);
        Some((*span, members.iter().map(member).collect()))
    };
    modules.into_iter().find_map(find).unwrap_or_else(|| panic!("no program has {name}"))
}

macro_rules! assert_mirrors {
    ($name:literal, $ty:ty, $($member:ident),*) => {
        let members = vec![$((stringify!($member).to_owned(), offset_of!($ty, $member) as u32)),*];
        assert_eq!(structure($name), (size_of::<$ty>() as u32, members), $name);
    };
}

#[test]
fn host_and_device_agree_about_every_byte() {
    assert_mirrors!("Primitive", DevicePrimitive, a, mask, b, kind, c, rank);
    assert_mirrors!("Ray", DeviceRay, origin, t_min, direction, t_max, mask, slot, cell, carried);
    assert_mirrors!("Hit", DeviceHit, t, u, v, rank);
    assert_mirrors!("Cone", Cone, center, radius, axis, sin);
    assert_mirrors!("Params", Params, tile_count, block_count, pair_capacity, question);
    assert_mirrors!(
        "Counters",
        Counters,
        root_pairs,
        node_pairs,
        tile_pairs,
        cone_tests,
        ray_tests,
        triangle_tests,
        sphere_tests
    );
    assert_mirrors!("CellParams", CellParams, finest, cell_count, unused_a, unused_b);
    assert_mirrors!("Pair", Pair, cone_idx, block_idx);
    assert_mirrors!("TileRange", TileRange, first, count);
}

#[test]
fn host_and_device_agree_about_every_byte_of_subfields() {
    assert_mirrors!(
        "SubfieldParams",
        SubfieldParams,
        shared_direction,
        is_shared,
        direction_edge,
        tile_edge,
        subfield_capacity,
        entry_capacity,
        prim_count,
        question,
        unused_a,
        unused_b
    );
    assert_mirrors!(
        "SubfieldCounters",
        SubfieldCounters,
        entries,
        entries_high,
        subfield_count,
        first_new,
        is_placed,
        left_count,
        triangle_tests,
        triangle_tests_high,
        sphere_tests,
        sphere_tests_high
    );
    assert_mirrors!(
        "Subfield", Subfield, column, column_pad, row, row_pad, depth, depth_pad, center, radius
    );
    assert_mirrors!("SubfieldTile", TileRange, first, count);
}

#[test]
fn host_and_device_agree_about_every_byte_of_deformed_objects() {
    assert_mirrors!(
        "DeformedObject",
        DeformedObject,
        x_axis,
        first_vertex,
        y_axis,
        vertex_count,
        z_axis,
        first_triangle,
        translation,
        triangle_count,
        first_rank,
        mask,
        corners,
        positions,
        normals,
        next_positions,
        next_normals,
        share,
        influences,
        joints,
        targets,
        target_count
    );
}

#[test]
fn host_and_device_agree_about_every_byte_of_a_picture() {
    assert_mirrors!(
        "FrameParams",
        FrameParams,
        top_left,
        width,
        right,
        row_count,
        down,
        first_row,
        eye,
        is_parallel,
        zenith,
        sky_share,
        horizon,
        slot_count,
        ground,
        first_texture,
        ambient,
        goes_on,
        subpixel,
        conserves,
        unused
    );
    assert_mirrors!(
        "Attributes",
        Attributes,
        normal_a,
        material,
        normal_b,
        flags,
        normal_c,
        unused_a,
        color_a,
        unused_b,
        color_b,
        unused_c,
        color_c,
        unused_d,
        uv_a,
        uv_b,
        uv_c,
        unused_e
    );
    let spans = ["Path", "LitPoint"].map(|name| structure(name).0 as usize);
    assert_eq!(spans, [PATH_BYTES, POINT_BYTES]);
}

#[test]
fn host_and_device_agree_about_every_byte_of_lights() {
    assert_mirrors!(
        "Light",
        DeviceLight,
        position,
        kind,
        direction,
        is_constant,
        intensity,
        cos_inner,
        cos_outer,
        sample_idx,
        sample_count,
        emitter_count
    );
    assert_mirrors!("Emitter", DeviceEmitter, a, kind, b, weight, c, cumulative, radiance, unused);
    let spans = ["Path", "LitPoint", "DeformedVertex"].map(|name| structure(name).0 as usize);
    assert_eq!(spans, [PATH_BYTES, POINT_BYTES, DEFORMED_VERTEX_BYTES]);
}

#[test]
fn host_and_device_agree_about_every_byte_of_virtual_lights() {
    assert_mirrors!(
        "VirtualLight",
        DeviceVirtualLight,
        position,
        kind,
        normal,
        evenness,
        intensity,
        shininess,
        to_source,
        varnish,
        highlight,
        unused
    );
    assert_mirrors!(
        "SoftSphere",
        DeviceSoftSphere,
        center,
        outer,
        flatness,
        opacity,
        peak,
        slope,
        unused_a,
        unused_b
    );
    assert_mirrors!(
        "Wall", DeviceWall, corner, opacity, normal, unused_a, axis_a, unused_b, axis_b, unused_c
    );
    assert_mirrors!(
        "GatherParams",
        GatherParams,
        bound,
        distance,
        first_light,
        end_light,
        sphere_count,
        wall_count,
        first_sum,
        unused
    );
    assert_mirrors!(
        "LitPoint",
        LitPoint,
        shadow_position,
        pixel,
        normal,
        shininess,
        to_viewer,
        seed,
        diffuse,
        unused_a,
        specular,
        unused_b,
        emitted,
        emitted_pixel
    );
}

#[test]
fn host_and_device_agree_about_every_byte_of_scan_conversion() {
    assert_mirrors!(
        "ScanParams",
        ScanParams,
        column,
        width,
        row,
        row_count,
        depth,
        is_parallel,
        origin,
        unused,
        shift,
        end
    );
    assert_mirrors!("ScanCounters", ScanCounters, triangle_tests, sphere_tests);
}

#[test]
fn host_and_device_agree_about_every_byte_of_photons() {
    assert_mirrors!("PhotonParams", PhotonParams, low, radius, photon_count, bucket_count, unused);
    let spans = ["Photon", "Bucket"].map(|name| structure(name).0 as usize);
    assert_eq!(spans, [PHOTON_BYTES, BUCKET_BYTES]);
    let (_, members) = structure("PhotonStore");
    assert_eq!(members.last(), Some(&("photons".to_owned(), PHOTONS_OFFSET as u32)));
}

/// Names and values of the whole numbers that programs state.
fn numbers() -> BTreeSet<(String, u32)> {
    let mut found = BTreeSet::new();
    for module in ALL.iter().map(parse) {
        found.extend(module.constants.iter().filter_map(|(_, constant)| {
            let value = &module.global_expressions[constant.init];
            let Expression::Literal(Literal::U32(number)) = *value else { return None };
            Some((constant.name.clone()?, number))
        }));
    }
    found
}

#[test]
fn host_and_device_have_the_same_constants() {
    let found = numbers();
    let expected = [
        ("TRIANGLE", TRIANGLE),
        ("SPHERE", SPHERE),
        ("NO_RANK", NO_RANK),
        ("QUESTION_OCCLUDED", Question::Occluded as u32),
        ("TILE_RAYS", TILE_RAYS as u32),
        ("EDGE", EDGE as u32),
        ("CHUNK_PRIMS", CHUNK_PRIMS as u32),
        ("BLOCK_CHUNKS", BLOCK_CHUNKS as u32),
        ("FAN_OUT", FAN_OUT as u32),
        ("BOUNDERS", BOUNDED_AT_ONCE as u32),
        ("CELLS_EACH", CELLS_EACH as u32),
        ("PLACERS", PLACERS as u32),
        ("KEY_BITS", KEY_BITS),
        ("FIRST_NODE", FIRST_NODE as u32),
        ("FIRST_ROOT", FIRST_ROOT as u32),
        ("MOST_CELLS", MOST_CELLS as u32),
        ("PRIM_BITS", PRIM_BITS),
        ("POINT", POINT),
        ("DIRECTIONAL", DIRECTIONAL),
        ("SPOT", SPOT),
        ("EMITTERS", EMITTERS),
        ("HAS_NORMALS", HAS_NORMALS),
        ("HAS_UVS", HAS_UVS),
        ("IS_MIRRORED", IS_MIRRORED),
        ("MIRRORED", MIRRORED as u32),
        ("FOLLOWED", FOLLOWED as u32),
        ("SHADOW", SHADOW as u32),
        ("NOWHERE", NOWHERE),
        ("JOINT_WORDS", JOINT_WORDS as u32),
        ("INFLUENCE_WORDS", INFLUENCE_WORDS as u32),
        ("TARGET_WORDS", TARGET_WORDS as u32),
        ("PLAIN", PLAIN),
        ("LOBED", LOBED),
        ("DISTANT", DISTANT),
        ("SUM_PLACES", SUM_PLACES as u32),
        ("BLOCK_SPHERES", BLOCK_SPHERES as u32),
        ("TILE_POINTS", TILE_RAYS as u32),
    ];
    for (name, value) in expected {
        let stated = found.iter().filter(|(other, _)| other == name).map(|&(_, number)| number);
        assert_eq!(stated.collect::<Vec<_>>(), [value], "{name}");
    }
}

/// Numbers of the kernel that stages gather past spheres by.
#[test]
fn host_and_device_have_the_same_fractions() {
    let module = parse(&GATHER_LIGHTS);
    for (name, value) in [("RISE", RISE), ("AT_END", AT_END), ("DARK", DARK)] {
        let stated = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
        let init = &module.global_expressions[stated.unwrap().1.init];
        assert_eq!(*init, Expression::Literal(Literal::F32(value)), "{name}");
    }
}
