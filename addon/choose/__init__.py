# SPDX-License-Identifier: GPL-3.0-or-later
"""What suits a scene: the estimator, the advice, and the account of what a material holds."""
