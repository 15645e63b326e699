#!/usr/bin/env python3
"""Writes text files as C byte arrays PREFIX_NAME: embed.py OUTPUT PREFIX FILE...; lines #include "x.glsl" are replaced
by that file."""
import pathlib
import re
import sys


def expand(path):
    text = []
    for line in path.read_text(encoding='utf-8').splitlines():
        include = re.fullmatch(r'#include "([\w.]+)"', line)
        text.append(expand(path.parent / include[1]) if include else line)
    return '\n'.join(text) + '\n'


def array(prefix, path):
    name = f'{prefix}_' + path.name.replace('.', '_')
    data = ','.join(str(byte) for byte in expand(path).encode() + b'\0')
    return f'static const char {name}[] = {{{data}}};\n'


if __name__ == '__main__':
    output, prefix, *sources = sys.argv[1:]
    text = ''.join(array(prefix, pathlib.Path(source)) for source in sources)
    pathlib.Path(output).write_text(text, encoding='utf-8')
