# SPDX-License-Identifier: Apache-2.0
"""Hashes of nested values, worked out once: a chart looks the parts of a sentence up very often."""

from __future__ import annotations

from typing import Any, TypeVar

_Class = TypeVar("_Class", bound=type)


def hashed_once(cls: _Class) -> _Class:
    """Makes a frozen dataclass keep its hash beside its fields."""
    worked_out: Any = cls.__hash__

    def kept(self: Any) -> int:
        known = self.__dict__
        if "_hash" not in known:
            known["_hash"] = worked_out(self)
        return known["_hash"]  # type: ignore[no-any-return]

    cls.__hash__ = kept  # type: ignore[assignment,method-assign]
    return cls
