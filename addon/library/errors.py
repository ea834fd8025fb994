# SPDX-License-Identifier: GPL-3.0-or-later
"""The base of all errors that a user can fix. Imports nothing, so that every room may use it."""


class InputError(ValueError):
    """The request cannot be fulfilled. The text is one line: what, where, how to fix it.

    The command line prints it and exits with 2; operators report it.
    """
