# SPDX-License-Identifier: Apache-2.0
"""Chapter 4: data, questions and measurements of the discrete latent state."""
