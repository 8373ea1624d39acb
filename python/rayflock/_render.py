"""Pictures of scenes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rayflock import _arguments as arguments
from rayflock._picture import Picture
from rayflock._scene import Scene

#: The longest edge of a picture in pixels, as in the program.
MAX_EDGE = 16_384


def render(
    scene: Scene,
    *,
    width: int = 640,
    height: int = 360,
    camera: str | None = None,
    eye: ArrayLike | None = None,
    center: ArrayLike | None = None,
    up: ArrayLike = (0.0, 1.0, 0.0),
    fov_deg: float = 60.0,
    samples: int = 1,
    depth: int = 5,
    shadows: bool = True,
    background: ArrayLike | None = None,
    exposure: float = 0.0,
    tone_map: str = "srgb",
    linear: bool = False,
    engine: str | None = None,
    threads: int | None = None,
) -> Picture:
    """Renders a scene as it is now: shadows, mirrors and glass of files, everything else in grey.

    Args:
        scene: what is seen.
        width: pixels a row, at most 16384.
        height: rows, at most 16384.
        camera: a camera of the file, by name; by default its first. A scene without cameras is
            seen as a whole, with +Y up.
        eye: where to look from instead, (3,), with ``center``.
        center: where to look to, (3,).
        up: which way is up in the picture, (3,).
        fov_deg: horizontal angle of view in degrees.
        samples: rays through each pixel; more make edges smoother.
        depth: how often a ray may be mirrored or refracted.
        shadows: whether lights cast shadows.
        background: linear colour of what lies behind everything, (3,).
        exposure: stops by which the picture is brighter.
        tone_map: "srgb", or "agx", which fades bright colours to white.
        linear: return float32 of linear light, without ``exposure`` and ``tone_map``.
        engine: traces by this engine in place of the scene's own.
        threads: works on so many threads in place of the scene's own number.

    Returns:
        uint8 (height, width, 3) as on a screen; with ``linear`` float32. Row 0 is the top row.

    Raises:
        ValueError: there is no such camera, tone map or engine, or a number is out of its range.
        TypeError: something has another type, or ``eye`` comes without ``center``.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a rayflock.Scene, found {type(scene).__name__}")
    if (eye is None) != (center is None):
        raise TypeError("give both eye and center, or neither")
    if camera is not None and eye is not None:
        raise TypeError("give either a camera, or eye and center, not both")
    size = _size(width, height)
    question: dict[str, Any] = {
        **size,
        "camera": camera,
        **_view(eye, center, up, fov_deg),
        "samples": arguments.count(samples, "samples", 1, 65_536),
        "depth": arguments.count(depth, "depth", 0, 32),
        "shadows": bool(shadows),
        "background": None if background is None else arguments.triple(background, "background"),
        "exposure": float(exposure),
        "tone_map": tone_map,
        "linear": bool(linear),
        "engine": arguments.engine(engine),
        "threads": arguments.threads(threads),
    }
    pixels = scene._native.render(question)
    return pixels.reshape(size["height"], size["width"], 3).view(Picture)


def _size(width: int, height: int) -> dict[str, int]:
    size = {"width": arguments.whole(width, "width"), "height": arguments.whole(height, "height")}
    if not all(1 <= edge <= MAX_EDGE for edge in size.values()):
        raise ValueError(
            f"width and height must lie in 1..{MAX_EDGE}, found {size['width']} x {size['height']}"
        )
    return size


def _view(
    eye: ArrayLike | None, center: ArrayLike | None, up: ArrayLike, fov_deg: float
) -> dict[str, Any]:
    if eye is None or center is None:
        return {"eye": None, "center": None, "up": None, "fov_deg": None}
    if not 0.0 < fov_deg < 180.0:
        raise ValueError(f"fov_deg must lie between 0 and 180 degrees, found {fov_deg}")
    given = (("eye", eye), ("center", center), ("up", up))
    view = {name: arguments.triple(value, name) for name, value in given}
    ahead = np.subtract(view["center"], view["eye"])
    if not np.linalg.norm(np.cross(ahead, view["up"])) > 0.0:
        raise ValueError("up must not be parallel to the direction from eye to center")
    return {**view, "fov_deg": float(fov_deg)}
