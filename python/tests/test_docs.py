"""Every block of Python in the documentation runs, in the order of its page."""

import doctest
import re
from pathlib import Path

import pytest
import rayflock

ROOT = Path(__file__).resolve().parents[2]
PAGES = ["README.md", "docs/python.md"]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", PAGES)
def test_blocks_run(page, tmp_path, monkeypatch):
    text = (ROOT / page).read_text(encoding="utf-8")
    blocks = [(text[: match.start()].count("\n") + 2, match[1]) for match in BLOCK.finditer(text)]
    assert blocks, f"{page} has no block of Python"
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__docs__"}
    for line, block in blocks:
        code = compile("\n" * (line - 1) + block, str(ROOT / page), "exec")
        exec(code, names)


def test_the_example_of_the_package_runs():
    failed, tried = doctest.testmod(rayflock)
    assert tried and not failed
