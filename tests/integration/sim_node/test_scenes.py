# SPDX-License-Identifier: Apache-2.0
"""sim_node in scenes of one's own: every camera's topics, resets of any kind, bad files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.parameter import Parameter
from ros2_run import Start, finish
from sensor_msgs.msg import CameraInfo, Image
from tamp_interfaces.msg import SceneGraph
from tamp_interfaces.srv import ResetScene
from tamp_runtime.messages.images import array_from_image
from tamp_runtime.messages.scene_graph import graph_from_message
from tamp_runtime.qos import LATCHED, NEWEST

from scene_graph import Stacks
from sim_node.generators import GENERATORS
from sim_node.node import SimNode
from sim_node.scene import SceneError

SCENE = """
places: [[0.5, -0.2], [0.5, -0.07], [0.5, 0.07], [0.5, 0.2]]
blocks: {size: [0.03, 0.05], shapes: [box, cylinder, sphere, prism], most: 12}
cameras:
  - {width: 160, height: 128, distortion: [-0.2, 0.05, 0.0, 0.0, 0.0]}
  - {name: side, position: [0.8, -1.0, 0.6], target: [0.5, 0.0, 0.1], width: 128, height: 144}
"""


class Watcher(Node):
    """Keeps the newest message of every topic."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("watcher", **kwargs)
        self.newest: dict[str, Any] = {}
        for camera in ("camera", "side"):
            for name, kind in (
                ("image_raw", Image), ("depth/image_raw", Image), ("segmentation", Image),
                ("camera_info", CameraInfo), ("depth/camera_info", CameraInfo),
            ):  # fmt: skip
                self._keep(kind, f"{camera}/{name}", NEWEST)
            self._keep(TransformStamped, f"{camera}/extrinsics", LATCHED)
        self._keep(SceneGraph, "sim/ground_truth", LATCHED)
        self.reset = self.create_client(ResetScene, "sim/reset")

    def _keep(self, kind: type, topic: str, profile: Any) -> None:
        def keep(message: Any) -> None:
            self.newest[topic] = message

        self.create_subscription(kind, topic, keep, profile)

    def truth(self) -> Stacks:
        return graph_from_message(self.newest["sim/ground_truth"]).stacks()


@pytest.fixture
def watcher(ros_context: Any, tmp_path: Path) -> Watcher:
    path = tmp_path / "mine.yaml"
    path.write_text(SCENE)
    ros_context.add(
        SimNode(
            context=ros_context.context,
            parameter_overrides=[
                Parameter("scene", value=str(path)),
                Parameter("layout", value=["red_box,blue_sphere", "", "mint_prism", ""]),
                Parameter("real_time_factor", value=0.0),
            ],
        )
    )
    node = ros_context.add(Watcher(context=ros_context.context))
    ros_context.wait_until(lambda: len(node.newest) == 13, what="every topic")
    return node


def call_reset(ros_context: Any, node: Watcher, **request: Any) -> ResetScene.Response:
    assert node.reset.wait_for_service(timeout_sec=10.0)
    future = node.reset.call_async(ResetScene.Request(**request))
    ros_context.wait_until(future.done, what="sim/reset")
    return future.result()


def test_every_camera_has_its_topics_frames_and_lens(watcher: Watcher) -> None:
    for name, shape in (("camera", (128, 160)), ("side", (144, 128))):
        labels = watcher.newest[f"{name}/segmentation"]
        assert array_from_image(labels, "16UC1").shape == shape
        assert len(np.unique(array_from_image(labels, "16UC1"))) == 4
        frame = f"{name}_optical_frame"
        for topic in ("image_raw", "depth/image_raw", "segmentation", "camera_info"):
            assert watcher.newest[f"{name}/{topic}"].header.frame_id == frame
        extrinsics = watcher.newest[f"{name}/extrinsics"]
        assert (extrinsics.header.frame_id, extrinsics.child_frame_id) == ("world", frame)
    info, side = (watcher.newest[f"{name}/camera_info"] for name in ("camera", "side"))
    assert info.distortion_model == "plumb_bob"
    assert list(info.d) == [-0.2, 0.05, 0.0, 0.0, 0.0]
    assert list(side.d) == [0.0] * 5
    assert (side.width, side.height) == (128, 144)
    moved = watcher.newest["side/extrinsics"].transform.translation
    assert (moved.x, moved.y, moved.z) == pytest.approx((0.8, -1.0, 0.6))


def test_the_truth_has_every_block_s_own_size(watcher: Watcher) -> None:
    graph = graph_from_message(watcher.newest["sim/ground_truth"])
    assert graph.stacks() == (("red_box", "blue_sphere"), (), ("mint_prism",), ())
    edges = {item.size[0] for item in graph.objects}
    assert len(edges) == 3 and all(0.03 <= edge <= 0.05 for edge in edges)
    assert [place.position_world[1] for place in graph.places] == [-0.2, -0.07, 0.07, 0.2]


@pytest.mark.parametrize("generator", ["", *GENERATORS])
def test_reset_takes_the_name_of_a_generator(
    ros_context: Any, watcher: Watcher, generator: str
) -> None:
    done = call_reset(ros_context, watcher, generator=generator, seed=5, blocks=4)
    assert done.success, done.message
    assert sum(len(text.split(",")) for text in done.layout if text) == 4
    expected = tuple(tuple(text.split(",")) if text else () for text in done.layout)
    ros_context.wait_until(lambda: watcher.truth() == expected, what="the new scene")


def test_a_bad_request_is_answered_and_changes_nothing(ros_context: Any, watcher: Watcher) -> None:
    there = watcher.truth()
    for request, says in (
        ({"generator": "pyramid", "blocks": 5}, "no generator 'pyramid'; known: uniform"),
        ({"generator": "flat", "blocks": 5}, "it has 4 places"),
        ({"blocks": 13}, "a random scene has 3 to 12"),
        ({"layout": ["red_box", "", ""]}, "4 stacks, the layout has 3"),
        ({"layout": ["red_prism,red_box", "", "", ""]}, "it would slide off"),
        ({"layout": ["red_sphere,red_box", "", "", ""]}, "it would roll off"),
        ({"layout": ["taupe_box", "", "", ""]}, "'taupe_box' is not COLOR_SHAPE"),
        ({"layout": ["red_box", "red_box", "", ""]}, "one place only"),
        ({"layout": ["", "", "", ""]}, "0 blocks; 1 to 12"),
    ):
        refused = call_reset(ros_context, watcher, **request)
        assert not refused.success
        assert says in refused.message and "the scene is unchanged" in refused.message
        assert tuple(tuple(text.split(",")) if text else () for text in refused.layout) == there
    assert watcher.truth() == there


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"scene": "teapot"}, "scene 'teapot' cannot be read"),
        ({"scene": "two_rows", "layout": ["red_box", "", ""]}, "6 stacks, the layout has 3"),
        ({"blocks": 8}, "8 blocks asked for; a random scene has 3 to 7"),
        ({"generator": "pyramid"}, "generator = 'pyramid' is not known; known: uniform"),
        ({"scene": "wall", "generator": "flat", "blocks": 7}, "it has 3 places"),
    ],
)
def test_parameters_that_do_not_fit_together_are_refused_at_start(
    ros_context: Any, parameters: dict[str, Any], says: str
) -> None:
    overrides = [Parameter(name, value=value) for name, value in parameters.items()]
    with pytest.raises(ValueError, match=says):
        SimNode(context=ros_context.context, parameter_overrides=overrides)


def test_what_only_the_bodies_show_is_refused_at_start(ros_context: Any, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("arm: {home: [0, 0, 0]}")
    with pytest.raises(SceneError, match="3 positions; panda has 7 joints"):
        SimNode(
            context=ros_context.context, parameter_overrides=[Parameter("scene", value=str(path))]
        )


def test_a_bad_file_ends_the_process_with_its_sentence_and_exit_code_2(
    start: Start, tmp_path: Path
) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text("cameras: [{vertical_fov: 4}]")
    ended = finish(start("sim_node", "sim_node", "--ros-args", "-p", f"scene:={path}"))
    assert ended.code == 2
    assert "bad.yaml': cameras[0].vertical_fov = 4 is out of range; 0.1 to 2.5 rad" in ended.stderr
    assert "Traceback" not in ended.stderr
