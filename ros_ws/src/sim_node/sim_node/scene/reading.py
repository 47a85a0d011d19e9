# SPDX-License-Identifier: Apache-2.0
"""Plain data, as YAML has it, to frozen dataclasses, with a sentence for what does not fit.

The fields of a dataclass are the keys of a mapping, their annotations what is possible::

    @dataclass(frozen=True)
    class Light:
        ambient: Annotated[float, Within(0.0, 2.0)] = 0.55
        direction_world: Annotated[Vector, Key("direction")] = (0.0, 0.0, 1.0)
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Final, Union, get_args, get_origin, get_type_hints

from .errors import SceneError

_KINDS: Final = {float: "a number", int: "a whole number", str: "a text"}


@dataclass(frozen=True)
class Key:
    """Note on a field: what a file calls it; None: it cannot be given in a file."""

    name: str | None


@dataclass(frozen=True)
class ReadBy:
    """Note on a field: a function of the data and its key reads it, and raises SceneError."""

    function: Callable[[object, str], Any]


@dataclass(frozen=True)
class Within:
    """Note on a field: every number in it lies in this range, ends included."""

    low: float
    high: float
    unit: str = ""

    def check(self, value: object, key: str) -> None:
        """Raises SceneError."""
        for number in _leaves(value):
            if not self.low <= number <= self.high:
                span = f"{self.low:g} to {self.high:g} {self.unit}".rstrip()
                several = f", in {_shown(value)}," if len(set(_leaves(value))) > 1 else ""
                shown = _shown_number(number) + several
                raise SceneError(key, f"= {shown} is out of range; {span} are possible")


@dataclass(frozen=True)
class OneOf:
    """Note on a field: every text in it is one of these."""

    names: Collection[str]

    def check(self, value: object, key: str) -> None:
        """Raises SceneError."""
        for name in _leaves(value):
            if name not in self.names:
                raise SceneError(key, f"= {name!r} is unknown; known: {', '.join(self.names)}")


@dataclass(frozen=True)
class Count:
    """Note on a field: how many items it has, ends included."""

    least: int
    most: int

    def check(self, value: object, key: str) -> None:
        """Raises SceneError."""
        count = len(value)  # type: ignore[arg-type]
        if not self.least <= count <= self.most:
            raise SceneError(key, f"has {count} items; {self.least} to {self.most} are possible")


def read(kind: Any, data: object, key: str) -> Any:
    """A value of a type from plain data.

    Args:
        kind: float, int, str, a tuple type, a Mapping from str, a dataclass, one of these or
            None, or Annotated.
        key: of the data in the file, for the sentence.

    Raises:
        SceneError: the sentence names the key, and what is possible.
    """
    if get_origin(kind) is Annotated:
        return _read_annotated(kind, data, key)
    if is_dataclass(kind):
        return _read_fields(kind, data, key)
    if get_origin(kind) in (Union, UnionType):  # of something with None
        (given,) = (option for option in get_args(kind) if option is not NoneType)
        return None if data is None else read(given, data, key)
    if get_origin(kind) is tuple:
        return _read_tuple(get_args(kind), data, key)
    if get_origin(kind) is Mapping:
        return {
            name: read(get_args(kind)[1], value, f"{key}.{name}")
            for name, value in mapping_of(data, key).items()
        }
    return _read_plain(kind, data, key)


def mapping_of(data: object, key: str) -> Mapping[str, Any]:
    """The data where they are a mapping from texts, nothing where there are none."""
    if data is None:
        return {}
    if not isinstance(data, Mapping):
        raise SceneError(key or "a scene", f"= {_shown(data)} is not a mapping of keys to values")
    for name in data:
        if not isinstance(name, str):
            raise SceneError(key or "a scene", f"has the key {name!r}, which is not a text")
    return data


def _read_annotated(kind: Any, data: object, key: str) -> Any:
    base, *notes = get_args(kind)
    reader = next((note.function for note in notes if isinstance(note, ReadBy)), None)
    value = reader(data, key) if reader else read(base, data, key)
    for note in notes:
        if isinstance(note, Within | OneOf | Count):
            note.check(value, key)
    return value


def _read_fields(kind: Any, data: object, key: str) -> Any:
    given = mapping_of(data, key)
    hints = get_type_hints(kind, include_extras=True)
    names = {}
    for item in fields(kind):
        notes = [note for note in get_args(hints[item.name])[1:] if isinstance(note, Key)]
        name = notes[0].name if notes else item.name
        if name is not None:
            names[name] = item.name
    start = f"{key}." if key else ""
    for name in given:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            hint = f"is it {near[0]}? " if near else ""
            raise SceneError(start + name, f"is unknown; {hint}known: {', '.join(names)}")
    return kind(
        **{names[name]: read(hints[names[name]], given[name], start + name) for name in given}
    )


def _read_tuple(kinds: tuple[Any, ...], data: object, key: str) -> tuple[Any, ...]:
    if not isinstance(data, list | tuple):
        raise SceneError(key, f"= {_shown(data)} is not a list")
    if kinds[-1] is Ellipsis:
        kinds = (kinds[0],) * len(data)
    if len(data) != len(kinds):
        raise SceneError(key, f"= {_shown(data)} has {len(data)} items, not {len(kinds)}")
    return tuple(read(kind, item, f"{key}[{i}]") for i, (kind, item) in enumerate(zip(kinds, data)))


def _read_plain(kind: Any, data: object, key: str) -> Any:
    accepted = (int, float) if kind is float else kind
    if isinstance(data, bool) or not isinstance(data, accepted):
        hint = "; YAML writes 1.0e-3, with a point" if _is_number(data) else ""
        raise SceneError(key, f"= {_shown(data)} is not {_KINDS[kind]}{hint}")
    try:
        value = kind(data)
    except OverflowError:
        value = math.inf
    if kind is float and not math.isfinite(value):
        raise SceneError(key, f"= {_shown(data)} is not finite")
    return value


def _is_number(data: object) -> bool:
    try:
        float(data)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False
    return isinstance(data, str)


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value


def _shown_number(number: float) -> str:
    return f"{number:g}" if abs(number) < 1e15 else _shown(number)


def _shown(data: object) -> str:
    """The data as a file has them, shortened."""
    text = repr(list(data) if isinstance(data, tuple) else data)
    return text if len(text) <= 60 else text[:57] + "..."
