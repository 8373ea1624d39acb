#!/usr/bin/env python3
"""Converts USD and Alembic files to the .npz frame sets that Rayflock reads.

    pip install numpy usd-core alembic3d
    python to_npz.py dance.usdc -o dance.npz
    python to_npz.py 'splash.*.usda.gz' -o splash.npz
    rayflock render dance.npz -o dance.gif

usd-core is wanted for .usd, .usda, .usdc and .usdz, alembic3d for .abc. Several files are frames
one after the other, in natural order. docs/formats.md tells what is read of them.
"""

from __future__ import annotations

import argparse
import glob
import importlib
import re
import sys
from pathlib import Path
from types import ModuleType

from frame_set import Frame, write

USD = (".usd", ".usda", ".usdc", ".usdz")


def main(arguments: list[str] | None = None) -> int:
    """Converts, and says in words what went wrong."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("inputs", nargs="+", metavar="INPUT", help="files, or quoted patterns")
    parser.add_argument("-o", "--output", required=True, type=Path, help="the .npz file")
    parser.add_argument(
        "--fps", type=float, help="frames a second [default: what the file states]"
    )
    options = parser.parse_args(arguments)
    try:
        if options.output.suffix != ".npz":
            raise ValueError(f"found the output {options.output}, expected a name ending in .npz")
        if options.fps is not None and not 0 < options.fps < float("inf"):
            raise ValueError(f"found {options.fps} frames a second, expected a positive number")
        convert(files(options.inputs), options.output, options.fps)
    except (ValueError, OSError, ImportError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def convert(paths: list[Path], output: Path, fps: float | None) -> None:
    """Writes the frames of all files to one frame set."""
    frames: list[Frame] = []
    rate = fps
    for path in paths:
        try:
            more, stated_rate = frames_of(path, fps)
        except (ValueError, RuntimeError) as error:
            raise ValueError(f"{path}: {error}") from None
        frames.extend(more)
        rate = rate or stated_rate
    write(output, frames, rate or 24.0)
    print(f"{len(frames)} frames, {rate or 24.0:g} a second: {output}")


def frames_of(path: Path, fps: float | None) -> tuple[list[Frame], float | None]:
    """The frames of a file, and their rate; `None` where there is one frame."""
    source = opened(path)
    times = source.times(None if fps is None else source.times_per_second / fps)
    frames, left_out = [], {}
    for time in times:
        frames.append(source.frame(time))
        left_out |= source.left_out
    for kind, count in sorted(left_out.items()):
        print(f"warning: {path}: {count} of type {kind} are left out", file=sys.stderr)
    if len(times) < 2:
        return frames, None
    rate = source.times_per_second * (len(times) - 1) / (times[-1] - times[0])
    return frames, round(rate, 6)


def opened(path: Path):
    """The file, by the package that reads it."""
    name = path.name.lower().removesuffix(".gz")
    if not path.is_file():
        raise ValueError("there is no such file")
    if name.endswith(USD):
        usd_frames = package("usd_frames", "usd-core")
        return usd_frames.UsdFile(path)
    if path.suffix.lower() == ".abc":
        abc_frames = package("abc_frames", "alembic3d")
        return abc_frames.AbcFile(path)
    raise ValueError(f"expected one of {', '.join(USD)} (each also .gz) or .abc")


def package(module: str, name: str) -> ModuleType:
    """A module of ours that wants a package."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"{error}; install it by: pip install {name}") from None


def files(inputs: list[str]) -> list[Path]:
    """The files that names and patterns stand for, in natural order."""
    found: list[str] = []
    for word in inputs:
        matches = [word] if Path(word).exists() else glob.glob(word)
        if not matches:
            raise ValueError(f"{word}: there is no such file")
        found.extend(matches)
    return [Path(name) for name in sorted(found, key=natural)]


def natural(name: str) -> list[tuple[int, str]]:
    """A key by which numbers in names are in order of their values."""
    parts = re.split(r"(\d+)", name)
    return [(int(part), "") if part.isdigit() else (-1, part) for part in parts]


if __name__ == "__main__":
    sys.exit(main())
