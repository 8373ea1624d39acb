"""What a scene tells about itself, and about the file that it is from."""

from __future__ import annotations

from dataclasses import dataclass, fields
from html import escape


@dataclass(frozen=True)
class Stats:
    """Numbers about a scene, and about what it was asked last."""

    #: Objects in the scene.
    objects: int
    #: Triangles in all objects.
    triangles: int
    #: Spheres in all objects.
    spheres: int
    #: Primitives that are ignored because a coordinate is NaN or infinite.
    non_finite: int
    #: Primitives that are ignored because they have no area, or a radius that is not positive.
    degenerate: int
    #: Which engine answered last; the scene's own, if none has.
    engine: str
    #: Why it was chosen, where the engine is ``auto``.
    reason: str | None
    #: How long the engine took to take the objects in, in seconds.
    update_seconds: float
    #: How long the last question took, in seconds, without what Python does around it.
    query_seconds: float
    #: Rays of the last question.
    rays: int
    #: Rays that were NaN, infinite, or had no direction: misses.
    invalid_rays: int
    #: Tests of rays against triangles, in SIMD lanes.
    triangle_tests: int
    #: Tests against boxes, in SIMD lanes.
    box_tests: int
    #: Tests of cones against spheres, in SIMD lanes.
    cone_tests: int
    #: Bytes that the engine holds besides the meshes.
    engine_bytes: int

    def __str__(self) -> str:
        return "\n".join(f"{name:>15}  {value}" for name, value in self._rows())

    def _repr_html_(self) -> str:
        row = "<tr><th style='text-align:left'>{}</th><td style='text-align:left'>{}</td></tr>"
        lines = (row.format(escape(name), escape(value)) for name, value in self._rows())
        return f"<table>{''.join(lines)}</table>"

    def _rows(self) -> list[tuple[str, str]]:
        rows = []
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name.endswith("_seconds"):
                rows.append((field.name.removesuffix("_seconds"), f"{value * 1e3:.3f} ms"))
            elif value is not None:
                rows.append(
                    (
                        field.name.replace("_", " "),
                        f"{value:,}" if isinstance(value, int) else value,
                    )
                )
        return rows


@dataclass(frozen=True)
class Source:
    """What a scene was loaded from."""

    #: Name of the file or generator.
    name: str
    #: Names of the objects; the one at place i has the id i.
    objects: list[str]
    #: Names of the clips, one of which is played.
    clips: list[str]
    #: Names of the cameras.
    cameras: list[str]
    #: Frames a second that the file states, or else 24.
    frame_rate: float
    #: Frames that show the whole motion once: frame i is at ``i / frame_rate`` seconds.
    frame_count: int
    #: The time that was evaluated last, in seconds.
    time: float
