# SPDX-License-Identifier: Apache-2.0
"""The package exports what a notebook needs, and imports what is heavy only when it is used."""

import subprocess
import sys

import pytest

import perception_node


def test_every_name_that_is_exported_exists() -> None:
    for name in perception_node.__all__:
        assert getattr(perception_node, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = perception_node.no_such_name


def test_only_what_is_learnt_needs_torch() -> None:
    code = (
        "import sys; sys.modules['torch'] = None\n"
        "from perception_node import Observation, Perception, PinholeCamera, Segments\n"
        "from perception_node import RowOfPlaces, draw_scene_graph\n"
        "import perception_node.blocks, perception_node.names, perception_node.verdict\n"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stderr
