"""Fetch the onnxruntime wheels that the extension ships, those of requirements/wheels.lock, into wheels/.

The lock holds a line for each: its SHA-256 and its file name, as sha256sum writes them. What is there already and right
is not fetched again; what is wrong is an error.
"""

import hashlib
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements" / "wheels.lock"
OTHERS = ROOT / "requirements" / "other_wheels.lock"  # older and newer ones, which a test tries the add-on with
WHEELS = ROOT / "wheels"


def main() -> int:
    """Fetch and verify every wheel of the lock. Exit status 1 where a hash differs."""
    WHEELS.mkdir(exist_ok=True)
    for _, name in locked():
        if not (WHEELS / name).exists():
            print(f"fetching {name}", flush=True)
            fetch(name)
    wrong = unlike_the_lock()
    for name in wrong:
        print(f"{WHEELS / name} is not the file of {LOCK.name}: delete it, and run this again", file=sys.stderr)
    return 1 if wrong else 0


def unlike_the_lock(lock: Path = LOCK) -> list[str]:
    """The names of the locked wheels that are missing in wheels/, or whose SHA-256 is another."""
    return [name for digest, name in locked(lock) if not _is(WHEELS / name, digest)]


def _is(path: Path, digest: str) -> bool:
    return path.exists() and hashlib.sha256(path.read_bytes()).hexdigest() == digest


def locked(lock: Path = LOCK) -> list[tuple[str, str]]:
    """(SHA-256, file name) for each wheel of the lock."""
    return [(digest, name) for digest, name in (line.split() for line in lock.read_text().splitlines())]


def fetch(name: str) -> None:
    """Let pip download the wheel of exactly this name."""
    package, version, python, abi, platforms = name.removesuffix(".whl").split("-")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
    command += ["--only-binary=:all:", "--dest", str(WHEELS), "--implementation", "cp"]
    command += ["--python-version", python.removeprefix("cp"), "--abi", abi]
    for platform in platforms.split("."):
        command += ["--platform", platform]
    subprocess.run([*command, f"{package}=={version}"], check=True)


if __name__ == "__main__":
    sys.exit(main())
