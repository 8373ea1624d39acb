"""Scenes from files."""

from __future__ import annotations

import os
import warnings

from rayflock._scene import Scene


def load(
    path: str | os.PathLike[str],
    *,
    clip: str | None = None,
    up: str = "y",
    interpolate: bool = False,
    frame_rate: float | None = None,
    detail: int | None = None,
    engine: str = "auto",
    threads: int | None = None,
) -> Scene:
    """Reads a scene, at time 0; :meth:`Scene.evaluate` moves it.

    Args:
        path: a file (glTF, OBJ, PLY, STL, VTK, AFF, NFF, NPZ, PC2, MDD), a folder or pattern of
            meshes, one a frame, or ``"builtin:NAME"``.
        clip: which animation is played, by name; by default the first.
        up: "y", or "z" for files that do not say which way is up and mean +Z.
        interpolate: move vertices straight from frame to frame of a sequence.
        frame_rate: frames a second of a sequence; by default what it states, or else 24.
        detail: level of detail up to which an AFF file includes others.
        engine: as for :class:`Scene`.
        threads: as for :class:`Scene`.

    Returns:
        the scene; :attr:`Scene.source` tells what is in the file.

    Raises:
        FileNotFoundError: there is no such file.
        ValueError: what is in the file breaks the rules of its format, with the place; or there is
            no such clip. What can be borne is a warning.
    """
    if frame_rate is not None:
        frame_rate = _rate(frame_rate)
    options = {
        "up": up,
        "interpolate": bool(interpolate),
        "frame_rate": frame_rate,
        "detail": detail,
    }
    scene = Scene(engine=engine, threads=threads)
    for warning in scene._native.load(os.fspath(path), clip, options):
        warnings.warn(warning, stacklevel=2)
    return scene


def _rate(value: float) -> float:
    rate = float(value)
    if not 0.0 < rate < float("inf"):
        raise ValueError(f"frame_rate must be a positive number, found {rate}")
    return rate
