"""Opens reports of runs in a real browser without a screen, and checks that they work there.

    python scripts/check_report.py [--shots FOLDER] RUN [RUN ...]

Needs a chromium (`CHROMIUM` names it, else it is sought) and nothing else: it is spoken to through a pipe. Each page is
opened at the width of a phone and of a desk, light and dark. Exit code 1 and a line per finding if anything is wrong.
"""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

WIDTHS = {"phone": 360, "desk": 1280}
SCHEMES = ("light", "dark")
PATIENCE = 60  # s

# What a page says of itself. Nothing may be wider than the window, and text must stand out from the paper.
ASK = """(() => {
  const wide = [...document.querySelectorAll("body *")].filter((e) => {
    const box = e.getBoundingClientRect();
    return box.right > innerWidth + 1 && !e.closest("pre, .wide, svg") && box.width > 0;
  });
  const style = getComputedStyle(document.body);
  const light = (colour) => {
    const part = colour.match(/[0-9.]+/g).slice(0, 3).map((c) => c / 255)
      .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    return 0.2126 * part[0] + 0.7152 * part[1] + 0.0722 * part[2];
  };
  const [ink, paper] = [light(style.color), light(style.backgroundColor)];
  const images = [...document.querySelectorAll("img")];
  return {
    contrast: (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05),
    dark: paper < 0.2,
    scroll: document.documentElement.scrollWidth - innerWidth,
    wide: wide.slice(0, 3).map((e) => e.outerHTML.slice(0, 80)),
    charts: Number(document.documentElement.dataset.charts),
    figures: document.querySelectorAll("figure.chart").length,
    drawn: [...document.querySelectorAll("figure.chart svg")].filter((s) => s.querySelector("polyline.line")).length,
    letters: Math.min(...[...document.querySelectorAll("figure.chart text")].map((t) => t.getBoundingClientRect().height)),
    images: images.length,
    seen: images.filter((i) => i.complete && i.naturalWidth > 0).length,
    sections: [...document.querySelectorAll("section")].map((s) => s.id),
    tall: [...document.querySelectorAll("td")].filter((e) => e.getBoundingClientRect().height > 200).map((e) => e.textContent).slice(0, 3),
    wrong: [...document.querySelectorAll("polyline, path, circle")].filter((e) => /NaN|Infinity|undefined/.test(e.outerHTML)).length,
  };
})()"""


class Browser:
    """A browser that is spoken to in its own protocol: messages of JSON, each ended by a zero byte."""

    def __init__(self):
        program = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        if program is None:
            sys.exit("there is no chromium; install one, or name it in CHROMIUM")
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, from_browser = os.pipe(), os.pipe()

        def ends():
            os.dup2(to_browser[0], 3)
            os.dup2(from_browser[1], 4)

        options = ["--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars",
                   "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update", f"--user-data-dir={self.profile.name}"]
        # The two ends may themselves be 3 and 4: copies far above are handed over.
        to_browser = (os.dup2(to_browser[0], 30), to_browser[1])
        from_browser = (from_browser[0], os.dup2(from_browser[1], 31))
        self.process = subprocess.Popen([program, *options, "about:blank"], preexec_fn=ends, pass_fds=(3, 4),
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.output, self.input = to_browser[1], os.fdopen(from_browser[0], "rb", buffering=0)
        self.buffer, self.number, self.events = b"", 0, []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = None
        self.session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")

    def read(self):
        while b"\0" not in self.buffer:
            more = self.input.read(1 << 16)
            if not more:
                sys.exit("the browser ended")
            self.buffer += more
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if getattr(self, "session", None):
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.output, data):]
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    sys.exit(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def wait(self, method):
        while True:
            for event in self.events:
                if event.get("method") == method:
                    return
            self.events.append(self.read())

    def evaluate(self, expression):
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            sys.exit(f"{expression[:60]}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def open(self, page, width, scheme):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=width < 500)
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.events.clear()
        self.ask("Page.navigate", url=page.resolve().as_uri())
        self.wait("Page.loadEventFired")
        self.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def mouse(self, kind, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def complaints(self, page):
        """Errors on the console, and whatever was loaded besides the page."""
        found = []
        for event in self.events:
            method, told = event.get("method"), event.get("params", {})
            if method == "Runtime.exceptionThrown":
                found.append(told["exceptionDetails"].get("exception", {}).get("description", "an exception"))
            elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
                found.append(f"console: {told['args']}")
            elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
                found.append(f"log: {told['entry']['text']}")
            elif method == "Network.requestWillBeSent":
                url = told["request"]["url"]
                if not url.startswith("data:") and url.split("#")[0] != page.resolve().as_uri():
                    found.append(f"loads {url[:80]}")
        return found

    def close(self):
        self.session = None
        self.ask("Browser.close")
        self.process.wait(PATIENCE)


def tells(browser):
    """Which charts tell nothing where they begin, where much is zero, or where they end."""
    places = browser.evaluate("""[...document.querySelectorAll("figure.chart svg")].map((svg) => {
      const { left, top, width, height } = svg.getBoundingClientRect();
      return { left: left + scrollX, top: top + scrollY, width, height };
    })""")
    found = []
    for number, box in enumerate(places):
        browser.evaluate(f"scrollTo(0, {box['top'] - 50})")
        scrolled = browser.evaluate("[scrollX, scrollY]")
        for share in (0.25, 0.95):
            x = box["left"] - scrolled[0] + share * box["width"]
            browser.mouse("mouseMoved", x, box["top"] - scrolled[1] + 0.4 * box["height"])
            told = browser.evaluate(f"""document.querySelectorAll("figure.chart")[{number}].querySelector(".readout:not([hidden])")?.textContent ?? "" """)
            if not told:
                found.append(f"chart {number + 1} tells nothing at {share:.0%} of its width")
    return found


def zooms(browser):
    """Whether dragging shows a part, hovering tells values, and a double click shows all again."""
    box = browser.evaluate("""(() => {
      const svg = document.querySelector("figure.chart svg");
      svg.scrollIntoView({ block: "center" });
      const { left, top, width, height } = svg.getBoundingClientRect();
      return { left, top, width, height };
    })()""")
    def marks():
        return browser.evaluate("""document.querySelector("figure.chart svg polyline").getAttribute("points")""")

    whole = marks()
    y = box["top"] + 0.4 * box["height"]

    def at(share):
        return box["left"] + share * box["width"]

    browser.mouse("mouseMoved", at(0.5), y)
    told = browser.evaluate("""document.querySelector("figure.chart .readout:not([hidden])")?.textContent ?? "" """)
    browser.mouse("mousePressed", at(0.4), y, button="left", clickCount=1)
    browser.mouse("mouseMoved", at(0.5), y, button="left")
    browser.mouse("mouseReleased", at(0.5), y, button="left", clickCount=1)
    part = marks()
    browser.mouse("mouseWheel", at(0.5), y, deltaX=0, deltaY=-100)
    browser.evaluate("new Promise((done) => setTimeout(done, 500))")
    nearer = marks()
    for count in (1, 2):
        browser.mouse("mousePressed", at(0.5), y, button="left", clickCount=count)
        browser.mouse("mouseReleased", at(0.5), y, button="left", clickCount=count)
    again = marks()
    found = []
    if not told:
        found.append("hovering over a chart tells nothing")
    if part == whole:
        found.append("dragging over a chart does not zoom")
    if nearer == part:
        found.append("the wheel does not zoom a chart that was clicked")
    if again != whole:
        found.append("a double click does not show all of a chart again")
    return found


def check(browser, run, shots):
    page = run / "report.html" if run.is_dir() else run
    findings = []
    for place, width in WIDTHS.items():
        for scheme in SCHEMES:
            browser.open(page, width, scheme)
            said = browser.evaluate(ASK)
            here = []
            if said["contrast"] < 7:
                here.append(f"contrast is {said['contrast']:.1f}")
            if said["dark"] != (scheme == "dark"):
                here.append(f"it does not look {scheme}")
            if said["scroll"] > 0 or said["wide"]:
                here.append(f"wider than the window by {said['scroll']} pixels: {said['wide']}")
            if not (said["charts"] == said["figures"] == said["drawn"] > 0):
                here.append(f"{said['figures']} charts, {said['charts']} with script, {said['drawn']} drawn")
            if (said["letters"] or 0) < 9:
                here.append(f"letters of charts are {said['letters']} pixels high")
            if said["images"] != said["seen"] or said["images"] == 0:
                here.append(f"{said['images']} pictures, {said['seen']} of them seen")
            if said["wrong"]:
                here.append(f"{said['wrong']} lines that are no numbers")
            for section in ("summary", "pictures", "case", "files"):
                if section not in said["sections"]:
                    here.append(f"no section {section}")
            if shots:
                height = browser.evaluate("document.documentElement.scrollHeight")
                part = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
                shot = browser.ask("Page.captureScreenshot", captureBeyondViewport=True, clip=part)
                (shots / f"{run.stem}-{place}-{scheme}.png").write_bytes(base64.b64decode(shot["data"]))
            if said["tall"]:
                here.append(f"squeezed into narrow columns: {said['tall']}")
            if width > 500:
                here += tells(browser) + zooms(browser)
            here += browser.complaints(page)
            findings += [f"{page} ({width} pixels, {scheme}): {finding}" for finding in here]
    return findings


def main():
    arguments = sys.argv[1:]
    shots = None
    if arguments[:1] == ["--shots"]:
        shots = Path(arguments[1])
        shots.mkdir(parents=True, exist_ok=True)
        arguments = arguments[2:]
    if not arguments:
        sys.exit(__doc__)
    browser = Browser()
    findings = [finding for run in arguments for finding in check(browser, Path(run), shots)]
    browser.close()
    for finding in findings:
        print(f"WRONG: {finding}")
    print(f"{len(arguments)} reports opened {len(WIDTHS) * len(SCHEMES)} times each, {len(findings)} findings")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
