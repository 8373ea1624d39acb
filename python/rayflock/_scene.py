"""The scene: what can be hit, and questions about it."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import _arguments as arguments
from rayflock import _native
from rayflock._arguments import ALL
from rayflock._questions import answer_rows, array_or_new, asked, given_hits, new_hits
from rayflock._rays import create_rays_pinhole, create_rays_spherical
from rayflock._sensor import Sensor
from rayflock._stats import Source, Stats
from rayflock._sweep import Sweep


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
        question, shape = asked(rays, origin, direction, t_min, t_max, mask, engine, threads)
        answer = new_hits(shape) if out is None else given_hits(out, shape)
        self._native.closest_hit(question, answer_rows(answer, shape))
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
        question, shape = asked(rays, origin, direction, t_min, t_max, mask, engine, threads)
        occluded = array_or_new(out, np.bool_, shape)
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
        question, shape = asked(rays, origin, direction, t_min, t_max, mask, engine, threads)
        counts = array_or_new(out, np.int32, shape)
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
        question, _ = asked(rays, origin, direction, t_min, t_max, mask, engine, threads)
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
