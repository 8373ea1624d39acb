//! `sun`: files, pictures, words, and what is wrong with arguments and input.

use std::fmt::Write;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use ndarray::{Array1, Array2};
use ndarray_npy::NpzReader;
use rayflock::import::{Reporter, load};
use rayflock::scene::Shape;

use crate::Workplace;
use crate::errors::fails;

/// A floor of two triangles, and a roof of one that shades a part of it at noon.
const OBJ: &str = "v -4 0 4\nv 4 0 4\nv 4 0 -4\nv -4 0 -4\nf 1 2 3\nf 1 3 4\n\
                   v -1 2 1\nv 3 2 1\nv 3 2 -3\nf 5 6 7\n";
const BERLIN: &str = "--latitude 52.5 --longitude 13.4";

fn workplace() -> Workplace {
    let work = Workplace::new();
    work.write("house.obj", OBJ);
    work
}

/// The command for a day at midsummer in Berlin, with more options.
fn midsummer(options: &str) -> String {
    format!("sun house.obj {BERLIN} --date 2024-06-21 {options}")
}

/// What stands in the summary after `name`.
fn line<'a>(summary: &'a str, name: &str) -> &'a str {
    let line = summary.lines().find_map(|line| line.trim_start().strip_prefix(name));
    line.unwrap_or_else(|| panic!("no line {name} in {summary}")).trim()
}

/// The hours of a CSV file.
fn csv_hours(work: &Workplace, name: &str) -> Vec<f64> {
    let bytes = work.read(name);
    let mut table = csv::Reader::from_reader(&bytes[..]);
    assert_eq!(
        table.headers().expect("a CSV file has a head"),
        vec!["index", "x", "y", "z", "hours"]
    );
    let rows = table.deserialize::<(usize, f32, f32, f32, f64)>();
    let rows: Vec<_> = rows.map(Result::unwrap).collect();
    assert!(rows.iter().enumerate().all(|(idx, row)| row.0 == idx));
    rows.into_iter().map(|row| row.4).collect()
}

/// Vertices, triangles and how many vertices have colours in a PLY file, as our importer sees it.
fn ply_counts(work: &Workplace, name: &str) -> [usize; 3] {
    let mut reporter = Reporter::new();
    let scene = load(&work.path(name), &mut reporter).expect("what we write we read");
    assert!(reporter.warnings().is_empty());
    let Shape::Fixed(surface) = &scene.objects[0].shape else { panic!("{name} moves") };
    let colors = surface.attributes.colors.len();
    [surface.mesh.vertices().len(), surface.mesh.triangles().len(), colors]
}

#[test]
fn every_format_tells_the_same_hours() {
    let work = workplace();
    let run = work.run_quietly(&midsummer("-o a.csv -o a.npz -o a.ply --picture a.png"));
    assert_eq!(work.names(), ["a.csv", "a.npz", "a.ply", "a.png", "house.obj"]);
    assert_eq!(line(&run.stdout, "samples"), "3 faces");
    let told = line(&run.stdout, "sun");
    let up = told.strip_suffix(" hours").and_then(|told| told.rsplit(' ').next()).unwrap();
    let up: f64 = up.parse().unwrap();
    assert!((16.5..17.0).contains(&up), "{told}");

    let hours = csv_hours(&work, "a.csv");
    assert!((hours[2] - up).abs() < 0.01, "the roof is lit all day: {hours:?}");
    assert!(hours[1] > 1.0 && hours[1] < hours[2] - 1.0, "the floor is not: {hours:?}");

    let mut npz = NpzReader::new(File::open(work.path("a.npz")).unwrap()).unwrap();
    let array: Array1<f64> = npz.by_name("hours").unwrap();
    assert_eq!(array.to_vec(), hours);
    let vertices: Array2<f32> = npz.by_name("vertices").unwrap();
    let triangles: Array2<u32> = npz.by_name("triangles").unwrap();
    assert_eq!((vertices.dim(), triangles.dim()), ((7, 3), (3, 3)));
    let times: Array1<i64> = npz.by_name("times").unwrap();
    let to_sun: Array2<f32> = npz.by_name("to_sun").unwrap();
    let step_hours: Array1<f64> = npz.by_name("step_hours").unwrap();
    assert_eq!((to_sun.dim(), step_hours.len()), ((times.len(), 3), times.len()));
    assert!((step_hours.sum() - hours[2]).abs() < 1e-9);
    assert!(to_sun.column(1).iter().all(|up| *up > 0.0), "{to_sun}");

    assert_eq!(ply_counts(&work, "a.ply"), [7, 3, 0]);
    let ply = work.read("a.ply");
    let header = String::from_utf8_lossy(&ply[..400]).into_owned();
    assert!(header.contains("property float sun_hours\nproperty uchar red"), "{header}");
    let picture = image::open(work.path("a.png")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (640, 360));
}

#[test]
fn vertices_are_told_too() {
    let work = workplace();
    let run = work.run_quietly(&midsummer("--per vertex -o v.csv -o v.ply --picture v.png"));
    assert_eq!(line(&run.stdout, "samples"), "7 vertices");
    assert_eq!(csv_hours(&work, "v.csv").len(), 7);
    assert_eq!(ply_counts(&work, "v.ply"), [7, 3, 7]);
}

#[test]
fn the_picture_has_a_colour_bar_and_sides_in_sun_and_shade() {
    let work = workplace();
    work.run_quietly(&midsummer("--picture a.png --size 320x200"));
    let picture = image::open(work.path("a.png")).unwrap().into_rgb8();
    let has = |left: u32, right: u32, color: [u8; 3]| {
        let near = |pixel: &image::Rgb<u8>| {
            pixel.0.iter().zip(color).all(|(found, wanted)| found.abs_diff(wanted) <= 3)
        };
        (left..right).any(|x| (0..200).any(|y| near(picture.get_pixel(x, y))))
    };
    // The ends of viridis, in the scene and in the bar; ink in the bar alone.
    let (dark, bright) = ([68, 1, 84], [253, 231, 37]);
    assert!(
        has(0, 208, dark) && has(0, 208, bright) && has(208, 320, dark) && has(208, 320, bright)
    );
    assert!(has(208, 320, [39, 39, 39]) && !has(0, 208, [39, 39, 39]));
}

#[test]
fn several_days_are_summed_or_averaged() {
    let work = workplace();
    let days = "--until 2024-06-25 --every 2";
    let sum = work.run_quietly(&midsummer(&format!("{days} -o sum.csv"))).stdout;
    let mean = work.run_quietly(&midsummer(&format!("{days} --average -o mean.csv"))).stdout;
    assert!(line(&sum, "days").starts_with("2024-06-21 to 2024-06-25, 5 days, looked at every 2"));
    assert!(line(&sum, "lit").contains(" hours,") && line(&mean, "lit").contains(" hours/day,"));
    let (sum, mean) = (csv_hours(&work, "sum.csv"), csv_hours(&work, "mean.csv"));
    assert!(mean[2] > 16.5 && mean[2] < 17.0, "{mean:?}");
    assert!(sum.iter().zip(&mean).all(|(sum, mean)| (sum - 5.0 * mean).abs() < 1e-9));
}

#[test]
fn engines_and_threads_do_not_change_hours() {
    let work = Workplace::new();
    let study = format!("sun builtin:crowd {BERLIN} --date 2024-03-20 --step 120");
    let moving = format!("{study} --frames 0..99");
    work.run_quietly(&format!("{moving} -o a.csv --engine bvh --threads 1"));
    work.run_quietly(&format!("{moving} -o b.csv --engine subfields --threads 3"));
    assert_eq!(work.read("a.csv"), work.read("b.csv"));
    work.run_quietly(&format!("{study} -o still.csv"));
    assert!(work.read("a.csv") != work.read("still.csv"), "nothing moves");
}

#[test]
fn z_up_and_north_turn_the_scene_and_not_its_file() {
    let work = workplace();
    // The same house with z up: (x, y, z) becomes (x, -z, y).
    let z_up = "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\nf 1 2 3\nf 1 3 4\n\
                v -1 -1 2\nv 3 -1 2\nv 3 3 2\nf 5 6 7\n";
    work.write("z.obj", z_up);
    let turned = |options: &str| midsummer(options).replace("house", "z");
    work.run_quietly(&midsummer("-o y.csv --north 30"));
    work.run_quietly(&turned("-o z.csv --north 30 --up z"));
    work.run_quietly(&midsummer("-o unturned.csv"));
    let hours = csv_hours(&work, "y.csv");
    assert_eq!(csv_hours(&work, "z.csv"), hours);
    assert_ne!(csv_hours(&work, "unturned.csv"), hours, "north matters");
    // Files keep their own axes, and the framing camera stands upright in them.
    work.run_quietly(&midsummer("--picture y.png --north 30 --size 224x160"));
    work.run_quietly(&turned("--picture z.png --north 30 --up z --size 224x160"));
    let [y_up, z_up] =
        ["y.png", "z.png"].map(|name| image::open(work.path(name)).unwrap().into_rgb8());
    let far = y_up.iter().zip(z_up.iter()).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    assert!(far < y_up.len() / 200, "{far} of {} channels differ", y_up.len());
    let lines = String::from_utf8(work.read("z.csv")).unwrap();
    assert!(lines.lines().nth(3).is_some_and(|line| line.contains(",2.0,")), "{lines}");
}

#[test]
fn the_polar_night_is_a_result() {
    let work = workplace();
    let night = "sun house.obj --latitude 80 --longitude 15 --date 2024-12-21 -o n.csv -o n.npz \
                 -o n.ply --picture n.png";
    let run = work.run(night);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.starts_with("note: the sun is never above the horizon"), "{}", run.stderr);
    assert_eq!(csv_hours(&work, "n.csv"), [0.0; 3]);
    assert_eq!(line(&run.stdout, "lit"), "0.00 to 0.00 hours, mean 0.00");
    assert_eq!(ply_counts(&work, "n.ply"), [7, 3, 0]);
}

#[test]
fn triangles_without_area_are_told() {
    let work = Workplace::new();
    work.write("house.obj", "v 0 0 0\nv 1 0 0\nv 0 0 -1\nf 1 2 3\nf 1 2 2\n");
    let run = work.run(&midsummer("-o a.csv"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("frame 0: 1 of 2 primitives are ignored"), "{}", run.stderr);
    assert!(line(&run.stdout, "samples").contains("1 have no normal"), "{}", run.stdout);
    assert_eq!(csv_hours(&work, "a.csv")[1], 0.0);
}

#[test]
fn wrong_arguments_say_what_is_expected() {
    let work = workplace();
    for (option, expected) in [
        ("--latitude 91", ["91", "from -90 to 90"]),
        ("--longitude -180.5", ["-180.5", "from -180 to 180"]),
        ("--date 2024-02-30", ["2024-02-30", "such as 2024-06-21"]),
        ("--until 2024-06-20", ["--until 2024-06-20", "--date 2024-06-21"]),
        ("--every 0", ["--every", "1..=366"]),
        ("--step 0", ["--step", "1..=1440"]),
        ("--from 25:00", ["25:00", "00:00 to 24:00"]),
        ("--from 12:00 --to 12:00", ["--to 12:00", "--from 12:00"]),
        ("--utc-offset CET", ["CET", "+2 or -3:30"]),
        ("--up w", ["\"w\"", "x, y or z"]),
        ("--north 400", ["400", "from -360 to 360"]),
        ("--per edge", ["edge", "vertex"]),
        ("--sides back", ["back", "front"]),
        ("--engine warp", ["\"warp\"", "brute, hierarchy"]),
        ("--clip Dance", ["Dance", "no clip"]),
        ("--camera Nobody --picture x.png", ["Nobody", "no camera"]),
        ("-o x.xyz", ["x.xyz", ".ply, .npz or .csv"]),
        ("-o hours", ["\"hours\"", ".ply, .npz or .csv"]),
        ("--picture x.jpg", ["x.jpg", ".png"]),
        ("--picture x.png --size 100x50", ["100x50", "224x160"]),
    ] {
        // What comes later on the command line replaces what came before.
        let given = option.split(' ').next().unwrap_or_default();
        let words = midsummer("");
        let words: Vec<&str> = words.split_whitespace().collect();
        let kept = words.iter().position(|word| *word == given).map_or_else(
            || words.join(" "),
            |at| [&words[..at], &words[at + 2..]].concat().join(" "),
        );
        fails(&work, &format!("{kept} {option}"), 2, &expected);
    }
    fails(&work, "sun house.obj --date 2024-06-21", 2, &["--latitude", "--longitude"]);
}

#[test]
fn inputs_without_faces_are_errors() {
    let work = Workplace::new();
    work.write("empty.gltf", "{\"asset\": {\"version\": \"2.0\"}}");
    let study = format!("{BERLIN} --date 2024-06-21 -o x.csv");
    fails(&work, &format!("sun empty.gltf {study}"), 2, &["empty.gltf", "found no triangles"]);
    fails(&work, &format!("sun nothing.obj {study}"), 2, &["nothing.obj"]);
}

/// Files are frames, whatever the rate; faces must stay as many as they are.
#[test]
fn sequences_are_shared_out_over_the_day() {
    let work = workplace();
    std::fs::create_dir(work.path("walk")).unwrap();
    // The roof shades the floor in the morning; then it is far up.
    work.write("walk/1.obj", OBJ.replace("v -1 2", "v -1 200").replace("v 3 2", "v 3 200"));
    work.write("walk/2.obj", OBJ);
    let study = format!("sun walk {BERLIN} --date 2024-06-21 --frames 0..1 --step 30");
    for (rate, output) in [("", "a.csv"), ("--fps 7", "b.csv")] {
        let run = work.run(&format!("{study} {rate} -o {output}"));
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    assert_eq!(csv_hours(&work, "a.csv"), csv_hours(&work, "b.csv"));
    assert_eq!(work.run(&midsummer("--step 30 -o rest.csv")).code, 0);
    assert_ne!(csv_hours(&work, "a.csv"), csv_hours(&work, "rest.csv"), "the roof has moved");

    work.write("walk/2.obj", format!("{OBJ}f 1 2 4\n"));
    let expected = ["frame 1: found 4 faces, expected 3 as in the first frame"];
    fails(&work, &format!("{study} -o c.csv"), 2, &expected);
}

#[test]
fn unwritable_outputs_are_found_before_tracing() {
    let work = Workplace::new();
    // A year of a large scene, minute by minute, would take hours.
    let study = format!(
        "sun builtin:museum8 {BERLIN} --date 2024-01-01 --until 2024-01-10 --step 1 --engine brute"
    );
    for output in ["-o no/x.ply", "-o no/x.npz", "-o no/x.csv", "--picture no/x.png"] {
        fails(&work, &format!("{study} {output}"), 1, &["cannot write no/x."]);
    }
}

#[test]
fn help_teaches_axes_and_motion() {
    let help = Workplace::new().run_quietly("sun --help").stdout;
    for part in ["north is -z", "--frames A..B", "Examples:", "sun_hours", "Exit codes"] {
        assert!(help.contains(part), "{part} is not in {help}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_cleanly_and_writes_nothing() {
    let work = Workplace::new();
    // Enough faces and steps for minutes, and a triangle without area, of which the program tells
    // when it has begun to listen.
    let mut grid = String::new();
    for (row, column) in (0..40).flat_map(|row| (0..40).map(move |column| (row, column))) {
        writeln!(grid, "v {column} 0 -{row}").unwrap();
        if row > 0 && column > 0 {
            writeln!(grid, "f -1 -2 -42\nf -1 -42 -41").unwrap();
        }
    }
    work.write("house.obj", grid + "f 1 1 2\n");
    let study = midsummer("--until 2024-08-20 --every 1 --step 1 --engine brute -o a.csv");
    let mut child = work.command(&study).stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut told = String::new();
    while !told.contains("primitives are ignored") {
        assert!(stderr.read_line(&mut told).unwrap() > 0, "ended early: {told}");
    }

    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(signal.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    stderr.read_line(&mut told).unwrap();
    assert!(told.contains("stopped after ") && told.contains("nothing was written"), "{told}");
    assert_eq!(work.names(), ["house.obj"]);
}
