# SPDX-License-Identifier: Apache-2.0
"""What perception is told of the camera that took a picture."""

from __future__ import annotations

from builtin_interfaces.msg import Time

from perception_node import PinholeCamera
from perception_node.calibration import Calibration, View
from perception_node.conversions import frame_pose_from_message, lens_from_message
from sim_node import Frame
from sim_node.conversions import camera_messages, extrinsics_message
from sim_node.scene import CameraConfig


def view_of(camera: CameraConfig, frame: Frame) -> View:
    """How a picture was taken; through a lens, as the messages of the simulator say it."""
    if not any(camera.distortion):
        return View(
            PinholeCamera(camera.intrinsics, camera.world_from_optical, camera.width, camera.height)
        )
    calibration = Calibration()
    calibration.place(frame_pose_from_message(extrinsics_message(camera, Time())))
    info, *_ = camera_messages(frame, camera, Time())
    return calibration.view(lens_from_message(info), camera.width, camera.height)
