# SPDX-License-Identifier: Apache-2.0
"""The state encoder G of Chapter 4: from an image to a discrete code, and back (4.2.1)."""
