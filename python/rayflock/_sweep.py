"""What sensors bring back."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import _native
from rayflock._picture import Picture


#: What files of points hold, and its type.
COLUMNS = (
    *((name, np.float32) for name in ("position", "position_in_sensor", "normal")),
    *((name, np.float32) for name in ("range", "intensity", "world_from_sensor")),
    *((name, np.float64) for name in ("time", "step_time")),
    *((name, np.uint32) for name in ("object_id", "prim_id", "beam", "row", "column")),
    *((name, np.uint8) for name in ("return_number", "return_count")),
)


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """What a sensor brought back: N points, in the order of beams and then of ranges, and where it
    was in each of S time steps. Arrays are named as in the NPZ files of ``rayflock sense``."""

    #: Points in world space, with noise: float32 (N, 3).
    position: NDArray[np.float32]
    #: The same in the frame of the sensor at that time: float32 (N, 3).
    position_in_sensor: NDArray[np.float32]
    #: Unit normals of facets in world space, on the sensor's side: float32 (N, 3).
    normal: NDArray[np.float32]
    #: Distances along beams, with noise: float32 (N,).
    range: NDArray[np.float32]
    #: How much light came back; from white that faces the sensor at a distance of 1 it is 1:
    #: float32 (N,).
    intensity: NDArray[np.float32]
    #: When, in seconds of the scene: float64 (N,).
    time: NDArray[np.float64]
    #: The objects, by their ids in the scene: uint32 (N,).
    object_id: NDArray[np.uint32]
    #: The triangle or sphere within the object: uint32 (N,).
    prim_id: NDArray[np.uint32]
    #: The beam, counted in the order in which they are fired: uint32 (N,).
    beam: NDArray[np.uint32]
    #: Row of the beam, from the top; the ring of a spinning sensor: uint32 (N,).
    row: NDArray[np.uint32]
    #: Column of the beam, from the left: uint32 (N,).
    column: NDArray[np.uint32]
    #: Which of the beam's told returns it is, from 1 on: uint8 (N,).
    return_number: NDArray[np.uint8]
    #: How many of the beam's returns are told: uint8 (N,).
    return_count: NDArray[np.uint8]
    #: When each time step was, in seconds of the scene: float64 (S,).
    step_time: NDArray[np.float64]
    #: Where the sensor was in each time step: float32 (S, 4, 4).
    world_from_sensor: NDArray[np.float32]
    #: Rows and columns of the picture that beams make; ``None`` for a rosette.
    shape: tuple[int, int] | None

    def __len__(self) -> int:
        return len(self.range)

    @property
    def depth(self) -> NDArray[np.float32]:
        """Distances from the sensor's plane, along the axis in which it looks: float32 (N,)."""
        return -self.position_in_sensor[:, 2]

    @property
    def range_image(self) -> NDArray[np.float32]:
        """Ranges of first returns: float32 (rows, columns), inf where there is none."""
        return self.image(self.range, np.inf)

    @property
    def depth_image(self) -> NDArray[np.float32]:
        """Depths of first returns: float32 (rows, columns), inf where there is none."""
        return self.image(self.depth, np.inf)

    @property
    def intensity_image(self) -> NDArray[np.float32]:
        """Intensities of first returns: float32 (rows, columns), 0 where there is none."""
        return self.image(self.intensity, 0.0)

    def image(self, values: ArrayLike, nothing: Any) -> NDArray[Any]:
        """Puts values where the beams of first returns are: (rows, columns, ...).

        Args:
            values: one for each point, (N, ...), such as ``sweep.normal``.
            nothing: what is put where no point is.

        Returns:
            an array of the dtype of ``values``; row 0 is the top row.

        Raises:
            ValueError: the beams make no picture, or there are not N values.
        """
        if self.shape is None:
            raise ValueError("the beams of a rosette make no picture: use position and column")
        values = np.asarray(values)
        if values.shape[:1] != (len(self),):
            raise ValueError(f"values must have shape ({len(self)}, ...), found {values.shape}")
        image = np.full(self.shape + values.shape[1:], nothing, values.dtype)
        is_first = self.return_number == 1
        image[self.row[is_first], self.column[is_first]] = values[is_first]
        return image

    def picture(self, show: str = "range") -> Picture:
        """Shows ranges, depths or intensities of first returns in viridis from the least to the
        most, a pixel a beam: uint8 (rows, columns, 3). What sent nothing back is light grey.

        Args:
            show: "range", "depth" or "intensity".

        Raises:
            ValueError: the beams make no picture, or ``show`` is none of these.
        """
        if show not in ("range", "depth", "intensity"):
            raise ValueError(f"show must be range, depth or intensity, found {show!r}")
        values = self.image(getattr(self, show), np.nan)
        return _false_colors(values).view(Picture)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file of points, as ``rayflock sense`` does, by the extension of its name:

        - ``.ply``: points in world space with all that is known of them, coloured by range;
        - ``.pcd``: the same but colours and the frame of the sensor, for the Point Cloud Library;
        - ``.npz``: all arrays by their names, with the three pictures if beams make any;
        - ``.csv``: a line a point.

        Args:
            path: where to; a file that is there is replaced.

        Raises:
            ValueError: the name has another extension, or arrays have different lengths.
            OSError: the file cannot be written; of a missing folder FileNotFoundError.
        """
        columns = {name: np.require(getattr(self, name), dtype, "C") for name, dtype in COLUMNS}
        columns["world_from_sensor"] = columns["world_from_sensor"].reshape(-1, 16)
        columns["color"] = _false_colors(columns["range"])
        images = None
        if self.shape is not None and os.fspath(path).lower().endswith(".npz"):
            names = ("range", "depth", "intensity")
            pixels = {name: getattr(self, f"{name}_image").reshape(-1) for name in names}
            images = {"shape": self.shape, **pixels}
        _native.save_points(os.fspath(path), columns, images)

    def __repr__(self) -> str:
        return f"<rayflock.Sweep: {len(self):,} points>"

    def _repr_png_(self) -> bytes | None:
        return None if self.shape is None else self.picture()._repr_png_()


def _false_colors(values: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Viridis from the least to the most, and light grey for NaN: uint8 (..., 3)."""
    values = values.astype(np.float64)  # as the program does: colours are the same to the bit
    seen = values[np.isfinite(values)]
    least, most = (seen.min(), seen.max()) if seen.size else (0.0, 0.0)
    if most > least:
        shares = (values - least) / (most - least)
    else:
        shares = np.where(np.isnan(values), values, 0.5)
    colors = _native.false_colors(np.ascontiguousarray(shares, np.float32).reshape(-1))
    return colors.reshape(*values.shape, 3)
