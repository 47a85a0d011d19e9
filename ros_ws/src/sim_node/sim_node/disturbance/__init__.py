# SPDX-License-Identifier: Apache-2.0
"""A world that misbehaves: what can go wrong in it, and when."""
