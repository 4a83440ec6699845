"""Makes what an installation has beside the sources' own files, in FOLDER:

    share                   completion of three shells, compressed manual pages (clients/shell)
    changelog.gz            CHANGELOG.md
    changelog.Debian.gz     of the packages; its date is the sources' (SOURCE_DATE_EPOCH, the commit, or CHANGELOG.md)
    copyright.puckloop, copyright.gap, copyright.mpi
    docs                    the pages, with commands as they are typed where it is installed
    puckloop-VERSION.dist-info   the Python client as Python's tools see it, with its plugin for pytest
"""

from __future__ import annotations

import argparse
import email.utils
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys


def compress(text: bytes, file: pathlib.Path) -> None:
    file.write_bytes(gzip.compress(text, 9, mtime=0))  # the same bytes each time


def source_date(source: pathlib.Path) -> float:
    """Seconds since 1970."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    if given.isdigit():
        return float(given)
    commit = subprocess.run(["git", "-C", source, "log", "-1", "--format=%ct"], capture_output=True, text=True, check=False) \
        if shutil.which("git") else None
    if commit and commit.returncode == 0 and commit.stdout.strip().isdigit():
        return float(commit.stdout)
    return (source / "CHANGELOG.md").stat().st_mtime


def make(options: argparse.Namespace) -> None:
    folder, source, version = options.folder, options.source, options.version
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for program in [options.program, *([options.mpi_program] if options.mpi_program else [])]:
        subprocess.run([sys.executable, "-B", source / "clients" / "shell", program, folder], check=True)
    for page in sorted((folder / "share" / "man" / "man1").glob("*.1")):
        compress(page.read_bytes(), page.with_name(page.name + ".gz"))
        page.unlink()

    compress((source / "CHANGELOG.md").read_bytes(), folder / "changelog.gz")
    date = email.utils.formatdate(source_date(source))
    compress(f"puckloop ({version}-{options.revision}) bookworm; urgency=medium\n\n"
             f"  * Version {version}; changelog.gz has what changed.\n\n"
             f" -- {options.maintainer}  {date}\n".encode(), folder / "changelog.Debian.gz")

    # The pages, whose commands are typed without the sources' launcher.
    pages = shutil.copytree(source / "docs", folder / "docs", ignore=shutil.ignore_patterns("site", "__pycache__"))
    for page in sorted(pages.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        text = re.sub(r"(?<![\w/])\./puckloop (?!(test|package|release|docs)\b)", "puckloop ", text)
        page.write_text(text.replace("PYTHONPATH=clients/python PUCKLOOP=./puckloop pytest clients/python/examples",
                                     "pytest /usr/share/doc/python3-puckloop/examples"), encoding="utf-8")

    own = (source / "packaging" / "copyright").read_text(encoding="utf-8")
    libraries = (source / "packaging" / "copyright.libraries").read_text(encoding="utf-8")
    solver = (source / "packaging" / "copyright.solver").read_text(encoding="utf-8")
    mpi = (source / "packaging" / "copyright.mpi").read_text(encoding="utf-8")
    for name, parts in (("puckloop", (own, libraries)), ("gap", (own, solver, libraries)), ("mpi", (own, mpi, libraries))):
        (folder / f"copyright.{name}").write_text("\n\n".join(parts), encoding="utf-8")

    info = folder / f"puckloop-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: puckloop\nVersion: {version}\n"
                                   "Summary: drives runs of robot firmware\nLicense: MIT\nRequires-Python: >=3.11\n",
                                   encoding="utf-8")
    # The plugin's name is its module's: a conftest.py that asks for it gets the same one, not a second.
    (info / "entry_points.txt").write_text("[pytest11]\npuckloop.pytest_plugin = puckloop.pytest_plugin\n", encoding="utf-8")
    (info / "INSTALLER").write_text("dpkg\n", encoding="utf-8")
    (folder / "done").touch()


def main() -> int:
    parser = argparse.ArgumentParser()
    for name in ("version", "revision", "maintainer"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--mpi-program", type=pathlib.Path)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("folder", type=pathlib.Path)
    try:
        make(parser.parse_args())
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"make_files: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
