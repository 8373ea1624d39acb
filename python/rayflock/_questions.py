"""From what the questions of a scene are given to what the compiled part takes and fills."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import _arguments as arguments

#: What :meth:`Scene.cast_rays` tells, with what each entry has beside the shape of the rays.
HITS: dict[str, tuple[type[np.generic], tuple[int, ...]]] = {
    "t_hit": (np.float32, ()),
    "geometry_ids": (np.uint32, ()),
    "primitive_ids": (np.uint32, ()),
    "primitive_uvs": (np.float32, (2,)),
    "primitive_normals": (np.float32, (3,)),
}


def asked(
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


def new_hits(shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
    """Arrays for all that is told."""
    return {name: np.empty(shape + tail, dtype) for name, (dtype, tail) in HITS.items()}


def given_hits(out: dict[str, Any], shape: tuple[int, ...]) -> dict[str, NDArray[Any]]:
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


def answer_rows(hits: dict[str, NDArray[Any]], shape: tuple[int, ...]) -> dict[str, Any]:
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


def array_or_new(
    out: NDArray[Any] | None, dtype: type[np.generic], shape: tuple[int, ...]
) -> NDArray[Any]:
    """The array to be written, checked, or a new one."""
    return np.empty(shape, dtype) if out is None else arguments.out(out, "out", dtype, shape)
