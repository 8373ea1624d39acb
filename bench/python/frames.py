"""Frames of a mesh that deforms: Rayflock, Open3D and embreex, each used as well as it can be.

    python bench/python/frames.py [--triangles 100000] [--rays 65536] [--kind camera] [--frames 30]

Each frame has new vertices for all triangles, which are handed over, and a batch of rays, which
are traced. The libraries take turns, frame by frame; what is told are medians.

Rayflock gets one update. Open3D and embreex cannot update, so they get a new scene each frame,
which is what their users do. Open3D is asked by cast_rays, as Rayflock is; embreex is asked for
triangles alone, which is its fastest answer. Answers are compared: which triangle, for every ray.

What a call costs besides the engine's work, which the compiled part measures itself, is told too.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np
import rayflock


class Rayflock:
    name = "rayflock"

    def __init__(self, triangles, rays, threads):
        self.scene = rayflock.Scene(threads=threads)
        self.triangles, self.rays = triangles, rays
        self.mesh = None
        self.out = self.scene.cast_rays(rays)
        self.cast_seconds = 0.0
        self.overheads = []

    def frame(self, vertices):
        if self.mesh is None:
            self.mesh = self.scene.add(vertices, self.triangles)
        else:
            self.scene.update(self.mesh, vertices)
        start = time.perf_counter()
        self.scene.cast_rays(self.rays, out=self.out)
        self.cast_seconds = time.perf_counter() - start
        return self.out["primitive_ids"].view(np.int32)

    def after(self):
        stats = self.scene.stats
        engine_seconds = stats.update_seconds + stats.query_seconds
        self.overheads.append(self.cast_seconds / engine_seconds - 1)


class Open3D:
    name = "open3d"

    def __init__(self, triangles, rays, threads):
        import open3d

        self.kind = open3d.t.geometry.RaycastingScene
        self.tensor = open3d.core.Tensor.from_numpy
        self.triangles, self.rays = self.tensor(triangles), self.tensor(rays)
        self.threads = threads or 0

    def frame(self, vertices):
        scene = self.kind(nthreads=self.threads)
        scene.add_triangles(self.tensor(vertices), self.triangles)
        hits = scene.cast_rays(self.rays, nthreads=self.threads)
        return hits["primitive_ids"].numpy().view(np.int32)

    def after(self):
        pass


class Embreex:
    name = "embreex"

    def __init__(self, triangles, rays, threads):
        from embreex import mesh_construction, rtcore_scene

        self.scene, self.mesh = rtcore_scene.EmbreeScene, mesh_construction.TriangleMesh
        self.triangles = triangles.astype(np.int32)
        flat = rays.reshape(-1, 6)
        self.origins, self.directions = flat[:, :3].copy(), flat[:, 3:].copy()

    def frame(self, vertices):
        scene = self.scene()
        self.mesh(scene, vertices, self.triangles)
        return scene.run(self.origins, self.directions)

    def after(self):
        pass


def ball(count):
    """A closed ball of about so many triangles."""
    rows = max(3, int(np.sqrt(count / 2)))
    theta, phi = np.linspace(0.01, np.pi - 0.01, rows + 1), np.arange(rows) * 2 * np.pi / rows
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    vertices = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    )
    corner = np.arange((rows + 1) * rows).reshape(rows + 1, rows)
    a, b = corner[:-1], np.roll(corner[:-1], -1, axis=1)
    c, d = corner[1:], np.roll(corner[1:], -1, axis=1)
    triangles = np.stack([[a, c, d], [a, d, b]]).transpose(2, 3, 0, 1).reshape(-1, 3)
    return vertices.reshape(-1, 3), np.ascontiguousarray(triangles, np.uint32)


def deformed(vertices, frame):
    """The ball at a frame: waves that run over it."""
    waves = np.sin(7 * vertices + 0.3 * frame).prod(axis=1, keepdims=True)
    return ((1 + 0.25 * waves) * vertices).astype(np.float32)


def make_rays(kind, count):
    side = int(np.sqrt(count))
    if kind == "camera":
        return rayflock.create_rays_pinhole(45, [0, 0, 0], [0, -3, 1], [0, 0, 1], side, side)
    rng = np.random.default_rng(3)
    origins = rng.normal(size=(side * side, 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
    rays = np.concatenate([origins, rng.uniform(-1, 1, origins.shape) - origins], axis=1)
    return rays.astype(np.float32)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=100_000)
    parser.add_argument("--rays", type=int, default=65_536)
    parser.add_argument("--kind", choices=["camera", "random"], default="camera")
    parser.add_argument("--frames", type=int, default=30)
    parser.add_argument("--threads", type=int, help="threads of Rayflock and Open3D")
    args = parser.parse_args()

    vertices, triangles = ball(args.triangles)
    rays = make_rays(args.kind, args.rays)
    sides = []
    for kind in (Rayflock, Open3D, Embreex):
        try:
            sides.append(kind(triangles, rays, args.threads))
        except ImportError as error:
            print(f"{kind.name} is left out: {error}")
    times = {side.name: [] for side in sides}
    differing = dict.fromkeys(times, 0)

    # The first frames allocate, and teach the engine what is asked.
    warm_up = 5
    for frame in range(warm_up + args.frames):
        shape = deformed(vertices, frame)
        answers = []
        for side in sides[frame % len(sides) :] + sides[: frame % len(sides)]:
            start = time.perf_counter()
            answer = side.frame(shape)
            took = time.perf_counter() - start
            side.after()
            answers.append((side.name, answer.reshape(-1)))
            if frame >= warm_up:
                times[side.name].append(took)
        ours = next(answer for name, answer in answers if name == Rayflock.name)
        for name, answer in answers:
            differing[name] = max(differing[name], int(np.count_nonzero(answer != ours)))

    report(args, sides, times, differing, len(triangles), rays.size // 6, warm_up)


def report(args, sides, times, differing, triangle_count, ray_count, warm_up):
    print(
        f"{triangle_count} triangles, {ray_count} rays ({args.kind}), {args.frames} frames, "
        f"{os.cpu_count()} cores, {platform.machine()}"
    )
    ours = times[Rayflock.name]
    for name, took in times.items():
        ratio = statistics.median(b / a for a, b in zip(ours, took, strict=True))
        print(
            f"{name:>10}: {statistics.median(took) * 1e3:8.2f} ms a frame, "
            f"{ratio:6.2f} x rayflock; at most {differing[name]} rays of a frame "
            "name another triangle"
        )
    overhead = statistics.median(sides[0].overheads[warm_up:])
    print(f"cast_rays takes {overhead:.1%} longer than what the engine does in it")


if __name__ == "__main__":
    main()
