#!/usr/bin/env python3
"""Checks relative links of all Markdown documents: each names a file or folder, and its anchor a heading there.

links.py ROOT      exit 1 if a link leads nowhere
First it plants wrong links in a tree of its own, and fails if it does not find each.
"""
import pathlib
import re
import sys
import tempfile

SKIPPED = re.compile(r'(^|/)(\.|build|subprojects/|out/)')
LINK = re.compile(r'\]\(([^()\s]*(?:\([^()\s]*\)[^()\s]*)?)\)|^\[[^\]^]+\]:\s*(\S+)', re.M)


def plain(path):
    """Text of a document without code."""
    text = re.sub(r'^```.*?^```', '', path.read_text(encoding='utf-8'), flags=re.M | re.S)
    return re.sub(r'`[^`\n]*`', 'code', text)


def anchors(path):
    """Anchors of a document's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r'^#+\s+(.*)', path.read_text(encoding='utf-8'), re.M):
        words = re.sub(r'!?\[([^\]]*)\]\([^)]*\)', r'\1', heading).strip().lower()
        name = re.sub(r'[^\w\- ]', '', words).replace(' ', '-')
        number = 0
        while name + (f'-{number}' if number else '') in found:
            number += 1
        found.add(name + (f'-{number}' if number else ''))
    return found


def broken(root):
    """Links that lead nowhere: a list of 'document: link'."""
    found = []
    for path in sorted(root.glob('**/*.md')):
        name = path.relative_to(root).as_posix()
        if SKIPPED.search(name):
            continue
        for match in LINK.finditer(plain(path)):
            link = match.group(1) or match.group(2) or ''
            if re.match(r'\w+:', link):
                continue
            target, _, anchor = link.partition('#')
            goal = path.parent / target if target else path
            if not goal.exists() or anchor and (goal.suffix != '.md' or anchor not in anchors(goal)):
                found.append(f'{name}: {link}')
    return found


def prove():
    """True if planted links are judged right."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / 'docs').mkdir()
        (root / 'a.c').write_text('', encoding='utf-8')
        (root / 'docs/b.md').write_text('# One `thing`, and others\n\n# Twice\n\n# Twice\n', encoding='utf-8')
        (root / 'a.md').write_text(
            '[1](a.c) [2](docs/b.md#one-thing-and-others) [3](docs/b.md#twice-1) [4](https://example.org/none)\n'
            '[5](b.c) [6](docs/b.md#three) ![7](docs/c.png) [8](#none) `[9](code)`\n\n[10]: docs/none.md\n', encoding='utf-8')
        wrong = ['b.c', 'docs/b.md#three', 'docs/c.png', '#none', 'docs/none.md']
        return broken(root) == [f'a.md: {link}' for link in wrong]


def main():
    if len(sys.argv) != 2 or not (pathlib.Path(sys.argv[1]) / 'README.md').is_file():
        sys.exit('usage: links.py ROOT, ROOT: the folder that holds README.md')
    if not prove():
        sys.exit('links.py itself does not find planted links')
    found = broken(pathlib.Path(sys.argv[1]))
    print(*found, f'{len(found)} links lead nowhere', sep='\n')
    sys.exit(1 if found else 0)


main()
