#!/usr/bin/env python3
"""Writes shader files as C byte arrays: embed.py OUTPUT FILE...; lines #include "x.glsl" are replaced by that file."""
import pathlib
import re
import sys


def expand(path):
    text = []
    for line in path.read_text(encoding='utf-8').splitlines():
        include = re.fullmatch(r'#include "([\w.]+)"', line)
        text.append(expand(path.parent / include[1]) if include else line)
    return '\n'.join(text) + '\n'


def array(path):
    name = 'shader_' + path.name.replace('.', '_')
    data = ','.join(str(byte) for byte in expand(path).encode() + b'\0')
    return f'static const char {name}[] = {{{data}}};\n'


if __name__ == '__main__':
    output, *sources = map(pathlib.Path, sys.argv[1:])
    output.write_text(''.join(array(source) for source in sources), encoding='utf-8')
