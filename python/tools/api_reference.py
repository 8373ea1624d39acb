"""Writes docs/python-api.md, the reference of the Python package, from its docstrings.

    python python/tools/api_reference.py

The package must be installed. A test compares the page that is committed with what this makes.
Docstrings are in Google's form; what they call :meth:`this` or ``that`` becomes code.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import textwrap
import types
import typing
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "python-api.md"
#: The modules that users import, in the order of the page.
MODULES = ("rayflock", "rayflock.compat.trimesh", "rayflock.compat.open3d", "rayflock.compat.embreex")
HEAD = """\
# Reference of the Python package

This page is made from the docstrings by `python python/tools/api_reference.py`; `help(rayflock.Scene)` says the same.
[Rayflock in Python](python.md) is where to begin, the [gallery](gallery.md) shows what can be done.
"""
SECTIONS = {"Args": "Arguments", "Returns": "Returns", "Raises": "Raises"}
#: The widest line of a signature.
WIDTH = 92


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for name in MODULES:
        module = importlib.import_module(name)
        parts += [f"## {name}\n", prose(inspect.getdoc(module))]
        parts += [public(name, getattr(module, name), module) for name in public_names(module)]
    return "\n".join(part.rstrip() + "\n" for part in parts)


def public_names(module: types.ModuleType) -> list[str]:
    """What a module offers, in the order of its source."""
    if hasattr(module, "__all__"):
        return [name for name in module.__all__ if not name.startswith("__")]
    own = {
        name: value
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__
    }
    return list(own)


def public(name: str, value: object, module: types.ModuleType) -> str:
    """A class, a function or a number."""
    if inspect.isclass(value):
        return class_entry(name, value)
    if inspect.isfunction(value):
        return f"### {name}\n\n{function_entry(name, value)}"
    text = comments(importlib.import_module("rayflock._rays"))[name]
    return f"### {name}\n\n`{name} = {number(value)}`\n\n{prose(text)}"


def class_entry(name: str, kind: type) -> str:
    """A class with its constructor, attributes and methods, in the order of its source."""
    parts = [f"### {name}"]
    init = vars(kind).get("__init__")
    is_data = hasattr(kind, "__dataclass_fields__")
    if inspect.isfunction(init) and not is_data:
        parts.append(code(signature(name, init, skip=1)))
    parts.append(prose(inspect.getdoc(kind)))
    if inspect.isfunction(init) and not is_data and init.__doc__:
        parts.append(prose(inspect.getdoc(init)))
    attributes = comments(kind)
    if is_data and list(attributes) != list(kind.__dataclass_fields__):
        raise ValueError(f"some attributes of {name} have no #: over them")
    if attributes:
        rows = [f"| `{name}` | {line(text)} |" for name, text in attributes.items()]
        parts.append("\n".join(["| Attribute | What it is |", "|---|---|", *rows]))
    for member, value in vars(kind).items():
        if member.startswith("_"):
            continue
        full = f"{name}.{member}"
        if isinstance(value, property):
            kind_of = inspect.signature(value.fget).return_annotation
            called = code(f"{member}: {kind_of}")
            parts.append(f"#### {full}\n\n{called}\n\n{prose(inspect.getdoc(value))}")
        elif isinstance(value, staticmethod):
            target = value.__func__
            parts.append(f"#### {full}\n\nThe function [`{target.__name__}`](#{target.__name__}).")
        elif inspect.isfunction(value):
            parts.append(f"#### {full}\n\n{function_entry(member, value, skip=1)}")
    return "\n\n".join(parts)


def function_entry(name: str, function: types.FunctionType, skip: int = 0) -> str:
    """A function: how it is called, and what it does."""
    forms = typing.get_overloads(function) or [function]
    called = "\n".join(signature(name, form, skip) for form in forms)
    return f"{code(called)}\n\n{prose(inspect.getdoc(function))}"


def code(text: str) -> str:
    return f"```python\n{text}\n```"


def signature(name: str, function: types.FunctionType, skip: int = 0) -> str:
    """How a function is called, on one line or with a parameter a line."""
    found = inspect.signature(function)
    words = []
    kinds = inspect.Parameter
    previous = None
    for parameter in list(found.parameters.values())[skip:]:
        if parameter.kind is kinds.KEYWORD_ONLY and previous not in (
            kinds.KEYWORD_ONLY,
            kinds.VAR_POSITIONAL,
        ):
            words.append("*")
        words.append(parameter_text(parameter))
        previous = parameter.kind
    result = found.return_annotation
    end = f") -> {result}" if isinstance(result, str) and name != "__init__" else ")"
    end = ")" if end == ") -> None" else end
    text = f"{name}({', '.join(words)}{end}"
    if len(text) <= WIDTH:
        return text
    return "\n".join([f"{name}(", *(f"    {word}," for word in words), end])


def parameter_text(parameter: inspect.Parameter) -> str:
    stars = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    has_type = isinstance(parameter.annotation, str)
    text = f"{stars}{parameter.name}" + (f": {parameter.annotation}" if has_type else "")
    if parameter.default is parameter.empty:
        return text
    equals = " = " if has_type else "="
    return f"{text}{equals}{number(parameter.default)}"


def number(value: object) -> str:
    """A default: masks and ids in hexadecimal."""
    is_wide = isinstance(value, int) and value > 1 << 31
    return f"0x{value:X}" if is_wide else str(value) if isinstance(value, float) else repr(value)


def comments(owner: type | types.ModuleType) -> dict[str, str]:
    """What ``#:`` says over the attributes of a class or the names of a module."""
    source = textwrap.dedent(inspect.getsource(owner))
    lines = source.splitlines()
    tree = ast.parse(source)
    body = tree.body if isinstance(owner, types.ModuleType) else tree.body[0].body
    found = {}
    for node in body:
        targets = [node.target] if isinstance(node, ast.AnnAssign) else getattr(node, "targets", [])
        above = []
        for text in reversed(lines[: node.lineno - 1]):
            if not text.strip().startswith("#:"):
                break
            above.insert(0, text.strip().removeprefix("#:").strip())
        if above and targets and isinstance(targets[0], ast.Name):
            found[targets[0].id] = " ".join(above)
    return found


def prose(docstring: str | None) -> str:
    """A docstring as Markdown."""
    if not docstring:
        raise ValueError("there is something public without a docstring")
    parts = []
    section = None
    for block in re.split(r"\n\n+", docstring):
        head, _, rest = block.partition("\n")
        if head.rstrip(":") in SECTIONS and head.endswith(":"):
            section = head.rstrip(":")
            parts.append(f"**{SECTIONS[section]}**")
            block = textwrap.dedent(rest)
        elif section:
            block = textwrap.dedent(block)
        if block.startswith(">>>"):
            parts.append(f"```pycon\n{block}\n```")
        elif section in ("Args", "Raises"):
            parts.append(entries(block))
        elif block.lstrip().startswith("- "):
            parts.append(bullets(block))
        elif block:
            parts.append(line(block))
    return "\n\n".join(parts)


def entries(block: str) -> str:
    """Names and what they are, a bullet each."""
    found: list[list[str]] = []
    for text in block.splitlines():
        if text.startswith(" ") and found:
            found[-1].append(text.strip())
        else:
            found.append([text])
    rows = []
    for words in found:
        name, _, text = " ".join(words).partition(": ")
        rows.append(f"- `{name}`: {inline(text)}")
    return "\n".join(rows)


def bullets(block: str) -> str:
    found: list[str] = []
    for text in block.splitlines():
        if text.lstrip().startswith("- "):
            found.append(text.strip())
        else:
            found[-1] += " " + text.strip()
    return "\n".join(inline(text) for text in found)


def line(block: str) -> str:
    """A paragraph on one line."""
    return inline(" ".join(text.strip() for text in block.splitlines()))


def inline(text: str) -> str:
    """What is code in reStructuredText as code in Markdown."""
    text = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text)
    return re.sub(r"``(.+?)``", r"`\1`", text)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
