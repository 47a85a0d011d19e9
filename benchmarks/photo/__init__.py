# SPDX-License-Identifier: Apache-2.0
"""Photorealistic pictures by Blender, as D_pbw of the thesis: path-traced, rubber and metal."""
