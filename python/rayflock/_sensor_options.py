"""What a sensor is, as the compiled part takes it: checked, be it from arguments or from a file."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from rayflock import _arguments as arguments

Options = dict[str, Any]


def numbers(value: Any, name: str, count: int | None, separator: str) -> tuple[float, ...]:
    """So many finite numbers, or any number of them; files may have them as text."""
    given = value
    if isinstance(value, str):
        try:
            given = [float(part) for part in value.lower().split(separator)]
        except ValueError:
            given = []
    array = np.asarray(given)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must hold numbers, found {value!r}")
    is_row = array.ndim == 1 and array.size > 0 and count in (None, array.size)
    if not is_row or not np.isfinite(array).all():
        raise ValueError(f"{name} must be {count or 'some'} finite numbers, found {value!r}")
    return tuple(array.astype(np.float64).tolist())


def elevations(value: Any, name: str) -> list[float] | tuple[float, ...]:
    """A list of one a row; or, from text such as "15..-25", a tuple of the first and the last."""
    if isinstance(value, str) and ".." in value:
        return numbers(value.replace("..", "|"), name, 2, "|")
    return list(numbers(value, name, None, ","))


def angles(value: Any, name: str) -> tuple[float, ...]:
    """One angle or two, in degrees."""
    is_one = not isinstance(value, str) and np.ndim(value) == 0
    found = numbers([value] if is_one else value, name, None, "x")
    if len(found) > 2:
        raise ValueError(f"{name} must be one angle or two, found {value!r}")
    return found


def size(value: Any, name: str) -> tuple[int, ...]:
    """Beams across and down."""
    edges = numbers(value, name, 2, "x")
    if not all(edge.is_integer() and 1 <= edge <= 16_384 for edge in edges):
        raise ValueError(f"{name} must be two whole numbers in 1..16384, found {value!r}")
    return tuple(int(edge) for edge in edges)


def word(value: Any, name: str) -> str:
    """A name, of which the compiled part knows which there are."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be text, found {type(value).__name__}")
    return value


def pose(at: Any, look_at: Any = None) -> tuple[Any, Any, Any]:
    """Place, place that is looked at, and rotation row by row; both or one of the last are None."""
    if isinstance(at, str) or np.shape(at) != (4, 4):
        target = None if look_at is None else numbers(look_at, "look_at", 3, ",")
        return numbers(at, "at", 3, ","), target, None
    if look_at is not None:
        raise TypeError("at is a matrix, which says where the sensor looks: leave look_at out")
    matrix = np.asarray(at)
    if matrix.dtype.kind not in "fiu":
        raise TypeError(f"at must hold numbers, found dtype {matrix.dtype}")
    matrix = matrix.astype(np.float64)
    turn = matrix[:3, :3]
    is_pose = np.allclose(turn @ turn.T, np.eye(3), atol=1e-4) and np.linalg.det(turn) > 0.0
    if not is_pose or not np.allclose(matrix[3], (0, 0, 0, 1)):
        raise ValueError(
            "at must be a pose, world from sensor: a (4, 4) matrix that turns and moves, and "
            f"neither scales nor mirrors; found {matrix.tolist()}"
        )
    return numbers(matrix[:3, 3], "at", 3, ","), None, tuple(turn.ravel().tolist())


def poses(value: Any, name: str) -> list[tuple[Any, ...]]:
    """Poses, each with its time before."""
    expected = f"{name} must be a list of (time, at) or (time, at, look_at)"
    try:
        found = [tuple(each) for each in value]
    except TypeError:
        raise TypeError(f"{expected}, found {value!r}") from None
    if not found or not all(len(each) in (2, 3) for each in found):
        raise ValueError(f"{expected}, found {value!r}")
    return [
        (arguments.scalar(time, "the time of a pose"), *pose(*place)) for time, *place in found
    ]


_beams = partial(arguments.count, least=1, most=1 << 24)

#: How each option is checked.
CHECKS: dict[str, Callable[[Any, str], Any]] = {
    "poses": poses,
    "camera": word,
    "rows": _beams,
    "elevations": elevations,
    "columns": _beams,
    "size": size,
    "fov": angles,
    "extent": partial(numbers, count=2, separator="x"),
    "beams": _beams,
    "turns": partial(numbers, count=2, separator=","),
    "rate": arguments.scalar,
    "shutter": word,
    "time_steps": _beams,
    "min_range": arguments.scalar,
    "max_range": arguments.scalar,
    "noise": arguments.scalar,
    "noise_per_range": arguments.scalar,
    "drop_out": arguments.scalar,
    "drop_out_grazing": arguments.scalar,
    "drop_out_far": arguments.scalar,
    "min_intensity": arguments.scalar,
    "returns": word,
    "dust": arguments.scalar,
    "panes": partial(arguments.count, least=0, most=64),
    "seed": partial(arguments.count, least=0, most=(1 << 64) - 1),
}
#: The keys of files, and which options they are.
KEYS = {
    "pose": "poses",
    **{name.replace("_", "-"): name for name in ("at", "look_at", *CHECKS)},
}
del KEYS["poses"], KEYS["camera"]


def resolve(sensor: Any, given: Options) -> Options:
    """All options of a sensor by the name of a preset or a file; those of the file count less."""
    try:
        preset = os.fspath(sensor)
    except TypeError:
        preset = None
    if not isinstance(preset, str):
        raise TypeError(
            "sensor must be a rayflock.Sensor, the name of a preset or the path of a TOML file, "
            f"found {type(sensor).__name__}"
        )
    options = checked(given)
    if preset.lower().endswith(".toml"):
        preset, of_file = read(preset)
        if options.keys() & {"poses", "camera"}:
            of_file.pop("poses", None)
        options = of_file | options
    return {"preset": preset, "elevation_ends": None, **dict.fromkeys(CHECKS), **arranged(options)}


def checked(given: Options) -> Options:
    """The options that are given, each as it should be."""
    placed = [name for name in ("at", "poses", "camera") if name in given]
    if len(placed) > 1:
        raise TypeError(f"give either {placed[0]} or {placed[1]}: both say where the sensor is")
    if "look_at" in given and "at" not in given:
        raise TypeError("look_at says where a sensor looks that at places: give at, too")
    found = {name: CHECKS[name](value, name) for name, value in given.items() if name in CHECKS}
    if "at" in given:
        found["poses"] = [(0.0, *pose(given["at"], given.get("look_at")))]
    return found


def arranged(options: Options) -> Options:
    """The options as the compiled part has them."""
    found = {"poses": [], **options}
    if isinstance(found.get("elevations"), tuple):
        found["elevation_ends"] = found.pop("elevations")
    return found


def read(path: str) -> tuple[str, Options]:
    """The preset and the options of a file, which the program ``rayflock sense`` takes too."""
    with open(path, "rb") as file:
        try:
            table = tomllib.load(file)
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise ValueError(f"{path}: {error}") from None
    preset = table.pop("sensor", None)
    if not isinstance(preset, str):
        raise ValueError(f'{path}: expected the name of a preset, as in sensor = "spinning:64"')
    for key in table:
        if key not in KEYS:
            raise ValueError(f"{path}: found the key {key}, expected one of {', '.join(KEYS)}")
    try:
        if "pose" in table:
            table["pose"] = [pose_of_table(each) for each in table["pose"]]
        return preset, checked({KEYS[key]: value for key, value in table.items()})
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


def pose_of_table(table: Any) -> tuple[Any, ...]:
    """Time, place and perhaps the place that is looked at, of a ``[[pose]]``."""
    keys = set(table) if isinstance(table, dict) else set()
    if not {"time", "at"} <= keys <= {"time", "at", "look-at"}:
        raise ValueError(f"found the pose {table}, expected time and at, and perhaps look-at")
    return tuple(table[key] for key in ("time", "at", "look-at") if key in table)
