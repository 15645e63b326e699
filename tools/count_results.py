"""count_results.py FOLDER: sums up runs of meson test, whose testlog.json (one object a line) lie in the folder by the
names 1-BUILD.json, 2-BUILD.json .., with what meson printed in 1-BUILD.log ..: the slowest tests, those that failed with the
end of what they printed, and "N passed, N failed"; exit status 1 if any failed. A run that has no testlog.json, as its build
failed, counts as a failed test.
"""
import json
import pathlib
import sys

PASSED = {'OK', 'EXPECTEDFAIL'}
SKIPPED = {'SKIP', 'IGNORED'}
LINES = 40  # kept of the output of a failed test: its summary and the checks before
SLOWEST = 20


def main():
    tests, failures = [], []
    for log in sorted(pathlib.Path(sys.argv[1]).glob('*.log'), key=lambda path: int(path.name.split('-')[0])):
        build, results = log.stem.split('-', 1)[1], log.with_suffix('.json')
        run = [json.loads(line) for line in results.read_text(encoding='utf-8').splitlines()] if results.exists() else []
        tests += [(test['duration'], build, test) for test in run]
        for test in run:
            if test['result'] not in PASSED | SKIPPED:
                failures.append((f"{build}: {test['name']}: {test['result']}, exit {test['returncode']}, {test['duration']:.1f} s",
                                 test.get('stdout', '') + test.get('stderr', '')))
        if not run:
            failures.append((f'{build}: no test ran', log.read_text(encoding='utf-8', errors='replace')))
    skipped = sum(test['result'] in SKIPPED for _, _, test in tests)
    ended = sum(test['result'] in PASSED for _, _, test in tests)

    print('slowest:')
    for seconds, build, test in sorted(tests, key=lambda t: -t[0])[:SLOWEST]:
        print(f"{seconds:8.1f} s  {build:14} {test['name']}")
    for name, printed in failures:
        print(f'\nFAILED: {name}')
        print('\n'.join(printed.splitlines()[-LINES:]))
    print(f'\n{ended} passed, {len(failures)} failed' + (f', {skipped} skipped' if skipped else ''))
    sys.exit(bool(failures) or not ended)


main()
