"""``embreex.rtcore_scene`` and ``embreex.mesh_construction`` in one module.

>>> from rayflock.compat.embreex import EmbreeScene, TriangleMesh

What differs, and why:

- Float64 is converted, where embreex refuses it; ``dists`` of float64 get no answer in place.
- ``output`` with ``query="OCCLUDED"`` raises ``ValueError``: embreex answers with memory that it
  has not written.
- Meshes may be added after rays were traced; embreex ignores them then, and answers without.
- ``tfar``, ``u`` and ``v`` differ in their last bits, and where a ray hits an edge, the other
  triangle may be named: ours is the lowest one.
- ``ElementMesh`` is not there: it makes triangles of hexahedra and tetrahedra.
- A mesh can change: ``TriangleMesh.update`` is ours.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import INVALID_ID, Scene

#: How far rays go, where nothing else is said.
FAR = np.float32(1e37)
QUERIES = ("INTERSECT", "OCCLUDED", "DISTANCE")


class EmbreeScene:
    """Triangle meshes, and what rays hit of them."""

    def __init__(self, device: Any = None, robust: bool = False) -> None:
        """Both arguments are there for embreex: every scene is robust."""
        self.scene = Scene()
        self.is_committed = 0

    def run(
        self,
        vec_origins: NDArray[np.float32],
        vec_directions: NDArray[np.float32],
        dists: ArrayLike | None = None,
        query: str = "INTERSECT",
        output: Any = None,
    ) -> Any:
        """Traces rays.

        Args:
            vec_origins: (n, 3).
            vec_directions: (n, 3), or (1, 3) for all.
            dists: how far rays go, in lengths of their directions; one number or (n,). With
                ``query="DISTANCE"`` or ``output``, an array of float32 (n,) gets the distances
                in place, and is what is returned.
            query: "INTERSECT", "OCCLUDED" or "DISTANCE".
            output: if true, the answer is a dictionary of what was hit.

        Returns:
            int32 (n,): which triangle is hit first, or 0 if occluded; -1 for a miss. Float32 (n,)
            with "DISTANCE": where the ray ends. A dictionary with ``output``: ``u``, ``v``, ``Ng``,
            ``tfar``, ``primID`` and ``geomID``.

        Raises:
            ValueError: there is no such query, an array has another shape, or ``output`` is wanted
                of "OCCLUDED".
            TypeError: points are no arrays.
        """
        if query not in QUERIES:
            raise ValueError(
                f"Embree ray query type {query} not recognized.\n"
                f"Accepted types are ({','.join(QUERIES)})"
            )
        if output and query == "OCCLUDED":
            raise ValueError("with query='OCCLUDED' there is no output: what is hit is not known")
        self.is_committed = 1
        origins, directions = _points(vec_origins), _points(vec_directions)
        if len(directions) == 1:
            directions = np.ascontiguousarray(np.broadcast_to(directions, origins.shape))
        ends = np.full(len(origins), FAR if dists is None else dists, np.float32)
        rays: dict[str, Any] = {"origin": origins, "direction": directions, "t_max": ends}
        if query == "OCCLUDED":
            return self.scene.test_occlusions(**rays).astype(np.int32) - 1
        hits = self.scene.cast_rays(**rays)
        is_hit = hits["geometry_ids"] != INVALID_ID
        if not output and query == "INTERSECT":
            return hits["primitive_ids"].view(np.int32)
        t_far = _in_place(np.where(is_hit, hits["t_hit"], ends), dists)
        return self._output(hits, is_hit, t_far) if output else t_far

    def _output(
        self, hits: dict[str, NDArray[Any]], is_hit: NDArray[np.bool_], t_far: NDArray[np.float32]
    ) -> dict[str, NDArray[Any]]:
        """What was hit; Embree's normals are as long as two areas of their triangles."""
        normals = hits["primitive_normals"]
        for geometry_id, mesh in _meshes(self).items():
            of_mesh = is_hit & (hits["geometry_ids"] == geometry_id)
            normals[of_mesh] = mesh.normals(hits["primitive_ids"][of_mesh])
        u, v = hits["primitive_uvs"].T
        return {
            "u": np.ascontiguousarray(u),
            "v": np.ascontiguousarray(v),
            "Ng": normals,
            "tfar": t_far,
            "primID": hits["primitive_ids"].view(np.int32),
            "geomID": hits["geometry_ids"].view(np.int32),
        }


class TriangleMesh:
    """A mesh in a scene."""

    def __init__(
        self, scene: EmbreeScene, vertices: ArrayLike, indices: ArrayLike | None = None
    ) -> None:
        """Adds a mesh: ``vertices`` (n, 3) with ``indices`` (m, 3), or (m, 3, 3) without."""
        self._scene = scene.scene
        self._keep(vertices, indices)
        self._id = self._scene.add(self._vertices, self._triangles)
        _meshes(scene)[self._id] = self

    def update(self, vertices: ArrayLike, indices: ArrayLike | None = None) -> None:
        """Replaces the mesh by another one, of any topology, given as at first; not in embreex."""
        self._keep(vertices, indices)
        self._scene.update(self._id, self._vertices, self._triangles)

    def normals(self, triangles: NDArray[np.uint32]) -> NDArray[np.float32]:
        """Normals of some triangles, as long as two areas: float32 (n, 3)."""
        a, b, c = (self._vertices[self._triangles[triangles, corner]] for corner in range(3))
        return np.cross(b - a, c - a)

    def _keep(self, vertices: ArrayLike, indices: ArrayLike | None) -> None:
        self._vertices = np.array(vertices, np.float32)
        if indices is None:
            if self._vertices.ndim != 3 or self._vertices.shape[1:] != (3, 3):
                raise ValueError(
                    "without indices, vertices must have shape (triangles, 3, 3), "
                    f"found {self._vertices.shape}"
                )
            self._vertices = self._vertices.reshape(-1, 3)
            indices = np.arange(len(self._vertices), dtype=np.uint32).reshape(-1, 3)
        self._triangles = np.array(indices)


def _meshes(scene: EmbreeScene) -> dict[int, TriangleMesh]:
    """The meshes of a scene by their ids."""
    return scene.__dict__.setdefault("_meshes", {})


def _in_place(t_far: NDArray[np.float32], dists: ArrayLike | None) -> NDArray[np.float32]:
    """``dists`` with the distances, where it is an array that can hold them."""
    if not isinstance(dists, np.ndarray):
        return t_far
    if (dists.dtype, dists.shape) != (t_far.dtype, t_far.shape):
        return t_far
    dists[:] = t_far
    return dists


def _points(points: NDArray[np.float32]) -> NDArray[np.float32]:
    if not isinstance(points, np.ndarray):
        raise TypeError(f"expected a numpy.ndarray of points, found {type(points).__name__}")
    if points.ndim != 2:
        raise ValueError(f"Buffer has wrong number of dimensions (expected 2, got {points.ndim})")
    return points
