# SPDX-License-Identifier: Apache-2.0
"""Tests of perception run on shared processors: nothing here depends on how long it takes."""

import torch

# Several threads on processors that others use wait for one another most of the time.
torch.set_num_threads(1)
