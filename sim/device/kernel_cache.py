"""Where compiled kernels are kept for later runs."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from scene.settings import Refused


def folder() -> str:
    """A folder that Taichi can keep compiled kernels in, its own if it can: it crashes at the end where it cannot.

    Raises Refused.
    """
    from sim.device.compiler import compiler, ti

    usual = os.environ.get("TI_OFFLINE_CACHE_FILE_PATH") or ti.lang.impl.default_cfg().offline_cache_file_path
    if compiler.module != "taichi":
        usual += f"-{compiler.module}"
    try:
        try:
            os.makedirs(usual, exist_ok=True)
            with tempfile.TemporaryFile(dir=usual):
                return usual
        except OSError:
            return _among_temporary_files()
    except OSError as error:
        raise Refused(
            f"compiled kernels can be kept neither in {usual} nor among temporary files: {error.strerror}",
            remedy="set XDG_CACHE_HOME or TMPDIR to a folder that can be written",
        ) from None


def _among_temporary_files() -> str:
    """A folder of this user alone: what is in it is run."""
    own = Path(tempfile.gettempdir(), f"tidemill-kernels-{os.getuid()}")
    own.mkdir(mode=0o700, exist_ok=True)
    found = own.lstat()
    mine = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077
    return str(own) if mine else tempfile.mkdtemp(prefix="tidemill-kernels-")
