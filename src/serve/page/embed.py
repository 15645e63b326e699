#!/usr/bin/env python3
"""Writes the content that the server hands out as C arrays and one table: embed.py OUTPUT EXPAND.py PATH=FILE...

A shader's includes are put in by EXPAND.py, as for the renderer. The hash of a content's bytes is its entity tag.
Beside them stands all.js, which is main.js with all modules that it imports, for a page that is one file.
"""
import hashlib
import importlib.util
import pathlib
import re
import sys

TYPES = {'.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
         '.svg': 'image/svg+xml', '.vert': 'text/plain; charset=utf-8', '.frag': 'text/plain; charset=utf-8'}


IMPORT = re.compile(r"^import \{([^}]*)\} from '\./([\w.]+)';\n", re.M)


def one_script(modules):
    """main.js and what it imports: each module a function that returns what others import from it."""
    wanted, order = {}, []
    for text in modules.values():
        for names, source in IMPORT.findall(text):
            wanted.setdefault(source, set()).update(n.split(' as ')[0].strip() for n in names.split(',') if n.strip())

    def visit(name):
        if name not in order:
            for _, source in IMPORT.findall(modules[name]):
                visit(source)
            order.append(name)
    visit('main.js')

    variable = lambda name: 'module_' + name.removesuffix('.js')
    out = []
    for name in order:
        body = IMPORT.sub(lambda m: f'const {{{m[1].replace(" as ", ": ")}}} = {variable(m[2])};\n', modules[name])
        body = re.sub(r'^export (?=(async|class|const|function|let)\b)', '', body, flags=re.M)
        if wrong := re.search(r'^\s*(import|export)\b.*', body, re.M):
            sys.exit(f'{name}: embed.py does not know how to put this into one script: {wrong[0]}')
        out.append(f'const {variable(name)} = (() => {{\n{body}return {{ {", ".join(sorted(wanted.get(name, ())))} }};\n}})();\n')
    return ''.join(out)


def main(output, expander, *contents):
    spec = importlib.util.spec_from_file_location('expander', expander)
    shaders = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(shaders)
    files = {}
    for content in contents:
        path, file = content.split('=', 1)
        file = pathlib.Path(file)
        files[path] = shaders.expand(file).encode() if file.suffix in ('.vert', '.frag') else file.read_bytes()
    files['all.js'] = one_script({p[1:]: d.decode() for p, d in files.items() if p.endswith('.js')}).encode()
    arrays, table = [], []
    for number, (path, data) in enumerate(files.items()):
        if re.search(rb'</(script|style)', data, re.I) and not path.endswith('.html'):
            sys.exit(f'{path}: this would end the element that holds it in a page')
        arrays.append(f'static const unsigned char content_{number}[] = {{{",".join(map(str, data))}}};\n')
        tag = hashlib.sha256(data).hexdigest()[:32]
        table.append(f'\t{{ "{path}", "{TYPES[pathlib.Path(path).suffix]}", "\\"{tag}\\"", content_{number}, {len(data)}, false }},\n')
    text = ''.join(arrays) + 'static const ob_content contents[] = {\n' + ''.join(table) + '};\n'
    pathlib.Path(output).write_text(text, encoding='utf-8')


if __name__ == '__main__':
    main(*sys.argv[1:])
