"""Prints "passed failed skipped" of one meson test run (its testlog.json, one object a line), then each test that failed
with the end of what it printed."""
import json
import sys

PASSED = {'OK', 'EXPECTEDFAIL'}
SKIPPED = {'SKIP', 'IGNORED'}
LINES = 40  # of what a failed test printed: its summary and the checks before

with open(sys.argv[1], encoding='utf-8') as log:
    tests = [json.loads(line) for line in log if line.strip()]
failed = [t for t in tests if t['result'] not in PASSED | SKIPPED]
skipped = sum(t['result'] in SKIPPED for t in tests)
print(len(tests) - len(failed) - skipped, len(failed), skipped)
for test in failed:
    print(f"\nFAILED: {test['name']}: {test['result']}, exit {test['returncode']}, {test['duration']:.1f} s")
    printed = (test.get('stdout', '') + test.get('stderr', '')).splitlines()
    print('\n'.join(printed[-LINES:]))
