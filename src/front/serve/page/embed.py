#!/usr/bin/env python3
"""Writes the content that the server hands out as C arrays and one table: embed.py OUTPUT EXPAND.py PATH=FILE...

Each page has one script, with all modules that it imports: a browser fetches one after the other, and a page may be one file.
Shaders are the module shaders.js. Their includes are put in by EXPAND.py, as for the renderer. The hash of a content's bytes is
its entity tag.
"""
import hashlib
import importlib.util
import json
import pathlib
import re
import sys

TYPES = {'.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
         '.svg': 'image/svg+xml'}
PAGES = 'main.js', 'compare.js'  # their scripts


IMPORT = re.compile(r"^import \{([^}]*)\} from '\./([\w.]+)';\n", re.M)


def one_script(first, modules):
    """A module and what it imports: each a function that returns what others import from it."""
    wanted, order = {}, []

    def visit(name):
        if name not in order:
            for names, source in IMPORT.findall(modules[name]):
                wanted.setdefault(source, set()).update(n.split(' as ')[0].strip() for n in names.split(',') if n.strip())
                visit(source)
            order.append(name)
    visit(first)

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
    files, modules, sources = {}, {}, {}
    for content in contents:
        path, file = content.split('=', 1)
        file = pathlib.Path(file)
        if file.suffix == '.js':
            modules[file.name] = file.read_text(encoding='utf-8')
        elif file.suffix in ('.vert', '.frag'):
            sources[file.name] = shaders.expand(file)
        else:
            files[path] = file.read_bytes()
    modules['shaders.js'] = f'export const SHADERS = {json.dumps(sources)};\n'
    for page in PAGES:
        files['/' + page] = one_script(page, modules).encode()
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
