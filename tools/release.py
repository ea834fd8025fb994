# SPDX-License-Identifier: GPL-3.0-or-later
"""Write what a release consists of: the extension's zip, wheel, sdist, notes from the CHANGELOG and SHA256SUMS.

python tools/release.py --clean      only whether the tree is clean: exits 1 with one line if not
python tools/release.py FOLDER

`make release` runs all checks in between. The same commit gives the same bytes: every file in an archive has the
commit's time, or that of SOURCE_DATE_EPOCH.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import package

if TYPE_CHECKING:
    from collections.abc import Iterable

ROOT = Path(__file__).parent.parent
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
LARGEST_ZIP = 60e6  # bytes


class RefusedError(Exception):
    """There is no release of this tree; one line says why."""


def git(*arguments: str) -> str:
    command = [shutil.which("git") or "git", "-C", ROOT, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check_clean() -> None:
    """RefusedError if a file is changed, or neither committed nor ignored."""
    changed = [line[3:] for line in git("status", "--porcelain").splitlines()]
    if changed:
        more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        message = f"a release needs a clean tree; commit or remove {changed[0]}{more}"
        raise RefusedError(message)


def export(folder: Path) -> Path:
    """The files that git knows, copied, so that nothing else that lies in the tree gets into a wheel."""
    for name in git("ls-files", "-z").split("\0"):
        if name and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


def uv() -> str:
    """The command, as the Makefile finds it; `uv run` names its own."""
    return os.environ.get("UV") or shutil.which("uv") or str(ROOT / ".tools" / "uv" / "bin" / "uv")


def build(source: Path, folder: Path) -> tuple[Path, Path]:
    """The wheel and the sdist of ``source``, which may be an sdist's folder; CalledProcessError where it fails."""
    subprocess.run([uv(), "build", "--quiet", "--out-dir", folder, source], check=True)
    wheel, sdist = (next(folder.glob(f"vgroove-{VERSION}{end}")) for end in ("-*.whl", ".tar.gz"))
    package.repack_zip(wheel)
    repack_tar(sdist)
    return wheel, sdist


def repack_tar(path: Path) -> None:
    """Rewrite a .tar.gz so that its bytes depend on its files alone: no owner, one time, names in order."""
    content = io.BytesIO()
    with tarfile.open(path) as old, tarfile.open(fileobj=content, mode="w", format=tarfile.PAX_FORMAT) as new:
        for member in sorted(filter(tarfile.TarInfo.isfile, old), key=lambda member: member.name):
            info = tarfile.TarInfo(member.name)
            info.size, info.mtime, info.mode = member.size, package.moment(), 0o644
            new.addfile(info, old.extractfile(member))
    path.write_bytes(gzip.compress(content.getvalue(), mtime=0))


def notes(changelog: str, version: str = VERSION) -> str:
    """The section of a version, without its heading; RefusedError if there is none."""
    found = re.search(rf"^## {re.escape(version)}\b.*\n((?:(?!## ).*\n?)*)", changelog, flags=re.MULTILINE)
    if not found:
        message = f"CHANGELOG.md has no section {version}"
        raise RefusedError(message)
    return found[1].strip() + "\n"


def sums(paths: Iterable[Path]) -> str:
    """Lines as `sha256sum --check` reads them."""
    return "".join(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(paths))


def release(folder: Path) -> list[Path]:
    """All files, made in ``folder``."""
    os.environ.setdefault("SOURCE_DATE_EPOCH", git("log", "-1", "--format=%ct").strip())
    text = notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    folder.mkdir(parents=True, exist_ok=True)
    archive = package.package(folder)
    if archive.stat().st_size > LARGEST_ZIP:
        message = f"{archive.name} has {archive.stat().st_size / 1e6:.1f} MB, more than {LARGEST_ZIP / 1e6:.0f}"
        raise RefusedError(message)
    with tempfile.TemporaryDirectory() as source:
        made = [archive, *build(export(Path(source)), folder)]
    (folder / "NOTES.md").write_text(text, encoding="utf-8")
    (folder / "SHA256SUMS").write_text(sums(made), encoding="utf-8")
    return [*made, folder / "NOTES.md", folder / "SHA256SUMS"]


def main() -> None:
    try:
        check_clean()
        for path in [] if sys.argv[1] == "--clean" else release(Path(sys.argv[1]).resolve()):
            print(f"{path.name}: {path.stat().st_size / 1e6:.2f} MB")
    except RefusedError as error:
        sys.exit(f"vgroove: {error}")


if __name__ == "__main__":
    main()
