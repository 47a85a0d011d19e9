# SPDX-License-Identifier: Apache-2.0
"""perception_node keeps the pictures of its camera, and training reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_camera import OTHER, TOWERS, WITHOUT_LABELS, camera_before
from rclpy.parameter import Parameter

from perception_node.node import PerceptionNode
from perception_node.training.dataset import read_crops
from scene_graph import Stacks
from sim_node.camera import Frame


def test_pictures_in_which_something_moved_are_kept(
    ros_context: Any, tmp_path: Path, frames: dict[Stacks, Frame]
) -> None:
    record = Parameter("record", value=str(tmp_path / "mine"))
    node = ros_context.add(
        PerceptionNode(context=ros_context.context, namespace="/cell", parameter_overrides=[record])
    )
    camera = camera_before(ros_context, node, WITHOUT_LABELS)
    camera.calibrate_and_show(frames[TOWERS])
    for layout in (TOWERS, OTHER, OTHER):
        camera.show(frames[layout])
    ros_context.remove(node)
    (shard,) = (tmp_path / "mine").glob("shard_*.npz")
    with np.load(shard) as kept:
        assert sorted(kept.files) == ["depth", "labels", "rgb"]
        assert np.array_equal(kept["rgb"], [frames[TOWERS].rgb, frames[OTHER].rgb])
        for labels, layout in zip(kept["labels"], (TOWERS, OTHER)):
            own = (labels > 0) & (frames[layout].labels > 0)
            either = (labels > 0) | (frames[layout].labels > 0)
            assert own.sum() > 0.9 * either.sum()
    assert read_crops(tmp_path / "mine").scenes.tolist() == [0, 5, 10]


def test_a_folder_that_cannot_be_written_keeps_the_node_from_starting(
    ros_context: Any, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    record = Parameter("record", value=str(tmp_path / "file" / "folder"))
    with pytest.raises(ValueError, match="cannot be kept"):
        PerceptionNode(context=ros_context.context, namespace="/cell", parameter_overrides=[record])
