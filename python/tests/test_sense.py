"""LiDAR and depth cameras."""

import numpy as np
import pytest
import rayflock
from conftest import TRIANGLES, VERTICES

# A square of 200 x 200 around the z axis.
SQUARE = np.float32([[-100, -100, 0], [100, -100, 0], [100, 100, 0], [-100, 100, 0]])
HALVES = np.uint32([[0, 1, 2], [0, 2, 3]])
HERE = (0, 0, 0)


@pytest.fixture
def wall():
    """A scene with a wall at z = -5 of which the id is not its place, and the id."""
    scene = rayflock.Scene()
    scene.remove(scene.add(VERTICES, TRIANGLES))
    return scene, scene.add(SQUARE - np.float32([0, 0, 5]), HALVES)


@pytest.fixture
def receding(tmp_path):
    """A wall that goes from z = -5 at 0 s to z = -6 at 1 s."""
    for frame in range(2):
        corners = "".join(f"v {x} {y} {-5 - frame}\n" for x, y, _ in SQUARE)
        (tmp_path / f"wall_{frame}.obj").write_text(corners + "f 1 2 3\nf 1 3 4\n")
    return rayflock.load(tmp_path, interpolate=True, frame_rate=1)


def test_a_depth_camera_measures_a_wall(wall):
    scene, wall_id = wall
    camera = rayflock.Sensor("depth", at=HERE, size=(24, 16), fov=np.rad2deg(2 * np.arctan(1)))
    sweep = scene.sense(camera)
    assert len(sweep) == camera.beam_count == 24 * 16
    # The picture is 2 high at distance 1, and 3 wide.
    columns, rows = (np.arange(24) + 0.5) / 24, (np.arange(16) + 0.5) / 16
    x, y = np.meshgrid(3 * (columns - 0.5), 2 * (0.5 - rows))
    expected = 5 * np.stack([x, y, -np.ones_like(x)], axis=-1)
    np.testing.assert_allclose(sweep.image(sweep.position, 0), expected, atol=1e-4)
    distance = np.linalg.norm(expected, axis=-1)
    np.testing.assert_allclose(sweep.range_image, distance, rtol=1e-5)
    np.testing.assert_allclose(sweep.depth_image, 5, rtol=1e-5)
    # Lambert over the range squared.
    intensity = 0.7 * (5 / distance) / distance**2
    np.testing.assert_allclose(sweep.intensity_image, intensity, rtol=1e-4)
    assert (sweep.object_id == wall_id).all() and wall_id == 1
    assert set(sweep.prim_id) == {0, 1}
    assert (sweep.normal == (0, 0, 1)).all() and (sweep.time == 0).all()
    assert (sweep.return_number == 1).all() and (sweep.return_count == 1).all()
    np.testing.assert_array_equal(sweep.beam, 24 * sweep.row + sweep.column)


def test_arrays_have_their_types_and_shapes(wall):
    sweep = wall[0].sense(rayflock.Sensor("spinning:16", at=HERE, columns=32))
    count = len(sweep)
    assert 0 < count < 16 * 32  # half of it looks away
    for name in ("position", "position_in_sensor", "normal"):
        array = getattr(sweep, name)
        assert (array.shape, array.dtype) == ((count, 3), np.float32), name
    kinds = {
        np.float32: ("range", "intensity"),
        np.float64: ("time",),
        np.uint32: ("object_id", "prim_id", "beam", "row", "column"),
        np.uint8: ("return_number", "return_count"),
    }
    for dtype, names in kinds.items():
        for name in names:
            array = getattr(sweep, name)
            assert (array.shape, array.dtype) == ((count,), dtype), name
    assert (sweep.step_time.shape, sweep.step_time.dtype) == ((32,), np.float64)
    poses = sweep.world_from_sensor
    assert (poses.shape, poses.dtype) == ((32, 4, 4), np.float32)
    assert sweep.row.max() == 15 and np.isinf(sweep.range_image[:, 0]).all()


def test_points_lie_on_the_wall_where_it_is_at_their_own_time(receding):
    options = {"at": HERE, "size": (8, 50), "fov": (20, 20), "rate": 1.25}
    sweep = receding.sense(rayflock.Sensor("solid-state", **options))
    np.testing.assert_allclose(sweep.time, sweep.row * 0.016, atol=1e-9)
    np.testing.assert_allclose(sweep.position[:, 2], -5 - sweep.time, rtol=1e-5)
    frozen = receding.sense(rayflock.Sensor("solid-state", **options, time_steps=1))
    np.testing.assert_allclose(frozen.position[:, 2], -5 - 0.8 * 0.49, rtol=1e-5)
    assert np.abs(frozen.position - sweep.position).max() > 0.3
    # The scene itself has not moved, and says when a sweep begins.
    assert receding.source.time == 0.0
    receding.evaluate(0.1)
    later = receding.sense(rayflock.Sensor("solid-state", **options))
    assert later.time.min() == 0.1
    again = receding.sense(rayflock.Sensor("solid-state", **options), time=0.0)
    np.testing.assert_array_equal(again.position, sweep.position)


def test_what_was_added_stands_in_front_of_what_was_loaded(receding):
    receding.remove(receding.add(VERTICES, TRIANGLES))
    pane = receding.add(SQUARE[:3] - np.float32([0, 0, 2]), TRIANGLES)
    sweep = receding.sense(rayflock.Sensor("depth", at=HERE, size=(16, 16)), time=0.5)
    is_pane = sweep.object_id == pane
    assert pane == 2 and set(sweep.object_id) == {0, pane}
    np.testing.assert_allclose(sweep.depth[is_pane], 2, rtol=1e-5)
    np.testing.assert_allclose(sweep.depth[~is_pane], 5.5, rtol=1e-5)


def test_a_sensor_moves_along_poses(wall):
    poses = [(0, (0, 0, 0), (0, 0, -9)), (0.1, (1, 0, 1), (1, 0, -9))]
    sweep = wall[0].sense(rayflock.Sensor("solid-state", poses=poses, size=(4, 10), fov=(9, 9)))
    places = sweep.world_from_sensor[sweep.row]
    np.testing.assert_allclose(places[:, 0, 3], 10 * sweep.time, atol=1e-6)
    moved = (places[:, :3, :3] @ sweep.position_in_sensor[..., None])[..., 0] + places[:, :3, 3]
    np.testing.assert_allclose(moved, sweep.position, atol=1e-5)
    np.testing.assert_allclose(sweep.position[:, 2], -5, atol=1e-5)
    np.testing.assert_allclose(sweep.depth, 5 + 10 * sweep.time, rtol=1e-5)


def test_a_pose_may_be_a_matrix(wall):
    place = np.eye(4)
    place[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # its +X is +Y of the world
    place[:3, 3] = (3, 4, 0)
    sweep = wall[0].sense(rayflock.Sensor("ortho", at=place, size=(2, 1), extent=(2, 2)))
    np.testing.assert_allclose(sweep.position, [[3, 3.5, -5], [3, 4.5, -5]], atol=1e-5)
    np.testing.assert_allclose(sweep.world_from_sensor, [place], atol=1e-6)
    keyed = rayflock.Sensor("ortho", poses=[(0, place)], size=(2, 1), extent=(2, 2))
    np.testing.assert_array_equal(wall[0].sense(keyed).position, sweep.position)


PRESETS = {
    "spinning:16": ((16, 1024), 10, 1024),
    "spinning:128": ((128, 1024), 10, 1024),
    "solid-state": ((100, 600), 10, 100),
    "rosette": (None, 10, 375),
    "depth": ((480, 640), 30, 1),
    "ortho": ((512, 512), 10, 1),
}


@pytest.mark.parametrize("name", PRESETS)
def test_presets_go_by_name(name):
    sensor = rayflock.Sensor(name)
    assert (sensor.shape, sensor.rate, sensor.time_steps) == PRESETS[name]
    assert name in repr(sensor) and f"{sensor.beam_count:,} beams" in repr(sensor)


def test_no_point_depends_on_engine_or_threads():
    scene = rayflock.load("builtin:crowd")
    sensor = rayflock.Sensor("spinning:16", columns=60, at=(2, 1.4, 0.6), noise=0.01, time_steps=6)
    sweep = scene.sense(sensor, time=0.3)
    assert len(sweep) > 300 and 0.3 <= sweep.time.min() < sweep.time.max() < 0.4
    for engine, threads in (("bvh", 1), ("hierarchy", 2)):
        other = scene.sense(sensor, time=0.3, engine=engine, threads=threads)
        for name in ("position", "range", "object_id", "prim_id", "time", "beam"):
            np.testing.assert_array_equal(getattr(other, name), getattr(sweep, name))
    still = scene.sense(sensor, time=1.3)
    assert len(still) != len(sweep) or (still.range != sweep.range).any()


def test_a_sensor_is_on_the_camera_of_the_file():
    scene = rayflock.load("builtin:crowd")
    name = scene.source.cameras[0]
    small = {"size": (32, 18), "max_range": 25}
    sweeps = [
        scene.sense(rayflock.Sensor("depth", **small, **place)) for place in ({}, {"camera": name})
    ]
    np.testing.assert_array_equal(sweeps[0].position, sweeps[1].position)
    assert 0 < len(sweeps[0]) and sweeps[0].range.max() <= 25
    with pytest.raises(ValueError, match='"Top"'):
        scene.sense(rayflock.Sensor("depth", camera="Top"))


def test_a_scene_without_cameras_is_in_view(one_triangle):
    scene, triangle = one_triangle
    sweep = scene.sense(rayflock.Sensor("depth", size=(64, 64)))
    assert len(sweep) > 50 and (sweep.object_id == triangle).all()
    assert (sweep.row > 0).all() and (sweep.row < 63).all()
    with pytest.raises(ValueError, match='no camera "Front": the scene was not loaded'):
        scene.sense(rayflock.Sensor("depth", camera="Front"))
    assert len(rayflock.Scene().sense("spinning:16")) == 0


def test_noise_and_drop_outs_are_chosen_by_the_seed(wall):
    def sweep(**options):
        return wall[0].sense(
            rayflock.Sensor("ortho", at=HERE, size=(100, 100), extent=(10, 10), **options)
        )

    noisy = sweep(noise=0.1, seed=3)
    # Five standard errors.
    assert abs(noisy.range.mean() - 5) < 5e-3 and abs(noisy.range.std() - 0.1) < 4e-3
    np.testing.assert_array_equal(noisy.range, sweep(noise=0.1, seed=3).range)
    assert (noisy.range != sweep(noise=0.1, seed=4).range).any()
    assert abs(len(sweep(drop_out=0.3)) - 7000) < 250
    assert len(sweep(min_range=5.5)) == len(sweep(max_range=4)) == 0


def test_files_of_the_program_say_what_a_sensor_is(wall, tmp_path):
    file = tmp_path / "lidar.toml"
    file.write_text(
        'sensor = "spinning:32"\nelevations = "10..-10"\nrows = 5\ncolumns = 100\nrate = 20\n'
        'max-range = 100\nreturns = "first+last"\nat = "0,0,1"\nlook-at = [0, 0, -9]\n'
    )
    options = {"elevations": [10, 5, 0, -5, -10], "columns": 100, "rate": 20, "max_range": 100}
    expected = rayflock.Sensor("spinning:32", **options, at=(0, 0, 1))
    sweeps = [wall[0].sense(sensor) for sensor in (file, expected)]
    assert sweeps[0].shape == (5, 100) and rayflock.Sensor(file).rate == 20
    np.testing.assert_allclose(sweeps[0].position, sweeps[1].position, atol=1e-5)
    nearer = rayflock.Sensor(file, columns=50, poses=[(0, (0, 0, -1))])
    assert nearer.shape == (5, 50)
    assert wall[0].sense(nearer).depth.min() == pytest.approx(4, rel=1e-5)

    file.write_text(
        'sensor = "depth"\nsize = "8x6"\n[[pose]]\ntime = 0\nat = [0, 0, 0]\n'
        "[[pose]]\ntime = 1\nat = [0, 0, 2]\nlook-at = [0, 0, 0]\n"
    )
    assert wall[0].sense(file, time=0.5).depth_image.shape == (6, 8)
    for text, message in [
        ("sensor = 3", "name of a preset"),
        ('sensor = "depth"\nsize = "8"', r"lidar.toml: size must be 2 finite numbers, found '8'"),
        ('sensor = "depth"\nmax_range = 3', "found the key max_range, expected one of pose, at"),
        ('sensor = "depth"\n[[pose]]\nat = [0, 0, 0]', "expected time and at"),
        ("sensor = = 3", "lidar.toml: .*line 1"),
    ]:
        file.write_text(text)
        with pytest.raises(ValueError, match=message):
            rayflock.Sensor(file)
    with pytest.raises(FileNotFoundError):
        rayflock.Sensor("gone.toml")


MISTAKES = [
    ("lidar", {}, ValueError, 'unknown sensor "lidar"; there are: spinning:16'),
    (3, {}, TypeError, "name of a preset or the path of a TOML file, found int"),
    ("depth", {"rows": 3}, TypeError, "rows says nothing about the sensor depth, which has size"),
    ("depth", {"fov": (40, 30)}, ValueError, "the fov is 40 x 30 degrees, expected one angle"),
    ("solid-state", {"fov": 30}, ValueError, "two angles, across and up"),
    ("depth", {"fov": 180}, ValueError, "field of view is 180.*expected above 0"),
    ("depth", {"size": (0, 4)}, ValueError, r"size must be two whole numbers in 1..16384"),
    ("depth", {"size": 4}, ValueError, "size must be 2 finite numbers, found 4"),
    ("depth", {"shutter": "open"}, ValueError, 'unknown shutter "open"; there are: global'),
    ("depth", {"time_steps": 2}, ValueError, "time steps is 2, expected 1, for all beams"),
    ("spinning:16", {"time_steps": 0}, ValueError, "time_steps must lie in 1"),
    ("spinning:16", {"columns": 2.5}, TypeError, "columns must be a whole number"),
    ("spinning:16", {"elevations": [95]}, ValueError, "elevation of a row is 95.*expected -90 to"),
    ("spinning:16", {"elevations": [1, 2], "rows": 3}, ValueError, "number of rows is 3, expected 2"),
    ("spinning:16", {"elevations": []}, ValueError, "elevations must be some finite numbers"),
    ("spinning:16", {"rate": 0}, ValueError, "the rate is 0, expected 0.001 to"),
    ("spinning:16", {"rate": "10"}, TypeError, "rate must be one number, found '10'"),
    ("spinning:16", {"noise": -1}, ValueError, "the noise is -1, expected 0 or more"),
    ("spinning:16", {"min_range": np.nan}, ValueError, "least range is NaN"),
    ("spinning:16", {"drop_out": 1.5}, ValueError, "drop-out is 1.5, expected 0 to 1"),
    ("spinning:16", {"returns": "dual"}, ValueError, 'unknown returns "dual"; there are: first,'),
    ("spinning:16", {"returns": 2}, TypeError, "returns must be text"),
    ("spinning:16", {"seed": -1}, ValueError, "seed must lie in 0"),
    ("spinning:16", {"at": (0, 0)}, ValueError, "at must be 3 finite numbers"),
    ("spinning:16", {"at": 2 * np.eye(4)}, ValueError, "at must be a pose.*neither scales"),
    ("spinning:16", {"at": np.eye(4), "look_at": HERE}, TypeError, "leave look_at out"),
    ("spinning:16", {"look_at": HERE}, TypeError, "give at, too"),
    ("spinning:16", {"at": HERE, "camera": "Top"}, TypeError, "give either at or camera"),
    ("spinning:16", {"poses": [HERE[:1]]}, ValueError, r"list of \(time, at\) or"),
    ("spinning:16", {"poses": 3}, TypeError, r"list of \(time, at\) or"),
    ("spinning:16", {"poses": [(1, HERE), (1, HERE)]}, ValueError, "is 1, expected more than 1"),
]


@pytest.mark.parametrize("mistake", MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_are_told(mistake):
    sensor, options, kind, message = mistake
    with pytest.raises(kind, match=message):
        rayflock.Sensor(sensor, **options)


def test_mistakes_of_sweeps_are_told(wall):
    scene = wall[0]
    small = rayflock.Sensor("rosette", at=HERE, beams=100)
    for options, kind, message in [
        ({"time": np.nan}, ValueError, "time must be finite"),
        ({"engine": "embree"}, ValueError, 'unknown engine "embree"'),
        ({"threads": 0}, ValueError, "threads must lie in"),
    ]:
        with pytest.raises(kind, match=message):
            scene.sense(small, **options)
    sweep = scene.sense(small)
    assert sweep.shape is None and sweep._repr_png_() is None
    with pytest.raises(ValueError, match="rosette make no picture"):
        _ = sweep.range_image
    picture = scene.sense(rayflock.Sensor("depth", at=HERE, size=(4, 3)))
    with pytest.raises(ValueError, match=r"values must have shape \(12, ...\)"):
        picture.image(np.zeros(3), 0)
    with pytest.raises(ValueError, match="show must be range, depth or intensity"):
        picture.picture("color")


def test_notebooks_show_ranges_in_colours(wall):
    sweep = wall[0].sense(rayflock.Sensor("spinning:16", at=HERE, columns=16))
    picture = sweep.picture()
    assert (picture.shape, picture.dtype) == ((16, 16, 3), np.uint8)
    assert (picture[np.isinf(sweep.range_image)] == 243).all()
    ranges = np.where(np.isinf(sweep.range_image), np.nan, sweep.range_image)
    nearest, farthest = (
        picture[np.unravel_index(find(ranges), ranges.shape)].astype(int)
        for find in (np.nanargmin, np.nanargmax)
    )
    # Viridis goes from dark blue to yellow.
    assert nearest.sum() < 200 < 300 < farthest[:2].sum() and farthest[2] < 100
    assert (sweep.picture("intensity") != picture).any()
    assert sweep._repr_png_() == picture._repr_png_()
    one_color = wall[0].sense(rayflock.Sensor("ortho", at=HERE, size=(1, 1))).picture()
    assert len(np.unique(one_color.reshape(-1, 3), axis=0)) == 1
