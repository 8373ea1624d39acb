"""The scene: what can be hit, and questions about it."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import _arguments as arguments
from rayflock import _native
from rayflock._arguments import ALL
from rayflock._rays import create_rays_pinhole, create_rays_spherical
from rayflock._sensor import Sensor
from rayflock._stats import Source, Stats
from rayflock._sweep import Sweep

#: What :meth:`Scene.cast_rays` tells, with what each entry has beside the shape of the rays.
HITS: dict[str, tuple[type[np.generic], tuple[int, ...]]] = {
    "t_hit": (np.float32, ()),
    "geometry_ids": (np.uint32, ()),
    "primitive_ids": (np.uint32, ()),
    "primitive_uvs": (np.float32, (2,)),
    "primitive_normals": (np.float32, (3,)),
}


class Scene:
    """Triangles and spheres that may change at any time, and what rays hit of them.

    Objects have an id from :meth:`add` or :meth:`add_spheres`; ids are not used again. A change
    costs a copy of the arrays; engines take it in when the next question is asked.

    Rays are float32 of shape (..., 6), origin and direction, as in Open3D; answers have the shape
    (...). Instead of ``rays``, ``origin`` and ``direction`` can be given, each (3,) for all rays or
    (..., 3) for one each. Arrays that are float32 (masks: uint32) and lie in memory row by row are
    read in place; others are converted first. The interpreter lock is released while rays are
    traced. A scene may be used by several threads at a time; it answers one after the other, each
    on all of ``threads``.

    Args:
        engine: which engine answers: "auto", "hierarchy", "bvh", "subfields" or "brute". All give
            the same answer to the bit.
        threads: how many threads work, by default one a core.
    """

    def __init__(self, *, engine: str = "auto", threads: int | None = None) -> None:
        if not isinstance(engine, str):
            arguments.engine(engine)
            raise TypeError("engine must be a name such as 'auto', found None")
        self._native = _native.Scene(engine, arguments.threads(threads) or 0)

    def add(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        static: bool = False,
        mask: int = ALL,
    ) -> int:
        """Adds a mesh and returns its id.

        Args:
            vertices: positions, (n, 3). Copied: what becomes of the array later changes nothing.
                Triangles with a corner that is NaN or infinite are ignored, and counted in
                :attr:`stats`.
            triangles: vertex numbers, (m, 3). Empty meshes are allowed.
            static: the object will not change: :meth:`update` refuses to. It does not have to be
                said for speed; engines notice by themselves what rests.
            mask: a ray hits the object only if ``ray_mask & mask != 0``.

        Returns:
            the id, from 0 on in a new scene.

        Raises:
            ValueError: an array has another shape, or the mask more than 32 bits.
            TypeError: an array holds something else than numbers.
            IndexError: a triangle names a vertex that is not there.
        """
        vertices = arguments.rows(vertices, "vertices", 3)
        triangles = arguments.triangles(triangles)
        return self._native.add_mesh(vertices, triangles, _one_mask(mask), bool(static))

    def update(self, id: int, vertices: ArrayLike, triangles: ArrayLike | None = None) -> None:
        """Replaces the mesh of an object by another one, of any topology.

        Args:
            id: which object.
            vertices: positions, (n, 3). Copied.
            triangles: vertex numbers, (m, 3); by default those that the object has, and then there
                must be as many vertices as before.

        Raises:
            KeyError: no object has this id: it was never added, or has been removed.
            IndexError: a triangle names a vertex that is not there.
            ValueError: an array has another shape, the object is static, belongs to a file, or
                holds spheres; or without triangles, the number of vertices is another.
            TypeError: an array holds something else than numbers.
        """
        id = arguments.object_id(id)
        vertices = arguments.rows(vertices, "vertices", 3)
        if triangles is not None:
            triangles = arguments.triangles(triangles)
        self._native.update_mesh(id, vertices, triangles)

    def add_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        *,
        static: bool = False,
        mask: int = ALL,
    ) -> int:
        """Adds spheres as one object and returns its id.

        Args:
            centers: positions, (n, 3). Copied.
            radii: one for all, or (n,). Spheres of a radius that is not positive are ignored.
            static: as for :meth:`add`.
            mask: as for :meth:`add`.

        Returns:
            the id.

        Raises:
            ValueError: an array has another shape, or the mask more than 32 bits.
            TypeError: an array holds something else than numbers.
        """
        centers = arguments.rows(centers, "centers", 3)
        radii = _radii(radii, len(centers))
        return self._native.add_spheres(centers, radii, _one_mask(mask), bool(static))

    def update_spheres(self, id: int, centers: ArrayLike, radii: ArrayLike | None = None) -> None:
        """Replaces the spheres of an object by others.

        Args:
            id: which object.
            centers: positions, (n, 3). Copied.
            radii: one for all, or (n,); by default those that the object has.

        Raises:
            KeyError: no object has this id.
            ValueError: an array has another shape, the object is static, or holds triangles; or
                without radii, the number of centers is another.
            TypeError: an array holds something else than numbers.
        """
        id = arguments.object_id(id)
        centers = arguments.rows(centers, "centers", 3)
        if radii is not None:
            radii = _radii(radii, len(centers))
        self._native.update_spheres(id, centers, radii)

    def remove(self, id: int) -> None:
        """Takes an object out of the scene; its id is not used again.

        Args:
            id: which object.

        Raises:
            KeyError: no object has this id.
            ValueError: the object belongs to a file.
        """
        self._native.remove(arguments.object_id(id))

    def copy(self) -> Scene:
        """A scene with the same objects and ids; changes to one do not show in the other.

        Meshes are shared until they change, so a copy costs next to nothing.
        """
        twin = object.__new__(type(self))
        twin._native = self._native.copy()
        return twin

    @property
    def ids(self) -> list[int]:
        """The ids of the objects, in rising order."""
        return self._native.ids()

    def cast_rays(
        self,
        rays: ArrayLike | None = None,
        *,
        origin: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: ArrayLike = ALL,
        out: dict[str, NDArray[Any]] | None = None,
        engine: str | None = None,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """Finds what each ray hits first.

        Args:
            rays: (..., 6), or ``None`` where ``origin`` and ``direction`` are given.
            origin: (3,) or (..., 3).
            direction: (3,) or (..., 3); it need not have length 1.
            t_min: where rays begin to hit, in lengths of their directions; one number or (...).
            t_max: where they end to.
            mask: which objects rays see; one number or (...).
            out: arrays to be written in place, by the names below; what is left out is not
                computed. They must have the dtype and shape below.
            engine: asks this engine in place of the scene's own.
            threads: works on so many threads in place of the scene's own number.

        Returns:
            ``out`` itself, or a dictionary of new arrays:

            - ``t_hit``, float32 (...): the distance in lengths of the direction; inf for a miss.
            - ``geometry_ids``, uint32 (...): the object; :data:`INVALID_ID` for a miss.
            - ``primitive_ids``, uint32 (...): the triangle or sphere in the object.
            - ``primitive_uvs``, float32 (..., 2): the hit is at ``(1 - u - v) v0 + u v1 + v v2``.
            - ``primitive_normals``, float32 (..., 3): of length 1, towards where the corners run
              counter-clockwise, or out of the sphere; 0 for a miss.

        Raises:
            ValueError: an array has another shape, ``out`` cannot be written in place or has a name
                that is none of these, or there is no such engine.
            TypeError: an array has another dtype, or both ``rays`` and ``origin`` are given.
        """
        question, shape = _question(rays, origin, direction, t_min, t_max, mask, engine, threads)
        answer = _new_hits(shape) if out is None else _given_hits(out, shape)
        self._native.closest_hit(question, _answer(answer, shape))
        return answer if out is None else out

    def test_occlusions(
        self,
        rays: ArrayLike | None = None,
        *,
        origin: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: ArrayLike = ALL,
        out: NDArray[np.bool_] | None = None,
        engine: str | None = None,
        threads: int | None = None,
    ) -> NDArray[np.bool_]:
        """Tells whether each ray hits anything at all, which is faster than asking what.

        Arguments as for :meth:`cast_rays`; ``out`` is an array of dtype bool and shape (...).

        Returns:
            bool (...): whether something lies within ``t_min..t_max``.
        """
        question, shape = _question(rays, origin, direction, t_min, t_max, mask, engine, threads)
        occluded = _array_or_new(out, np.bool_, shape)
        occluded.fill(False)  # np.empty may leave bytes that are no bool
        self._native.occluded(question, occluded.reshape(-1))
        return occluded

    def count_intersections(
        self,
        rays: ArrayLike | None = None,
        *,
        origin: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: ArrayLike = ALL,
        out: NDArray[np.int32] | None = None,
        engine: str | None = None,
        threads: int | None = None,
    ) -> NDArray[np.int32]:
        """Counts how often each ray crosses a surface.

        An object counts once at one distance, so a ray through an edge between two triangles
        crosses there once: an odd count from inside a closed mesh, an even one from outside.

        Arguments as for :meth:`cast_rays`; ``out`` is an array of dtype int32 and shape (...).

        Returns:
            int32 (...): how many hits lie within ``t_min..t_max``.
        """
        question, shape = _question(rays, origin, direction, t_min, t_max, mask, engine, threads)
        counts = _array_or_new(out, np.int32, shape)
        self._native.count_hits(question, counts.reshape(-1))
        return counts

    def list_intersections(
        self,
        rays: ArrayLike | None = None,
        *,
        origin: ArrayLike | None = None,
        direction: ArrayLike | None = None,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: ArrayLike = ALL,
        engine: str | None = None,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]:
        """Lists all hits of each ray, from near to far; see :meth:`count_intersections`.

        Arguments as for :meth:`cast_rays`.

        Returns:
            ``t_hit``, ``geometry_ids``, ``primitive_ids`` and ``primitive_uvs`` with one row a
            hit, ``ray_ids``, uint32 (hits,): whose hit it is, counting rays in C order, and
            ``ray_splits``, uint32 (rays + 1,): the hits of ray i are the rows from
            ``ray_splits[i]`` to ``ray_splits[i + 1]``.
        """
        question, _ = _question(rays, origin, direction, t_min, t_max, mask, engine, threads)
        hits = self._native.list_hits(question)
        hits["primitive_uvs"] = hits["primitive_uvs"].reshape(-1, 2)
        return hits

    def sense(
        self,
        sensor: Sensor | str | os.PathLike[str] = "spinning:64",
        *,
        time: float | None = None,
        engine: str | None = None,
        threads: int | None = None,
    ) -> Sweep:
        """Sweeps the scene with a LiDAR or a depth camera.

        What was loaded moves while the sensor looks: each column or row of beams meets it as it is
        at its own time. What was added rests as it is now, and so does the scene itself: its time
        stays. Files have their materials; what was added is grey and reflects 0.7 of the light.

        Args:
            sensor: a :class:`Sensor`, or the name or TOML file of one that is on a camera of the
                file, or where everything is in view.
            time: when the sweep begins, in seconds; by default at the time to which
                :meth:`evaluate` has moved the scene, or at 0.
            engine: traces by this engine in place of the scene's own; no point depends on it.
            threads: works on so many threads in place of the scene's own number.

        Returns:
            the points, in the order of beams, with all that is known of each.

        Raises:
            ValueError: there is no such camera, or a frame of a sequence is damaged.
            TypeError: ``sensor`` is none.
        """
        if not isinstance(sensor, Sensor):
            sensor = Sensor(sensor)
        start = None if time is None else _time(time)
        engine, threads = arguments.engine(engine), arguments.threads(threads)
        arrays = self._native.sense(sensor._options, start, engine, threads)
        return Sweep(**arrays, shape=sensor.shape)

    def evaluate(self, time: float) -> None:
        """Moves what was loaded by :func:`rayflock.load` to a time in seconds.

        Clips repeat. Objects that were added stay as they are.

        Args:
            time: in seconds; frame i of a file is at ``i / source.frame_rate``.

        Raises:
            ValueError: the scene was not loaded, the time is not finite, or a frame of a sequence
                is damaged.
        """
        self._native.evaluate(_time(time))

    @property
    def source(self) -> Source | None:
        """What the scene was loaded from; ``None`` if it was not."""
        found = self._native.source()
        return None if found is None else Source(**found)

    @property
    def stats(self) -> Stats:
        """Numbers about the objects, and about the last question: who answered, why, how long."""
        return Stats(**self._native.stats())

    create_rays_pinhole = staticmethod(create_rays_pinhole)
    create_rays_spherical = staticmethod(create_rays_spherical)

    def __repr__(self) -> str:
        stats = self.stats
        parts = [f"{stats.objects} objects", f"{stats.triangles} triangles"]
        if stats.spheres:
            parts.append(f"{stats.spheres} spheres")
        return f"<rayflock.Scene: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        return self.stats._repr_html_()


def _time(time: float) -> float:
    found = float(time)
    if not np.isfinite(found):
        raise ValueError(f"time must be finite, found {found}")
    return found


def _one_mask(mask: int) -> int:
    found = arguments.mask(mask)
    if not isinstance(found, int):
        raise ValueError("the mask of an object is one number")
    return found


def _radii(radii: ArrayLike, count: int) -> NDArray[np.float32]:
    array = arguments.floats(radii, "radii")
    if array.ndim == 0:
        return array.reshape(1)
    if array.shape != (count,):
        raise ValueError(f"radii must be one number or have shape ({count},), found {array.shape}")
    return array


def _question(
    rays: ArrayLike | None,
    origin: ArrayLike | None,
    direction: ArrayLike | None,
    t_min: ArrayLike,
    t_max: ArrayLike,
    mask: ArrayLike,
    engine: str | None,
    threads: int | None,
) -> tuple[dict[str, Any], tuple[int, ...]]:
    """What the compiled part is asked, and the shape of the answer."""
    if rays is not None:
        if origin is not None or direction is not None:
            raise TypeError("give either rays, or origin and direction, not both")
        rays = arguments.floats(rays, "rays")
        if rays.ndim == 0 or rays.shape[-1] != 6:
            raise ValueError(
                f"rays must have shape (..., 6), origin and direction; found {rays.shape}"
            )
        shape = rays.shape[:-1]
        rays = rays.reshape(-1, 6)
    elif origin is None or direction is None:
        raise TypeError("give either rays, or both origin and direction")
    else:
        origin, direction, shape = _points(origin, direction)
    question = {
        "rays": rays,
        "origin": origin,
        "direction": direction,
        "t_min": arguments.number(t_min, "t_min", shape),
        "t_max": arguments.number(t_max, "t_max", shape),
        "mask": arguments.mask(mask, shape),
        "image": _image(shape),
        "engine": arguments.engine(engine),
        "threads": arguments.threads(threads),
    }
    return question, shape


def _points(origin: ArrayLike, direction: ArrayLike) -> tuple[Any, Any, tuple[int, ...]]:
    """Origins and directions: three numbers for all rays, or rows; and the shape of the rays."""
    found = []
    for value, name in ((origin, "origin"), (direction, "direction")):
        array = arguments.floats(value, name)
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"{name} must have shape (3,) or (..., 3), found {array.shape}")
        found.append(array)
    origins, directions = found
    each = [array.shape[:-1] for array in found if array.ndim > 1]
    if len(each) == 2 and each[0] != each[1]:
        raise ValueError(
            f"origin and direction must have the same shape, or one of them (3,); "
            f"found {origins.shape} and {directions.shape}"
        )
    columns = [
        tuple(array.tolist()) if array.ndim == 1 else array.reshape(-1, 3) for array in found
    ]
    return columns[0], columns[1], each[0] if each else ()


def _image(shape: tuple[int, ...]) -> tuple[int, int] | None:
    """Rays a row and rows, where the rays are an image or several on top of each other."""
    if len(shape) < 2:
        return None
    rows = 1
    for count in shape[:-1]:
        rows *= count
    return shape[-1], rows


def _new_hits(shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
    return {name: np.empty(shape + tail, dtype) for name, (dtype, tail) in HITS.items()}


def _given_hits(out: dict[str, Any], shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
    """The arrays to be written, checked."""
    if not isinstance(out, dict):
        raise TypeError(
            "out must be a dictionary of arrays, such as one that cast_rays returned; "
            f"found {type(out).__name__}"
        )
    unknown = [name for name in out if name not in HITS]
    if unknown:
        raise ValueError(f"out has {unknown[0]!r}, which is none of: {', '.join(HITS)}")
    return {
        name: arguments.out(out[name], f"out[{name!r}]", dtype, shape + tail)
        for name, (dtype, tail) in HITS.items()
        if name in out
    }


def _answer(hits: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> dict[str, Any]:
    """The arrays as rows; with those that nobody asked for, but that others are made of."""
    answer = dict.fromkeys(HITS)
    for name, array in hits.items():
        tail = HITS[name][1]
        answer[name] = array.reshape((-1, *tail))
    needed = ["t_hit"]
    if "primitive_normals" in hits:
        needed += ["geometry_ids", "primitive_ids"]
    count = 1
    for extent in shape:
        count *= extent
    for name in needed:
        if answer[name] is None:
            answer[name] = np.empty(count, HITS[name][0])
    return answer


def _array_or_new(
    out: NDArray[Any] | None, dtype: type[np.generic], shape: tuple[int, ...]
) -> NDArray[Any]:
    return np.empty(shape, dtype) if out is None else arguments.out(out, "out", dtype, shape)
