"""Points of sweeps: where they lie, and the files that hold them."""

import dataclasses

import numpy as np
import pytest
import rayflock
from conftest import real_file


@pytest.fixture(scope="module")
def sweep():
    """A sweep over objects of a file and one that was added, with noise."""
    scene = rayflock.load("builtin:crowd")
    scene.add_spheres([[2, 1.4, -1.5]], 0.5)
    sensor = rayflock.Sensor(
        "spinning:16", at=(2, 1.4, 0.6), columns=40, noise=0.01, time_steps=4
    )
    return scene.sense(sensor)


def errors_at(scene, sweep, times):
    """How far each point is from the first surface on its beam, relative to its range, where the
    scene is as it is at ``times``."""
    errors = np.empty(len(sweep))
    for time in np.unique(times):
        scene.evaluate(time)
        is_now = times == time
        step = np.searchsorted(sweep.step_time, sweep.time[is_now])
        origins = sweep.world_from_sensor[step, :3, 3]
        rays = np.concatenate([origins, sweep.position[is_now] - origins], axis=1)
        # The point itself is at 1; all rays are tested against all triangles.
        errors[is_now] = np.abs(scene.cast_rays(rays, engine="brute")["t_hit"] - 1)
    return errors


@pytest.mark.filterwarnings("ignore:.*normals")
def test_points_on_cesium_man_lie_where_he_is_at_their_own_time():
    scene = rayflock.load(real_file("CesiumMan.glb"))
    # From within him, so that many beams meet him.
    sensor = rayflock.Sensor(
        "spinning:32", at=(0, 0.9, 0), look_at=(1, 0.9, 0), columns=64, rate=2
    )
    sweep = scene.sense(sensor, time=0.2)
    assert len(sweep) > 500 and len(np.unique(sweep.time)) > 32
    assert errors_at(scene, sweep, sweep.time).max() < 1e-5
    # The same in a frozen scene: this test can fail.
    frozen = errors_at(scene, sweep, np.full_like(sweep.time, 0.2))
    assert np.count_nonzero(frozen > 1e-3) > 100


def test_files_of_points_hold_what_the_arrays_do(sweep, tmp_path):
    assert len(sweep) > 200
    points = {
        ("x", "y", "z"): sweep.position,
        ("nx", "ny", "nz"): sweep.normal,
        ("x_sensor", "y_sensor", "z_sensor"): sweep.position_in_sensor,
        ("range",): sweep.range[:, None],
        ("intensity",): sweep.intensity[:, None],
        ("time",): sweep.time[:, None],
        ("object",): sweep.object_id[:, None],
        ("primitive",): sweep.prim_id[:, None],
        ("row",): sweep.row[:, None],
        ("column",): sweep.column[:, None],
        ("return_number",): sweep.return_number[:, None],
        ("return_count",): sweep.return_count[:, None],
    }
    for read, name in ((read_ply, "a.ply"), (read_csv, "a.CSV")):
        sweep.save(tmp_path / name)
        found = read(tmp_path / name)
        for names, expected in points.items():
            for column, values in zip(names, expected.T, strict=True):
                np.testing.assert_array_equal(found[column].astype(values.dtype), values)
    sweep.save(tmp_path / "a.pcd")
    found = read_pcd(tmp_path / "a.pcd")
    for name, expected in (("x", sweep.position[:, 0]), ("time", sweep.time), ("ring", sweep.row)):
        np.testing.assert_array_equal(found[name], expected)
    np.testing.assert_array_equal(found["normal_z"], sweep.normal[:, 2])


def test_ply_is_coloured_by_range(sweep, tmp_path):
    sweep.save(str(tmp_path / "a.ply"))
    found = read_ply(tmp_path / "a.ply")
    near, far = np.argmin(sweep.range), np.argmax(sweep.range)
    # Viridis goes from dark blue to yellow.
    assert found["red"][near] < 90 and found["green"][near] < 30 < found["blue"][near]
    assert found["red"][far] > 240 > 90 > found["blue"][far]


def test_npz_holds_arrays_by_their_names(sweep, tmp_path):
    sweep.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as arrays:
        for field in dataclasses.fields(sweep):
            if field.name == "shape":
                continue
            expected = getattr(sweep, field.name)
            assert arrays[field.name].dtype == expected.dtype, field.name
            np.testing.assert_array_equal(arrays[field.name], expected)
        for name in ("range_image", "depth_image", "intensity_image"):
            np.testing.assert_array_equal(arrays[name], getattr(sweep, name))


def test_some_points_of_a_sweep_can_be_kept(sweep, tmp_path):
    is_near = sweep.range < 5
    names = [name for name in vars(sweep) if len(getattr(sweep, name)) == len(sweep)]
    near = dataclasses.replace(sweep, **{name: getattr(sweep, name)[is_near] for name in names})
    near.save(tmp_path / "near.ply")
    assert 0 < len(read_ply(tmp_path / "near.ply")) == len(near) < len(sweep)
    broken = dataclasses.replace(sweep, normal=sweep.normal[1:])
    with pytest.raises(ValueError, match="normal has .* entries, expected"):
        broken.save(tmp_path / "broken.ply")


def test_what_is_wrong_with_names_is_told(sweep, tmp_path):
    for name in ("scan.las", "scan", "ply"):
        with pytest.raises(ValueError, match=f"{name}.: expected a .ply, .pcd, .npz or .csv"):
            sweep.save(tmp_path / name)
    with pytest.raises(FileNotFoundError, match="cannot write .*gone"):
        sweep.save(tmp_path / "gone" / "scan.ply")
    with pytest.raises(TypeError):
        sweep.save(3)
    assert not list(tmp_path.iterdir())


def read_ply(path):
    kinds = {"float": "<f4", "double": "<f8", "uint": "<u4", "uchar": "u1"}
    head, body = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    fields = [(line[2], kinds[line[1]]) for line in lines if line[0] == "property"]
    return np.frombuffer(body, fields)


def read_pcd(path):
    head, body = path.read_bytes().split(b"DATA binary\n", 1)
    lines = dict(line.split(" ", 1) for line in head.decode().splitlines() if line[0] != "#")
    columns = (lines[key].split() for key in ("FIELDS", "TYPE", "SIZE"))
    return np.frombuffer(body, [(n, f"<{kind.lower()}{size}") for n, kind, size in zip(*columns)])


def read_csv(path):
    with open(path) as file:
        names = file.readline().strip().split(",")
    return np.loadtxt(path, [(name, np.float64) for name in names], delimiter=",", skiprows=1)
