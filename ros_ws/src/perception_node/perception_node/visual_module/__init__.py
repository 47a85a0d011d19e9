# SPDX-License-Identifier: Apache-2.0
"""The visual module G (5.2.1, A.2.1): from images of single objects to their coordinates."""
