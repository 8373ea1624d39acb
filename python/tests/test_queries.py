"""Forms of rays, and what is told about them."""

import numpy as np
import pytest
import rayflock
from conftest import random_rays, soup, sphere_mesh


@pytest.fixture
def crowd(rng):
    """A scene of some hundred triangles in two objects."""
    scene = rayflock.Scene()
    for _ in range(2):
        scene.add(*soup(rng, 300))
    return scene


def assert_same(a, b):
    assert set(a) == set(b)
    for name in a:
        np.testing.assert_array_equal(a[name].reshape(b[name].shape), b[name])


def test_shapes_follow_the_rays(crowd, rng):
    rays = random_rays(rng, 24)
    flat = crowd.cast_rays(rays)
    for shape in ((24,), (4, 6), (2, 3, 4)):
        hits = crowd.cast_rays(rays.reshape(*shape, 6))
        assert hits["t_hit"].shape == shape
        assert hits["primitive_uvs"].shape == (*shape, 2)
        assert_same(hits, flat)
        assert crowd.test_occlusions(rays.reshape(*shape, 6)).shape == shape
    assert crowd.cast_rays(rays[0])["t_hit"].shape == ()
    assert crowd.cast_rays(rays[:0])["primitive_normals"].shape == (0, 3)
    dtypes = {name: array.dtype.name for name, array in flat.items()}
    assert dtypes == {
        "t_hit": "float32",
        "geometry_ids": "uint32",
        "primitive_ids": "uint32",
        "primitive_uvs": "float32",
        "primitive_normals": "float32",
    }


def test_origins_and_directions_may_be_shared(crowd, rng):
    rays = random_rays(rng, 300)
    both = crowd.cast_rays(origin=rays[:, :3], direction=rays[:, 3:])
    assert_same(both, crowd.cast_rays(rays))
    camera = np.float32([0, 0, 3])
    aims = rays[:, 3:]
    rays[:, :3] = camera
    assert_same(crowd.cast_rays(origin=camera, direction=aims), crowd.cast_rays(rays))
    rays[:, :3], rays[:, 3:] = rng.uniform(-1, 1, (300, 3)) + [0, 0, 3], [0.1, 0, -1]
    sun = crowd.cast_rays(origin=rays[:, :3].reshape(3, 100, 3), direction=(0.1, 0, -1))
    assert sun["t_hit"].shape == (3, 100)
    assert_same(sun, crowd.cast_rays(rays))
    assert np.isfinite(sun["t_hit"]).any()
    assert crowd.cast_rays(origin=(0, 0, 3), direction=(0, 0, -1))["t_hit"].shape == ()


def test_rays_that_share_an_origin_are_found_out(crowd, rng):
    rays = crowd.create_rays_pinhole(60, [0, 0, 0], [0, 0, 4], [0, 1, 0], 64, 48)
    crowd.cast_rays(rays)
    assert "from one point" in crowd.stats.reason
    crowd.cast_rays(random_rays(rng, 100))
    assert "in no order" in crowd.stats.reason


def test_other_types_are_converted(crowd, rng):
    rays = random_rays(rng, 100)
    expected = crowd.cast_rays(rays)
    wide = np.zeros((200, 8), np.float32)
    wide[::2, 1:7] = rays
    for same in (
        rays.astype(np.float64),
        np.asfortranarray(rays),
        wide[::2, 1:7],
        rays.tolist(),
        rays.astype(">f4"),
    ):
        assert_same(crowd.cast_rays(same), expected)


def test_intervals_limit_rays_in_lengths_of_their_directions(one_triangle):
    scene, _ = one_triangle
    ray = [0.25, 0.25, 2.0, 0.0, 0.0, -0.5]
    rays = np.float32([ray] * 4)
    t_min, t_max = [0, 4, 4.5, 0], [4, 5, 9, 3.5]
    assert scene.cast_rays(rays, t_min=t_min, t_max=t_max)["t_hit"].tolist() == [
        4,
        4,
        np.inf,
        np.inf,
    ]
    assert scene.test_occlusions(rays, t_min=t_min, t_max=t_max).tolist() == [
        True,
        True,
        False,
        False,
    ]
    assert scene.count_intersections(rays, t_max=3.5).tolist() == [0] * 4
    assert not scene.test_occlusions([ray], t_min=np.float64(4.5)).any()


def test_occlusions_are_hits(crowd, rng):
    rays = random_rays(rng, 1000)
    hit = np.isfinite(crowd.cast_rays(rays)["t_hit"])
    np.testing.assert_array_equal(crowd.test_occlusions(rays), hit)
    assert hit.any() and not hit.all()


def test_hits_lie_on_triangles_and_normals_stand_on_them(rng):
    vertices, triangles = soup(rng, 400)
    scene = rayflock.Scene()
    scene.add(vertices, triangles)
    rays = random_rays(rng, 1000)
    hits = scene.cast_rays(rays)
    hit = hits["geometry_ids"] != rayflock.INVALID_ID
    corners = vertices[triangles[hits["primitive_ids"][hit]]]
    u, v = hits["primitive_uvs"][hit].T[:, :, None]
    on_triangle = (1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2]
    on_ray = rays[hit, :3] + hits["t_hit"][hit, None] * rays[hit, 3:]
    assert np.abs(on_triangle - on_ray).max() < 1e-5
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.abs(hits["primitive_normals"][hit] - normals).max() < 1e-4
    assert not hits["primitive_normals"][~hit].any()
    assert (hits["primitive_ids"][~hit] == rayflock.INVALID_ID).all()


def test_every_crossing_of_a_surface_is_listed_once(rng):
    scene = rayflock.Scene()
    outer = scene.add(*sphere_mesh())
    inner = scene.add(*sphere_mesh(radius=0.5))
    # Through the middle, off all edges; through vertices and edges; past everything.
    rays = np.float32(
        [[0.01, 0.02, 3, 0, 0, -1], [0, 0, 3, 0, 0, -1], [3, 0, 0, -1, 0, 0], [9, 9, 9, 0, 0, 1]]
    )
    assert scene.count_intersections(rays).tolist() == [4, 4, 4, 0]
    hits = scene.list_intersections(rays)
    assert hits["ray_splits"].tolist() == [0, 4, 8, 12, 12]
    assert hits["geometry_ids"][:4].tolist() == [outer, inner, inner, outer]
    assert (np.diff(hits["t_hit"].reshape(3, 4), axis=1) > 0).all()
    assert hits["ray_ids"].tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert hits["primitive_uvs"].shape == (12, 2)
    inside = rng.uniform(-0.3, 0.3, (500, 3))
    counts = scene.count_intersections(origin=inside, direction=rng.normal(size=(500, 3)))
    assert (counts == 2).all()


def test_a_panorama_looks_everywhere():
    rays = rayflock.create_rays_spherical((1, 2, 3), 8, 4)
    assert rays.shape == (4, 8, 6) and (rays[..., :3] == [1, 2, 3]).all()
    np.testing.assert_allclose(np.linalg.norm(rays[..., 3:], axis=-1), 1, rtol=1e-6)
    assert (rays[0, :, 5] > 0.9).all() and (rays[-1, :, 5] < -0.9).all()
    np.testing.assert_allclose(rays[..., 3:].sum((0, 1)), 0, atol=1e-5)
    ahead = rayflock.create_rays_spherical(
        (0, 0, 0), 1, 3, azimuth_deg=(10, -10), elevation_deg=(15, -15), forward=(0, 1, 0)
    )
    np.testing.assert_allclose(ahead[1, 0, 3:], [0, 1, 0], atol=1e-7)
    assert ahead[0, 0, 5] == pytest.approx(np.sin(np.deg2rad(10)))
    left = rayflock.create_rays_spherical(
        (0, 0, 0), 1, 1, azimuth_deg=(90, 90), elevation_deg=(0, 0)
    )
    np.testing.assert_allclose(left[0, 0, 3:], [0, 1, 0], atol=1e-7)
