# SPDX-License-Identifier: GPL-3.0-or-later
"""A release: refused from a dirty tree, and the same bytes each time."""

import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile

import pytest

from ..scripts import ROOT, load

package, release = load("package"), load("release")


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A repository with one file, from which ``release`` releases."""
    folder = tmp_path / "tree"
    folder.mkdir()
    monkeypatch.setattr(release, "ROOT", folder)
    release.git("init", "--quiet")
    (folder / "kept.txt").write_text("kept", encoding="utf-8")
    release.git("add", ".")
    who = ["-c", "user.name=Somebody", "-c", "user.email="]
    release.git(*who, "commit", "--quiet", "--no-gpg-sign", "--message", "first")
    return folder


def test_a_clean_tree_is_released(tree):
    release.check_clean()


@pytest.mark.parametrize("name", ["kept.txt", "new.txt"])
def test_a_dirty_tree_is_refused_in_one_line(tree, name, monkeypatch):
    """Changed or new; the line names the file, and nothing is written."""
    (tree / name).write_text("changed", encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["release.py", str(tree / "dist")])
    with pytest.raises(SystemExit) as refused:
        release.main()
    assert refused.value.code == f"vgroove: a release needs a clean tree; commit or remove {name}"
    assert not (tree / "dist").exists()


def test_only_what_git_knows_gets_into_a_wheel(tree, tmp_path):
    """Nothing that lies beside it, as an older build does."""
    (tree / "stray.py").touch()
    folder = release.export(tmp_path / "copy")
    assert [path.name for path in folder.rglob("*")] == ["kept.txt"]


def test_the_notes_are_the_section_of_the_version():
    """Up to the next version, whatever follows its number."""
    text = "# Changelog\n\n## 1.2.0 (unreleased)\n\n### Added\n\n- New.\n\n## 1.1.0\n\n- Old.\n"
    assert release.notes(text, "1.2.0") == "### Added\n\n- New.\n"
    assert release.notes(text, "1.1.0") == "- Old.\n"
    with pytest.raises(release.RefusedError, match=r"no section 1\.2$"):
        release.notes(text.replace("1.2.0", "1.20"), "1.2")


def test_all_say_the_same_version():
    """The manifest, the changelog and what to cite."""
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    assert manifest["version"] == release.VERSION
    assert release.notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))


def test_archives_do_not_depend_on_when_and_by_whom(tmp_path, monkeypatch):
    """Other times, modes and orders give the same bytes; another content does not."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    made = []
    for case, (year, mode, names, last) in enumerate(
        [(1990, 0o644, "ab", b"b"), (2020, 0o755, "ba", b"b"), (2020, 0o755, "ba", b"c")]
    ):
        plain, packed = tmp_path / f"{case}.zip", tmp_path / f"{case}.tar.gz"
        with zipfile.ZipFile(plain, "w") as file, tarfile.open(packed, "w:gz") as tar:
            for name in names:
                path = tmp_path / name
                path.write_bytes(last if name == "b" else b"a")
                path.chmod(mode)
                os.utime(path, ((year - 1970) * 31556952,) * 2)
                file.write(path, name)
                tar.add(path, name)
        package.repack_zip(plain)
        release.repack_tar(packed)
        made.append((plain.read_bytes(), packed.read_bytes()))
        assert zipfile.ZipFile(plain).getinfo("a").date_time == (2023, 11, 14, 22, 13, 20)
        with tarfile.open(packed) as tar:
            assert tar.getmember("a").mtime == 1700000000
    assert made[0] == made[1]
    assert made[0][0] != made[2][0]
    assert made[0][1] != made[2][1]


def test_sums_are_those_of_sha256sum(tmp_path):
    for name in ("b", "a"):
        (tmp_path / name).write_text(name, encoding="utf-8")
    (tmp_path / "SHA256SUMS").write_text(release.sums([tmp_path / "b", tmp_path / "a"]), encoding="utf-8")
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=tmp_path, check=True, capture_output=True)
