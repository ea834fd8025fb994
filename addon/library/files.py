# SPDX-License-Identifier: GPL-3.0-or-later
"""Files in and out.

What is read is a regular file of bounded size, so that no pipe or device can hang the program or fill its memory.
Output files appear complete or not at all: they are written under another name and then renamed.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import stat
import tempfile
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

NODE = re.sub(r"\W", "", platform.node())[:16]  # of this machine: others may write to the same folder
# Blender expands {templates}, takes // for the folder of the .blend and \ for a separator, and cuts off paths of more
# than 1023 bytes; # is the frame in names of movies, < begins <UDIM>. OpenImageIO takes no bytes that are not UTF-8,
# and a ? in a name begins options.
SPECIAL = re.compile(r"^//|[{}\\#<>?*%\x00-\x1f\x7f\ud800-\udfff]")
LONGEST_PATH = 900  # bytes


class FileError(InputError, OSError):
    """A file that cannot be read or written, in words that follow "PATH: "."""


# Reading


def read_bytes(path: Path, most: int) -> bytes:
    """The content of a regular file of at most ``most`` bytes; FileError says why there is none."""
    try:
        check_regular(path)
        with path.open("rb") as file:
            content = file.read(most + 1)
    except FileError:
        raise
    except (OSError, ValueError) as error:  # a NUL in a name is a ValueError
        raise FileError(_reason(error)) from error
    if len(content) > most:
        message = f"is larger than {most} bytes"
        raise FileError(message)
    return content


def read_text(path: Path, most: int) -> str:
    """``read_bytes`` of UTF-8, with any kind of line ends."""
    try:
        text = read_bytes(path, most).decode("utf-8")
    except UnicodeDecodeError as error:
        message = f"is not UTF-8 (byte {error.start}); save it as UTF-8"
        raise FileError(message) from error
    return text.replace("\r\n", "\n")


def check_regular(path: Path) -> None:
    """FileError for a folder, pipe, socket or device, which may never end or never begin."""
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        message = "is a folder, not a file"
        raise FileError(message)
    if not stat.S_ISREG(mode):
        message = "is a pipe or a device, not a file"
        raise FileError(message)


@contextmanager
def readable(path: Path) -> Iterator[Path]:
    """A path by which Blender and OpenImageIO find the file: its own, or that of a link if they would misread it.

    FileError for what is not a regular file.
    """
    with all_readable([path]) as (found,):
        yield found


@contextmanager
def all_readable(paths: Sequence[Path]) -> Iterator[Sequence[Path]]:
    """``readable`` for several files of one folder: what stands for them lies in one folder too."""
    for path in paths:
        check_regular(path)
    if all(map(is_plain, paths)):
        yield paths
        return
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        links = [Path(folder) / f"{number:08}{_ending(path)}" for number, path in enumerate(paths)]
        for path, link in zip(paths, links, strict=True):
            try:
                link.symlink_to(path.absolute())
            except OSError:  # Windows allows it to developers only
                shutil.copyfile(path, link)
        yield links


def is_plain(path: Path) -> bool:
    """Whether Blender and OpenImageIO take a path as it is written."""
    return SPECIAL.search(path.as_posix()) is None and len(_utf8(str(path))) <= LONGEST_PATH


def one_root(path: Path) -> Path:
    """``path`` with one slash at its start: POSIX allows two, which Blender takes for the folder of the .blend."""
    text = str(path)
    return Path("/" + text.lstrip("/")) if text.startswith("//") else path


def _utf8(text: str) -> bytes:
    return text.encode("utf-8", "surrogatepass")


def _ending(path: Path) -> str:
    return path.suffix if re.fullmatch(r"\.\w{1,8}", path.suffix, re.ASCII) else ""


def _reason(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


# Writing


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path that becomes ``path`` when the block ends well, and is removed when it does not.

    It lies in the folder of ``path``, or in a folder of its own if Blender would misread that. Raises FileNotFoundError
    if the block wrote nothing there.
    """
    path = path.absolute()  # Blender finds no folder for a name alone
    hidden = _hidden(path)
    with ExitStack() as stack:
        written = hidden
        if not is_plain(hidden):
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="vgroove-"))
            written = Path(folder) / f"output{_ending(path)}"
        try:
            yield written
            if not written.is_file():
                message = f"{path}: nothing was written"
                raise FileNotFoundError(message)
            if written != hidden:
                shutil.copyfile(written, hidden)
            hidden.replace(path)
        finally:
            with suppress(OSError):  # an error of the block says more
                hidden.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """``text`` as UTF-8. Names from the command line may hold bytes that are none: they are escaped."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace")


def _hidden(path: Path) -> Path:
    """Beside ``path``, by a name that is short and plain whatever that of ``path`` is."""
    digest = hashlib.sha256(_utf8(path.name)).hexdigest()[:32]
    return path.with_name(f".{digest}.{os.getpid()}-{NODE}{_ending(path)}")


def check_writable(path: Path) -> None:
    """OSError, before any work, if ``path`` could not be written: its folder is missing or read-only."""
    folder = path.absolute().parent
    if not folder.is_dir():
        message = f"{path}: the folder {folder} does not exist; make it first"
        raise FileNotFoundError(message)
    for one in (path.absolute(), _hidden(path.absolute())):
        try:
            mode = one.stat().st_mode
        except FileNotFoundError:
            continue
        except OSError as error:
            message = f"{path}: cannot be written: {_reason(error)}; choose another name"
            raise FileError(message) from error
        if stat.S_ISDIR(mode):
            message = f"{path}: is a folder; name a file"
            raise IsADirectoryError(message)
        if not stat.S_ISREG(mode):
            message = f"{path}: is a pipe or a device; name a file"
            raise FileError(message)
    if not os.access(folder, os.W_OK):
        message = f"{path}: the folder {folder} cannot be written; choose another with -o"
        raise PermissionError(message)
