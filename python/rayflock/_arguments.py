"""Arguments as the compiled part takes them: checked, and converted only where they must be.

An array that has the right type and lies in memory row by row comes out as itself, so that it is
read or written in place. Whatever is wrong is said in terms of the argument, with what to do.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Array = np.ndarray[Any, Any]

#: Every bit of a mask.
ALL = 0xFFFFFFFF
#: One more than the largest id.
ID_END = 0xFFFFFFFF


def floats(value: ArrayLike, name: str) -> Array:
    """An array of numbers, as float32 in C order."""
    array = np.asarray(value)
    if array.dtype == np.float32:
        return np.require(array, requirements=("C", "A"))
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must hold numbers, found dtype {array.dtype}")
    with np.errstate(over="ignore"):
        return np.require(array, np.float32, ("C", "A"))


def rows(value: ArrayLike, name: str, columns: int) -> Array:
    """An array of shape (n, columns), as float32."""
    array = floats(value, name)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} must have shape (n, {columns}), found {array.shape}")
    return array


def triangles(value: ArrayLike) -> Array:
    """An array of vertex numbers of shape (n, 3), as uint32."""
    array = np.asarray(value)
    if array.size == 0 and array.ndim <= 2:
        return np.empty((0, 3), np.uint32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"triangles must have shape (n, 3), found {array.shape}")
    if array.dtype.kind not in "iu":
        raise TypeError(
            f"triangles must hold vertex numbers, found dtype {array.dtype}: "
            "convert them by triangles.astype(numpy.uint32)"
        )
    if array.dtype != np.uint32:
        check_range(array)
    return np.require(array, np.uint32, ("C", "A"))


def check_range(triangles: Array) -> None:
    """Refuses vertex numbers that conversion to uint32 would change."""
    wrong = (triangles < 0) | (triangles >= ID_END)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise IndexError(
            f"triangle {row} names vertex {triangles[row, column]}: vertices are counted from 0"
        )


def number(value: ArrayLike, name: str, shape: tuple[int, ...]) -> float | Array:
    """A number for all rays, or an array of one for each of ``shape``, flat, as float32."""
    if isinstance(value, (float, int)):
        return float(value)
    array = floats(value, name)
    return float(array) if array.ndim == 0 else spread(array, name, shape)


def mask(value: ArrayLike, shape: tuple[int, ...] = ()) -> int | Array:
    """A mask for all rays, or an array of one for each of ``shape``, flat, as uint32."""
    if isinstance(value, int) and 0 <= value <= ALL:
        return int(value)
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"mask must hold whole numbers, found dtype {array.dtype}")
    if array.size and (array.min() < 0 or array.max() > ALL):
        raise ValueError("mask must lie in 0..0xFFFFFFFF: it has 32 bits")
    array = np.require(array, np.uint32, ("C", "A"))
    return int(array) if array.ndim == 0 else spread(array, "mask", shape)


def scalar(value: ArrayLike, name: str) -> float:
    """One number."""
    array = np.asarray(value)
    if array.ndim or array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be one number, found {value!r}")
    return float(array)


def whole(value: int, name: str) -> int:
    """A whole number."""
    try:
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, found {type(value).__name__}") from None


def count(value: int, name: str, least: int, most: int) -> int:
    """A whole number within limits, both included."""
    found = whole(value, name)
    if not least <= found <= most:
        raise ValueError(f"{name} must lie in {least}..{most}, found {found}")
    return found


def triple(value: ArrayLike, name: str) -> tuple[float, float, float]:
    """A point, a direction or a colour."""
    array = floats(value, name)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name} must be three finite numbers, found {array.tolist()}")
    return tuple(array.tolist())


def spread(array: Array, name: str, shape: tuple[int, ...]) -> Array:
    """One value a ray, flat; broadcast where there are fewer."""
    if array.shape != shape:
        try:
            array = np.ascontiguousarray(np.broadcast_to(array, shape))
        except ValueError:
            raise ValueError(
                f"{name} must be one number or have the shape of the rays, {shape}; "
                f"found {array.shape}"
            ) from None
    return array.reshape(-1)


def object_id(value: int) -> int:
    """The id of an object."""
    try:
        found = operator.index(value)
    except TypeError:
        raise TypeError(f"an id is a whole number, found {type(value).__name__}") from None
    if not 0 <= found < ID_END:
        raise KeyError(f"no object has the id {found}: ids come from add and add_spheres")
    return found


def engine(value: str | None) -> str | None:
    """The name of an engine; the compiled part knows which there are."""
    if value is not None and not isinstance(value, str):
        raise TypeError(f"engine must be a name such as 'auto', found {type(value).__name__}")
    return value


def threads(value: int | None) -> int | None:
    """A number of threads."""
    if value is None:
        return None
    try:
        count = operator.index(value)
    except TypeError:
        raise TypeError(
            f"threads must be a whole number or None, found {type(value).__name__}"
        ) from None
    if not 1 <= count <= 1024:
        raise ValueError(f"threads must lie in 1..1024, or be None for one a core; found {count}")
    return count


def out(value: Any, name: str, dtype: type[np.generic], shape: tuple[int, ...]) -> Array:
    """An array to be written in place."""
    if not isinstance(value, np.ndarray):
        raise TypeError(f"{name} must be a numpy.ndarray, found {type(value).__name__}")
    if value.dtype != dtype:
        raise TypeError(f"{name} must have dtype {np.dtype(dtype)}, found {value.dtype}")
    if value.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, found {value.shape}")
    if not value.flags.writeable:
        raise ValueError(f"{name} is read-only: it cannot be written")
    if not value.flags.carray:
        raise ValueError(
            f"{name} must lie in memory row by row: make it by numpy.empty, "
            "or by numpy.ascontiguousarray"
        )
    return value
