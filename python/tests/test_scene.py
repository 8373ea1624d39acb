"""Objects come, change and go."""

import numpy as np
import pytest
import rayflock
from conftest import TRIANGLES, VERTICES, random_rays, soup, sphere_mesh

DOWN = [[0.25, 0.25, 2.0, 0.0, 0.0, -1.0]]


def depth(scene, ray=DOWN):
    return float(scene.cast_rays(ray)["t_hit"][0])


def test_an_update_moves_an_object(one_triangle):
    scene, triangle = one_triangle
    assert depth(scene) == 2.0
    scene.update(triangle, VERTICES + np.float32([0, 0, 1]))
    assert depth(scene) == 1.0


def test_what_becomes_of_the_arrays_later_changes_nothing(one_triangle):
    scene, triangle = one_triangle
    vertices, triangles = VERTICES.copy(), TRIANGLES.copy()
    scene.update(triangle, vertices, triangles)
    vertices += 10.0
    triangles[:] = 0
    assert depth(scene) == 2.0


def test_an_update_may_change_everything(one_triangle, rng):
    scene, triangle = one_triangle
    rays = random_rays(rng, 400)
    for count in (500, 3, 0, 120):
        vertices, triangles = soup(rng, count)
        scene.update(triangle, vertices, triangles)
        fresh = rayflock.Scene()
        fresh.add(vertices, triangles)
        found, expected = scene.cast_rays(rays), fresh.cast_rays(rays)
        for name in found:
            np.testing.assert_array_equal(found[name], expected[name])
        assert (count > 0) == bool(np.isfinite(found["t_hit"]).any())


def test_objects_are_removed_and_ids_are_not_used_again(one_triangle):
    scene, triangle = one_triangle
    other = scene.add(VERTICES + np.float32([0, 0, -1]), TRIANGLES)
    scene.remove(triangle)
    assert (depth(scene), scene.ids) == (3.0, [other])
    assert scene.add(VERTICES, TRIANGLES) == other + 1
    with pytest.raises(KeyError, match=f"no object has the id {triangle}.*removed"):
        scene.update(triangle, VERTICES)
    with pytest.raises(KeyError):
        scene.remove(triangle)


def test_a_copy_goes_its_own_way(one_triangle):
    scene, triangle = one_triangle
    twin = scene.copy()
    twin.update(triangle, VERTICES + np.float32([0, 0, 1]))
    scene.add(VERTICES + np.float32([0, 0, 1.5]), TRIANGLES)
    assert (depth(scene), depth(twin)) == (0.5, 1.0)
    assert (scene.ids, twin.ids) == ([0, 1], [0])


def test_spheres_are_hit_and_move():
    scene = rayflock.Scene()
    balls = scene.add_spheres([[0, 0, 0], [5, 0, 0]], 0.5)
    ray = [[5.0, 0.0, 2.0, 0.0, 0.0, -1.0]]
    hit = scene.cast_rays(ray)
    assert (hit["t_hit"][0], hit["primitive_ids"][0]) == (1.5, 1)
    np.testing.assert_array_equal(hit["primitive_normals"][0], [0, 0, 1])
    scene.update_spheres(balls, [[0, 0, 0], [5, 0, 1]])
    assert depth(scene, ray) == 0.5
    scene.update_spheres(balls, [[5, 0, 0]], radii=[1.0])
    assert depth(scene, ray) == 1.0


def test_masks_hide_objects(one_triangle):
    scene, _ = one_triangle
    hidden = scene.add(VERTICES + np.float32([0, 0, 1]), TRIANGLES, mask=2)
    rays = DOWN * 3
    ids = scene.cast_rays(rays, mask=np.array([1, 2, 3]))["geometry_ids"]
    assert ids.tolist() == [0, hidden, hidden]
    assert depth(scene) == 1.0


def test_what_is_not_finite_is_ignored_and_counted():
    scene = rayflock.Scene()
    vertices = np.concatenate([VERTICES, VERTICES, VERTICES * [1, 0, 1]])
    vertices[4, 1] = np.nan
    scene.add(vertices, np.arange(9).reshape(3, 3))
    hit = scene.cast_rays(DOWN + [[np.nan, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0]])
    assert hit["t_hit"].tolist() == [2.0, np.inf, np.inf]
    stats = scene.stats
    assert (stats.non_finite, stats.degenerate, stats.invalid_rays) == (1, 1, 2)


def test_a_static_object_refuses_to_change():
    scene = rayflock.Scene()
    ground = scene.add(VERTICES, TRIANGLES, static=True)
    with pytest.raises(ValueError, match="added with static=True"):
        scene.update(ground, VERTICES)
    assert depth(scene) == 2.0
    scene.remove(ground)


def test_a_scene_tells_about_itself(one_triangle):
    scene, triangle = one_triangle
    assert scene.stats.rays == 0
    scene.add_spheres([[9, 9, 9]], [1])
    scene.cast_rays(DOWN * 5)
    stats = scene.stats
    assert (stats.objects, stats.triangles, stats.spheres, stats.rays) == (2, 1, 1, 5)
    assert stats.engine in ("brute", "hierarchy", "bvh", "subfields")
    assert "5 rays" in stats.reason
    assert stats.query_seconds > 0 and stats.update_seconds > 0
    assert "query" in str(stats) and stats._repr_html_().startswith("<table>")
    assert repr(scene) == "<rayflock.Scene: 2 objects, 1 triangles, 1 spheres>"
    scene.cast_rays(DOWN, engine="bvh")
    assert (scene.stats.engine, scene.stats.reason) == ("bvh", None)


def test_all_engines_and_thread_counts_agree_over_frames(rng):
    scene = rayflock.Scene()
    vertices, triangles = sphere_mesh()
    ball = scene.add(vertices, triangles)
    rays = random_rays(rng, 2000)
    for frame in range(3):
        scene.update(ball, vertices * np.float32(1 - 0.2 * frame))
        answers = [
            scene.cast_rays(rays, engine=engine, threads=threads)
            for engine in ("brute", "hierarchy", "bvh", "subfields", "auto")
            for threads in (1, 2)
        ]
        for answer in answers[1:]:
            for name in answer:
                np.testing.assert_array_equal(answer[name], answers[0][name])
