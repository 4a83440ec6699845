"""What files a client may name: those below the user's folders, and what puckloop ships."""

from __future__ import annotations

import os
import pathlib
import re
from typing import Sequence

from ..errors import PuckloopError, StartError


class Refused(PuckloopError):
    """A call cannot be done; nothing was."""


class Folders:
    """StartError: one of them is no folder."""

    def __init__(self, folders: Sequence[pathlib.Path]) -> None:
        for folder in folders:
            if not folder.is_dir():
                raise StartError(f"{folder}: is no folder")
        self.folders = [folder.resolve() for folder in folders]

    def inside(self, name: str) -> pathlib.Path:
        """The file; relative names are of the first folder. Refused: it is outside, links followed."""
        if not name or "\0" in name:
            raise Refused("a file's name is empty or has a zero in it")
        path = (self.folders[0] / name).resolve()
        if not any(path == folder or folder in path.parents for folder in self.folders):
            raise Refused(f"{name}: is outside of {', '.join(map(str, self.folders))} "
                          "(puckloop mcp --folder DIR adds a folder)")
        return path

    def scenario(self, name: str) -> str:
        """A file of the folders, or a shipped scenario's name."""
        if re.fullmatch(r"\w[\w-]*", name) and not (self.folders[0] / name).is_file():
            return name
        path = self.inside(name)
        if not path.is_file():
            near = sorted(one.name for one in path.parent.glob("*.toml")) if path.parent.is_dir() else []
            raise Refused(f"{name}: there is no such file" + (f"; there are {', '.join(near[:20])}" if near else ""))
        return str(path)

    def image(self, name: str) -> str:
        """A file of the folders or of PUCKLOOP_IMAGES, or "own"."""
        images = os.environ.get("PUCKLOOP_IMAGES")
        if name == "own":
            return name
        if images and "/" not in name and (pathlib.Path(images) / name).is_file():
            return str(pathlib.Path(images) / name)
        path = self.inside(name)
        if not path.is_file():
            raise Refused(f"{name}: there is no such image")
        return str(path)

    def snapshot(self, name: str) -> pathlib.Path:
        """A file that may be written, so that nothing else can be lost by it."""
        path = self.inside(name)
        if path.suffix != ".snapshot":
            raise Refused(f"{name}: a snapshot's name ends with .snapshot")
        return path

    def new_results(self) -> pathlib.Path:
        """A new folder. Refused: it cannot be made."""
        place = self.folders[0] / "out" / "mcp"
        try:
            place.mkdir(parents=True, exist_ok=True)
            for number in range(1, 1_000_000):
                try:
                    folder = place / f"run{number}"
                    folder.mkdir()
                    return folder
                except FileExistsError:
                    continue
        except OSError as error:
            raise Refused(f"{place}: {error.strerror}") from None
        raise Refused(f"{place}: has a million runs")
