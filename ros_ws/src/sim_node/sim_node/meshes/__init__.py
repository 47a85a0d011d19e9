# SPDX-License-Identifier: Apache-2.0
"""Lighter visual meshes for the arm, so that a picture of it costs a few milliseconds."""
