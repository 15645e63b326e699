#!/usr/bin/env python3
"""lint.py ROOT BUILD quick|deep: clang-tidy (.clang-tidy) finds nothing in the C files of this build. quick: all files, but
without clang's analyzer, which takes twenty times as long; deep: files of src, with it. Prints findings."""
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys


def main():
    root, build = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
    deep = sys.argv[3] == 'deep'
    if not shutil.which('clang-tidy'):
        return 77  # skipped
    commands = json.loads((build / 'compile_commands.json').read_text(encoding='utf-8'))
    files = {pathlib.Path(c['directory'], c['file']).resolve() for c in commands}
    files = sorted(path for path in files if path.suffix == '.c' and build not in path.parents and
                   (not deep or root / 'src' in path.parents))
    checks = [] if deep else ['--checks=-clang-analyzer-*']

    def lint(path):
        return subprocess.run(['clang-tidy', '--quiet', *checks, '-p', build, path], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, check=False)

    wrong = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for done in pool.map(lint, files):
            if done.returncode:
                wrong += 1
                print(done.stdout or done.stderr)
    print(f'{wrong} of {len(files)} files with findings')
    return bool(wrong)


sys.exit(main())
