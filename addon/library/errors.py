# SPDX-License-Identifier: GPL-3.0-or-later
"""The one base of errors that a user can mend. Imports nothing, so that every room may use it."""


class InputError(ValueError):
    """What was asked for cannot be done. The text is one line: what, where, how to mend it.

    The command line prints it and exits with 2; operators report it.
    """
