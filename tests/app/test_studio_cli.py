"""The command `studio`: what it refuses, what it prints, how it stops, what it leaves behind."""

from __future__ import annotations

import http.client
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from aeroservo.aircraft.files import new

COMMAND = [sys.executable, "-m", "aeroservo.cli", "studio"]


def test_without_nicegui_it_says_what_to_install(cli: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib.util

    real = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *a: None if name == "nicegui" else real(name, *a))
    answer = cli("studio")
    assert answer.code == 1 and 'pip install "aeroservo[studio]"' in answer.err and answer.out == ""


def test_help_does_not_load_it() -> None:
    code = (
        "import sys; sys.argv = ['aeroservo', '--help']\nfrom aeroservo.cli import main\n"
        "try: main()\nexcept SystemExit: pass\n"
        "bad = [m for m in sys.modules if m.split('.')[0] in ('nicegui', 'fastapi', 'uvicorn')]\nassert not bad, bad"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert found.returncode == 0, found.stderr


def test_bad_input_is_refused_before_anything_is_served(cli: Callable[..., Any], tmp_path: Path) -> None:
    pytest.importorskip("nicegui", reason="the extra 'studio' is not installed")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        (tmp_path / "bad.toml").write_text("kind = 'wing'")
        for name in ("good.toml", "good;1.toml"):
            new("goland", tmp_path / name)
        refused = {
            ("thesis-binry",): "no such file",
            (tmp_path / "none.toml",): "no such file",
            (tmp_path / "bad.toml",): "is not known",
            ("thesis-binary", "--folder", tmp_path / "gone"): "no such folder",
            (tmp_path / "good.toml", "--folder", "/"): "does not lie in the folder",
            (tmp_path / "good;1.toml",): "letters, digits",
            ("thesis-binary", "--port", port, "--no-browser"): "cannot listen there",
            ("thesis-binary", "--port", 70000): "port",
        }
        for words, why in refused.items():
            answer = cli("studio", *words)
            assert answer.code == 2 and why in answer.err, (words, answer)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_stops_it_without_a_word_a_file_or_an_orphan(tmp_path: Path) -> None:
    pytest.importorskip("nicegui", reason="the extra 'studio' is not installed")
    running = subprocess.Popen(
        [*COMMAND, "thesis-binary", "--no-browser"], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    assert running.stdout is not None
    line = running.stdout.readline()
    found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
    assert found, line
    assert _status(int(found[1])) == 200
    assert _listening(int(found[1])) == {"127.0.0.1"}
    workers = _until(lambda: _children(running.pid))
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=20)
    assert (running.returncode, out, err) == (0, "", "")
    assert list(tmp_path.iterdir()) == []
    _until(lambda: not [pid for pid in workers if Path(f"/proc/{pid}").exists() and _state(pid) != "Z"])


def _status(port: int) -> int:
    end = time.monotonic() + 30.0
    while True:
        try:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
            connection.request("GET", "/")
            return connection.getresponse().status
        except ConnectionError:
            assert time.monotonic() < end
            time.sleep(0.1)


def _listening(port: int) -> set[str]:
    """Addresses of this machine at which something listens at a port, out of the kernel's table."""
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            address, state = line.split()[1], line.split()[3]
            host, number = address.split(":")
            if int(number, 16) == port and state == "0A":
                found.add(".".join(str(int(host[i : i + 2], 16)) for i in (6, 4, 2, 0)) if len(host) == 8 else host)
    return found


def _children(pid: int) -> list[int]:
    task = Path(f"/proc/{pid}/task")
    return [int(child) for t in task.iterdir() for child in (t / "children").read_text().split()]


def _state(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return "Z"


def _until(true: Callable[[], Any]) -> Any:
    end = time.monotonic() + 20.0
    while not (found := true()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return found
