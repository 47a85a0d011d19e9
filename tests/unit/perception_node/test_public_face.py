# SPDX-License-Identifier: Apache-2.0
"""Torch takes seconds to import, and most of perception needs none of it."""

import subprocess
import sys


def test_only_what_is_learnt_needs_torch() -> None:
    code = (
        "import sys; sys.modules['torch'] = None\n"
        "from perception_node import Observation, Perception, PinholeCamera, Segments\n"
        "from perception_node import RowOfPlaces, draw_scene_graph\n"
        "import perception_node.blocks, perception_node.names, perception_node.verdict\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stderr
