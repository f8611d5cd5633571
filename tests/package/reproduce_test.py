#!/usr/bin/env python3
"""A quick reproduction: the report has every section, the numbers in it are those of the steps' JSON, a second call runs no step again, and
folders that are not its own are refused.  Usage: reproduce_test.py BUILD [FOLDER]   (with a FOLDER, all stays there)"""
import html.parser
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from browser import Browser

BUILD = pathlib.Path(sys.argv[1]).resolve()
SECTIONS = ["summary", "robot", "failures", "ablation", "stability", "constellations", "spread", "counts", "hidden", "spans", "grasps",
            "commands"]
WITHOUT_NUMBERS = {"hidden", "failures"}  # a quick run has no sweep over hidden nodes, and all its grasps may hold


def check(condition, what):
    if not condition:
        raise SystemExit(f"reproduce_test: {what}")


class Cells(html.parser.HTMLParser):
    """The cells that say where their number comes from, by section, and all else that is checked."""

    def __init__(self):
        super().__init__()
        self.section, self.cell, self.cells, self.pictures, self.numbers = None, None, [], 0, {}

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "section":
            self.section = attributes["id"]
            self.numbers[self.section] = 0
        if tag == "td" and "data-from" in attributes:
            self.cell = (attributes["data-from"], float(attributes["data-factor"]), "")
        self.pictures += tag == "img"
        check(not any(str(attributes.get(name, "")).startswith(("http", "//")) for name in ("src", "href")), "the report fetches something")

    def handle_data(self, data):
        if self.section and re.search(r"\d", data):
            self.numbers[self.section] += 1
        if self.cell:
            self.cell = (*self.cell[:2], self.cell[2] + data)

    def handle_endtag(self, tag):
        if tag == "td" and self.cell:
            self.cells.append(self.cell)
            self.cell = None


def reproduce(folder, *options):
    return subprocess.run([BUILD / "server/trainer/boxgrasp-trainer", "reproduce", "--out", folder, *options], capture_output=True, text=True)


def value_at(folder, origin):
    step, pointer = origin.split("#")
    value = json.loads((folder / f"{step}.json").read_text())
    for key in pointer.split("/")[1:]:
        value = value[int(key)] if isinstance(value, list) else value.get(key)
    return value


def check_numbers(folder, text):
    cells = Cells()
    cells.feed(text)
    check(list(cells.numbers) == SECTIONS, f"sections are {list(cells.numbers)}")
    for section in SECTIONS:
        check(section in WITHOUT_NUMBERS or cells.numbers[section] > 3, f"the section '{section}' has no numbers")
    check(len(cells.cells) > 50, f"only {len(cells.cells)} cells name their origin")
    for origin, factor, shown in cells.cells:
        value = value_at(folder, origin)
        if value is None:
            check(shown == "–", f"{origin} is null, the report says {shown}")
            continue
        digits = len(shown.partition(".")[2])
        check(abs(float(shown) - factor * value) <= 0.5001 * 10**-digits, f"{origin} is {factor * value}, the report says {shown}")
    check(cells.pictures >= 4, f"only {cells.pictures} pictures")
    check(text.count("<svg") >= 3, "plots are missing")


def check_page(folder):
    if not shutil.which("chromedriver"):
        return
    with Browser() as browser:
        browser.open(f"file://{folder}/report.html")
        for width in (1280, 400):
            browser.resize(width, 900)
            browser.wait_until(f"innerWidth === {width}")
            check(browser.run("return document.documentElement.scrollWidth") <= width, f"the report is wider than {width} pixels")
            browser.picture(folder / f"report_{width}.png")
        check(not browser.errors(), f"errors on the console: {browser.errors()}")


def check_refusals(folder):
    foreign = folder / "foreign"
    foreign.mkdir()
    (foreign / "thesis.txt").write_text("mine")
    refused = reproduce(foreign, "--quick")
    check(refused.returncode == 3 and "holds other files" in refused.stderr, f"a foreign folder: {refused.returncode} {refused.stderr}")
    refused = reproduce(foreign / "thesis.txt", "--quick")
    check(refused.returncode == 3 and "is no folder" in refused.stderr, f"a file: {refused.returncode} {refused.stderr}")


def main():
    with tempfile.TemporaryDirectory() as temporary:
        check_refusals(pathlib.Path(temporary))
        folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else f"{temporary}/report").resolve()
        first = reproduce(folder, "--quick")
        check(first.returncode == 0, f"exit code {first.returncode}: {first.stderr}")
        check_numbers(folder, (folder / "report.html").read_text())
        before = {file.name: file.stat().st_mtime_ns for file in folder.glob("*.json") if file.name != "steps.json"}
        page = (folder / "report.html").read_bytes()
        second = reproduce(folder, "--quick")
        check(second.returncode == 0, f"the second call: exit code {second.returncode}: {second.stderr}")
        after = {file.name: file.stat().st_mtime_ns for file in folder.glob("*.json") if file.name != "steps.json"}
        check(before == after, "the second call ran steps again")
        check(second.stderr.count("done before") == len(before), f"of {len(before)} steps not all were done before: {second.stderr}")
        check((folder / "report.html").read_bytes() == page, "the second report differs")
        check_page(folder)
    print(f"reproduce_test: {len(before)} steps, and a report that agrees with them")


main()
