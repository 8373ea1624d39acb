"""Scenes from files, and pictures."""

import numpy as np
import pytest
import rayflock
from conftest import TRIANGLES, VERTICES, real_file

DOWN = [[0.25, 0.25, 2.0, 0.0, 0.0, -1.0]]


@pytest.fixture
def sequence(tmp_path):
    """A folder of three frames, in which a triangle rises and then is gone."""
    for frame, height in enumerate((0.0, 0.5)):
        corners = "".join(f"v {x} {y} {height}\n" for x, y in ((0, 0), (1, 0), (0, 1)))
        (tmp_path / f"scan_{frame}.obj").write_text(corners + "f 1 2 3\n")
    (tmp_path / "scan_2.obj").write_text("v 0 0 0\n")
    return tmp_path


def depth(scene):
    return float(scene.cast_rays(DOWN)["t_hit"][0])


def test_a_sequence_moves(sequence):
    scene = rayflock.load(sequence)
    source = scene.source
    assert (source.frame_count, source.frame_rate, source.time) == (3, 24.0, 0.0)
    depths = []
    for frame in range(source.frame_count):
        scene.evaluate(frame / source.frame_rate)
        depths.append(depth(scene))
    assert depths == [2.0, 1.5, np.inf]
    twin = scene.copy()
    twin.evaluate(0)
    assert (depth(twin), depth(scene)) == (2.0, np.inf)
    with pytest.warns(UserWarning, match="first of 3 numbered files"):
        between = rayflock.load(sequence / "scan_0.obj", interpolate=True, frame_rate=2)
    between.evaluate(0.25)
    assert depth(between) == 1.75


def test_objects_can_be_added_to_what_was_loaded(sequence):
    scene = rayflock.load(str(sequence))
    lid = scene.add(VERTICES + np.float32([0, 0, 1]), TRIANGLES)
    assert (lid, depth(scene)) == (1, 1.0)
    scene.evaluate(1 / 24)
    assert depth(scene) == 1.0
    scene.remove(lid)
    assert depth(scene) == 1.5
    for change in (lambda: scene.update(0, VERTICES), lambda: scene.remove(0)):
        with pytest.raises(ValueError, match="object 0 belongs to the file.*evaluate"):
            change()


def test_a_built_in_scene_moves():
    scene = rayflock.load("builtin:crowd")
    assert scene.source.frame_count > 1
    rays = rayflock.create_rays_spherical((0, 2, 6), 64, 32, forward=(0, 0, -1), up=(0, 1, 0))
    before = scene.cast_rays(rays)["t_hit"]
    scene.evaluate(1.0)
    assert (scene.cast_rays(rays)["t_hit"] != before).any()


def test_what_is_wrong_with_files_is_told(tmp_path, one_triangle):
    scene, _ = one_triangle
    with pytest.raises(ValueError, match="only scenes that were loaded"):
        scene.evaluate(1.0)
    with pytest.raises(ValueError, match="time must be finite"):
        scene.evaluate(np.nan)
    with pytest.raises(FileNotFoundError, match="nothing.glb"):
        rayflock.load(tmp_path / "nothing.glb")
    with pytest.raises(ValueError, match='no built-in scene is called "kettle"; there are: '):
        rayflock.load("builtin:kettle")
    with pytest.raises(ValueError, match="clip"):
        rayflock.load("builtin:cornell", clip="Run")
    with pytest.raises(ValueError, match='found "x", expected y or z'):
        rayflock.load("builtin:cornell", up="x")
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nf 1 2 9\n")
    with pytest.raises(ValueError, match=r"broken.obj: line 2.*expected"):
        rayflock.load(broken)
    with pytest.raises(TypeError):
        rayflock.load(3)
    odd = tmp_path / "odd.obj"
    odd.write_text("mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.warns(UserWarning, match="gone.mtl"):
        rayflock.load(odd)


def test_pictures_show_the_scene(one_triangle):
    scene, triangle = one_triangle
    view = {"width": 40, "height": 30, "eye": (0.3, 0.3, 2), "center": (0.3, 0.3, 0)}
    picture = rayflock.render(scene, **view)
    assert (picture.shape, picture.dtype) == ((30, 40, 3), np.uint8)
    black = rayflock.render(scene, **view, background=(0, 0, 0))
    covered = black.any(axis=2)
    assert covered[15, 20] and not covered[0, 0] and not covered[15, 39]
    # The right angle is below and left, as seen with +Y up: rows widen downward, to the right.
    assert covered[19].sum() > 2 * covered[6].sum() > 0
    assert not covered[:, :14].any() and covered[19, 26]
    scene.remove(triangle)
    assert not rayflock.render(scene, **view, background=(0, 0, 0)).any()
    linear = rayflock.render(scene, **view, background=(0.5, 2, 0), linear=True)
    assert linear.dtype == np.float32
    np.testing.assert_allclose(linear[3, 4], [0.5, 2, 0])


def test_pictures_of_files_are_those_of_every_engine():
    scene = rayflock.load("builtin:cornell")
    size = {"width": 48, "height": 36}
    picture = rayflock.render(scene, **size)
    assert picture.std() > 10
    for engine, threads in (("brute", 1), ("bvh", 2)):
        np.testing.assert_array_equal(
            rayflock.render(scene, **size, engine=engine, threads=threads), picture
        )
    scene.evaluate(2.0)
    assert (rayflock.render(scene, **size) != picture).any()


def test_notebooks_show_pictures(one_triangle, tmp_path):
    picture = rayflock.render(one_triangle[0], width=5, height=4)
    png = picture._repr_png_()
    assert png.startswith(b"\x89PNG") and png[16:24] == bytes([0, 0, 0, 5, 0, 0, 0, 4])
    picture.save(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes() == png
    assert picture[..., 0]._repr_png_() is None
    with pytest.raises(ValueError, match="only pictures of dtype uint8"):
        picture.astype(np.float32).save(tmp_path / "no.png")
    assert picture[1:3, ::2]._repr_png_().startswith(b"\x89PNG")


def test_wrong_options_of_pictures_are_told(one_triangle):
    scene, _ = one_triangle
    mistakes = [
        ({"width": 0}, ValueError, "must lie in 1..16384, found 0 x 360"),
        ({"width": 4, "height": 16385}, ValueError, "must lie in 1..16384, found 4 x 16385"),
        ({"height": 2.5}, TypeError, "height must be a whole number"),
        ({"camera": "Front"}, ValueError, 'no camera "Front"'),
        ({"eye": (0, 0, 1)}, TypeError, "both eye and center"),
        ({"eye": (0, 0, 1), "center": (0, 0, 1)}, ValueError, "parallel"),
        ({"eye": (0, 0, 1), "center": (0, 0, "x")}, TypeError, "center must hold numbers"),
        ({"tone_map": "film"}, ValueError, 'unknown tone map "film"'),
        ({"samples": 0}, ValueError, "samples must lie in"),
        ({"background": (1, 2)}, ValueError, "three finite numbers"),
        ({"engine": "gpu"}, ValueError, 'unknown engine "gpu"'),
    ]
    for options, kind, message in mistakes:
        with pytest.raises(kind, match=message):
            rayflock.render(scene, **options)
    with pytest.raises(TypeError, match="must be a rayflock.Scene"):
        rayflock.render(VERTICES)
    with pytest.raises(ValueError, match='"Top".*there are|camera'):
        rayflock.render(rayflock.load("builtin:cornell"), camera="Top")


@pytest.mark.filterwarnings("ignore:.*normals")
@pytest.mark.parametrize("name", ["CesiumMan.glb", "mannequiny.glb"])
def test_real_characters_deform(name):
    scene = rayflock.load(real_file(name))
    hits = []
    for time in (0.0, 0.4):
        scene.evaluate(time)
        rays = rayflock.create_rays_spherical((0, 1, 3), 96, 64, forward=(0, 0, -1), up=(0, 1, 0))
        hits.append(scene.cast_rays(rays)["t_hit"])
    assert np.isfinite(hits[0]).any() and (hits[0] != hits[1]).any()
