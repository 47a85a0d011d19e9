# SPDX-License-Identifier: Apache-2.0
"""What stands in a graph for blocks that blocks in front of them hide (5.4.3).

Such an object stands where blocks may be that are not seen: on the
place, under a block that is seen, or on top of one. Its size is that of the hidden space.
"""

from __future__ import annotations

import re
from typing import Final

from .places import base_name

#: Colour of what is hidden.
HIDDEN: Final = "hidden"
_NAME: Final = re.compile(r"hidden_stack(\d+)(_\d+)?")


def hidden_name(index: int) -> str:
    """The name of what is hidden on a place: ``hidden_stack4``."""
    return f"{HIDDEN}_{base_name(index)}"


def is_hidden(name: str) -> bool:
    """Whether a name is not that of a block, but of what is hidden on a place."""
    return hidden_place(name) is not None


def hidden_place(name: str) -> int | None:
    """The place on which something of this name stands for hidden blocks; None of a block."""
    match = _NAME.fullmatch(name)
    return int(match.group(1)) if match else None


def hidden_places(stacks: tuple[tuple[str, ...], ...]) -> tuple[int, ...]:
    """The places of which it is not known what stands there, in order."""
    return tuple(i for i, stack in enumerate(stacks) if any(map(is_hidden, stack)))
