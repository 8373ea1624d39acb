"""Arrays of pixels that notebooks show."""

from __future__ import annotations

import os

import numpy as np

from rayflock import _native


class Picture(np.ndarray):
    """An array of pixels, (height, width, 3), that notebooks show: uint8 as on a screen, or float32
    of linear light."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a PNG file.

        Args:
            path: where to; a file that is there is replaced.

        Raises:
            ValueError: the picture is not of dtype uint8 and shape (height, width, 3).
            OSError: the file cannot be written.
        """
        with open(path, "wb") as file:
            file.write(self._png())

    def _repr_png_(self) -> bytes | None:
        is_picture = self.ndim == 3 and self.shape[2] == 3 and self.size and self.dtype == np.uint8
        return self._png() if is_picture else None

    def _png(self) -> bytes:
        if self.dtype != np.uint8 or self.ndim != 3 or self.shape[2] != 3 or not self.size:
            raise ValueError(
                "only pictures of dtype uint8 and shape (height, width, 3) can be written as PNG; "
                f"this is {self.dtype} of shape {self.shape}"
            )
        pixels = np.ascontiguousarray(self).view(np.ndarray).reshape(-1, 3)
        return _native.encode_png(pixels, self.shape[1])
