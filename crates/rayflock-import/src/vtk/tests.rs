//! Tests on tiny files.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::ZlibEncoder};
use glam::Vec3;
use rayflock_geom::Sphere;

use crate::tests::{fixed_mesh, load_bytes};

const HEADER: &str = "# vtk DataFile Version 3.0\na quad\nASCII\nDATASET POLYDATA\n";
const POINTS: &str = "POINTS 4 float\n0 0 0  1 0 0\n1 1 0  0 1 0\n";

fn message(name: &str, bytes: &[u8]) -> String {
    load_bytes(name, bytes).unwrap_err().to_string()
}

#[test]
fn polygons_become_fans_and_strips_triangles() {
    let text = format!(
        "{HEADER}{POINTS}POLYGONS 2 9\n4 0 1 2 3\n3 2 1 0\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\n\
         POINT_DATA 4\nNORMALS n float\n0 0 2 0 0 2 0 0 2 0 0 2\n"
    );
    let (scene, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    let mesh = fixed_mesh(&scene, 0);
    let expected = [[0, 1, 2], [0, 2, 3], [2, 1, 0], [0, 1, 3], [1, 2, 3]];
    assert_eq!(mesh.mesh.triangles(), expected);
    assert_eq!(*mesh.normals, [Vec3::Z; 4]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

/// A binary file of one triangle, with attributes of all kinds before its normals.
fn binary() -> Vec<u8> {
    let mut bytes = HEADER.replace("ASCII", "BINARY").into_bytes();
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>();
    bytes.extend(b"POINTS 3 double\n");
    let corners = [0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    bytes.extend(corners.iter().flat_map(|value| value.to_be_bytes()));
    bytes.extend(b"\nMETADATA\nINFORMATION 0\n\nPOLYGONS 1 4\n");
    bytes.extend([3_i32, 0, 1, 2].map(i32::to_be_bytes).as_flattened());
    bytes.extend(b"\nCELL_DATA 1\nCOLOR_SCALARS c 3\n\x0a\x0a\x0a\nPOINT_DATA 3\n");
    bytes.extend(b"SCALARS id unsigned_short\nLOOKUP_TABLE default\n\0\x01\0\x02\0\x03\n");
    bytes.extend(b"LOOKUP_TABLE t 1\n\x0a\x0a\x0a\x0a\nTENSORS t float\n");
    bytes.extend(floats(&[0.5; 27]));
    bytes.extend(b"\nTEXTURE_COORDINATES uv 2 float\n");
    bytes.extend(floats(&[0.5; 6]));
    bytes.extend(b"\nFIELD more 2\nspeed 1 3 vtktypeint64\n");
    bytes.extend([7_i64; 3].map(i64::to_be_bytes).as_flattened());
    bytes.extend(b"\nMETADATA\nCOMPONENT_NAMES\nx\n\nradius 1 3 float\n");
    bytes.extend(floats(&[1.0; 3]));
    bytes.extend(b"\nNORMALS n float\n");
    bytes.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    bytes
}

#[test]
fn binary_files_are_read_past_what_is_not_wanted() {
    let (scene, warnings) = load_bytes("a.vtk", &binary()).unwrap();
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.mesh.corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(*mesh.normals, [Vec3::Z; 3]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn cells_may_be_two_arrays() {
    let text = format!(
        "{HEADER}{POINTS}POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\n\
         CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n"
    );
    let (scene, _) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
}

fn grid(cells: &str, types: &str) -> String {
    let header = HEADER.replace("POLYDATA", "UNSTRUCTURED_GRID");
    format!("{header}{POINTS}{cells}{types}")
}

#[test]
fn points_with_a_radius_are_spheres() {
    let grid = grid("CELLS 4 8\n1 0 1 1 1 2 1 3\n", "CELL_TYPES 4\n1 1 1 1\n");
    let text = format!(
        "{grid}POINT_DATA 4\nSCALARS id unsigned_int 1\nLOOKUP_TABLE t\n3 2 1 0\n\
         FIELD f 1\nRadius 1 4 float\n1 2 3 4\n"
    );
    let (scene, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    let spheres = fixed_mesh(&scene, 0).mesh.spheres();
    assert_eq!((spheres.len(), spheres[1]), (4, Sphere::new(Vec3::X, 2.0)));
    assert!(warnings.is_empty(), "{warnings:?}");
    let (scene, warnings) = load_bytes("a.vtk", grid.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.spheres()[0].radius, 0.5);
    assert!(warnings.len() == 1 && warnings[0].contains("shown with 0.5"), "{warnings:?}");
}

#[test]
fn cells_of_a_grid_are_sorted_by_kind() {
    let cells = "CELLS 7 27\n3 0 1 2 4 0 1 2 3 4 0 1 3 2 4 0 1 3 2 2 0 1 1 0 2 0 1\n";
    let text = grid(cells, "CELL_TYPES 7\n5 9 8 6 3 1 11\n");
    let (scene, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    let expected = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]];
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), expected);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("1 cells with a volume, 1 lines: these are not drawn"));
}

#[test]
fn lines_alone_are_told_and_show_nothing() {
    let text = format!("{HEADER}{POINTS}LINES 1 3\n2 0 1\nVERTICES 1 2\n1 0\n");
    let (scene, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.prim_count(), 0);
    assert!(warnings[0].contains("1 lines: these are not drawn"), "{warnings:?}");
}

#[test]
fn points_that_are_not_finite_are_told() {
    let text = format!("{HEADER}POINTS 3 float\n0 0 0 nan 0 0 0 1 inf\nPOLYGONS 1 4\n3 0 1 2\n");
    let (scene, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles().len(), 1);
    assert!(warnings[0].contains("2 vertices are not finite"), "{warnings:?}");
}

#[test]
fn an_attribute_that_is_not_understood_is_told() {
    let text = format!("{HEADER}{POINTS}POLYGONS 1 4\n3 0 1 2\nPOINT_DATA 4\nSCALARS s string\n");
    let (_, warnings) = load_bytes("a.vtk", text.as_bytes()).unwrap();
    assert!(warnings[0].contains("\"SCALARS s string\" is not understood"), "{warnings:?}");
}

#[test]
fn damage_is_an_error_with_its_place() {
    let polygons = |text: &str| format!("{HEADER}{POINTS}{text}");
    let cases = [
        ("# vtk\n".to_owned(), "line 1: found \"# vtk\""),
        ("solid".to_owned(), "header: found \"solid\""),
        (HEADER.replace("ASCII", "EBCDIC"), "line 3: found \"EBCDIC\", expected ASCII or BINARY"),
        (HEADER.replace("POLYDATA", "FIELD"), "\"DATASET FIELD\" is not supported"),
        (HEADER.to_owned(), "no POINTS"),
        (format!("{HEADER}POINTS 4 real\n"), "POINTS: found \"POINTS 4 real\""),
        (format!("{HEADER}POINTS x float\n"), "expected a count as word 2"),
        (format!("{HEADER}POINTS 4000000000 float\n0"), "found a count of 12000000000 numbers"),
        (format!("{HEADER}POINTS 18446744073709551615 float\n0"), "a count of"),
        (format!("{HEADER}POINTS 1 float\n0 0 zero\n"), "found \"zero\", expected a number"),
        (polygons("POLYGONS 1 4\n3 0 1 4\n"), "POLYGONS, cell 0: found point 4, expected less"),
        (polygons("POLYGONS 1 4\n3 0 1 -1\n"), "found point -1"),
        (polygons("POLYGONS 1 4\n4 0 1 2\n"), "POLYGONS, cell 0: found a length beyond the list"),
        (polygons("POLYGONS 2 4\n3 0 1 2\n"), "POLYGONS, cell 1: found nothing"),
        (polygons("POLYGONS 1 5\n3 0 1 2 0\n"), "1 numbers behind the last cell"),
        (polygons("POLYGONS 1 4\n3 0 1.5 2\n"), "found \"1.5\", expected a whole number"),
        (polygons("SPIRALS 1\n"), "found \"SPIRALS 1\""),
        (
            polygons("POLYGONS 2 3\nOFFSETS vtktypeint64\n0 9\nCONNECTIVITY vtktypeint64\n0 1 2"),
            "POLYGONS, offset of cell 0: found 9, expected from 0 to 3",
        ),
        (grid("CELLS 1 2\n1 0\n", ""), "CELL_TYPES: found 0 types, expected 1"),
    ];
    for (text, expected) in cases {
        let message = message("a.vtk", text.as_bytes());
        assert!(message.contains("a.vtk") && message.contains(expected), "{expected}: {message}");
    }
    let whole = binary();
    assert!(message("a.vtk", &whole[..whole.len() - 3]).contains("n, byte"));
}

/// A `<Piece>` of a quad, its arrays written by `array` from their attributes and bytes.
fn xml(root: &str, mut array: impl FnMut(&str, Vec<u8>) -> String) -> String {
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let ints = |values: &[i64]| values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let points = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    let points = array("type=\"Float32\" NumberOfComponents=\"3\"", floats(&points));
    let corners = array("type=\"Int64\" Name=\"connectivity\"", ints(&[0, 1, 2, 3]));
    let ends = array("type=\"Int64\" Name=\"offsets\"", ints(&[4]));
    let normals = "type=\"Float32\" Name=\"n\" NumberOfComponents=\"3\"";
    let normals = array(normals, floats(&[0.0, 0.0, 1.0].repeat(4)));
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" {root}>\n<PolyData>\
         <Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\" NumberOfLines=\"0\">\
         <PointData Normals=\"n\">{normals}</PointData><Points>{points}</Points>\
         <Polys>{corners}{ends}</Polys></Piece></PolyData>"
    )
}

fn check_quad(bytes: &[u8]) {
    let (scene, warnings) = load_bytes("a.vtp", bytes).unwrap();
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((mesh.mesh.vertices()[2], mesh.normals[3]), (Vec3::new(1.0, 1.0, 0.0), Vec3::Z));
    assert!(warnings.is_empty(), "{warnings:?}");
}

const PLAIN: &str = "byte_order=\"LittleEndian\" header_type=\"UInt32\"";
const PACKED: &str = "byte_order=\"LittleEndian\" header_type=\"UInt64\" \
                      compressor=\"vtkZLibDataCompressor\"";

/// A byte count and the bytes.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
}

/// A header and two blocks, the second shorter.
fn packed(bytes: &[u8]) -> [Vec<u8>; 2] {
    let half = bytes.len().div_ceil(2) + 1;
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(half)
        .map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        })
        .collect();
    let last = bytes.len() % half;
    let sizes = blocks.iter().map(Vec::len);
    let header: Vec<usize> = [blocks.len(), half, last].into_iter().chain(sizes).collect();
    let header = header.iter().flat_map(|number| (*number as u64).to_le_bytes()).collect();
    [header, blocks.concat()]
}

#[test]
fn arrays_in_place_are_text_or_base64() {
    let text = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" \
        NumberOfStrips=\"1\" NumberOfLines=\"2\"><Points><DataArray type=\"Float64\" \
        NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0\n0 1 0<InformationKey/></DataArray>\
        </Points><Strips><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray>\
        <DataArray type=\"UInt8\" Name=\"offsets\">3</DataArray></Strips></Piece>\
        <Piece NumberOfPoints=\"0\"/></PolyData></VTKFile>";
    let (scene, warnings) = load_bytes("a.vtp", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), [[0, 1, 2]]);
    assert!(warnings[0].contains("2 lines"), "{warnings:?}");

    let text = xml(PLAIN, |attributes, bytes| {
        let text = STANDARD.encode(counted(&bytes));
        format!("<DataArray {attributes} format=\"binary\">\n {text}\n</DataArray>")
    });
    check_quad(format!("{text}</VTKFile>").as_bytes());
    let text = xml(PACKED, |attributes, bytes| {
        let text = packed(&bytes).map(|part| STANDARD.encode(part)).concat();
        format!("<DataArray {attributes} format=\"binary\">{text}</DataArray>")
    });
    check_quad(format!("{text}</VTKFile>").as_bytes());
}

#[test]
fn arrays_behind_the_elements_are_raw_or_base64() {
    for (encoding, is_packed) in [("raw", false), ("base64", false), ("raw", true)] {
        let mut block = b"_".to_vec();
        let root = if is_packed { PACKED } else { PLAIN };
        let text = xml(root, |attributes, bytes| {
            let offset = block.len() - 1;
            let bytes = if is_packed { packed(&bytes).concat() } else { counted(&bytes) };
            match encoding {
                "raw" => block.extend(bytes),
                _ => block.extend(STANDARD.encode(bytes).into_bytes()),
            }
            format!("<DataArray {attributes} format=\"appended\" offset=\"{offset}\"/>")
        });
        let text = format!("{text}<AppendedData encoding=\"{encoding}\">\n   ");
        let end = b"\n</AppendedData></VTKFile>";
        check_quad(&[text.as_bytes(), &block, end].concat());
    }
}

#[test]
fn pieces_follow_each_other() {
    let piece = |radius: &str| {
        format!(
            "<Piece NumberOfPoints=\"2\" NumberOfVerts=\"2\"><PointData><DataArray \
             type=\"Float32\" Name=\"radius\">{radius}</DataArray></PointData><Points><DataArray \
             type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0</DataArray></Points></Piece>"
        )
    };
    let text = format!(
        "<VTKFile type=\"PolyData\"><PolyData>{}{}</PolyData></VTKFile>",
        piece("1 2"),
        piece("3 4")
    );
    let (scene, _) = load_bytes("a.vtp", text.as_bytes()).unwrap();
    let radii: Vec<f32> = fixed_mesh(&scene, 0).mesh.spheres().iter().map(|s| s.radius).collect();
    assert_eq!(radii, [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn damaged_xml_is_an_error_with_its_place() {
    let ascii = "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><Points>\
        <DataArray type=\"Float32\" format=\"ascii\">0 0 0</DataArray></Points></Piece></PolyData>\
        </VTKFile>";
    assert!(load_bytes("a.vtp", ascii.as_bytes()).is_ok());
    let appended = ascii.replace("ascii", "appended").replace("0 0 0", "");
    let cases = [
        (ascii[..90].to_owned(), "XML: found"),
        (ascii.replace("VTKFile", "VTK"), "found <VTK>, expected <VTKFile>"),
        (ascii.replace("type=\"PolyData\"", "type=\"ImageData\""), "the type \"ImageData\""),
        (ascii.replace("<VTKFile", "<VTKFile compressor=\"lz4\""), "compressor \"lz4\""),
        (ascii.replace("<VTKFile", "<VTKFile byte_order=\"x\""), "byte_order \"x\""),
        (ascii.replace("<VTKFile", "<VTKFile header_type=\"Int8\""), "header_type \"Int8\""),
        (ascii.replace("\"1\"", "\"many\""), "piece 0, NumberOfPoints: found \"many\""),
        (ascii.replace("\"1\"", "\"4000000000000\""), "piece 0, <Points>: found 3 numbers"),
        (ascii.replace("0 0 0", "0 0 x"), "found \"x\", expected a number"),
        (ascii.replace("Float32", "Text"), "the type \"Text\""),
        (ascii.replace("ascii", "morse"), "the format \"morse\""),
        (ascii.replace("DataArray", "Array"), "piece 0, <Points>: found no array"),
        (ascii.replace("ascii", "binary").replace("0 0 0", "AAAA"), "the end of the data"),
        (appended.clone(), "found the offset \"\", expected a place in <AppendedData>"),
        (
            appended.replace("format", "offset=\"99\" format").replace(
                "</VTKFile>",
                "<AppendedData encoding=\"raw\">_abc</AppendedData></VTKFile>",
            ),
            "found the offset \"99\", expected a place in <AppendedData>",
        ),
        (
            ascii.replace("</VTKFile>", "<AppendedData encoding=\"x\">_</AppendedData></VTKFile>"),
            "expected the encoding \"raw\" or \"base64\"",
        ),
    ];
    for (text, expected) in cases {
        let message = message("a.vtp", text.as_bytes());
        assert!(message.contains("a.vtp") && message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn headers_that_claim_too_much_are_refused() {
    let array = |numbers: &[u64]| {
        let header: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let text = STANDARD.encode(header);
        let text = format!("<DataArray type=\"Float32\" format=\"binary\">{text}</DataArray>");
        format!(
            "<VTKFile type=\"PolyData\" {PACKED}><PolyData><Piece NumberOfPoints=\"1\"><Points>\
             {text}</Points></Piece></PolyData></VTKFile>"
        )
    };
    let message = |numbers: &[u64]| message("a.vtp", array(numbers).as_bytes());
    assert!(message(&[u64::MAX]).contains("the end of the data"));
    assert!(message(&[1 << 40, 1, 1]).contains("the end of the data"));
    assert!(message(&[1, 1 << 40, 1 << 40, 0]).contains("is more than the limit"));
    assert!(message(&[1, 8, 0, u64::MAX]).contains("the end of the data"));
}
