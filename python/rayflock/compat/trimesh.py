"""``trimesh.ray``'s ``RayMeshIntersector``.

>>> from rayflock.compat.trimesh import RayMeshIntersector

Takes a ``trimesh.Trimesh``, or whatever has ``vertices`` and ``faces``.

What differs, and why:

- ``multiple_hits`` goes on exactly beyond each hit. trimesh moves the origin by a small step, and
  can miss a surface that is closer than that behind another, or meet one twice.
- Hits of a ray follow each other from near to far, and rays in order. trimesh lists the first hits
  of all rays, then the second ones, and so on.
- A ray through an edge between two triangles meets one of them.
- ``scale_to_box`` has no effect: nothing depends on the scale. Coordinates are counted from the
  corner of the mesh's box, as in trimesh, so that meshes may lie far from the origin.
- Changed vertices are taken in by the next question, without anything being built anew.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import Scene


class RayMeshIntersector:
    """Questions about rays and one mesh."""

    def __init__(self, geometry: Any, scale_to_box: bool = True) -> None:
        """Asks about ``geometry``; it may change between questions."""
        self.mesh = geometry
        self._scale_to_box = scale_to_box
        self._scene = Scene()
        self._id = self._scene.add(np.empty((0, 3)), np.empty((0, 3), np.uint32))
        self._vertices: NDArray[Any] = np.empty((0, 3))
        self._faces: NDArray[Any] = np.empty((0, 3), np.int64)
        self._corner: NDArray[np.float64] = np.zeros(3)

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Returns where rays hit.

        Args:
            ray_origins: (n, 3).
            ray_directions: (n, 3), of any length.
            multiple_hits: all hits of each ray, or only the first one.

        Returns:
            locations (m, 3), index_ray (m,) and index_tri (m,).
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits, return_locations=True
        )
        return locations, index_ray, index_tri

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int = 100,
        return_locations: bool = False,
    ) -> tuple[NDArray[Any], ...]:
        """Returns which triangles rays hit: index_tri (m,), index_ray (m,), and locations (m, 3) if
        ``return_locations``; at most ``max_hits`` for each ray."""
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._current_scene()
        if multiple_hits:
            hits = scene.list_intersections(origin=origins - self._corner, direction=directions)
            rank = np.arange(len(hits["ray_ids"])) - hits["ray_splits"][hits["ray_ids"]]
            kept = rank < max_hits
            index_ray = hits["ray_ids"][kept].astype(np.int64)
            index_tri = hits["primitive_ids"][kept].astype(np.int64)
            t_hit = hits["t_hit"][kept]
        else:
            hits = scene.cast_rays(origin=origins - self._corner, direction=directions)
            index_ray = np.flatnonzero(np.isfinite(hits["t_hit"]))
            index_tri = hits["primitive_ids"][index_ray].astype(np.int64)
            t_hit = hits["t_hit"][index_ray]
        if not return_locations:
            return index_tri, index_ray
        return (
            index_tri,
            index_ray,
            self._locations(origins, directions, index_ray, index_tri, t_hit),
        )

    def intersects_first(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.int32]:
        """Returns which triangle each ray hits first, (n,); -1 for a miss."""
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._current_scene()
        hits = scene.cast_rays(origin=origins - self._corner, direction=directions)
        return hits["primitive_ids"].view(np.int32)

    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.bool_]:
        """Returns whether each ray hits anything, (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        scene = self._current_scene()
        return scene.test_occlusions(origin=origins - self._corner, direction=directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Returns whether each point is inside the mesh, (n,), by trimesh's own way of asking."""
        from trimesh.ray.ray_util import contains_points

        return contains_points(self, points)

    def _current_scene(self) -> Scene:
        """The scene, with the mesh as it is now, moved to the origin of single precision."""
        vertices, faces = np.asarray(self.mesh.vertices), np.asarray(self.mesh.faces)
        if not (_same(vertices, self._vertices) and _same(faces, self._faces)):
            self._vertices, self._faces = vertices.copy(), faces.copy()
            # A vertex that is not finite costs its own triangles alone.
            finite = vertices[np.isfinite(vertices).all(axis=1)]
            self._corner = finite.min(axis=0) if len(finite) else np.zeros(3)
            self._scene.update(self._id, vertices - self._corner, faces)
        return self._scene

    def _locations(
        self,
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
        index_ray: NDArray[np.int64],
        index_tri: NDArray[np.int64],
        t_hit: NDArray[np.float32],
    ) -> NDArray[np.float64]:
        """Where rays meet the planes of their triangles, in double precision as trimesh does it;
        where a ray runs within the plane, where it was hit."""
        origins, directions = origins[index_ray], directions[index_ray]
        a, b, c = np.moveaxis(np.asarray(self.mesh.vertices)[self.mesh.faces[index_tri]], 1, 0)
        normals = np.cross(b - a, c - a)
        across = np.einsum("ij,ij->i", normals, directions)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.einsum("ij,ij->i", normals, a - origins) / across
        t = np.where(np.isclose(t, t_hit, rtol=1e-3, atol=1e-6), t, t_hit)
        return origins + t[:, None] * directions

    def __copy__(self, *args: Any) -> RayMeshIntersector:
        return type(self)(self.mesh, self._scale_to_box)

    __deepcopy__ = __copy__

    def __getstate__(self) -> dict[str, Any]:
        return {"mesh": self.mesh, "_scale_to_box": self._scale_to_box}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(type(self)(state["mesh"], state["_scale_to_box"]).__dict__)


def _same(a: NDArray[Any], b: NDArray[Any]) -> bool:
    return np.array_equal(a, b, equal_nan=True)


def _rays(
    ray_origins: ArrayLike, ray_directions: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origins, and directions of length 1; zero where there is none."""
    origins = np.array(ray_origins, np.float64)
    directions = np.array(ray_directions, np.float64)
    if origins.shape != directions.shape:
        raise ValueError("Ray origin and direction don't match!")
    length = np.linalg.norm(directions, axis=-1, keepdims=True)
    return origins, np.divide(directions, length, out=np.zeros_like(directions), where=length > 0)
