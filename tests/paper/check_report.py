#!/usr/bin/env python3
"""check_report.py WRITER: WRITER's report is complete and well-formed, without outside links, the same each time, and
has the counterparts of the paper's tables and figures."""
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
        self.open, self.ids, self.wrong = [], [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        attrs = dict(attrs)
        self.ids += [attrs['id']] if 'id' in attrs else []
        self.wrong += [f'{tag} {name}' for name in attrs if name in ('src', 'href') or name.startswith('on')]
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
    figures = ['figure-14', 'figure-15', 'figure-16', 'figure-6-common', 'figure-6-obs', 'figure-6-obs-shown']
    assert [json.loads(text)['name'] for text in re.findall(r'<script class="chart" type="application/json">(.*?)</script>', page)] == figures
    wanted = [f'table-{i}' for i in range(1, 6)] + ['obs-load', 'obs-obb', 'claim-growth']
    assert set(wanted) <= set(checker.ids), set(wanted) - set(checker.ids)
    markup = re.sub(r'<(style|script).*?</\1>', ' ', page, flags=re.S)
    assert not re.search(r'\{\{|\}\}', markup) and not re.search(r'url\(|@import|fetch|https?://(?!www.w3.org/2000/svg)', page), 'a slot was left, or something is loaded'
    bare = re.sub(r'<[^>]*>', ' ', markup)
    assert not re.search(r'\bnan\b|\binf\b', bare), 'a figure is printed raw'
    assert 'made &lt;up&gt; &amp; &quot;checked&quot;' in page and 'signal&quot; &lt;9&gt;' in page

    tables = first['tables.md'].decode()
    assert tables.count('\n## ') == 7 and len(re.findall(r'\| 15 +\|', tables)) == 7 and '**does not hold**' in tables
    # the paper's fourth experiment, beside ours
    assert re.search(r'\| 4 +\| +10 \| +(1|1\.01|1\.0|0\.99\d?) \| +240 \|', tables), 'table 1 is not the paper\'s'


main()
