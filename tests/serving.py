# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder on a web server of this machine alone."""

import contextlib
import functools
import http.server
import threading


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Notes what was asked for in place of printing it."""

    def log_message(self, text, *arguments):
        self.server.asked.append(self.path)


@contextlib.contextmanager
def served(folder):
    """(address, the paths asked for so far) while the folder is served."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(folder)))
    server.asked = []
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}", server.asked
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
