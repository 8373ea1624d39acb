"""Arrays that fit are read and written where they are; frames leave nothing behind."""

import os
import resource
import threading

import numpy as np
import pytest
import rayflock
from conftest import TRIANGLES, VERTICES, random_rays, soup, sphere_mesh
from rayflock import _arguments, _questions


def test_arrays_that_fit_are_handed_on_as_they_are(rng):
    rays = random_rays(rng, 12).reshape(3, 4, 6)
    t_max = np.full((3, 4), 5, np.float32)
    mask = np.full((3, 4), 1, np.uint32)
    question, _ = _questions.asked(rays, None, None, 0.0, t_max, mask, None, None)
    for given, name in ((rays, "rays"), (t_max, "t_max"), (mask, "mask")):
        assert question[name].ctypes.data == given.ctypes.data
        assert np.shares_memory(question[name], given)
    question, _ = _questions.asked(
        None, rays[..., 0, :3].copy(), (0, 0, 1), 0.0, 1.0, 1, None, None
    )
    assert question["direction"] == (0, 0, 1)
    triangles = np.zeros((1, 3), np.uint32)
    assert _arguments.triangles(triangles).ctypes.data == triangles.ctypes.data
    assert _arguments.rows(VERTICES, "vertices", 3).ctypes.data == VERTICES.ctypes.data


def test_hits_are_written_in_place(one_triangle, rng):
    scene, _ = one_triangle
    rays = random_rays(rng, 60).reshape(6, 10, 6)
    expected = scene.cast_rays(rays)
    out = {name: np.full_like(array, 7) for name, array in expected.items()}
    places = {name: array.ctypes.data for name, array in out.items()}
    assert scene.cast_rays(rays, out=out) is out
    for name in expected:
        assert out[name].ctypes.data == places[name]
        np.testing.assert_array_equal(out[name], expected[name])
    for names in (["t_hit"], ["geometry_ids"], ["primitive_normals"], ["primitive_uvs", "t_hit"]):
        some = {name: np.full_like(expected[name], 7) for name in names}
        scene.cast_rays(rays, out=some)
        for name in names:
            np.testing.assert_array_equal(some[name], expected[name])
    shadow = np.full((6, 10), 7, np.uint8).view(np.bool_)
    assert scene.test_occlusions(rays, out=shadow) is shadow
    assert set(shadow.view(np.uint8).reshape(-1)) <= {0, 1}
    counts = np.empty((6, 10), np.int32)
    assert scene.count_intersections(rays, out=counts) is counts


def test_rays_may_be_read_only(one_triangle, rng):
    scene, _ = one_triangle
    rays = random_rays(rng, 5)
    rays.flags.writeable = False
    scene.cast_rays(rays)


def test_memory_does_not_grow_over_frames(rng):
    scene = rayflock.Scene()
    vertices, triangles = soup(rng, 20_000)
    mesh = scene.add(vertices, triangles)
    rays = random_rays(rng, 5_000)
    peaks = []
    for frame in range(200):
        scene.update(mesh, vertices + np.float32(0.001 * frame), triangles)
        scene.cast_rays(rays)
        if frame in (60, 199):
            peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    # A mesh is 480 KB: to keep those of 140 frames would take 66 MB. Kilobytes, but on macOS.
    assert peaks[1] - peaks[0] < 16 * 1024


def test_threads_share_a_scene(rng):
    scene = rayflock.Scene()
    mesh = scene.add(*sphere_mesh())
    vertices, triangles = sphere_mesh()
    rays = random_rays(rng, 500)
    expected = {}
    for size in (1.0, 0.5):
        scene.update(mesh, vertices * np.float32(size))
        expected[size] = scene.cast_rays(rays)["t_hit"].tobytes()
    answers, failures = [], []

    def work(seed):
        try:
            for turn in range(20):
                if seed == 0:
                    scene.update(mesh, vertices * np.float32(1.0 if turn % 2 else 0.5))
                answers.append(scene.cast_rays(rays, threads=1 + seed % 2)["t_hit"].tobytes())
        except Exception as error:
            failures.append(error)

    workers = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert not failures
    assert set(answers) == set(expected.values())


def test_the_interpreter_runs_on_while_rays_are_traced(rng):
    scene = rayflock.Scene(engine="brute")
    scene.add(*soup(rng, 20_000))
    rays = random_rays(rng, 20_000)
    done = threading.Event()

    def work():
        scene.cast_rays(rays)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    turns = 0
    while not done.is_set():
        turns += 1
    worker.join()
    # With the lock held, this loop gets a turn or two; without, as many as it likes.
    assert turns > 1000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork.*")
def test_a_fork_has_threads_of_its_own(one_triangle):
    scene, triangle = one_triangle
    ray = [[0.25, 0.25, 2, 0, 0, -1]] * 5000
    scene.cast_rays(ray)
    child = os.fork()
    if child == 0:
        try:
            scene.update(triangle, VERTICES + np.float32([0, 0, 1]), TRIANGLES)
            os._exit(0 if (scene.cast_rays(ray)["t_hit"] == 1.0).all() else 3)
        finally:
            os._exit(4)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0
    assert (scene.cast_rays(ray)["t_hit"] == 2.0).all()
