#!/usr/bin/env python3
"""fused.py BUILD: fails if the compiler, with a processor that has fused multiply-adds, generates any that the source
does not request: bits would then depend on the build of obsim. It reads the assembler text of the code that plans a
body's turn; an fma() of the source becomes another instruction than those searched.
"""
import json
import os
import platform
import re
import shlex
import subprocess
import sys

NOT_OURS = re.compile(r'vfmaddsub\w+|vfmsubadd\w+')


def main():
    if platform.machine() != 'x86_64':
        return 77 # skipped
    with open(os.path.join(sys.argv[1], 'compile_commands.json'), encoding='utf-8') as f:
        command, = (shlex.split(c['command']) for c in json.load(f) if c['file'].endswith('src/universe/motion/spin.c'))
    for processor in 'x86-64-v3', 'x86-64-v4':
        done = subprocess.run([*command[:command.index('-o')], '-fno-lto', f'-march={processor}', '-S', '-o', '-', command[-1]], cwd=sys.argv[1],
                              stdout=subprocess.PIPE, text=True, check=True)
        found = sorted(set(NOT_OURS.findall(done.stdout)))
        if found or 'vfmadd' not in done.stdout:
            print(f'{processor}: {", ".join(found) or "no fused operation at all: nothing was looked at"}')
            return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())
