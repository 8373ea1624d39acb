"""Frames of a mesh that deforms: Rayflock, Open3D and embreex, each used as well as it can be.

    python bench/python/frames.py [--triangles 100000] [--rays 65536] [--kinds camera random]
        [--frames 60] [--threads N]

Each frame has new vertices for all triangles, which are handed over, and a batch of rays, which
are traced. The libraries take turns, frame by frame, and each begins as often as the others; what
is told are medians, as a table in Markdown.

Rayflock gets one update. Open3D and embreex cannot update, so they get a new scene each frame,
which is what their users do. Open3D is asked by cast_rays, as Rayflock is; embreex is asked for
triangles alone, which is its fastest answer. Answers are compared: which triangle, for every ray.

The call in Rust is what `stats` of a scene tells: the time in which the compiled part has the
engine take in the mesh, find the hits and write them and their normals to the caller's arrays, as a
program in Rust would. What cast_rays takes longer than that is the cost of the call from Python:
checking arguments, looking for what rays share, handing over.
"""

import argparse
import os
import platform
import statistics
import time

import numpy as np
import rayflock


KINDS = ("camera", "random")
#: Frames that do not count: the first ones allocate, and teach the engine what is asked.
WARM_UP = 10


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
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--threads", type=int, help="threads of Rayflock and Open3D")
    args = parser.parse_args()
    print(f"{processor()}, {os.cpu_count()} cores, Python {platform.python_version()}\n")
    for kind in args.kinds:
        compare(kind, args)


def compare(kind, args):
    """Has the libraries take turns with one kind of rays."""
    vertices, triangles = ball(args.triangles)
    rays = make_rays(kind, args.rays)
    sides = []
    for library in (Rayflock, Open3D, Embreex):
        try:
            sides.append(library(triangles, rays, args.threads))
        except ImportError as error:
            print(f"{library.name} is left out: {error}")
    times = {side.name: [] for side in sides}
    differing = dict.fromkeys(times, 0)
    for frame in range(WARM_UP + args.frames):
        shape = deformed(vertices, frame)
        answers = {}
        turn = frame % len(sides)
        for side in sides[turn:] + sides[:turn]:
            start = time.perf_counter()
            answer = side.frame(shape)
            took = time.perf_counter() - start
            side.after()
            answers[side.name] = answer.reshape(-1)
            if frame >= WARM_UP:
                times[side.name].append(took)
        for name, answer in answers.items():
            count = int(np.count_nonzero(answer != answers[Rayflock.name]))
            differing[name] = max(differing[name], count)
    print(f"{len(triangles):,} triangles, {rays.size // 6:,} rays ({kind}), {args.frames} frames\n")
    report(sides[0], times, differing)


def report(ours, times, differing):
    print("| | ms a frame | times Rayflock | other triangles, of rays, at most |")
    print("|---|---:|---:|---:|")
    for name, took in times.items():
        ratios = [b / a for a, b in zip(times[Rayflock.name], took, strict=True)]
        print(
            f"| {name} | {statistics.median(took) * 1e3:.2f} | {statistics.median(ratios):.2f} | "
            f"{differing[name]} |"
        )
    overhead = statistics.median(ours.overheads[WARM_UP:])
    print(f"\ncast_rays takes {overhead:.1%} longer than the call in Rust\n")


def processor():
    """What the processor is called, where the system tells."""
    try:
        with open("/proc/cpuinfo") as file:
            names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
        return names[0]
    except (OSError, IndexError):
        return platform.processor() or platform.machine()


if __name__ == "__main__":
    main()
