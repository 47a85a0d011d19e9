# SPDX-License-Identifier: Apache-2.0
"""From image to scene graph: masks, visual module G, poses, relations, confidence."""
