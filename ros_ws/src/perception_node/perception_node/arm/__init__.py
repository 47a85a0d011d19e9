# SPDX-License-Identifier: Apache-2.0
"""The arm in the picture: a camera that is calibrated sees it where its joints say that it is.

Blocks cannot tell a mirrored picture from one of another state of the table; the arm can, for what
it looks like and how it stands is known from ``robot_description`` and ``joint_states``, past the
camera. :mod:`.shape` says where its surface is seen, :mod:`.rest` how its joints were when a
picture was taken, and :mod:`.sight` whether the picture contradicts that. :mod:`.topics` are its
topics.
"""

from .rest import JointHistory
from .shape import ArmShape
from .sight import ArmSight

__all__ = ["ArmShape", "ArmSight", "JointHistory"]
