"""Rays of cameras and scanners, as arrays of the shape (rows, columns, 6)."""

from __future__ import annotations

from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: The id of no object and of no primitive.
INVALID_ID = 0xFFFFFFFF

Rays = NDArray[np.float32]


@overload
def create_rays_pinhole(
    intrinsic_matrix: ArrayLike, extrinsic_matrix: ArrayLike, width_px: int, height_px: int
) -> Rays: ...


@overload
def create_rays_pinhole(
    fov_deg: float,
    center: ArrayLike,
    eye: ArrayLike,
    up: ArrayLike,
    width_px: int,
    height_px: int,
) -> Rays: ...


def create_rays_pinhole(*args, **kwargs) -> Rays:
    """Makes the rays of a pinhole camera, as Open3D's function of the same name does.

    Either from ``intrinsic_matrix`` (3, 3) and ``extrinsic_matrix`` (4, 4), world to camera, or
    from ``fov_deg`` (horizontal, in degrees), ``center`` (looked at), ``eye`` and ``up``.

    Returns:
        float32 of shape (height_px, width_px, 6): origin and direction of the ray through the
        middle of each pixel. Directions have length 1 along the camera's axis, so ``t_hit`` is
        depth. Made from ``up``, the first row is the one farthest down and the first column the
        one farthest right, as in Open3D: ``rays[::-1, ::-1]`` is the picture the right way round.

    Raises:
        ValueError: a matrix cannot be inverted or has another shape, ``up`` is along the view, or
            ``fov_deg`` does not lie between 0 and 180.
        TypeError: arguments are neither those of the one form nor of the other.
    """
    names = _signature(args, kwargs)
    values = dict(zip(names, args, strict=False))
    values.update(kwargs)
    if set(values) != set(names):
        raise TypeError(f"create_rays_pinhole takes {', '.join(names)}; found {', '.join(values)}")
    size = (_pixels(values["width_px"], "width_px"), _pixels(values["height_px"], "height_px"))
    if "fov_deg" in values:
        intrinsic, extrinsic = _matrices(values, size)
    else:
        intrinsic = _matrix(values["intrinsic_matrix"], "intrinsic_matrix", (3, 3))
        extrinsic = _matrix(values["extrinsic_matrix"], "extrinsic_matrix", (4, 4))
    return _rays_of(intrinsic, extrinsic, size)


def _signature(args: tuple, kwargs: dict) -> tuple[str, ...]:
    """The parameters of the form that is meant."""
    from_matrices = ("intrinsic_matrix", "extrinsic_matrix", "width_px", "height_px")
    from_view = ("fov_deg", "center", "eye", "up", "width_px", "height_px")
    has_matrix = "intrinsic_matrix" in kwargs or (args and np.ndim(args[0]) == 2)
    return from_matrices if has_matrix else from_view


def _matrices(values: dict, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Intrinsic and extrinsic matrix of a camera that looks from a point to another."""
    fov_deg = float(values["fov_deg"])
    if not 0.0 < fov_deg < 180.0:
        raise ValueError(f"fov_deg must lie between 0 and 180 degrees, found {fov_deg}")
    center, eye, up = (_matrix(values[name], name, (3,)) for name in ("center", "eye", "up"))
    width, height = size
    focal = 0.5 * width / np.tan(0.5 * np.deg2rad(fov_deg))
    intrinsic = np.array([[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]])
    ahead = center - eye
    side = np.cross(up, ahead)
    if not np.linalg.norm(side) > 0.0:
        raise ValueError("up must not be parallel to the direction from eye to center")
    rotation = np.stack([side, np.cross(ahead, side), ahead])
    rotation /= np.linalg.norm(rotation, axis=1, keepdims=True)
    extrinsic = np.eye(4)
    extrinsic[:3, :3], extrinsic[:3, 3] = rotation, -rotation @ eye
    return intrinsic, extrinsic


def _rays_of(intrinsic: np.ndarray, extrinsic: np.ndarray, size: tuple[int, int]) -> Rays:
    try:
        to_camera = np.linalg.inv(intrinsic)
        to_world = np.linalg.inv(extrinsic)
    except np.linalg.LinAlgError:
        raise ValueError("intrinsic_matrix and extrinsic_matrix must be invertible") from None
    width, height = size
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays = np.empty((height, width, 6), np.float32)
    rays[..., :3] = to_world[:3, 3]
    rays[..., 3:] = pixels @ (to_world[:3, :3] @ to_camera).T
    return rays


def create_rays_spherical(
    eye: ArrayLike,
    width_px: int,
    height_px: int,
    *,
    azimuth_deg: tuple[float, float] = (180.0, -180.0),
    elevation_deg: tuple[float, float] = (90.0, -90.0),
    forward: ArrayLike = (1.0, 0.0, 0.0),
    up: ArrayLike = (0.0, 0.0, 1.0),
) -> Rays:
    """Makes the rays of a panorama, or of a scanner that turns.

    Args:
        eye: where all rays start, (3,).
        width_px: number of columns, evenly spaced from the first to the second ``azimuth_deg``.
        height_px: number of rows, evenly spaced from the first to the second ``elevation_deg``.
        azimuth_deg: degrees about ``up``, counter-clockwise from ``forward``.
        elevation_deg: degrees towards ``up`` from the plane across it.
        forward: where azimuth is 0; what it has of ``up`` is left out.
        up: the axis.

    Returns:
        float32 of shape (height_px, width_px, 6); directions have length 1. The ray of a pixel
        goes through its middle, so no ray is at the very first or last angle.

    Raises:
        ValueError: something has another shape, or ``up`` is along ``forward``.
    """
    width, height = _pixels(width_px, "width_px"), _pixels(height_px, "height_px")
    origin, ahead, axis = (
        _matrix(value, name, (3,))
        for value, name in ((eye, "eye"), (forward, "forward"), (up, "up"))
    )
    left = np.cross(axis, ahead)
    if not np.linalg.norm(left) > 0.0:
        raise ValueError("up must not be parallel to forward")
    axes = np.stack([np.cross(left, axis), left, axis])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)

    azimuth = np.deg2rad(_steps(azimuth_deg, "azimuth_deg", width))[None, :]
    elevation = np.deg2rad(_steps(elevation_deg, "elevation_deg", height))[:, None]
    across = np.cos(elevation)
    local = (across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation) + 0 * azimuth)
    rays = np.empty((height, width, 6), np.float32)
    rays[..., :3] = origin
    rays[..., 3:] = np.stack(local, axis=-1) @ axes
    return rays


def _steps(ends: tuple[float, float], name: str, count: int) -> np.ndarray:
    first, last = _matrix(ends, name, (2,))
    return first + (last - first) * (np.arange(count) + 0.5) / max(count, 1)


def _matrix(value: ArrayLike, name: str, shape: tuple[int, ...]) -> np.ndarray:
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must hold numbers, found dtype {array.dtype}")
    if array.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, found {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, found {array.tolist()}")
    return array.astype(np.float64)


def _pixels(value: int, name: str) -> int:
    try:
        count = value.__index__()
    except AttributeError:
        raise TypeError(f"{name} must be a whole number, found {type(value).__name__}") from None
    if not 0 <= count <= 1 << 20:
        raise ValueError(f"{name} must lie in 0..2**20, found {count}")
    return count
