# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered by the workers of a Dask cluster (``pip install .[cluster]``), which share folders with this machine.

Each worker has its renders done by a ``Child``, which ends with it. One thread a worker is enough: a second would wait.
"""

from __future__ import annotations

import ipaddress
import logging
import queue
import re
import threading
from collections import Counter
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from ..addon.library.errors import InputError
from ..headless import memory
from ..headless.pipe import LostError
from .child import Child, sweep
from .outcome import Outcome
from .pool import Limits, Tries

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence
    from pathlib import Path

    from .job import Task

PATIENCE = 10  # seconds for a scheduler to answer
ADDRESS = re.compile(r"(tcp|tls|wss?)://[^\s/]+:([0-9]{1,5})", re.ASCII)


ENCRYPTED = "tls", "wss"


class ClusterError(InputError):
    """A cluster that cannot be used."""


def connect_client(address: str, *, insecure: bool = False) -> Any:
    """A client of the scheduler at ``address``; ClusterError if it cannot be reached.

    insecure: also without TLS to another machine. Whoever can reach such a scheduler runs code on all its workers, and
    on whoever asks it.
    """
    found = ADDRESS.fullmatch(address)
    if not found or not 1 <= int(found[2]) <= 65535:
        message = f'--cluster "{address}": write the address of a Dask scheduler, as in tcp://farm:8786'
        raise ClusterError(message)
    if not (insecure or found[1] in ENCRYPTED or _is_this_machine(address)):
        message = f"{address}: is not encrypted, and whoever reaches it can run code here and on the workers; "
        message += "use tls:// (Dask's configuration names the certificates), or --insecure in a network that you trust"
        raise ClusterError(message)
    try:
        import distributed
    except ImportError as error:
        message = "--cluster needs Dask, which is not installed; pip install vgroove[cluster]"
        raise ClusterError(message) from error
    for logger in ("distributed", "distributed.client"):  # we say in one line what they say in forty
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    answers: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def connect() -> None:
        try:
            answers.put(distributed.Client(address, timeout=PATIENCE, set_as_default=False))
        except Exception as error:  # noqa: BLE001 - of any kind, by scheme and by what answers
            answers.put(error)

    # By a thread: Dask's own timeout does not hold for something that takes the connection and then says nothing.
    threading.Thread(target=connect, daemon=True).start()
    try:
        answer = answers.get(timeout=1.5 * PATIENCE)
    except queue.Empty:
        answer = TimeoutError("something else took the connection")
    if isinstance(answer, Exception):
        message = f"{address}: no Dask scheduler answers there ({' '.join(str(answer).split())}); "
        message += "start one by `dask scheduler` and give its address, as in tcp://farm:8786"
        raise ClusterError(message) from answer
    return answer


def _is_this_machine(address: str) -> bool:
    """Whether nobody else can listen on the way: an address of the loopback network, as a number or by its name."""
    host = str(urlsplit(address).hostname)
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def outcomes(
    tasks: Sequence[Task], folder: Path, versions: dict[str, str], limit: Limits, client: Any
) -> Generator[Outcome]:
    """As ``pool.outcomes``, by the workers that the client's scheduler has and gets; those of limit do not count.

    RuntimeError if the scheduler is lost.
    """
    from distributed import CancelledError, KilledWorker, as_completed
    from distributed.comm import CommClosedError

    sweep(folder)
    address, tries = client.scheduler.address, Tries()
    neighbours = Counter(str(urlsplit(one).hostname) for one in client.scheduler_info(n_workers=-1)["workers"])
    named = {task.identity(versions): task for task in sorted(tasks, key=lambda task: task.place)}  # scenes together

    def submit(name: str) -> Any:
        arguments = named[name], folder, versions, limit, dict(neighbours)
        return client.submit(render_on_worker, *arguments, pure=False)

    try:
        futures = {submit(name): name for name in named}
        waiting = as_completed(list(futures), loop=client.loop)
        for future in waiting:
            name = futures.pop(future)
            try:
                found = future.result()
            except KilledWorker:
                found = Outcome(name, "stumbled", reason="its worker was killed")
            outcome = tries.settle(found)
            if outcome is not None:
                yield outcome
            else:
                again = submit(name)
                futures[again] = name
                waiting.add(again)
    except Exception as error:
        if client.status == "running" and not isinstance(error, (CancelledError, CommClosedError)):
            raise
        message = f"{address}: the Dask scheduler is gone; start it and its workers, and give the same command again"
        raise RuntimeError(message) from error


# On a worker

_LOCK = threading.Lock()
_children: dict[Any, Child] = {}  # at most one, by what it was begun for


def render_on_worker(
    task: Task, folder: Path, versions: dict[str, str], limit: Limits, neighbours: dict[str, int]
) -> Outcome:
    """The outcome of a task; "stumbled" if its process was lost. neighbours: workers of each host."""
    from distributed import get_worker

    here = version("bpy")  # pictures name the version that rendered them
    if versions.get("blender", here) != here:
        message = f"{get_worker().address} has Blender {here}, and {versions['blender']} was asked for; "
        message += "take it out of the cluster, or give the command with its Blender"
        raise RuntimeError(message)
    if not folder.is_dir():
        message = f"{folder}: there is no such folder on {get_worker().address}; use one that all machines share"
        raise FileNotFoundError(message)
    host = str(urlsplit(get_worker().address).hostname)
    workers = max(1, neighbours.get(host, 1))
    limit = replace(limit, workers=workers, memory=limit.memory or memory.free() // workers)
    with _LOCK:
        kind = folder, tuple(sorted(versions.items()))
        child = _children.pop(kind, None)
        for other in _children.values():
            other.close()
        _children.clear()
        if child is not None and limit.is_used_up(child):
            child.close()
            child = None
        try:
            child = child or Child(folder, versions, limit.threads)
            found = child.run(task, limit.timeout, limit.memory)
        except LostError as error:
            if child is not None:
                child.close()
            return Outcome(task.identity(versions), "stumbled", reason=str(error))
        _children[kind] = child
        return found
