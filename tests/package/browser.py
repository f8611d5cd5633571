"""A headless Chromium, driven over the WebDriver protocol with Python's standard library (Debian: chromium-driver)."""
import base64
import json
import socket
import subprocess
import time
import urllib.request


class Browser:
    def __init__(self, width=1280, height=900):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.url = f"http://127.0.0.1:{free.getsockname()[1]}"
        port = self.url.rsplit(":", 1)[1]
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL)
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--hide-scrollbars", f"--window-size={width},{height}"]
        wanted = {"browserName": "chrome", "goog:chromeOptions": {"args": arguments}, "goog:loggingPrefs": {"browser": "ALL"}}
        self._wait_for_driver()
        self.session = f"/session/{self._call('POST', '/session', {'capabilities': {'alwaysMatch': wanted}})['sessionId']}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._call("DELETE", self.session)
        self.driver.terminate()
        self.driver.wait()

    def open(self, url):
        self._call("POST", f"{self.session}/url", {"url": url})

    def run(self, script):
        """The value that the script returns."""
        return self._call("POST", f"{self.session}/execute/sync", {"script": script, "args": []})

    def wait_until(self, condition, timeout_s=20):
        end = time.monotonic() + timeout_s
        while not self.run(f"return Boolean({condition})"):
            if time.monotonic() > end:
                raise AssertionError(f"not within {timeout_s} s: {condition}")
            time.sleep(0.1)

    def click(self, selector):
        found = self._call("POST", f"{self.session}/element", {"using": "css selector", "value": selector})
        self._call("POST", f"{self.session}/element/{next(iter(found.values()))}/click", {})

    def resize(self, width, height):
        self._call("POST", f"{self.session}/goog/cdp/execute", {
            "cmd": "Emulation.setDeviceMetricsOverride",
            "params": {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}})

    def errors(self):
        entries = self._call("POST", f"{self.session}/se/log", {"type": "browser"})
        return [entry["message"] for entry in entries if entry["level"] == "SEVERE"]

    def picture(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self._call("GET", f"{self.session}/screenshot")))

    def _wait_for_driver(self):
        for _ in range(100):
            try:
                return self._call("GET", "/status")
            except OSError:
                time.sleep(0.1)
        raise RuntimeError("chromedriver does not start")

    def _call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.url + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)["value"]
