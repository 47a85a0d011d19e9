# SPDX-License-Identifier: Apache-2.0
"""All kinds of disturbances; a new one is a module in this folder and an entry here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from .add import Add
from .cover import Cover
from .disturbance import Disturbance
from .jam import Jam
from .nudge import Nudge
from .push import Push
from .shove import Shove
from .slip import Slip
from .swap import Swap
from .take_away import TakeAway

#: By the name that a request gives.
KINDS: Final[Mapping[str, type[Disturbance]]] = {
    "push": Push,
    "swap": Swap,
    "take_away": TakeAway,
    "add": Add,
    "slip": Slip,
    "jam": Jam,
    "cover": Cover,
    "shove": Shove,
    "nudge": Nudge,
}
