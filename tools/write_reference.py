# SPDX-License-Identifier: Apache-2.0
"""``make reference``: docs/parameters.md and docs/interfaces.md from the declarations themselves.

A node is the module ``PACKAGE.node`` of one of the graph's packages. Its tuple ``PARAMETERS`` gives
the table of parameters, the docstring of its one Node class gives its topics, and the interface
files are quoted as they are.
"""

from __future__ import annotations

import importlib
import inspect
import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from rclpy.node import Node
from tamp_runtime.parameters import ParameterSpec

from tamp_bringup.processes import NODES

ROOT: Final = Path(__file__).resolve().parent.parent
INTERFACES_FOLDER: Final = ROOT / "ros_ws" / "src" / "tamp_interfaces"

_GENERATED: Final = "<!-- Written by `make reference` from the sources; changes belong there. -->"
_KINDS: Final = (("msg", "Messages"), ("srv", "Services"), ("action", "Actions"))
_TYPES: Final[Mapping[type | None, str]] = {
    bool: "bool",
    int: "integer",
    float: "double",
    str: "string",
}


class DeclarationError(ValueError):
    """A node whose declarations cannot be found where they belong; ``module`` names it."""

    def __init__(self, module: str, problem: str) -> None:
        super().__init__(f"{module}: {problem}")
        self.module = module


def parameters_of(module: ModuleType) -> Sequence[ParameterSpec]:
    """The declared parameters of a node. Raises DeclarationError if there is no such tuple."""
    specs = getattr(module, "PARAMETERS", None)
    if not isinstance(specs, Sequence) or not all(isinstance(s, ParameterSpec) for s in specs):
        raise DeclarationError(module.__name__, "has no tuple PARAMETERS of ParameterSpec")
    return specs


def node_class_of(module: ModuleType) -> type[Node]:
    """The node that a module defines. Raises DeclarationError if it is not exactly one."""
    found = [
        item
        for item in vars(module).values()
        if inspect.isclass(item) and issubclass(item, Node) and item.__module__ == module.__name__
    ]
    if len(found) != 1 or not found[0].__doc__:
        raise DeclarationError(module.__name__, f"defines {len(found)} documented nodes, not one")
    return found[0]


def type_name(value: Any, element: type | None = None) -> str:
    """The ROS name of a parameter's type, from its default; ``element`` tells that of an empty one.

    Raises:
        KeyError: if neither does.
    """
    if isinstance(value, Sequence) and not isinstance(value, str):
        return f"{_TYPES[type(value[0]) if value else element]}[]"
    return _TYPES[type(value)]


def range_text(spec: ParameterSpec) -> str:
    """The inclusive range, and the further check where there is one."""
    low, high = spec.minimum, spec.maximum
    if low is not None and high is not None:
        text = f"{low:.15g} to {high:.15g}"
    elif low is not None:
        text = f"at least {low:.15g}"
    elif high is not None:
        text = f"at most {high:.15g}"
    else:
        text = ""
    if spec.check is None:
        return text
    explained = (inspect.getdoc(spec.check) or "checked when set").splitlines()[0].rstrip(".")
    return f"{text}; {explained}" if text else explained


def parameter_table(specs: Iterable[ParameterSpec]) -> list[str]:
    """A Markdown table, sorted as declared."""
    lines = [
        "| name | type | default | range | read-only | meaning |",
        "|---|---|---|---|---|---|",
    ]
    for spec in specs:
        default = f"`{json.dumps(spec.default, ensure_ascii=False)}`"
        cells = (
            f"`{spec.name}`",
            type_name(spec.default, spec.element),
            default,
            range_text(spec),
            "yes" if spec.read_only else "",
            spec.description,
        )
        lines.append("| " + " | ".join(_cell(cell) for cell in cells) + " |")
    return lines


def write_parameters(modules: Mapping[str, ModuleType]) -> str:
    """The page docs/parameters.md; ``modules`` by node name."""
    lines = [
        _GENERATED,
        "",
        "# Parameters",
        "",
        "Set them at start (`--ros-args -p NAME:=VALUE`, or a file as `tamp_bringup`'s "
        "`config/demo.yaml`) or, where they are not read-only, while the node runs. A value out of "
        "its range is refused with a sentence that names the range. Ranges include their ends; of "
        "an array they hold for each element. Every node also has `use_sim_time`.",
    ]
    for name, module in modules.items():
        lines += ["", f"## {name}", "", *parameter_table(parameters_of(module))]
    return "\n".join(lines) + "\n"


def write_interfaces(modules: Mapping[str, ModuleType], folder: Path) -> str:
    """The page docs/interfaces.md.

    Args:
        folder: the interface package, with the folders msg, srv and action.
    """
    lines = [
        _GENERATED,
        "",
        "# Interfaces",
        "",
        "Names are relative: a namespace and remappings apply. Units are SI and radians.",
        "",
        "## Nodes",
    ]
    for name, module in modules.items():
        doc = inspect.getdoc(node_class_of(module)) or ""
        lines += ["", f"### {name}", "", "```text", doc.strip(), "```"]
    for kind, title in _KINDS:
        lines += ["", f"## {title}"]
        for path in sorted((folder / kind).glob(f"*.{kind}")):
            content = path.read_text().rstrip()
            lines += ["", f"### {folder.name}/{kind}/{path.stem}", "", "```", content, "```"]
    return "\n".join(lines) + "\n"


def pages() -> dict[str, str]:
    """The content of each page by its path relative to the repository."""
    modules = {name: importlib.import_module(f"{name}.node") for name in NODES}
    return {
        "docs/parameters.md": write_parameters(modules),
        "docs/interfaces.md": write_interfaces(modules, INTERFACES_FOLDER),
    }


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def main() -> int:
    for path, content in pages().items():
        (ROOT / path).parent.mkdir(exist_ok=True)
        (ROOT / path).write_text(content)
        print(f"written {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
