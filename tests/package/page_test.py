#!/usr/bin/env python3
"""The interactive page in headless Chromium: it opens, fetches nothing, shows the grasps, a click selects one, no error on the console,
and it fits screens of 1280 and 400 pixels.  Usage: page_test.py BUILD [PICTURES]"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

from browser import Browser

SKIPPED = 77
# How much of the drawing differs from its ground: an empty view would be 0.
DRAWN = """
  const canvas = document.getElementById('view'), copy = document.createElement('canvas');
  copy.width = canvas.width; copy.height = canvas.height;
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);
  const data = context.getImageData(0, 0, copy.width, copy.height).data;
  let drawn = 0, sum = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i]) { ++drawn; sum = (sum * 31 + data[i - 1] + data[i - 2] * 7) % 1000003; }
  return [drawn / (data.length / 4), sum];
"""


def check(condition, what):
    if not condition:
        raise SystemExit(f"page_test: {what}")


def fits(browser, width):
    browser.resize(width, 900)
    browser.wait_until(f"innerWidth === {width}")
    check(browser.run("return document.documentElement.scrollWidth") <= width, f"the page is wider than {width} pixels")
    smallest = browser.run("""return Math.min(...[...document.querySelectorAll('td, th, p, label, button, h1, h2')]
        .filter(e => e.offsetParent && e.textContent.trim()).map(e => parseFloat(getComputedStyle(e).fontSize)))""")
    check(smallest >= 11, f"text of {smallest} pixels is too small to read")


def main():
    if not shutil.which("chromedriver"):
        print("skipped: no chromedriver (Debian: chromium-driver)")
        sys.exit(SKIPPED)
    build = pathlib.Path(sys.argv[1]).resolve()
    pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        cloud, page = f"{folder}/<b>mug.pcd", f"{folder}/mug.html"
        subprocess.run([build / "server/trainer/boxgrasp-trainer", "sample", "mug", "--out", cloud], check=True)
        subprocess.run([build / "client/boxgrasp", "plan", cloud, "--local", "--top", "7", "--html", page],
                       check=True, stdout=subprocess.DEVNULL)
        text = pathlib.Path(page).read_text()
        check(' src="http' not in text and ' href="http' not in text, "the page refers to another place")
        browser.open(f"file://{page}")
        browser.wait_until("document.body.dataset.ready === 'true'")
        rows = "document.querySelectorAll('#grasps tbody tr')"
        check(browser.run(f"return {rows}.length") == 7, "it does not list the 7 grasps")
        check(browser.run("return document.title") == "Boxgrasp: <b>mug.pcd", "the file's name is not shown as it is")
        share, first = browser.run(DRAWN)
        check(share > 0.02, f"the 3D view is empty ({share:.4f} of it drawn)")
        browser.click("#grasps tbody tr:nth-child(5)")
        check(browser.run(f"return {rows}[4].getAttribute('aria-selected')") == "true", "a click does not select a grasp")
        check("Grasp 5" in browser.run("return document.getElementById('selected-title').textContent"), "its measures are not shown")
        check(browser.run(DRAWN)[1] != first, "the 3D view does not show the grasp that was selected")
        browser.click("#faces button")
        check(browser.run("return document.querySelectorAll('#faces img').length") > 0, "no face image")
        check(browser.run("return document.querySelectorAll('#stages tbody tr').length") >= 5, "the stages are not listed")
        for width in (1280, 400):
            fits(browser, width)
            if pictures:
                browser.run("scrollTo(0, 0)")
                browser.picture(pictures / f"page_{width}.png")
        check(not browser.errors(), f"errors on the console: {browser.errors()}")
    print("page_test: the page is sound")


if __name__ == "__main__":
    main()
