# SPDX-License-Identifier: Apache-2.0
"""Clients that cancel, die, crowd and ask for nonsense."""

from __future__ import annotations

import signal

from faults.fault import ALL_PHASES, MOVING_PHASES, Fault, Phase
from faults.injections import Cancelled, ClientSignalled, OthersAsk

_NONSENSE = (
    "red", "red on red", "red on blue on", "on on on", "purple_dragon on stack0", ", ,, and",
    "blue_box on stack99", "x" * 5000, "красный на синий",
)  # fmt: skip

FAULTS = (
    Fault("cancelled", "the one who asked cancels", Cancelled(), ALL_PHASES, (("cancel",),),
          statuses=("CANCELLED",)),
    Fault("command-interrupted", "Ctrl-C at the command-line client",
          ClientSignalled(signal.SIGINT), MOVING_PHASES, (("cancel",),),
          statuses=("CANCELLED",), asker="command"),
    Fault("command-terminated", "the command-line client gets SIGTERM",
          ClientSignalled(signal.SIGTERM), MOVING_PHASES, (("cancel", ""),), asker="command"),
    Fault("client-killed", "the client is killed; somebody else asks for the same",
          ClientSignalled(signal.SIGKILL), (*MOVING_PHASES, Phase.CONFIRM), (("carried out",),),
          asker="command"),
    Fault("second-client", "a second client asks for the same goal", OthersAsk(("",)), ALL_PHASES,
          (("busy", "worked on"),), transient=True),
    Fault("crowd", "ten more clients ask for the same goal at once", OthersAsk(("",) * 10),
          ALL_PHASES, (("busy", "worked on"),), transient=True),
    Fault("nonsense", "nine goals that make no sense", OthersAsk(_NONSENSE, together=False),
          ALL_PHASES, (("busy", "worked on"),), transient=True),
)  # fmt: skip
