# SPDX-License-Identifier: Apache-2.0
"""A package exports names without importing what defines them until one is asked for.

An executable imports its package before it can listen to Ctrl-C; numpy, casadi, pybullet and torch
take seconds. So a package's ``__init__.py`` reads::

    __getattr__ = exported_by(__name__)

and its ``public.py`` imports what the package exports, and lists it in ``__all__`` (PEP 562).
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any


def exported_by(package: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of a package whose module ``public`` holds what it exports."""

    def find(name: str) -> Any:
        if name.startswith("_") and name != "__all__":
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        public = importlib.import_module(".public", package)
        if name != "__all__" and name not in public.__all__:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(public, name)

    return find
