# SPDX-License-Identifier: Apache-2.0
"""What the network that finds blocks in colour is trained on."""
