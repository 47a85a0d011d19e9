# SPDX-License-Identifier: Apache-2.0
"""A pybullet world with a Franka Panda, a table of blocks, a camera and an arm controller."""
