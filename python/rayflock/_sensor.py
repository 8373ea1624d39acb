"""Sensors: LiDAR and depth cameras."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from rayflock import _native
from rayflock import _sensor_options as sensor_options


class Sensor:
    """A LiDAR or a depth camera: where its beams go and when, where it is, and what it sees.

    What is not given is as in the preset. Lengths are in units of the scene, angles in degrees,
    times in seconds. The sensor's frame is that of a camera: it looks along its -Z, with +Y up and
    +X to the right. :meth:`Scene.sense` sweeps with it.

    Args:
        sensor: "spinning:16", ":32", ":64" or ":128" (rows of beams that turn around),
            "solid-state" (a raster), "rosette" (a beam that two turning prisms bend), "depth" (a
            pinhole camera), "ortho" (parallel beams), or the path of a TOML file as ``rayflock
            sense`` takes it. What is given here counts more than what the file says.
        at: where the sensor is, (3,); or its pose, (4, 4), which takes points of the sensor to the
            world. Without, it is on a camera of the file and moves along with it; without cameras,
            where everything is in view.
        look_at: a point that it looks to, (3,), with +Y up; by default it looks along -Z.
        poses: where it is when: a list of (time, at) or (time, at, look_at). It goes straight from
            place to place, on the shortest turn.
        camera: on which camera of the file it is, by name; by default the first.
        rows: rows of a spinning sensor, spread evenly over its elevations.
        elevations: of each of its rows, from the top; or "A..B" for the first and the last.
        columns: columns of its revolution.
        size: beams across and down of solid-state, depth and ortho.
        fov: angles of view across and up of solid-state; up of depth, by default that of the camera
            it is on; across a rosette.
        extent: width and height of what ortho scans; by default what the whole motion needs.
        beams: beams of a sweep of a rosette.
        turns: turns a second of its two prisms.
        rate: sweeps a second: revolutions, pictures.
        shutter: "global", or "rolling" for depth and ortho row by row.
        time_steps: how often a sweep looks at the scene; by default once for each column of a
            spinning sensor, for each row of others, for 64 beams of a rosette. Fewer are faster.
        min_range: nearer points are not told, 0 by default.
        max_range: nor are farther ones; by default all are.
        noise: standard deviation of ranges, 0 by default.
        noise_per_range: what is added to it in proportion to the range.
        drop_out: the chance from 0 to 1 that an echo is lost.
        drop_out_grazing: the chance at grazing incidence, less towards the normal.
        drop_out_far: the chance at ``max_range``, less, by the square, nearby.
        min_intensity: weaker echoes are lost; 1 is white, facing, at a distance of 1.
        returns: which echoes of a beam are told: "first" (by default), "strongest", "last",
            "first+last", "first+strongest", "strongest+last" or "all".
        dust: the share of light that glass scatters at least, 0.02 by default.
        panes: how many surfaces of glass a beam passes at most, 8 by default.
        seed: chooses noise and drop-outs, 0 by default.

    Raises:
        ValueError: there is no such preset, a number is out of its range, or the file is damaged.
        TypeError: an option has another type, or says nothing about this sensor.
        FileNotFoundError: there is no such file.
    """

    def __init__(
        self,
        sensor: str | os.PathLike[str] = "spinning:64",
        *,
        at: ArrayLike | None = None,
        look_at: ArrayLike | None = None,
        poses: Sequence[tuple[Any, ...]] | None = None,
        camera: str | None = None,
        rows: int | None = None,
        elevations: ArrayLike | str | None = None,
        columns: int | None = None,
        size: tuple[int, int] | None = None,
        fov: float | tuple[float, float] | None = None,
        extent: tuple[float, float] | None = None,
        beams: int | None = None,
        turns: tuple[float, float] | None = None,
        rate: float | None = None,
        shutter: str | None = None,
        time_steps: int | None = None,
        min_range: float | None = None,
        max_range: float | None = None,
        noise: float | None = None,
        noise_per_range: float | None = None,
        drop_out: float | None = None,
        drop_out_grazing: float | None = None,
        drop_out_far: float | None = None,
        min_intensity: float | None = None,
        returns: str | None = None,
        dust: float | None = None,
        panes: int | None = None,
        seed: int | None = None,
    ) -> None:
        arguments = dict(locals())
        del arguments["self"], arguments["sensor"]
        given = {name: value for name, value in arguments.items() if value is not None}
        self._options = sensor_options.resolve(sensor, given)
        self._about = _native.describe_sensor(self._options)

    @property
    def rate(self) -> float:
        """Sweeps a second: sweep s begins at ``s / rate`` seconds."""
        return self._about["rate"]

    @property
    def beam_count(self) -> int:
        """Beams of a sweep."""
        return self._about["beam_count"]

    @property
    def shape(self) -> tuple[int, int] | None:
        """Rows and columns of the picture that beams make; ``None`` for a rosette."""
        return self._about["shape"]

    @property
    def time_steps(self) -> int:
        """How often a sweep looks at the scene."""
        return self._about["time_steps"]

    def __repr__(self) -> str:
        preset, beams = self._options["preset"], f"{self.beam_count:,} beams"
        return f"<rayflock.Sensor: {preset}, {beams}, {self.rate:g} Hz>"
