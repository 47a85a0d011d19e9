# SPDX-License-Identifier: Apache-2.0
"""Scenes as YAML files: anybody's, and the examples that are installed with the package."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import yaml

from .config import SceneConfig, check_scene
from .errors import SceneError
from .reading import read

_EXAMPLES: Final = Path(__file__).parents[1] / "scenes"


def example_scenes() -> dict[str, Path]:
    """The files of the installed examples by their names."""
    return {path.stem: path for path in sorted(_EXAMPLES.glob("*.yaml"))}


def load_scene(name: str) -> SceneConfig:
    """The scene of a name.

    Args:
        name: path of a YAML file, or the name of an example; empty: the default.

    Raises:
        SceneError: the sentence says what is wrong, and what is possible.
    """
    if not name:
        return SceneConfig()
    examples = example_scenes()
    path = examples.get(name, Path(name).expanduser())
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not a text"
        raise SceneError(
            "", f"scene {name!r} cannot be read: {reason}; examples: {', '.join(examples)}"
        ) from error
    try:
        return parse_scene(text)
    except SceneError as error:
        raise SceneError(error.key, error.reason, f"scene {name!r}") from error


def parse_scene(text: str) -> SceneConfig:
    """The scene that a YAML text describes; what it leaves out is as by default.

    Raises:
        SceneError: the sentence says what is wrong, and what is possible.
    """
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f"line {mark.line + 1}: " if mark else ""
        reason = getattr(error, "problem", None) or str(error)
        raise SceneError("", f"the scene is no YAML: {line}{reason}") from error
    except ValueError as error:  # such as a date that no calendar has
        raise SceneError("", f"the scene is no YAML: {error}") from error
    scene: SceneConfig = read(SceneConfig, data, "")
    check_scene(scene)
    return scene


class _Loader(yaml.SafeLoader):
    """Plain data only, and no key twice: which of them counts would be anybody's guess."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            if key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str | int | float | bool) and key is not None:
                continue  # refused by the constructor, or later by its type
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key {key!r} is there twice", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)
