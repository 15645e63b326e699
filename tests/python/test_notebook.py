#!/usr/bin/env python3
"""The notebook examples/sliding.ipynb: its cells run one after another, without Jupyter, and end at the closed form.

test_notebook.py            runs it in a folder of its own. Exit 77 (skipped) without NumPy or Matplotlib
test_notebook.py write      and puts its pictures into docs/images
"""
import json
import os
import pathlib
import shutil
import sys
import tempfile

try:
    import matplotlib
    import numpy # pylint: disable=unused-import
except ImportError as e:
    print(e)
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ['sliding.svg', 'dragged.png']


def main():
    matplotlib.use('agg')
    with open(ROOT / 'examples/sliding.ipynb', encoding='utf-8') as f:
        cells = json.load(f)['cells']
    names = {}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for i, cell in enumerate(cells):
            if cell['cell_type'] == 'code':
                exec(compile(''.join(cell['source']), f'cell {i}', 'exec'), names) # pylint: disable=exec-used
        assert names['worst'] < .01, names['worst']
        for name in PICTURES:
            assert os.path.getsize(name) > 1000, name
            assert (ROOT / 'docs/images' / name).is_file() or 'write' in sys.argv, f'docs/images/{name} is missing'
            if 'write' in sys.argv:
                shutil.copy(name, ROOT / 'docs/images' / name)
        os.chdir(ROOT)


main()
