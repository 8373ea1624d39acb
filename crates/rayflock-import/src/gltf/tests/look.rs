//! Materials, textures, cameras and lights.

use glam::{Vec2, Vec3};
use rayflock_scene::{Fresnel, LightKind, Projection};
use serde_json::json;

use super::document::{Document, assert_has};
use crate::tests::{fixed_mesh, load_files};
use crate::texture::tests::png;

#[test]
fn materials_are_mapped_as_documented() {
    let document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.5, 0.0, 1.0], "metallicFactor": 1.0, "roughnessFactor": 0.0 } }));
    let (scene, _) = document.load().unwrap();
    let gold = &scene.materials[0];
    assert_eq!((gold.mirror, gold.diffuse), (Vec3::new(1.0, 0.5, 0.0), Vec3::ZERO));
    assert_eq!((gold.fresnel, gold.shininess), (Fresnel::Schlick, 1000.0));

    let document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.5, 0.0, 1.0] } }));
    let (scene, _) = document.load().unwrap();
    let rough = &scene.materials[0];
    assert_eq!((rough.mirror, rough.diffuse), (Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0)));

    let document = Document::triangle().material(&json!({
        "emissiveFactor": [1, 1, 0], "alphaMode": "BLEND",
        "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorFactor": [1, 1, 1, 0.25] },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } } }));
    let (scene, _) = document.load().unwrap();
    let lamp = &scene.materials[0];
    assert_eq!((lamp.emission, lamp.transmission), (Vec3::new(4.0, 4.0, 0.0), Vec3::splat(0.75)));

    let document = Document::triangle().material(&json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1.0 },
            "KHR_materials_ior": { "ior": 1.25 },
            "KHR_materials_volume": { "attenuationDistance": 2.0,
                "attenuationColor": [1.0, 0.5, 0.25] } } }));
    let (scene, _) = document.load().unwrap();
    let glass = &scene.materials[0];
    assert_eq!((glass.fresnel, glass.ior), (Fresnel::Dielectric, 1.25));
    assert_eq!((glass.transmission, glass.diffuse), (Vec3::ONE, Vec3::ZERO));
    assert!((glass.absorption.y - 0.5 * 2.0_f32.ln()).abs() < 1e-6);
}

#[test]
fn colour_textures_load_with_their_coordinates_and_means_stand_for_data() {
    let mut document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorTexture": { "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform":
            { "offset": [0.5, 0.0], "scale": [2.0, 1.0] } } },
        "metallicRoughnessTexture": { "index": 1 } } }));
    let uvs = document.floats("VEC2", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    document.primitive()["attributes"]["TEXCOORD_1"] = json!(uvs);
    let colors = document.column("VEC4", 5121, 3, &[255; 12]);
    document.primitive()["attributes"]["COLOR_0"] = json!(colors);
    let view = document.json["bufferViews"].as_array().unwrap().len();
    document.column("SCALAR", 5121, 0, &png(2, 2, [0, 51, 255]));
    document.json["images"] = json!([
        { "bufferView": view, "mimeType": "image/png" }, { "uri": "data.png" },
    ]);
    document.json["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
    let text = document.text();
    let data = png(1, 1, [0, 51, 255]);
    let files: [(&str, &[u8]); 2] = [("a.gltf", text.as_bytes()), ("data.png", &data)];
    let (scene, warnings) = load_files("a.gltf", &files).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.textures[0].width, scene.textures[0].texels[0][2]), (2, 1.0));
    assert!(scene.materials[0].diffuse_texture.is_some());
    let gloss = 0.8_f32.powi(2);
    assert!((scene.materials[0].mirror.x - gloss).abs() < 1e-5, "metal of roughness 0.2");
    let attributes = &fixed_mesh(&scene, 0).attributes;
    let expected = [Vec2::new(0.5, 0.0), Vec2::new(2.5, 0.0), Vec2::new(0.5, 1.0)];
    assert_eq!((attributes.uvs.as_slice(), attributes.colors.len()), (&expected[..], 3));

    // Without the data, the default of full metalness would be wrong.
    let (scene, warnings) = document.load().unwrap();
    assert_eq!((scene.materials[0].mirror, warnings.len()), (Vec3::ZERO, 1));
    assert_has(&warnings[0], &["image 1", "data.png", "do without it"]);
}

#[test]
fn unreadable_images_are_warnings() {
    for image in [
        json!({ "uri": "data:image/png;base64,AAAA" }),
        json!({ "uri": "https://host/a.png" }),
        json!({ "bufferView": 0 }),
        json!({}),
    ] {
        let mut document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 } } }));
        document.json["images"] = json!([image]);
        document.json["textures"] = json!([{ "source": 0 }]);
        let (scene, warnings) = document.load().unwrap();
        assert!(scene.textures.is_empty() && warnings.len() == 1, "{warnings:?}");
        assert_eq!(scene.materials[0].diffuse, Vec3::splat(0.5), "neither white nor metal");
        document.json["textures"] = json!([{}]);
        assert_eq!(document.load().unwrap().1.len(), 1);
    }
}

#[test]
fn cameras_and_lights_hang_on_their_nodes() {
    let mut document = Document::triangle();
    document.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 3.0, "color": [1, 0, 0], "spot": {} },
        { "type": "point", "name": "bulb" }, { "type": "directional" } ] } });
    let light = |idx: usize| json!({ "extensions": { "KHR_lights_punctual": { "light": idx } } });
    document.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } },
        { "type": "orthographic", "name": "top",
          "orthographic": { "xmag": 1.0, "ymag": 2.0, "znear": 0.0, "zfar": 9.0 } } ]);
    document.json["nodes"] =
        json!([light(0), light(1), light(2), { "camera": 0, "name": "eye" }, { "camera": 1 }]);
    document.json["scenes"] = json!([{ "nodes": [0, 1, 2, 3, 4] }]);
    let (scene, _) = document.load().unwrap();
    let LightKind::Spot { intensity, cos_inner, .. } = scene.lights[0].kind else { panic!("spot") };
    assert_eq!((intensity, cos_inner), (Vec3::new(3.0, 0.0, 0.0), 1.0));
    assert_eq!((scene.lights[1].name.as_str(), scene.lights[2].node.unwrap().0), ("bulb", 2));
    assert_eq!((scene.cameras[0].name.as_str(), scene.cameras[1].name.as_str()), ("eye", "top"));
    assert_eq!(scene.cameras[0].projection, Projection::Perspective { vertical_fov: 0.5 });
    assert_eq!(scene.cameras[1].projection, Projection::Orthographic { height: 4.0 });

    document.json["cameras"][0]["perspective"]["yfov"] = json!(0);
    assert_has(&document.message(), &["camera 0", "yfov of 0"]);
    document.json["cameras"][0] = json!({ "type": "perspective", "orthographic": document.json["cameras"][1]["orthographic"] });
    assert_has(&document.message(), &["camera 0", "no projection of the stated type"]);
    document.json["cameras"] = json!([]);
    assert_has(&document.message(), &["camera", "out of range"]);
    document.json["nodes"] = json!([light(9), {}, {}, {}, {}]);
    assert_has(&document.message(), &["light", "out of range"]);
}
