#!/usr/bin/env python3
"""Compares labels of the viewer's page with docs/page.md, which explains them: words.py ROOT

Lists labels that the document lacks, and words in the document's tables that the page does not use; exit 1 if there are any.
First it takes a label from the document, and adds one, and fails if it does not find both.
"""
import html.parser
import pathlib
import re
import sys

LABELS = {'summary', 'label', 'h2', 'button', 'span'}  # elements whose own text is a label


class Labels(html.parser.HTMLParser):
    """Labels in the page's HTML: own texts of some elements, choices of colours, the text of an empty field."""

    def __init__(self):
        super().__init__()
        self.inside, self.colours, self.found = [], False, set()

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if tag == 'select':
            self.colours = given.get('id') == 'colours'
        if tag == 'input' and given.get('type') == 'search':
            self.found.add(given['placeholder'])
        if tag not in ('input', 'meta', 'link'):
            self.inside.append(tag)

    def handle_endtag(self, tag):
        while self.inside and self.inside.pop() != tag:
            pass

    def handle_data(self, data):
        inside = self.inside[-1] if self.inside else ''
        if re.search(r'[a-z]{3}', data) and (inside in LABELS or inside == 'option' and self.colours):
            self.found.add(data.strip())


def labels(page):
    """All labels: of the HTML, of a picked object's facts, of plots."""
    parser = Labels()
    parser.feed((page / 'index.html').read_text(encoding='utf-8'))
    panel, explore = ((page / name).read_text(encoding='utf-8') for name in ('panel.js', 'explore.js'))
    facts = re.findall(r"\['([a-z][a-zA-Z ]+)', ", panel[panel.index('details(d)'):panel.index('offerKill(d)')])
    plots = re.findall(r"\w: '([^']+)'", re.search(r'LINES = \{.*\}', explore)[0])
    assert len(parser.found) > 40 and len(facts) > 10 and len(plots) > 5
    return {label.removesuffix(' its worker') for label in parser.found | set(facts) | set(plots)}


def differences(root, document):
    page = root / 'src/front/serve/page'
    used = labels(page)
    sources = ' '.join(file.read_text(encoding='utf-8') for file in page.iterdir() if file.suffix in ('.js', '.html')).lower()
    explained, found = re.findall(r'^\| (?!label \|)([^|]+) \| [^|]+ \|$', document, re.M), []
    rows = [f', {row},' for row in explained + re.findall(r'^## (.+)$', document, re.M)]
    for label in sorted(used, key=len, reverse=True):
        if not any(f', {label},' in row for row in rows):
            found.append(f'docs/page.md lacks "{label}"')
        rows = [row.replace(f', {label},', ',') for row in rows]
    for word in (word for row in rows[:len(explained)] for word in row.split(',') if word.strip()):
        if word.strip().lower().removesuffix('s') not in sources:
            found.append(f'docs/page.md explains "{word.strip()}", which is not on the page')
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    document = (root / 'docs/page.md').read_text(encoding='utf-8')
    planted = differences(root, document.replace('| substeps |', '| brownies |'))
    if not {'docs/page.md lacks "substeps"', 'docs/page.md explains "brownies", which is not on the page'} <= set(planted):
        sys.exit(f'words.py does not find what was planted: {planted}')
    found = differences(root, document)
    print('\n'.join(found), end='\n' if found else '')
    sys.exit(bool(found))


main()
