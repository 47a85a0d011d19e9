# SPDX-License-Identifier: Apache-2.0
"""Room for pictures in the shared memory of a process that publishes them.

A picture of 640x480 is larger than all that Fast DDS has unless it is told otherwise, and goes
through it piece by piece: reliable ones arrive late, best-effort ones often not at all.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

#: What Fast DDS is told.
PROFILE: Final = Path(__file__).with_name("fast_dds.xml")
#: Where it looks for that: by its name of today, and by that of its next major version.
VARIABLES: Final = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")


def make_room_for_pictures() -> None:
    """Must run before ``rclpy.init``; a profile that the environment names stays."""
    if not any(os.environ.get(name) for name in VARIABLES):
        os.environ.update(dict.fromkeys(VARIABLES, str(PROFILE)))
