"""``open3d.t.geometry.RaycastingScene``, with NumPy arrays in place of tensors.

>>> from rayflock.compat.open3d import RaycastingScene

What differs, and why:

- Answers are NumPy arrays; ``.numpy()`` is not needed, and not there. Arguments may be whatever
  ``numpy.asarray`` takes; where Open3D refuses float64, it is converted.
- Vertex numbers out of range raise ``IndexError``, where Open3D reads beyond the array.
- ``t_hit`` and ``primitive_uvs`` differ in their last bits, and where a ray hits an edge or two
  surfaces at one distance, the other triangle may be named: ours is the lowest one.
- ``list_intersections`` lists the hits of a ray from near to far, and an object once at one
  distance. Open3D's order is that of its traversal, and so is whether a ray through a common edge
  counts once or twice.
- Geometry can change: ``update_triangles`` and ``remove`` are ours.
- The questions about closest points and distances are not there: they are not about rays.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import INVALID_ID, Scene, create_rays_pinhole


class RaycastingScene:
    """Triangle meshes, and what rays hit of them."""

    INVALID_ID = INVALID_ID

    def __init__(self, nthreads: int = 0, device: Any = None) -> None:
        """``nthreads`` threads work, 0 for one a core; ``device`` is always the CPU."""
        self.scene = Scene(threads=nthreads or None)

    def add_triangles(self, *args: Any, **kwargs: Any) -> int:
        """Adds a mesh, ``(vertex_positions, triangle_indices)`` or ``(mesh)``; returns its id.

        Positions are (n, 3), float32, and indices (m, 3), uint32; a mesh is an
        ``open3d.t.geometry.TriangleMesh``.

        Raises:
            IndexError: a triangle names a vertex that is not there.
        """
        return self.scene.add(*_mesh(args, kwargs))

    def update_triangles(
        self,
        geometry_id: int,
        vertex_positions: ArrayLike,
        triangle_indices: ArrayLike | None = None,
    ) -> None:
        """Replaces a mesh by another one, of any topology; not in Open3D.

        Args:
            geometry_id: which mesh.
            vertex_positions: (n, 3), float32.
            triangle_indices: (m, 3), uint32; by default those that the mesh has.

        Raises:
            KeyError: there is no such mesh.
        """
        self.scene.update(geometry_id, vertex_positions, triangle_indices)

    def remove(self, geometry_id: int) -> None:
        """Takes a mesh out; not in Open3D. Raises ``KeyError`` where there is none."""
        self.scene.remove(geometry_id)

    def cast_rays(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, NDArray[Any]]:
        """What each ray hits first: see :meth:`rayflock.Scene.cast_rays`."""
        return self.scene.cast_rays(rays, threads=nthreads or None)

    def test_occlusions(
        self, rays: ArrayLike, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0
    ) -> NDArray[np.bool_]:
        """Whether rays hit anything, bool (...): see :meth:`rayflock.Scene.test_occlusions`."""
        return self.scene.test_occlusions(rays, t_min=tnear, t_max=tfar, threads=nthreads or None)

    def count_intersections(self, rays: ArrayLike, nthreads: int = 0) -> NDArray[np.int32]:
        """How often rays hit, int32 (...): see :meth:`rayflock.Scene.count_intersections`."""
        return self.scene.count_intersections(rays, threads=nthreads or None)

    def list_intersections(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, NDArray[Any]]:
        """All hits of each ray: see :meth:`rayflock.Scene.list_intersections`."""
        return self.scene.list_intersections(rays, threads=nthreads or None)

    create_rays_pinhole = staticmethod(create_rays_pinhole)


def _mesh(args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[Any, Any]:
    """Vertices and triangles of either form of ``add_triangles``."""
    values = [*args, *kwargs.values()]
    if len(values) == 1 and hasattr(values[0], "vertex"):
        mesh = values[0]
        return _array(mesh.vertex["positions"]), _array(mesh.triangle["indices"])
    names = ("vertex_positions", "triangle_indices")
    given = dict(zip(names, args, strict=False)) | kwargs
    if len(args) > 2 or set(given) != set(names):
        raise TypeError(
            "add_triangles takes vertex_positions and triangle_indices, or a mesh of open3d.t"
        )
    return _array(given[names[0]]), _array(given[names[1]])


def _array(tensor: Any) -> Any:
    """A tensor of Open3D as an array; anything else as it is."""
    return tensor.numpy() if hasattr(tensor, "numpy") else tensor
