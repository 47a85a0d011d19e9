# SPDX-License-Identifier: Apache-2.0
"""Where messages that several nodes use meet plain values: scene graphs, images, stamps."""
