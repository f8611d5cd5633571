#!/usr/bin/env python3
"""A server that is watched: its live page in headless Chromium, its metrics, its log, and what boxgrasp doctor says of it.
Usage: live_test.py BUILD [PICTURES]"""
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from browser import Browser
from page_test import DRAWN, fits

SKIPPED = 77
URL = f"udpm://239.255.76.67:{20000 + os.getpid() % 20000}?ttl=0"


def check(condition, what):
    if not condition:
        raise SystemExit(f"live_test: {what}")


def until(condition, what, timeout_s=60):
    end = time.monotonic() + timeout_s
    while not (value := condition()):
        check(time.monotonic() < end, f"not within {timeout_s} s: {what}")
        time.sleep(0.05)
    return value


def enter_own_network():
    if os.geteuid() == 0 and "IN_NAMESPACE" not in os.environ and subprocess.run(["unshare", "--net", "true"], stderr=subprocess.DEVNULL).returncode == 0:
        os.environ["IN_NAMESPACE"] = "1"
        os.execvp("unshare", ["unshare", "--net", sys.executable, *sys.argv])
    if "IN_NAMESPACE" in os.environ:
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        subprocess.run(["ip", "route", "add", "239.255.76.67/32", "dev", "lo"], check=True)


class Server:
    """boxgrasp-server with a page and metrics on free ports; its log in a file."""

    def __init__(self, program, log, *options, env=None):
        self.log = pathlib.Path(log)
        with open(log, "wb") as stderr:
            if env == "journal":
                status = os.fstat(stderr.fileno())
                env = {**os.environ, "JOURNAL_STREAM": f"{status.st_dev}:{status.st_ino}"}
            self.process = subprocess.Popen([program, "--lcm-url", URL, "--http", "127.0.0.1:0", "--metrics", "127.0.0.1:0", *options], stderr=stderr, env=env)

    def __enter__(self):
        self.page = until(lambda: re.search(r"page at (http://\S+/)", self.log.read_text()), "the server has a page")[1]
        self.metrics = until(lambda: re.search(r"metrics at (http://\S+/)", self.log.read_text()), "the server has metrics")[1] + "metrics"
        until(lambda: "answering on" in self.log.read_text(), "the server answers")
        return self

    def __exit__(self, *_):
        self.process.terminate()
        check(self.process.wait(60) == 0, f"the server ends badly:\n{self.log.read_text()}")

    def get(self, path):
        with urllib.request.urlopen(self.page + path, timeout=60) as answer:
            return json.load(answer)


# --- metrics

SAMPLE = re.compile(r'([a-zA-Z_:][\w:]*)(?:\{((?:[a-zA-Z_]\w*="(?:[^"\\\n]|\\["\\n])*",?)*)\})? (NaN|[+-]Inf|[-+.\deE]+)$')


def parsed_metrics(text):
    """{family: (type, {(name, labels): value})} of Prometheus' text format; what is not that ends the test."""
    families, types = {}, {}
    check(text.endswith("\n"), "the last line of the metrics has no end")
    for line in text.splitlines():
        if line.startswith("# HELP "):
            continue
        if line.startswith("# TYPE "):
            _, _, name, kind = line.split(" ")
            check(name not in types and kind in ("counter", "gauge", "histogram"), f"metrics: {line}")
            types[name] = kind
            families[name] = (kind, {})
            continue
        match = SAMPLE.match(line)
        check(match, f"metrics: not a sample: {line}")
        name, labels, value = match.groups()
        family = name if name in types else re.sub("_(bucket|sum|count)$", "", name)
        check(family in types, f"metrics: {name} has no type")
        check(types[family] != "counter" or name.endswith("_total"), f"metrics: the counter {name} does not end with _total")
        key = (name, tuple(sorted(re.findall(r'(\w+)="((?:[^"\\]|\\.)*)"', labels or ""))))
        check(key not in families[family][1], f"metrics: {key} stands twice")
        families[family][1][key] = float(value.replace("Inf", "inf"))
    return families


def metrics_of(server):
    with urllib.request.urlopen(server.metrics, timeout=60) as answer:
        check(answer.headers["Content-Type"].startswith("text/plain; version=0.0.4"), "the metrics have another type")
        return parsed_metrics(answer.read().decode())


def answered(metrics, outcome):
    return metrics["boxgrasp_requests_total"][1][("boxgrasp_requests_total", (("outcome", outcome),))]


def check_metrics(server, plans):
    metrics = until(lambda: (m := metrics_of(server)) and answered(m, "grasps") == plans and m, f"{plans} plans are counted")
    duration = "boxgrasp_request_duration_seconds"
    buckets = [value for (name, _), value in metrics[duration][1].items() if name.endswith("_bucket")]
    check(buckets == sorted(buckets) and buckets[-1] == plans == metrics[duration][1][(duration + "_count", ())], "the buckets do not add up")
    check(metrics[duration][1][(duration + "_sum", ())] > 0, "plans take time")
    for name in ("queue_length", "receiver_restarts_total", "resident_memory_bytes", "model_info", "build_info"):
        check(f"boxgrasp_{name}" in metrics, f"no metric {name}")
    check(metrics["boxgrasp_resident_memory_bytes"][1][("boxgrasp_resident_memory_bytes", ())] > 1e6, "the server has no memory")


# --- the page's server

def status_of(request):
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def talk(server, text, end=True):
    """What a server says to these bytes."""
    host, port = re.match(r"http://(.*):(\d+)/", server.page).groups()
    with socket.create_connection((host, int(port)), timeout=60) as link:
        try:
            link.sendall(text)
            if end:
                link.shutdown(socket.SHUT_WR)
            said = b""
            while part := link.recv(65536):
                said += part
            return said
        except ConnectionError:
            return b""


def check_hostile_requests(server):
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH"):
        check(status_of(urllib.request.Request(server.page, b"x" * 1000 if method == "POST" else None, method=method)) == 405, f"{method} is not refused")
    check(status_of(urllib.request.Request(server.page + "api/plans", headers={"Host": "evil.example"})) == 421, "another host's name is served")
    check(status_of(server.page + "../../etc/passwd") == 404 and status_of(server.page + "%2e%2e/etc/passwd") == 400, "a path out of the page")
    check(status_of(server.page + "api/status?x=1") == 200, "a query changes the page")
    for text in (b"", b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9\r\n\r\n", b"\x00\xff" * 1000 + b"\r\n\r\n", b"GET / HTTP/1.1\r\nHost\r\n\r\n", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"):
        check(b"200 OK" not in talk(server, text), f"{text[:20]} is answered")
    for text in (b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 1_000_000, b"GET /" + b"a" * 10_000_000):
        check(talk(server, text) == b"", "a head without end is read")
    many_ranges = b"GET /api/status HTTP/1.1\r\nHost: localhost\r\nRange: bytes=" + b"0-," * 4000 + b"0-1\r\nAccept-Encoding: br\r\n\r\n"
    check(talk(server, many_ranges).startswith(b"HTTP/1.1 200"), "ranges are not ignored")
    host, port = re.match(r"http://(.*):(\d+)/", server.page).groups()
    # As many as the server takes at once: more wait in the kernel, each for its turn.
    idle = [socket.create_connection((host, int(port))) for _ in range(12)]
    for link in idle:
        link.sendall(b"GET / HT")
    check(server.process.poll() is None, "idle connections end the server")
    for link in idle:
        link.close()
    check(server.get("api/status")["schema"] == 1, "the page is gone after hostile requests")


def check_headers(server):
    with urllib.request.urlopen(server.page, timeout=60) as answer:
        policy = answer.headers["Content-Security-Policy"]
        check("default-src 'none'" in policy and "unsafe" not in policy, f"the policy is {policy}")
        check(answer.headers["X-Content-Type-Options"] == "nosniff" and answer.headers["X-Frame-Options"] == "DENY", "headers are missing")
        text = answer.read().decode()
    check(' src="http' not in text and ' href="http' not in text, "the page refers to another place")
    head = urllib.request.urlopen(urllib.request.Request(server.page, method="HEAD"), timeout=60)
    check(int(head.headers["Content-Length"]) == len(text.encode()) and head.read() == b"", "HEAD is not GET without its body")


# --- the page in a browser

def check_page(server, plan, browser, pictures):
    requests, rows = "document.querySelectorAll('#requests button')", "document.querySelectorAll('#grasps tbody tr')"
    browser.open(server.page)
    browser.wait_until("document.getElementById('message').textContent.startsWith('No request yet')", 60)
    plan("first")
    browser.wait_until(f"{requests}.length === 1 && document.title === 'Boxgrasp: first' && {rows}.length > 0", 60)
    share, before = browser.run(DRAWN)
    check(share > 0.02, f"the 3D view is empty ({share:.4f} of it drawn)")
    browser.click("#grasps tbody tr:nth-child(2)")
    check(browser.run(f"return {rows}[1].getAttribute('aria-selected')") == "true", "a click does not select a grasp")
    check(browser.run(DRAWN)[1] != before, "the 3D view does not show the grasp that was selected")
    plan("second")
    browser.wait_until(f"{requests}.length === 2 && document.title === 'Boxgrasp: second'", 60)
    browser.click("#requests button:nth-child(2)")
    browser.wait_until("document.title === 'Boxgrasp: first' && !document.getElementById('follow').checked", 60)
    plan("third")
    browser.wait_until(f"{requests}.length === 3", 60)
    check(browser.run("return document.title") == "Boxgrasp: first", "the page leaves the plan that was chosen")
    browser.click("#follow")
    browser.wait_until("document.title === 'Boxgrasp: third'", 60)
    browser.click("summary")
    browser.wait_until("document.querySelectorAll('#models tbody tr.serving').length === 1", 60)
    for width in (1280, 400):
        fits(browser, width)
        if pictures:
            browser.run("scrollTo(0, 0)")
            browser.picture(pictures / f"live_{width}.png")
    check(not browser.errors(), f"errors on the console: {browser.errors()}")


def check_api(server):
    listed = server.get("api/plans")
    check(listed["schema"] == 1 and [plan["request_id"] for plan in listed["plans"]] == ["third", "second", "first"], f"the list is {listed}")
    scene = server.get(f"api/plans/{listed['plans'][0]['id']}")
    check(scene["schema"] == 1 and scene["objects"][0]["cloud"]["points"] > 100 and len(scene["faces"]) > 0, "a plan has no cloud or faces")
    check(scene["num_grasps"] == listed["plans"][0]["num_grasps"], "the numbers of grasps differ")


# --- log and doctor

def check_log(program, folder):
    with Server(program, f"{folder}/journal.log", env="journal") as server:
        check(all(re.match(r"<[0-7]>\S", line) for line in server.log.read_text().splitlines()), f"lines without level:\n{server.log.read_text()}")
    run = subprocess.run([program, "--lcm-url", URL, "--http", "127.0.0.1:99999"], capture_output=True, text=True)
    check(run.returncode == 3 and "127.0.0.1:8080" in run.stderr, f"a port that is none: {run}")
    run = subprocess.run([program, "--lcm-url", URL, "--log-level", "loud"], capture_output=True, text=True)
    check(run.returncode == 3 and "debug, info, warning, error" in run.stderr, f"a level that is none: {run}")


def doctor(client, folder, *options):
    run = subprocess.run([client, "doctor", "--lcm-url", URL, "--json", "--state-dir", f"{folder}/state", "--trusted-keys", f"{folder}/keys", *options],
                         capture_output=True, text=True)
    report = json.loads(run.stdout)
    check(list(report)[0] == "schema" and report["schema"] == 1, "the doctor's JSON has no schema")
    check(run.returncode == (0 if report["healthy"] else 1), f"exit code {run.returncode}, healthy {report['healthy']}")
    for finding in report["checks"]:
        check(finding["grade"] == "ok" or finding["remedy"], f"no remedy for {finding}")
    return {finding["name"]: finding for finding in report["checks"]}


def check_doctor(client, folder):
    """While a server answers."""
    found = doctor(client, folder)
    check([found[name]["grade"] for name in ("multicast", "server", "clock", "model")] == ["ok"] * 4, f"not healthy: {found}")
    check("keygen" in found["keys"]["remedy"] and found["store"]["grade"] == "warn", f"no keys, no store: {found}")
    state, keys = pathlib.Path(f"{folder}/state"), pathlib.Path(f"{folder}/keys")
    state.mkdir()
    keys.mkdir()
    check(doctor(client, folder)["store"]["grade"] in ("ok", "warn"), "an empty folder is no damage")
    (state / "outcomes.db").write_text("this is a letter")
    (keys / "x.pub").write_text("this is a letter")
    found = doctor(client, folder, "--model", keys / "x.pub")
    check([found[name]["grade"] for name in ("model", "keys", "store")] == ["fail"] * 3, f"damage is not found: {found}")
    text = subprocess.run([client, "doctor", "--lcm-url", URL, "--state-dir", state], capture_output=True, text=True).stdout
    check("fail  store" in text and "->" in text and "\x1b" not in text, f"its text: {text}")


def main():
    enter_own_network()
    build = pathlib.Path(sys.argv[1]).resolve()
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    client, program = build / "client/boxgrasp", build / "server/planner/boxgrasp-server"
    with tempfile.TemporaryDirectory() as folder:
        cloud = f"{folder}/mug.pcd"
        subprocess.run([build / "server/trainer/boxgrasp-trainer", "sample", "mug", "--out", cloud], check=True)

        def plan(request_id):
            subprocess.run([client, "plan", cloud, "--lcm-url", URL, "--top", "7", "--request-id", request_id], check=True, stdout=subprocess.DEVNULL)

        with Server(program, f"{folder}/log") as server:
            check_headers(server)
            if shutil.which("chromedriver"):
                with Browser() as browser:
                    check_page(server, plan, browser, pictures)
            else:
                print("no chromedriver (Debian: chromium-driver): the page was not opened")
                for request_id in ("first", "second", "third"):
                    plan(request_id)
            check_api(server)
            check_metrics(server, 3)
            check_hostile_requests(server)
            check_doctor(client, folder)
        check(doctor(client, folder)["server"]["grade"] == "fail", "the doctor finds a server that has ended")
        check_log(program, folder)
    print("live_test: page, metrics, log and doctor are sound")


main()
