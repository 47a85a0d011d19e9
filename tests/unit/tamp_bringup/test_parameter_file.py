# SPDX-License-Identifier: Apache-2.0
"""The parameter file of the graph leaves to arguments what they set.

Of two values for one node, ROS takes the one under the more specific name, not the later one: a
value that the file has under ``/**/sim_node`` is deaf to ``-p`` and to launch arguments.
"""

from __future__ import annotations

from pathlib import Path

import yaml

CONFIG = Path(__file__).parents[3] / "ros_ws/src/tamp_bringup/config/demo.yaml"
#: Set by ``make demo``, ``make eval-tasks``, ``ros2 launch`` and the tests.
ARGUMENTS = {"real_time_factor", "seed", "blocks", "layout"}


def test_no_argument_is_set_in_the_file() -> None:
    sections = yaml.safe_load(CONFIG.read_text())
    named = {key for section in sections.values() for key in section["ros__parameters"]}
    assert "use_sim_time" in named
    assert not named & ARGUMENTS
