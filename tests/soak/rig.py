"""What chaos and soak share: Boxgrasp's programs as processes on a network of their own, and reports."""
import ctypes
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

URL = "udpm://239.255.76.67:7667?ttl=0"
READY = "answering on"
CLONE_NEWNS, CLONE_NEWNET = 0x00020000, 0x40000000
OK, NO_GRASP, BAD, NOT_REACHABLE, LATE = 0, 1, 3, 4, 5  # exit codes


def enter_own_world():
    """A network with nothing but loopback, and mounts that nobody else sees. Needs root: exit code 77 otherwise."""
    if os.geteuid() != 0 or ctypes.CDLL(None).unshare(CLONE_NEWNET | CLONE_NEWNS) != 0:
        print("skipped: this needs root, for a network of its own", file=sys.stderr)
        sys.exit(77)
    subprocess.run(["mount", "--make-rprivate", "/"], check=True)
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)


def add_route():
    subprocess.run(["ip", "route", "add", "239.255.76.67/32", "dev", "lo"], check=True)


def remove_route():
    subprocess.run(["ip", "route", "del", "239.255.76.67/32", "dev", "lo"], check=True)


class Programs:
    """Copies of a build's programs, so that the build may go on meanwhile."""

    def __init__(self, build, folder):
        copies = folder / "programs"
        copies.mkdir()

        def copied(name):
            return pathlib.Path(shutil.copy2(build / name, copies))
        copied("server/planner/boxgrasp-receiver")  # the server looks for it beside itself
        self.server = copied("server/planner/boxgrasp-server")
        self.trainer = copied("server/trainer/boxgrasp-trainer")
        self.client = copied("client/boxgrasp")
        self.clock = copied("tests/soak/libclock_shift.so")

    def run(self, *arguments, timeout=60, **options):
        return subprocess.run([str(word) for word in arguments], capture_output=True, text=True, timeout=timeout, **options)


def make_cloud(programs, folder, points=2000):
    cloud = folder / "cup.pcd"
    made = programs.run(programs.trainer, "sample", "paper_cup", "--points", points, "--out", cloud)
    if made.returncode != OK:
        sys.exit(f"no cloud: {made.stderr}")
    return cloud


def wait_until(condition, timeout_s=10.0, pause_s=0.005):
    end = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(pause_s)
    return True


class Server:
    """A server whose log of all lives is one file; `keep` starts it again when it ends, as systemd does."""

    def __init__(self, programs, folder, *arguments, url=URL, environment=None):
        self.line = [str(word) for word in (programs.server, "--lcm-url", url, *arguments)]
        self.log_file = folder / "server.log"
        self.environment = {**os.environ, **(environment or {})}
        self.process, self.keeping, self.starts, self.back_s = None, False, 0, []
        self.lock = threading.Lock()

    def log(self):
        return self.log_file.read_text(errors="replace") if self.log_file.exists() else ""

    def says(self, pattern, timeout_s=10.0):
        """The log's line in which the pattern stands; None if it does not come."""
        line = re.compile(rf"^.*(?:{pattern}).*$", re.M)
        wait_until(lambda: line.search(self.log()), timeout_s)
        found = [one.group().strip() for one in line.finditer(self.log())]
        return found[-1] if found else None

    def spawn(self):
        with open(self.log_file, "a") as log:
            self.process = subprocess.Popen(self.line, stderr=log, stdout=log, env=self.environment)

    def start(self, timeout_s=10.0):
        before = self.log().count(READY)
        self.spawn()
        if not wait_until(lambda: self.log().count(READY) > before or self.process.poll() is not None, timeout_s) or self.process.poll() is not None:
            raise RuntimeError(f"the server does not start: {self.log()[-1000:]}")
        return self

    def keep(self):
        self.keeping = True
        threading.Thread(target=self._keep, daemon=True).start()
        return self

    def _keep(self):
        while self.keeping:
            self.process.wait()
            ended = time.monotonic()
            if not self.keeping:
                return
            with self.lock:
                before = self.log().count(READY)
                time.sleep(0.1)  # RestartSec
                self.spawn()
                wait_until(lambda: self.log().count(READY) > before or self.process.poll() is not None, 20.0, 0.002)
                self.starts += 1
                if self.process.poll() is None:
                    self.back_s.append(time.monotonic() - ended)

    def receiver(self):
        """The id of its receiving process."""
        children = pathlib.Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        try:
            return int(children.read_text().split()[0])
        except (OSError, IndexError):
            return None

    def kill(self):
        self.process.send_signal(signal.SIGKILL)

    def stop(self):
        with self.lock:
            self.keeping = False
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.kill()
            return self.process.wait()


class Number(float):
    """A number that keeps the text that it was read from, which the model's version depends on."""

    def __new__(cls, text):
        number = super().__new__(cls, text)
        number.text = text
        return number


def canonical(value):
    if isinstance(value, dict):
        return "{" + ",".join(f"{json.dumps(key)}:{canonical(value[key])}" for key in sorted(value)) + "}"
    if isinstance(value, list):
        return "[" + ",".join(map(canonical, value)) + "]"
    return value.text if isinstance(value, Number) else json.dumps(value, ensure_ascii=False)


class ModelPress:
    """Makes models of other names and dates from one, each with a version of its own."""

    def __init__(self, file):
        self.content = json.loads(file.read_text(), parse_float=Number)
        made = self.version()
        if self.content["version"] != made:
            raise RuntimeError(f"the version of {file} is {self.content['version']}, but {made} was expected")
        self.number, self.begin = 0, time.time()

    def version(self):
        content = {key: value for key, value in self.content.items() if key != "version"}
        return hashlib.blake2b(canonical(content).encode(), digest_size=32).hexdigest()[:8]

    def make(self, file):
        self.number += 1
        self.content["name"] = f"chaos-{self.number}"
        self.content["created"] = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(self.begin + self.number))
        self.content["version"] = self.version()
        file.write_text(canonical(self.content))
        return self.content["version"]


class Report:
    def __init__(self, title):
        self.title, self.rows, self.begin = title, [], time.time()

    def add(self, case, passed, figures, log_line=""):
        self.rows.append({"case": case, "passed": bool(passed), "figures": figures, "log": log_line or ""})
        print(f"{case:<28} {'passed' if passed else 'FAILED':<7} {figures}", flush=True)
        if log_line:
            print(f"{'':<36} log: {log_line[:150]}", flush=True)

    def passed(self):
        return all(row["passed"] for row in self.rows)

    def write(self, file, **more):
        if file:
            content = {"schema": 1, "what": self.title, "seconds": round(time.time() - self.begin, 1), "passed": self.passed(),
                       **more, "cases": self.rows}
            file.write_text(json.dumps(content, indent=1) + "\n")


def work_folder():
    return tempfile.TemporaryDirectory(prefix="boxgrasp-soak-")
