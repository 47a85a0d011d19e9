# SPDX-License-Identifier: Apache-2.0
"""What the camera sees of triangles: surfaces, and the rasteriser that draws them."""
