"""What sensors bring back."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rayflock import _native
from rayflock._picture import Picture


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
        """
        if show not in ("range", "depth", "intensity"):
            raise ValueError(f"show must be range, depth or intensity, found {show!r}")
        values = self.image(getattr(self, show), np.nan)
        seen = values[np.isfinite(values)]
        least, most = (seen.min(), seen.max()) if seen.size else (0.0, 0.0)
        if most > least:
            shares = (values - least) / (most - least)
        else:
            shares = np.where(np.isnan(values), values, np.float32(0.5))
        colors = _native.false_colors(np.ascontiguousarray(shares, np.float32).reshape(-1))
        return colors.reshape(*values.shape, 3).view(Picture)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the arrays by their names as NPZ, with the three pictures if beams make any: the
        file that ``rayflock sense`` writes, which also writes PLY, PCD and CSV."""
        if not os.fspath(path).endswith(".npz"):
            raise ValueError(f"the name of the file must end in .npz, found {os.fspath(path)}")
        arrays = {field.name: getattr(self, field.name) for field in fields(self)}
        del arrays["shape"]
        if self.shape is not None:
            names = ("range_image", "depth_image", "intensity_image")
            arrays |= {name: getattr(self, name) for name in names}
        np.savez_compressed(path, **arrays)

    def __repr__(self) -> str:
        return f"<rayflock.Sweep: {len(self):,} points>"

    def _repr_png_(self) -> bytes | None:
        return None if self.shape is None else self.picture()._repr_png_()
