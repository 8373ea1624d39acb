"""Every block of Python in the documentation runs, in the order of its page, and the pages that are
made from something are as it is."""

import doctest
import importlib.util
import re
import struct
from pathlib import Path

import pytest
import rayflock

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", "docs/python.md", "docs/gallery.md"]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", PAGES)
def test_blocks_run(page, tmp_path, monkeypatch):
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = [(text[: match.start()].count("\n") + 2, match[1]) for match in BLOCK.finditer(text)]
    assert blocks, f"{page} has no block of Python"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GALLERY_SCALE", "0.1")
    names = {"__name__": "__docs__"}
    for line, block in blocks:
        code = compile("\n" * (line - 1) + block, str(ROOT / page), "exec")
        exec(code, names)


def test_pictures_of_the_gallery_are_there_and_small():
    text = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[.+?\]\((images/.+?\.png)\)", text)
    assert len(pictures) == text.count('.save("')
    for picture in pictures:
        png = (ROOT / "docs" / picture).read_bytes()
        assert struct.unpack(">II", png[16:24]) == (800, 450), picture
        assert len(png) < 150_000, picture


def test_the_reference_is_as_the_docstrings_are():
    path = ROOT / "python/tools/api_reference.py"
    spec = importlib.util.spec_from_file_location("api_reference", path)
    api_reference = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(api_reference)
    page = api_reference.PAGE.read_text(encoding="utf-8")
    assert page == api_reference.page(), "run python python/tools/api_reference.py"


def test_the_example_of_the_package_runs():
    failed, tried = doctest.testmod(rayflock)
    assert tried and not failed
