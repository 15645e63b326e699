"""Prints "passed failed skipped" of one meson test run: its testlog.json, one object a line."""
import json
import sys

PASSED = {'OK', 'EXPECTEDFAIL'}
SKIPPED = {'SKIP', 'IGNORED'}

with open(sys.argv[1], encoding='utf-8') as log:
    results = [json.loads(line)['result'] for line in log if line.strip()]
passed = sum(r in PASSED for r in results)
skipped = sum(r in SKIPPED for r in results)
print(passed, len(results) - passed - skipped, skipped)
