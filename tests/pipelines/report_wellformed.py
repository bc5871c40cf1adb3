"""Is a report well-formed, self-contained and below 5 MB, and does it say what it must? Exit code 0 and the word
"sound", or what is wrong.

Run: python3 report_wellformed.py report.html [text that a reader must find, in this order]...
"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser

VOID = {"meta", "br", "img", "hr", "input", "link", "wbr"}
SELF_CLOSED = {"path", "rect"}
wrong = []


class Checker(HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open, self.ids, self.targets, self.svg_start = [], [], [], None
        self.counts = {}
        self.read = []

    def handle_data(self, data):
        if not {"style", "script"} & set(self.open):
            self.read.append(data)

    def handle_starttag(self, tag, attributes):
        self.look(tag, dict(attributes))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.look(tag, dict(attributes))
        if tag not in SELF_CLOSED:
            wrong.append(f"<{tag}/> is closed in itself")

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            wrong.append(f"</{tag}> at {self.getpos()} closes nothing")

    def look(self, tag, attributes):
        self.counts[tag] = self.counts.get(tag, 0) + 1
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if "src" in attributes or tag in ("link", "img", "iframe", "object", "embed"):
            wrong.append(f"<{tag}> fetches something")
        href = attributes.get("href")
        if href is not None and not href.startswith(("#", "https://", "http://")):
            wrong.append(f"link to {href}")
        if href is not None and href.startswith("#"):
            self.targets.append(href[1:])
        if tag == "th" and attributes.get("scope") not in ("col", "row"):
            wrong.append("a table heading without scope")
        if any(name.startswith("on") for name in attributes):
            wrong.append(f"<{tag}> carries a script")


text = open(sys.argv[1], encoding="utf-8", errors="strict").read()
checker = Checker()
checker.feed(text)
checker.close()
if len(text.encode()) > 5e6:
    wrong.append(f"{len(text.encode()) / 1e6:.1f} MB")
reading, found = re.sub(r"\s+", " ", " ".join(checker.read)), 0
for wanted in sys.argv[2:]:
    at = reading.find(wanted, found)
    if at < 0:
        wrong.append(f"nobody can read `{wanted}`" + (" after the texts before it" if wanted in reading else ""))
    found = max(at, found)
if checker.open:
    wrong.append(f"never closed: {checker.open}")
if len(set(checker.ids)) != len(checker.ids):
    wrong.append("an id occurs twice")
for target in checker.targets:
    if target not in checker.ids:
        wrong.append(f"link to #{target}, which is not there")
for forbidden in ("url(", "@import", "fetch(", "XMLHttpRequest"):
    if forbidden in text:
        wrong.append(f"{forbidden} in the page")

# Every picture is XML of its own, with a title and a description unless it is mere decoration.
pictures, at, depth, start = 0, 0, 0, 0
while True:
    opening, closing = text.find("<svg", at), text.find("</svg>", at)
    if closing < 0:
        break
    if 0 <= opening < closing:
        if depth == 0:
            start = opening
        depth += 1
        at = opening + 4
    else:
        depth -= 1
        at = closing + 6
        if depth == 0:
            pictures += 1
            root = ElementTree.fromstring(text[start:at])
            named = root.find("title") is not None and root.find("desc") is not None
            if not named and root.get("aria-hidden") != "true":
                wrong.append("a picture without title and description")
print("sound" if not wrong else "\n".join(wrong[:20]), f"({pictures} pictures, {checker.counts.get('table', 0)} tables)")
sys.exit(1 if wrong or pictures == 0 else 0)
