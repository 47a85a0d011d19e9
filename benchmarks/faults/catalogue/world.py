# SPDX-License-Identifier: Apache-2.0
"""A world that changes meanwhile; ``sim/reset`` also puts the arm home, whatever it holds."""

from __future__ import annotations

from faults.fault import ALL_PHASES, Fault
from faults.injections import Rearranged
from faults.small_tasks import other_layout, two_blocks_swapped, without_top

_CHANGED = ("differs", "saw", "seen", "path", "moved", "changed", "finger", "reset")

FAULTS = (
    Fault("world-rearranged", "the same blocks somewhere else", Rearranged(other_layout),
          ALL_PHASES, (_CHANGED,)),
    Fault("world-blocks-swapped", "two blocks change places", Rearranged(two_blocks_swapped),
          ALL_PHASES, (_CHANGED,)),
    Fault("world-as-before", "every block back where it was, the arm home",
          Rearranged(lambda stacks, _seed: stacks), ALL_PHASES, (_CHANGED,)),
    Fault("world-block-gone", "a block is taken away", Rearranged(without_top), ALL_PHASES,
          (("cannot be seen", "not seen", "no ", "unknown"),)),
)  # fmt: skip
