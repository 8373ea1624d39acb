use super::*;

fn changed(from: &str, to: &str) -> Result<Definition, BenchError> {
    assert!(MAP.contains(from), "the definition says {from}");
    Definition::parse(&MAP.replace(from, to), Path::new("my.toml"))
}

fn message(from: &str, to: &str) -> String {
    changed(from, to).unwrap_err().to_string()
}

#[test]
fn the_built_in_map_is_that_of_the_record() {
    let map = Definition::default_map();
    assert_eq!(map.triangles, [1 << 10, 1 << 14, 1 << 16, 1 << 18, 1 << 20]);
    assert_eq!(map.rays, [1 << 12, 1 << 16, 1 << 18, 1 << 20]);
    assert_eq!(map.kinds, RayKind::DEFAULT);
    let names: Vec<_> = map.phases.iter().map(|phase| &phase.name[..]).collect();
    assert_eq!(names, ["cloud", "sphere"]);
    for phase in &map.phases {
        assert!(
            phase.frames.iter().all(|frame| (0.0..=1.0).contains(&(frame - phase.before - 32.0)))
        );
    }
    assert_eq!(map.text(), MAP);
}

#[test]
fn a_file_is_read_and_may_say_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.toml");
    let triangles = r#"triangles = ["1K", "16K", "64K", "256K", "1M"]"#;
    fs::write(&path, MAP.replace(triangles, r#"triangles = [100, "2k"]"#)).unwrap();
    assert_eq!(Definition::read(&path).unwrap().triangles, [100, 2048]);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = Definition::read(Path::new("no/such.toml")).unwrap_err();
    assert_eq!(error.to_string(), "no/such.toml: cannot be read");
}

#[test]
fn what_is_not_known_or_missing_is_refused() {
    let unknown = message("skylight = 12", "skylight = 12\nwindows = 3");
    assert!(unknown.starts_with("my.toml: ") && unknown.contains("windows"), "{unknown}");
    let unknown = message("seed = ", "sead = ");
    assert!(unknown.contains("sead"), "{unknown}");
    let missing = message("skylight = 12", "");
    assert!(missing.contains("skylight"), "{missing}");
    let form = message("skylight = 12", "skylight = 'large'");
    assert!(form.contains("skylight = 'large'"), "{form}");
}

#[test]
fn wrong_entries_of_lists_are_named_with_their_place() {
    assert_eq!(
        message("\"64K\", \"256K\", \"1M\"]\n# There", "\"64X\"]\n# There"),
        "my.toml: rays[1]: found \"64X\", expected a whole number above 0, or text like \"64K\" \
         or \"1M\""
    );
    let negative = message("triangles = [\"1K\"", "triangles = [-3");
    assert!(negative.starts_with("my.toml: triangles[0]: found -3, expected"), "{negative}");
    let kind = message("\"mirror\"", "\"mirrow\"");
    assert!(kind.starts_with("my.toml: kinds[3]: found \"mirrow\", expected one of primary, "));
}

#[test]
fn values_that_cannot_be_measured_are_refused() {
    for (from, to, expected) in [
        (
            "kinds = [\"primary\", \"pointshadow\", \"dirshadow\", \"mirror\", \"diffuse\"]",
            "kinds = []",
            "kinds: found []",
        ),
        ("triangles = [\"1K\"", "triangles = [\"300M\"", "triangles[0]: found 314572800"),
        ("frames = [64.0, 64.25]", "frames = []", "phases[1].frames: found []"),
        ("before = 32.0", "before = nan", "phases[1].before: found NaN"),
        ("name = \"cloud\"", "name = \"\"", "phases[0].name: found \"\""),
        ("skylight = 12", "skylight = 11", "room.skylight: found 11"),
        ("skylight = 12", "skylight = 34", "room.skylight: found 34"),
        ("cells = [32,", "cells = [0,", "room.cells: found [0, 24, 32]"),
        ("size = [10.0,", "size = [-10.0,", "room.size: found [-10.0, 7.5, 10.0]"),
        ("area = 60.0", "area = 0", "shapes.area: found 0.0"),
        ("frames_apart = 32.0", "frames_apart = 0", "shapes.frames_apart: found 0.0"),
        (
            "vertical_fov_degrees = ",
            "vertical_fov_degrees = 3",
            "camera.vertical_fov_degrees: found 3",
        ),
        ("target = [", "target = [inf, 0, 0] # ", "camera.target: found [inf, 0.0, 0.0]"),
        ("to_sun = [", "to_sun = [0, 0, 0] # ", "lights.to_sun: found [0.0, 0.0, 0.0]"),
        ("offset = ", "offset = -", "secondary.offset: found -"),
        ("shadow_end = 0", "shadow_end = 1", "secondary.shadow_end: found 1."),
        ("ao_reach = ", "ao_reach = -", "secondary.ao_reach: found -"),
        ("elevation_degrees = [-", "elevation_degrees = [9", "lidar.elevation_degrees: found [9"),
    ] {
        let found = message(from, to);
        assert!(found.starts_with(&format!("my.toml: {expected}")), "{found}");
        assert!(found.contains(", expected "), "{found}");
    }
}

#[test]
fn the_camera_looks_from_its_position_at_its_target_upright() {
    let camera = Definition::default_map().camera;
    let view = camera.view();
    let (position, target) = (Vec3::from(camera.position), Vec3::from(camera.target));
    assert_eq!(Vec3::from(view.world_from_camera.translation), position);
    let axis = |v| view.world_from_camera.transform_vector3(v);
    assert!(axis(-Vec3::Z).abs_diff_eq((target - position).normalize(), 1e-6));
    assert!(axis(Vec3::X).y.abs() < 1e-6 && axis(Vec3::Y).y > 0.0);
}
