#!/usr/bin/env python3
"""Follows the links of all documents below a folder: links.py FOLDER. Those to the web are left alone."""
import pathlib
import re
import sys

LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def anchors(text):
    """Of a document's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#+ +(.+)$", CODE.sub("", text), re.MULTILINE):
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading.lower())
        found.add(re.sub(r"[^\w\- ]", "", plain).replace(" ", "-"))
    return found


def dead_links(document):
    text = document.read_text()
    for target in LINK.findall(CODE.sub("", text)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        to = document.parent / path if path else document
        if not to.exists():
            yield f"{document}: {target}: there is no such file"
        elif anchor and anchor not in anchors(to.read_text()):
            yield f"{document}: {target}: there is no such heading"


folder = pathlib.Path(sys.argv[1])
documents = [one for one in sorted(folder.rglob("*.md")) if "build" not in one.relative_to(folder).parts]
dead = [line for document in documents for line in dead_links(document)]
print("\n".join(dead) or f"{len(documents)} documents, no dead link")
sys.exit(1 if dead or not documents else 0)
