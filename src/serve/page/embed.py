#!/usr/bin/env python3
"""Writes the content that the server hands out as C arrays and one table: embed.py OUTPUT EXPAND.py PATH=FILE...

A shader's includes are put in by EXPAND.py, as for the renderer. The hash of a content's bytes is its entity tag.
"""
import hashlib
import importlib.util
import pathlib
import sys

TYPES = {'.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
         '.svg': 'image/svg+xml', '.vert': 'text/plain; charset=utf-8', '.frag': 'text/plain; charset=utf-8'}


def main(output, expander, *contents):
    spec = importlib.util.spec_from_file_location('expander', expander)
    shaders = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(shaders)
    arrays, table = [], []
    for number, content in enumerate(contents):
        path, file = content.split('=', 1)
        file = pathlib.Path(file)
        shader = file.suffix in ('.vert', '.frag')
        data = shaders.expand(file).encode() if shader else file.read_bytes()
        arrays.append(f'static const unsigned char content_{number}[] = {{{",".join(map(str, data))}}};\n')
        tag = hashlib.sha256(data).hexdigest()[:32]
        table.append(f'\t{{ "{path}", "{TYPES[file.suffix]}", "\\"{tag}\\"", content_{number}, {len(data)} }},\n')
    text = ''.join(arrays) + 'static const ob_content contents[] = {\n' + ''.join(table) + '};\n'
    pathlib.Path(output).write_text(text, encoding='utf-8')


if __name__ == '__main__':
    main(*sys.argv[1:])
