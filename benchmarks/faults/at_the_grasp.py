# SPDX-License-Identifier: Apache-2.0
"""What happens to a block while the hand comes down on it, shortly before its fingers close."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from tamp_interfaces.srv import Disturb

from faults.disturbances import Disturbed, ask
from faults.setting import Setting
from scene_graph import Stacks

#: From the beginning of a pick until its fingers close, in simulated time [s].
_COMES_DOWN: Final = (0.4, 1.2)
#: How long a pick may be waited for [s].
_PATIENCE: Final = 30.0


@dataclass(frozen=True)
class AtTheGrasp(Disturbed):
    """``sim/disturb`` while the hand is on its way to the next block, which it is about if any.

    Args:
        next_block: whether it is about the block that is picked.
    """

    next_block: bool = True

    def begin(self, setting: Setting) -> None:
        """Waits for the next pick."""
        eyes = setting.eyes

        def picks() -> bool:
            said = eyes.motion()
            return said is not None and said.phase == "pick"

        eyes.wait_for(picks, _PATIENCE)
        said = eyes.motion()
        block = said.object_name if said is not None else ""
        stacks: Stacks = ((block,),) if self.next_block and block else setting.initial
        request = self.request(stacks, setting.seed)
        rng = np.random.default_rng([setting.seed, 13])
        request.delay = float(rng.uniform(*_COMES_DOWN))
        ask(request)


def this_block(stacks: Stacks, _seed: int) -> tuple[str, ...]:
    """The only one."""
    return (stacks[0][0],)


TAKEN: Final = AtTheGrasp(Disturb.Request.TAKE_AWAY, this_block)
PUSHED: Final = AtTheGrasp(Disturb.Request.PUSH, this_block)
#: For longer than the hand waits for a sight of the block.
COVERED: Final = AtTheGrasp(
    Disturb.Request.COVER, fields={"what": "sheet", "seconds": 8.0}, next_block=False
)
