# SPDX-License-Identifier: Apache-2.0
"""Training of the visual module G, self-supervised (5.2.1): ``ros2 run … train_visual``."""
