//! A small, sound file of each kind, with most of what its format has.

use std::io::{Cursor, Write};
use std::path::Path;

use zip::CompressionMethod;
use zip::write::{SimpleFileOptions, ZipWriter};

pub(crate) const OBJ: &[u8] =
    b"mtllib a.mtl\no a\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\n\
    usemtl m\nf 1/1/1 2/1/1 3//1\ng b\nf -1 -2 -3\ns off\nl 1 2\n";
pub(crate) const MTL: &[u8] =
    b"newmtl m\nKd 1 1 1\nKs 0.5\nNs 10\nNi 1.5\nd 0.5\nillum 7\nmap_Kd -s 1 1 1 a.png\n";
const PLY_ASCII: &[u8] = b"ply\nformat ascii 1.0\ncomment c\nelement vertex 3\n\
    property float x\nproperty float y\nproperty float z\nproperty uchar red\n\
    property uchar green\nproperty uchar blue\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n\
    0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n3 0 1 2\n4 0 1 2 0\n";
const PLY_BINARY: &[u8] = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\n\
    property float x\nproperty float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n\
    \0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\
    \x03\0\0\0\0\x01\0\0\0\x02\0\0\0";
const STL_ASCII: &[u8] = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
    vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";

/// Every command, and keys of every kind.
const AFF: &[u8] = b"v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 8 6\n\
    b 0 0 1 am 1 1 1 a 0 4 5 # end\nl 1 2 3 1 1 1\nla lamp 1 2 3\nd 1 f 1 0 0 1 0.5 20 0 0\n\
    p 5 0 0 0 4 0 0 4 4 0 3 1 0 0 1 0\nfm 1 1 1 1 1 1 0 0 0 20 0.5 1.5\n\
    pp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 tt a.ppm 0 0 0 0 0 1 0 0 1 0 0 1 0 0 1\n\
    xs 1 2 1 0 1 0 30 1 0 0 { s 0 0 0 1 c 0 0 0 1 0 1 0 0 x car { s 0 0 0 1\n\
    m vertices 3 0 0 0 1 0 0 0 1 0 normals 1 0 0 1 texturecoords 1 a.ppm 0 0\n\
    triangles 1 0 1 2 0 0 0 0 0 0 } }\ntpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1\n\
    3 0 0 1 0 0 1 1 0 1 0 0 1 0 1 1 0 0 1\nk car { transl 4 0 0 0 0 0 0 0 1 1 0 0 0 0 0\n\
    2 2 0 0 0.5 0 0 3 3 0 0 0 0 0 rot 4 0 0 1 0 0 0 0 0 1 0 1 0 90 0 0 0 2 0 1 0 270 0 0 0\n\
    3 1 0 0 9 0 0 0 scale 4 0 1 1 1 0 0 0 1 1 1 1 0 0 0 2 2 1 1 0 0 0 3 1 1 1 0 0 0\n\
    visibility 2 1 0 2 1 }\nk camera { transl 4 0 0 0 0 0 0 0 1 1 0 0 0 0 0 2 2 0 0 0 0 0\n\
    3 3 0 0 0 0 0 }\ni 0 b.aff\n";
const AFF_INCLUDED: &[u8] = b"p 3 0 0 0 1 0 0 0 1 0\n";

const VTK_ASCII: &[u8] = b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n\
    POINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 4\n\
    3 0 1 2\nLINES 1 3\n2 0 1\nPOINT_DATA 4\nSCALARS id int 1\nLOOKUP_TABLE default\n1 2 3 4\n\
    FIELD f 1\nradius 1 4 float\n1 1 1 1\nNORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n";
const VTK_BINARY: &[u8] = b"# vtk DataFile Version 5.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\n\
    POINTS 1 float\n\0\0\0\0\x3f\x80\0\0\0\0\0\0\nCELLS 2 1\nOFFSETS vtktypeint64\n\
    \0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x01\nCONNECTIVITY vtktypeint64\n\0\0\0\0\0\0\0\0\n\
    CELL_TYPES 1\n\0\0\0\x01\nPOINT_DATA 1\nFIELD f 1\nradius 1 1 float\n\x3f\x80\0\0\n";

/// One triangle: text, base64, and bytes behind the elements.
fn vtp() -> Vec<u8> {
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let points: Vec<u8> = corners.map(f32::to_le_bytes).concat();
    let points = encode(&[&36_u32.to_le_bytes(), points.as_slice()].concat());
    let head = format!(
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\
         <PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><PointData><DataArray \
         type=\"Float64\" Name=\"radius\" format=\"ascii\">1 2 3</DataArray></PointData><Points>\
         <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">{points}\
         </DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" \
         format=\"appended\" offset=\"0\"/><DataArray type=\"Int32\" Name=\"offsets\" \
         format=\"appended\" offset=\"16\"/></Polys></Piece></PolyData>\
         <AppendedData encoding=\"raw\">_"
    );
    let words = [12_u32, 0, 1, 2, 4, 3].map(u32::to_le_bytes).concat();
    [head.as_bytes(), &words, b"</AppendedData></VTKFile>"].concat()
}

/// An array as NumPy writes it.
pub(crate) fn npy(kind: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + text.len()) % 16 != 15 {
        text.push(' ');
    }
    let length = (text.len() as u16 + 1).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], text.as_bytes(), b"\n", bytes].concat()
}

/// The arrays of two frames of a triangle, of which the second has a sphere too.
pub(crate) fn arrays() -> [(&'static str, Vec<u8>); 6] {
    let floats = |count: usize| 0.5_f32.to_le_bytes().repeat(count);
    let offsets = [0_i64, 3, 6].map(i64::to_le_bytes).concat();
    [
        ("vertices", npy("<f4", "(6, 3)", &floats(18))),
        ("vertex_offsets", npy("<i8", "(3,)", &offsets)),
        ("triangles", npy("<u4", "(1, 3)", &[0_u32, 1, 2].map(u32::to_le_bytes).concat())),
        ("centers", npy("<f4", "(2, 1, 3)", &floats(6))),
        ("radii", npy("<f4", "(1,)", &floats(1))),
        ("frame_rate", npy("<f8", "()", &24_f64.to_le_bytes())),
    ]
}

/// The arrays as a file.
pub(crate) fn npz(arrays: &[(&str, Vec<u8>)], method: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in arrays {
        zip.start_file(format!("{name}.npy"), options).expect("a file in memory");
        zip.write_all(bytes).expect("a file in memory");
    }
    zip.finish().expect("a file in memory").into_inner()
}

/// The mesh that caches move.
const CACHED_OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

fn pc2() -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0\x01\0\0\0\x03\0\0\0\0\0\0\0\0\0\x80\x3f\x02\0\0\0".to_vec();
    bytes.extend([0x3f; 72]);
    bytes
}

fn mdd() -> Vec<u8> {
    let mut bytes = b"\0\0\0\x02\0\0\0\x03\0\0\0\0\x3f\x80\0\0".to_vec();
    bytes.extend([0x3f; 72]);
    bytes
}

fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend([0x3f; 100]);
    bytes
}

/// A skinned, morphed, animated and textured document with everything inside.
fn gltf() -> Vec<u8> {
    let floats = |count: usize, value: f32| value.to_le_bytes().repeat(count);
    // Positions (36), joints (12), weights (48), times (8), translations (24), indices (12).
    let mut buffer = floats(9, 0.5);
    buffer.extend([0, 1, 0, 0].repeat(3));
    buffer.extend(floats(12, 0.25));
    buffer.extend([0.0_f32, 1.0].map(f32::to_le_bytes).concat());
    buffer.extend(floats(6, 2.0));
    buffer.extend([0_u32, 1, 2].map(u32::to_le_bytes).concat());
    let encoded = encode(&buffer);
    assert_eq!(buffer.len(), 140);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,3]}}],
"nodes":[{{"mesh":0,"skin":0,"children":[1]}},{{"children":[2]}},{{"rotation":[0,0,0,1]}},{{"camera":0,
"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","spot":{{}}}}]}}}},
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}},"indices":5,
"targets":[{{"POSITION":0}}],"material":0}}]}}],"skins":[{{"joints":[1,2]}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
"textures":[{{"source":0}}],"images":[{{"uri":"data:image/png;base64,{png}"}}],
"animations":[{{"samplers":[{{"input":3,"output":4}}],
"channels":[{{"sampler":0,"target":{{"node":2,"path":"translation"}}}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
{{"bufferView":0,"byteOffset":36,"componentType":5121,"count":3,"type":"VEC4"}},
{{"bufferView":0,"byteOffset":48,"componentType":5126,"count":3,"type":"VEC4"}},
{{"bufferView":0,"byteOffset":96,"componentType":5126,"count":2,"type":"SCALAR"}},
{{"bufferView":0,"byteOffset":104,"componentType":5126,"count":2,"type":"VEC3"}},
{{"bufferView":0,"byteOffset":128,"componentType":5125,"count":3,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":140}}],
"buffers":[{{"byteLength":140,"uri":"data:application/octet-stream;base64,{encoded}"}}]}}"#,
        png = encode(PNG),
    )
    .into_bytes()
}

/// One white pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde\
    \0\0\0\x0cIDATx\x9cc\xf8\xff\xff?\0\x05\xfe\x02\xfe\x0d\xefF\xb8\0\0\0\0IEND\xaeB`\x82";

/// Base64, as data URIs have it.
fn encode(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let mut triple = [0; 3];
        triple[..chunk.len()].copy_from_slice(chunk);
        let bits = u32::from_be_bytes([0, triple[0], triple[1], triple[2]]);
        for digit_idx in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * digit_idx)) as usize & 63];
            text.push(if digit_idx <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

fn glb() -> Vec<u8> {
    let mut json = gltf();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((20 + json.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes
}

/// A compressed file.
pub(crate) fn gz(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(content).expect("a file in memory");
    encoder.finish().expect("a file in memory")
}

/// A valid file of each kind: the name to load and its content.
pub(crate) fn samples() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", OBJ.to_vec()),
        ("a.ply", PLY_ASCII.to_vec()),
        ("a.ply", PLY_BINARY.to_vec()),
        ("a.stl", STL_ASCII.to_vec()),
        ("a.stl", stl_binary()),
        ("a.gltf", gltf()),
        ("a.glb", glb()),
        ("a.aff", AFF.to_vec()),
        ("a.vtk", VTK_ASCII.to_vec()),
        ("a.vtk", VTK_BINARY.to_vec()),
        ("a.vtp", vtp()),
        ("a.npz", npz(&arrays(), CompressionMethod::Deflated)),
        ("b.pc2", pc2()),
        ("b.mdd", mdd()),
        ("a.stl.gz", gz(&stl_binary())),
    ]
}

/// The files that samples name.
pub(crate) fn write_neighbours(folder: &Path) {
    for (name, bytes) in [("a.mtl", MTL), ("b.aff", AFF_INCLUDED), ("b.obj", CACHED_OBJ)] {
        std::fs::write(folder.join(name), bytes).expect("the new folder is writable");
    }
}
