#!/usr/bin/env python3
"""check_report.py WRITER: WRITER's report is complete, well-formed, without outside links, and the same each time."""
import html.parser
import json
import pathlib
import re
import subprocess
import sys
import tempfile

VOID = {'meta', 'br'}


class Checker(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.wrong, self.tables = [], [], [], [], 0

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        attrs = dict(attrs)
        self.tables += tag == 'table'
        self.ids += [attrs['id']] if 'id' in attrs else []
        self.links += [attrs['href']] if 'href' in attrs else []
        self.wrong += [f'{tag} {name}' for name in attrs if name == 'src' or name.startswith('on')]
        self.wrong += [tag] if tag in ('link', 'iframe', 'img') else []

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f'</{tag}> at {self.getpos()}')


def written(writer):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([writer, folder], check=True)
        root = pathlib.Path(folder)
        return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob('*') if path.is_file()}


def main():
    first, second = written(sys.argv[1]), written(sys.argv[1])
    assert first == second, 'not the same bytes'
    page = first['report.html'].decode('utf-8')
    checker = Checker()
    checker.feed(page)
    checker.close()
    assert not checker.open and not checker.wrong, (checker.open, checker.wrong)
    assert len(set(checker.ids)) == len(checker.ids), 'ids are not unique'
    astray = [link for link in checker.links if not link.startswith('#') or link[1:] not in checker.ids]
    assert not astray, astray
    markup = re.sub(r'<(style|script).*?</\1>', ' ', page, flags=re.S)
    assert not re.search(r'\{\{|\}\}', markup) and not re.search(r'url\(|@import|fetch|https?://(?!www.w3.org/2000/svg)', page), 'a slot was left, or something is loaded'
    assert not re.search(r'\bnan\b|\binf\b', re.sub(r'<[^>]*>', ' ', markup)), 'a figure is printed raw'
    assert 'Bullet &lt;3.24&gt; &amp; &quot;single&quot;' in page and 'Bullet <3' not in page
    charts = [json.loads(text)['name'] for text in re.findall(r'<script class="chart" type="application/json">(.*?)</script>', page)]
    assert {'stack-10', 'order-pile', 'all-cases', 'all-ghost', 'lag'} <= set(charts), charts
    # each diagram once, except the one of late partners, which has a section and a case
    cases = checker.ids.count('stack-10') and page.count('<section id=')
    assert cases > 30 and len(charts) == len(set(charts)) + 1 and checker.tables == 4 + 2 * cases, (cases, charts)
    print(f'{cases} cases, {len(charts)} diagrams, {len(page) / 1e6:.2f} MB')


main()
