"""Ray tracing for scenes that never hold still.

Hand a :class:`Scene` this frame's triangles and a batch of rays as NumPy arrays; get hits. All
triangles may move, appear or vanish from frame to frame: there is nothing to refit or rebuild.

>>> import numpy as np, rayflock
>>> scene = rayflock.Scene()
>>> vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
>>> triangle = scene.add(vertices, [[0, 1, 2]])
>>> scene.cast_rays([[0.25, 0.25, 2, 0, 0, -1]])["t_hit"].tolist()
[2.0]
>>> scene.update(triangle, vertices + [0, 0, 1])
>>> scene.cast_rays([[0.25, 0.25, 2, 0, 0, -1]])["t_hit"].tolist()
[1.0]
"""

from rayflock._files import load
from rayflock._native import VERSION as __version__
from rayflock._picture import Picture
from rayflock._rays import INVALID_ID, create_rays_pinhole, create_rays_spherical
from rayflock._render import render
from rayflock._scene import Scene
from rayflock._sensor import Sensor
from rayflock._stats import Source, Stats
from rayflock._sweep import Sweep

__all__ = [
    "INVALID_ID",
    "Picture",
    "Scene",
    "Sensor",
    "Source",
    "Stats",
    "Sweep",
    "__version__",
    "create_rays_pinhole",
    "create_rays_spherical",
    "load",
    "render",
]
