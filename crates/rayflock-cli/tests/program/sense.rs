//! `sense`: files, pictures, words, and what is wrong with arguments and input.

use std::fs::File;

use ndarray::{Array1, Array2, Array3};
use ndarray_npy::NpzReader;
use pcd_rs::DynReader;
use rayflock::import::{Reporter, load};
use rayflock::scene::Shape;

use crate::Workplace;
use crate::errors::fails;

/// A wall at Z = -4 and a floor at Y = -1.
const OBJ: &str = "v -50 -50 -4\nv 50 -50 -4\nv 50 50 -4\nv -50 50 -4\nf 1 2 3\nf 1 3 4\n\
                   v -50 -1 -50\nv -50 -1 50\nv 50 -1 50\nv 50 -1 -50\nf 5 6 7\nf 5 7 8\n";
/// A depth camera at the origin that looks at the wall.
const DEPTH: &str = "sense room.obj --at 0,0,0 --sensor depth --size 40x30";

fn workplace() -> Workplace {
    let work = Workplace::new();
    work.write("room.obj", OBJ);
    work
}

/// What stands in the summary after `name`.
fn line<'a>(summary: &'a str, name: &str) -> &'a str {
    let line = summary.lines().find_map(|line| line.trim_start().strip_prefix(name));
    line.unwrap_or_else(|| panic!("no line {name} in {summary}")).trim()
}

/// Columns of a CSV file, by name.
fn csv_columns<const N: usize>(work: &Workplace, file: &str, names: [&str; N]) -> [Vec<f64>; N] {
    let bytes = work.read(file);
    let mut table = csv::Reader::from_reader(&bytes[..]);
    let head = table.headers().expect("a CSV file has a head").clone();
    let places = names.map(|name| head.iter().position(|found| found == name).expect(name));
    let rows: Vec<_> = table.records().map(|row| row.expect("all rows are alike")).collect();
    places.map(|place| rows.iter().map(|row| row[place].parse().expect("a number")).collect())
}

#[test]
fn every_format_tells_the_same_points() {
    let work = workplace();
    let outputs = "-o a.csv -o a.npz -o a.ply -o a.pcd --picture a.png";
    let run = work.run_quietly(&format!("{DEPTH} {outputs}"));
    assert_eq!(work.names(), ["a.csv", "a.npz", "a.pcd", "a.ply", "a.png", "room.obj"]);
    assert_eq!(line(&run.stdout, "points"), "1200 from 1200 beams");
    assert_eq!(line(&run.stdout, "sensor"), "depth, 30 rows x 40 columns");
    assert_eq!(line(&run.stdout, "time"), "1 sweep from 0.000 s on at 30 Hz, 1 time step each");

    let [x, y, z, range, z_sensor] =
        csv_columns(&work, "a.csv", ["x", "y", "z", "range", "z_sensor"]);
    assert_eq!(range.len(), 1200);
    for idx in 0..1200 {
        let on_wall = (z[idx] + 4.0).abs() < 1e-4 && y[idx] > -1.001;
        assert!(on_wall || (y[idx] + 1.0).abs() < 1e-4, "{} {} {}", x[idx], y[idx], z[idx]);
        assert!((z[idx] - z_sensor[idx]).abs() < 1e-5);
    }

    let mut npz = NpzReader::new(File::open(work.path("a.npz")).unwrap()).unwrap();
    let found: Array1<f32> = npz.by_name("range").unwrap();
    assert!(found.iter().zip(&range).all(|(found, told)| (f64::from(*found) - told).abs() < 1e-5));
    let image: Array2<f32> = npz.by_name("depth_image").unwrap();
    assert_eq!(image.dim(), (30, 40));
    assert!((image[[0, 0]] - 4.0).abs() < 1e-5 && image[[29, 20]] < 3.0);
    let place: Array3<f32> = npz.by_name("world_from_sensor").unwrap();
    assert_eq!((place.dim(), place[[0, 3, 3]]), ((1, 4, 4), 1.0));
    let ids: Array1<u32> = npz.by_name("prim_id").unwrap();
    assert!([0, 1].iter().all(|wall| ids.iter().any(|id| id == wall)));
    assert!(ids.iter().any(|id| [2, 3].contains(id)), "the floor is seen");

    let mut reporter = Reporter::new();
    let scene = load(&work.path("a.ply"), &mut reporter).expect("what we write we read");
    let Shape::Fixed(surface) = &scene.objects[0].shape else { panic!("points do not move") };
    let spheres = surface.mesh.spheres();
    assert_eq!(spheres.len(), 1200);
    assert!((f64::from(spheres[7].center.x) - x[7]).abs() < 1e-5);

    let points = DynReader::open(work.path("a.pcd")).unwrap();
    let points: Vec<_> = points.map(Result::unwrap).collect();
    assert_eq!(points.len(), 1200);
    let point = points[7].to_xyz::<f32>().unwrap();
    assert!((f64::from(point[0]) - x[7]).abs() < 1e-5 && (f64::from(point[2]) - z[7]).abs() < 1e-5);
}

#[test]
fn several_sweeps_are_numbered_and_move_on() {
    let work = Workplace::new();
    let sweeps =
        "sense builtin:crowd --sensor spinning:16 --columns 64 --time-steps 4 --sweeps 2..3";
    work.run_quietly(&format!("{sweeps} --at 2,1.4,0.6 -o scan.csv --picture p_%d.png"));
    assert_eq!(work.names(), ["p_2.png", "p_3.png", "scan_0002.csv", "scan_0003.csv"]);
    for (file, start) in [("scan_0002.csv", 0.2), ("scan_0003.csv", 0.3)] {
        let [time, row, column] = csv_columns(&work, file, ["time", "row", "column"]);
        assert!(time.iter().all(|time| (start..start + 0.1).contains(time)), "{file}");
        assert!(row.iter().all(|row| *row < 16.0) && column.iter().all(|column| *column < 64.0));
    }
    assert!(work.read("p_2.png") != work.read("p_3.png"));
}

#[test]
fn engines_and_threads_change_nothing() {
    let work = Workplace::new();
    let sweep = "sense builtin:crowd --sensor spinning:16 --columns 60 --noise 0.01 --time-steps 6";
    work.run_quietly(&format!("{sweep} --engine bvh --threads 1 -o a.csv"));
    work.run_quietly(&format!("{sweep} --engine hierarchy --threads 2 -o b.csv"));
    work.run_quietly(&format!("{sweep} --seed 1 -o c.csv"));
    assert_eq!(work.read("a.csv"), work.read("b.csv"));
    assert_ne!(work.read("a.csv"), work.read("c.csv"));
}

#[test]
fn a_file_says_what_the_command_line_does_not() {
    let work = workplace();
    work.write(
        "my.toml",
        "sensor = \"spinning:16\"\nelevations = [10, 0, -10]\ncolumns = 36\nrate = 5\n\
         returns = \"first+last\"\nmax-range = 30.0\n\
         [[pose]]\ntime = 0\nat = [0, 0, 0]\n[[pose]]\ntime = 0.2\nat = \"2,0,0\"\n",
    );
    let run = work.run_quietly("sense room.obj --sensor my.toml --columns 72 -o a.npz");
    assert_eq!(line(&run.stdout, "sensor"), "my.toml, 3 rows x 72 columns");
    assert!(line(&run.stdout, "time").contains("at 5 Hz, 72 time steps"));
    let mut npz = NpzReader::new(File::open(work.path("a.npz")).unwrap()).unwrap();
    let place: Array3<f32> = npz.by_name("world_from_sensor").unwrap();
    assert!((place[[36, 0, 3]] - 1.0).abs() < 1e-5, "it is half way");
    work.run_quietly("sense room.obj --sensor my.toml --at 1,0,0 -o b.npz");
    let mut npz = NpzReader::new(File::open(work.path("b.npz")).unwrap()).unwrap();
    let place: Array3<f32> = npz.by_name("world_from_sensor").unwrap();
    assert_eq!((place[[0, 0, 3]], place[[35, 0, 3]]), (1.0, 1.0));

    for (text, expected) in [
        ("columns = 36\n", ["found no key sensor", "spinning:16"]),
        ("sensor = \"depth\"\ncolour = 1\n", ["colour", "expected one of"]),
        ("sensor = \"depth\"\nsize = \"3\"\n", ["found \"3\"", "as in 640x360"]),
        ("sensor = \"depth\"\nrate = \"fast\"\n", ["line 2", "fast"]),
        ("sensor = \"depth\"\n[[pose]]\ntime = 1\n", ["missing field `at`", "line 2"]),
        ("sensor = \"depth\"\nat = [0,0]\n", ["expected 3 numbers", "1.5,97,-4"]),
        (
            "sensor = \"depth\"\nat = [0,0,0]\n[[pose]]\ntime=0\nat=[0,0,0]\n",
            ["[[pose]]", "one of"],
        ),
    ] {
        work.write("bad.toml", text);
        let [first, second] = expected;
        fails(&work, "sense room.obj --sensor bad.toml", 2, &["bad.toml", first, second]);
    }
    fails(&work, "sense room.obj --sensor none.toml", 2, &["cannot read none.toml"]);
}

#[test]
fn wrong_arguments_say_what_is_expected() {
    let work = workplace();
    for (option, expected) in [
        ("--sensor lidar", ["\"lidar\"", "spinning:16, spinning:32"]),
        ("--sensor depth --columns 5", ["columns says nothing", "size, fov"]),
        ("--sensor ortho --fov 40", ["fov says nothing", "extent"]),
        ("--sensor solid-state --fov 40", ["fov is 40 degrees", "two angles"]),
        ("--sensor depth --fov 80x40", ["fov is 80 x 40 degrees", "one angle"]),
        ("--sensor depth --fov 180", ["180", "up to 175"]),
        ("--sensor depth --time-steps 2", ["time steps is 2", "all beams are fired at once"]),
        ("--sensor ortho --extent 0x1", ["0 x 1", "above 0"]),
        ("--rows 0", ["number of beams is 0", "1 to"]),
        ("--elevations 1,2 --rows 3", ["number of rows is 3", "expected 2"]),
        ("--elevations 95", ["95", "-90 to 90"]),
        ("--elevations up", ["up", "15..-25"]),
        ("--columns 99999999", ["number of beams", "16777216"]),
        ("--rows 16777216 --columns 2 --picture x.png", ["beams is 33554432", "16777216"]),
        ("--rate 0", ["rate is 0", "sweeps a second"]),
        ("--time-steps 1025", ["time steps is 1025", "1 to 1024"]),
        ("--min-range 5 --max-range 4", ["most range is 4", "least, 5"]),
        ("--noise -1", ["noise is -1", "0 or more"]),
        ("--drop-out 2", ["drop-out is 2", "0 to 1"]),
        ("--drop-out-far 0.5", ["most range is inf", "finite"]),
        ("--returns dual", ["\"dual\"", "first+last"]),
        ("--at 1,2", ["1,2", "3 numbers"]),
        ("--look-at 1,2,3", ["--look-at", "no --at"]),
        ("--at 0,0,0 --camera x", ["--at", "--camera"]),
        ("--camera Nobody", ["Nobody", "no camera"]),
        ("--clip Dance", ["Dance", "no clip"]),
        ("--sweeps 3..1", ["3..1", "expected 1..3"]),
        ("-o x.las", ["x.las", ".ply, .pcd, .npz or .csv"]),
        ("--picture x.jpg", ["x.jpg", ".png"]),
        ("--picture x.png --picture-size 100x50", ["100x50", "224x160"]),
    ] {
        fails(&work, &format!("sense room.obj {option}"), 2, &expected);
    }
    for output in ["-o no/x.ply", "-o no/x.pcd", "--picture no/x.png"] {
        fails(&work, &format!("sense room.obj {output}"), 1, &["cannot write no/x."]);
    }
}

#[test]
fn other_sensors_find_their_place() {
    let work = workplace();
    for (sensor, points) in [
        // On a camera that frames everything.
        ("ortho --size 20x20", "points"),
        ("rosette --beams 500 --at 0,0,0", "500 from 500 beams"),
        ("solid-state --size 20x10 --at 0,0,0", "200 from 200 beams"),
    ] {
        let words = format!("sense room.obj --sensor {sensor} --picture a.png --show intensity");
        let run = work.run_quietly(&words);
        assert!(run.stdout.contains(points), "{sensor}: {}", run.stdout);
        let picture = image::open(work.path("a.png")).unwrap().into_rgb8();
        let is_colored = |pixel: &&image::Rgb<u8>| pixel.0[1].abs_diff(pixel.0[2]) > 20;
        // The colour bar has some thousand.
        let colored = picture.enumerate_pixels().filter(|(x, ..)| x + 112 < picture.width());
        let count = colored.map(|(.., pixel)| pixel).filter(is_colored).count();
        assert!(count > 100, "{sensor}: {count}");
    }
}

#[test]
fn sweeps_end_where_a_sequence_does() {
    let work = Workplace::new();
    std::fs::create_dir(work.path("walk")).unwrap();
    for frame in 1..=5 {
        work.write(&format!("walk/{frame}.obj"), OBJ.replace(" -4\n", &format!(" -{frame}\n")));
    }
    // Five frames at 2 a second end at 2 s.
    let words = "sense walk --fps 2 --sensor depth --rate 2 --size 8x8 --at 0,0,0 -o a.csv";
    work.run_quietly(&format!("{words} --sweeps 4"));
    let [z] = csv_columns(&work, "a.csv", ["z"]);
    assert!((z[0] + 5.0).abs() < 1e-4, "the first file is at -1, the last at -5");
    let expected = ["--sweeps asks for 3..5", "begins at 2.5 s", "ends at 2 s"];
    fails(&work, &format!("{words} --sweeps 3..5"), 2, &expected);
}

#[test]
fn help_lists_sensors() {
    let help = Workplace::new().run_quietly("sense --help").stdout;
    for part in ["spinning:16", "rosette", "FILE.toml", "--time-steps", "Examples:", "Exit codes"] {
        assert!(help.contains(part), "{part} is not in {help}");
    }
}
