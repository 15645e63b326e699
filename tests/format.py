#!/usr/bin/env python3
"""format.py ROOT: every file of C and C++ is as clang-format writes it. To format one: clang-format -i FILE."""
import pathlib
import shutil
import subprocess
import sys

if not shutil.which('clang-format'):
    sys.exit(77)  # skipped
root = pathlib.Path(sys.argv[1])
files = [str(path.relative_to(root)) for folder in ('bench', 'examples', 'include', 'src', 'tests')
         for path in sorted((root / folder).rglob('*')) if path.suffix in ('.c', '.cpp', '.h')]
sys.exit(subprocess.run(['clang-format', '--dry-run', '-Werror', *files], cwd=root).returncode)
