# SPDX-License-Identifier: Apache-2.0
"""What every node shares: starting and stopping, parameters, QoS, messages, domains."""
