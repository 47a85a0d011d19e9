# SPDX-License-Identifier: Apache-2.0
"""A second judge: what the arm was commanded in pybullet is carried out once more in MuJoCo."""
