"""What is wrong is an exception of the type a NumPy user expects, with what to do."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
import rayflock
from conftest import TRIANGLES, VERTICES
from rayflock.compat import embreex, open3d, trimesh

RAYS = np.float32([[0.25, 0.25, 2, 0, 0, -1]] * 4)


def cast(**options):
    def call(scene):
        scene.cast_rays(options.pop("rays", RAYS), **options)

    return call


def hits(**changes):
    scene = rayflock.Scene()
    out = scene.cast_rays(RAYS)
    out.update(changes)
    return out


def read_only(array):
    array.flags.writeable = False
    return array


SHARED = np.zeros((4, 6), np.float32)
SMALL = rayflock.Sensor("depth", at=(0, 0, 2), size=(2, 2))
MESH = SimpleNamespace(vertices=VERTICES, faces=TRIANGLES)

MISTAKES = [
    # Meshes.
    (
        lambda s: s.add(VERTICES[:, :2], TRIANGLES),
        ValueError,
        r"vertices must have shape \(n, 3\), found \(3, 2\)",
    ),
    (lambda s: s.add(VERTICES[0], TRIANGLES), ValueError, r"vertices must have shape"),
    (
        lambda s: s.add([["a", "b", "c"]], TRIANGLES),
        TypeError,
        "vertices must hold numbers, found dtype <U1",
    ),
    (
        lambda s: s.add(VERTICES * 1j, TRIANGLES),
        TypeError,
        "vertices must hold numbers, found dtype complex",
    ),
    (
        lambda s: s.add(VERTICES, TRIANGLES[:, :2]),
        ValueError,
        r"triangles must have shape \(n, 3\), found \(1, 2\)",
    ),
    (
        lambda s: s.add(VERTICES, TRIANGLES * 1.0),
        TypeError,
        r"found dtype float64.*astype\(numpy.uint32\)",
    ),
    (
        lambda s: s.add(VERTICES, [[0, 1, 3]]),
        IndexError,
        "triangle 0 names vertex 3, but there are 3 vertices",
    ),
    (
        lambda s: s.add(VERTICES, [[0, 1, -1]]),
        IndexError,
        "triangle 0 names vertex -1.*counted from 0",
    ),
    (lambda s: s.add(VERTICES, [[0, 1, 1 << 40]]), IndexError, f"names vertex {1 << 40}"),
    (lambda s: s.add(VERTICES, TRIANGLES, mask=-1), ValueError, "mask must lie in"),
    (lambda s: s.add(VERTICES, TRIANGLES, mask=[1, 2]), ValueError, "mask"),
    (lambda s: s.add(VERTICES, TRIANGLES, True), TypeError, "positional"),
    (
        lambda s: s.update(0, VERTICES[:2]),
        ValueError,
        "there are 2 vertices, and there were 3: hand over the triangles",
    ),
    (lambda s: s.update(0, VERTICES, [[0, 1, 9]]), IndexError, "vertex 9"),
    (lambda s: s.update(5, VERTICES), KeyError, "no object has the id 5"),
    (lambda s: s.update(-1, VERTICES), KeyError, "no object has the id -1"),
    (lambda s: s.update(1 << 70, VERTICES), KeyError, "no object has the id"),
    (lambda s: s.update("0", VERTICES), TypeError, "an id is a whole number, found str"),
    (lambda s: s.update_spheres(0, VERTICES), ValueError, "holds triangles: update"),
    (
        lambda s: s.update(s.add_spheres(VERTICES, 1), VERTICES),
        ValueError,
        "holds spheres: update_spheres",
    ),
    (
        lambda s: s.add_spheres(VERTICES, [1, 2]),
        ValueError,
        r"radii must be one number or have shape \(3,\)",
    ),
    (
        lambda s: s.update_spheres(s.add_spheres(VERTICES, 1), VERTICES[:1]),
        ValueError,
        "hand over the radii",
    ),
    # Rays.
    (cast(rays=RAYS[:, :5]), ValueError, r"rays must have shape \(..., 6\).*found \(4, 5\)"),
    (cast(rays=3.0), ValueError, r"rays must have shape"),
    (cast(rays=[[1, 2], [3]]), ValueError, "inhomogeneous"),
    (cast(rays=[None] * 6), TypeError, "rays must hold numbers, found dtype object"),
    (cast(rays=None), TypeError, "both origin and direction"),
    (cast(origin=(0, 0, 0)), TypeError, "not both"),
    (
        cast(rays=None, origin=(0, 0), direction=(0, 0, 1)),
        ValueError,
        r"origin must have shape \(3,\)",
    ),
    (cast(rays=None, origin=np.zeros((2, 3)), direction=np.ones((3, 3))), ValueError, "same shape"),
    (
        cast(t_max=[1, 2]),
        ValueError,
        r"t_max must be one number or have the shape of the rays, \(4,\); found \(2,\)",
    ),
    (cast(t_min="near"), TypeError, "t_min must hold numbers"),
    (cast(mask=1.5), TypeError, "mask must hold whole numbers"),
    (cast(mask=1 << 32), ValueError, "32 bits"),
    (cast(engine="embree"), ValueError, 'unknown engine "embree"; there are: auto'),
    (cast(engine=3), TypeError, "engine must be a name"),
    (cast(threads=0), ValueError, r"threads must lie in 1..1024"),
    (cast(threads="all"), TypeError, "threads must be a whole number"),
    (lambda s: s.cast_rays(RAYS, 0.0), TypeError, "positional"),
    # Arrays to be written.
    (cast(out=[]), TypeError, "out must be a dictionary of arrays"),
    (cast(out={"t": RAYS}), ValueError, "out has 't', which is none of: t_hit"),
    (
        cast(out=hits(t_hit=[0] * 4)),
        TypeError,
        r"out\['t_hit'\] must be a numpy.ndarray, found list",
    ),
    (
        cast(out=hits(t_hit=np.zeros(4))),
        TypeError,
        r"out\['t_hit'\] must have dtype float32, found float64",
    ),
    (
        cast(out=hits(primitive_uvs=np.zeros((4, 3), np.float32))),
        ValueError,
        r"must have shape \(4, 2\), found \(4, 3\)",
    ),
    (cast(out=hits(t_hit=read_only(np.zeros(4, np.float32)))), ValueError, "read-only"),
    (cast(out=hits(t_hit=np.zeros(8, np.float32)[::2])), ValueError, "row by row"),
    (cast(rays=SHARED, out={"t_hit": SHARED.reshape(-1)[:4]}), ValueError, "shares memory"),
    (lambda s: s.test_occlusions(RAYS, out=np.zeros(4)), TypeError, "out must have dtype bool"),
    (
        lambda s: s.count_intersections(RAYS, out=np.zeros(3, np.int32)),
        ValueError,
        r"must have shape \(4,\)",
    ),
    # Cameras, and the scene itself.
    (
        lambda s: s.create_rays_pinhole(60, [0, 0, 0], [0, 0, 0], [0, 1, 0], 4, 4),
        ValueError,
        "parallel",
    ),
    (
        lambda s: s.create_rays_pinhole(0, [0, 0, 1], [0, 0, 0], [0, 1, 0], 4, 4),
        ValueError,
        "fov_deg",
    ),
    (lambda s: s.create_rays_pinhole(np.zeros((3, 3)), np.eye(4), 4, 4), ValueError, "invertible"),
    (lambda s: s.create_rays_pinhole(60, 4, 4), TypeError, "create_rays_pinhole takes"),
    (lambda s: s.create_rays_spherical((0, 0, math.nan), 4, 4), ValueError, "eye must be finite"),
    (
        lambda s: s.create_rays_spherical((0, 0, 0), 4.5, 4),
        TypeError,
        "width_px must be a whole number",
    ),
    (lambda s: rayflock.Scene(engine="fast"), ValueError, 'unknown engine "fast"'),
    (lambda s: rayflock.Scene(threads=2.0), TypeError, "threads must be a whole number"),
]


@pytest.mark.parametrize(("mistake", "kind", "message"), MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_are_told(one_triangle, mistake, kind, message):
    scene, _ = one_triangle
    with pytest.raises(kind, match=message):
        mistake(scene)
    assert scene.cast_rays(RAYS)["t_hit"][0] <= 2.0


ODD = [
    None,
    True,
    -1,
    0,
    7,
    1e300,
    math.nan,
    "x",
    [],
    [[]],
    (0, 0, 1),
    np.float32(np.inf),
    np.zeros((0, 6)),
    np.full((3, 6), np.nan),
    np.zeros((2, 3, 6), np.float16),
    np.arange(12).reshape(2, 6)[:, ::-1],
    np.zeros((4, 3), np.uint8),
    np.full((5, 3), -(1 << 62)),
    np.zeros(3, np.datetime64),
    np.zeros((2, 6), [("a", "f4")]),
    np.zeros((1 << 16, 0)),
    np.frombuffer(bytes(97), np.uint8)[1:].view(np.float32).reshape(4, 6),
    object(),
    {},
]


def test_no_argument_makes_it_panic(one_triangle, rng):
    """Calls with all sorts of values answer or raise; they neither panic nor end the process."""
    scene, triangle = one_triangle
    calls = [
        lambda a, b: scene.add(a, b),
        lambda a, b: scene.update(triangle, a, b),
        lambda a, b: scene.add_spheres(a, b),
        lambda a, b: scene.update_spheres(a, b),
        lambda a, b: scene.cast_rays(a, t_min=b),
        lambda a, b: scene.cast_rays(a, mask=b, t_max=b),
        lambda a, b: scene.cast_rays(origin=a, direction=b),
        lambda a, b: scene.cast_rays(a, out={"t_hit": b}),
        lambda a, b: scene.test_occlusions(a, out=b),
        lambda a, b: scene.list_intersections(a, t_max=b),
        lambda a, b: scene.count_intersections(a, engine=b),
        lambda a, b: rayflock.create_rays_spherical(a, b, 3),
        lambda a, b: rayflock.create_rays_pinhole(a, b, (0, 0, 0), (0, 0, 1), 2, 2),
        lambda a, b: rayflock.Scene(engine=a, threads=b),
        lambda a, b: rayflock.Sensor(a, at=b),
        lambda a, b: rayflock.Sensor("depth", size=(2, 2), fov=a, poses=b),
        lambda a, b: rayflock.Sensor("spinning:16", columns=a, elevations=b),
        lambda a, b: scene.sense(SMALL, time=a, threads=b),
        lambda a, b: scene.sense(SMALL).image(a, b),
        lambda a, b: scene.sense(SMALL).picture(a).save(b),
        lambda a, b: scene.sense(a).save(b),
        lambda a, b: scene.copy().remove(a),
        lambda a, b: scene.evaluate(a),
        lambda a, b: rayflock.load(a, clip=b),
        lambda a, b: rayflock.load("builtin:cornell", up=a, frame_rate=b),
        lambda a, b: rayflock.render(scene, width=a, height=b),
        lambda a, b: rayflock.render(scene, width=2, height=2, eye=a, center=b),
        lambda a, b: rayflock.render(scene, width=2, height=2, background=a, samples=b),
        lambda a, b: open3d.RaycastingScene().add_triangles(a, b),
        lambda a, b: embreex.TriangleMesh(embreex.EmbreeScene(), a, b),
        lambda a, b: embreex.EmbreeScene().run(a, b),
        lambda a, b: trimesh.RayMeshIntersector(MESH).intersects_any(a, b),
        lambda a, b: trimesh.RayMeshIntersector(MESH).intersects_location(a, b),
        lambda a, b: trimesh.RayMeshIntersector(SimpleNamespace(vertices=a, faces=b)),
    ]
    answered = 0
    for call, (a, b) in itertools.product(calls, itertools.product(ODD, repeat=2)):
        try:
            call(a, b)
            answered += 1
        except (TypeError, ValueError, IndexError, KeyError, OSError, OverflowError):
            pass
    assert answered > 100
    # Whatever was added, the scene still answers.
    assert scene.cast_rays(RAYS)["t_hit"].shape == (4,)
