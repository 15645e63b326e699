#!/usr/bin/env python3
"""Counts what the laws of contact and joints take: the lines of code of src/physics/contact and src/physics/solver together,
their named constants, and branches on the population of an island. Prints them beside those of a former commit; exit 1 if a
number is above its ceiling, which may only fall.

laws.py ROOT    counts in ROOT/src
First it counts a text of its own, and fails if a number is off.
"""
import pathlib
import re
import sys

from borders import without_comments

FOLDERS = ['src/physics/contact', 'src/physics/solver']
FORMER = '09c4338a'
# Lines of code, constants, branches. Both trees have the format of .clang-format, so that a line is a line.
THEN = [15926, 224, 59]
CEILING = [15981, 221, 60]

CONSTANT = re.compile(r'(?:static )?const (?:double|int|uint32_t) ([^;]*);')
# A number by which nothing but a number of the text follows: "x = 1e-3", not "x = 1 / y", which is arithmetic.
NUMBER = re.compile(r'\w+ = -?(?:(?:\d+\.?\d*|\.\d+)(?:e-?\d+)?|UINT32_C\(\w+\))(?: / \d+\.?| - \d+e-\d+)?$')
# Comparisons of a number of bodies or members with one of the text, and properties that tell if others are there.
POPULATION = re.compile(
    r'\b(?:bodies|members)\s*(?:==|!=|<=|>=|<|>)\s*(?:\d+|[A-Z]\w+|most->bodies)\b'
    r'|(?<!bool )(?<!unsigned )(?<!uint32_t )\b(?:among_others|in_reach|isolated|moves_alone|few_touch)\b(?!\s*(?:=[^=]|\|=|&=))'
    r'|(?:&&|\|\||!|\bif \(|\? |\()\s*(?:\w+(?:->|\.))*joints(?:\.count)?\s*(?:&&|\|\||\)|\?|==|> 0)'
    r'|(?<!bool )\bob_flies_with_joints\b')


def code_of(text):
    return [line for line in without_comments(text).split('\n') if line.strip()]


def constants_of(code):
    """Names of constants: a number of the text each. Those of one declaration count one by one."""
    found = []
    for declaration in CONSTANT.findall('\n'.join(code)):
        found += [part.split()[0] for part in re.split(r',\s*(?![^()]*\))', declaration) if NUMBER.match(' '.join(part.split()))]
    return found


def branches_of(code):
    """Lines that branch on a population. Loops over all bodies are none."""
    return [line.strip() for line in code if not re.match(r'\s*for \(', line) and POPULATION.search(line)]


def count(files):
    sums = [0, 0, 0]
    for path in files:
        code = code_of(path.read_text(encoding='utf-8'))
        for i, found in enumerate((code, constants_of(code), branches_of(code))):
            sums[i] += len(found)
    return sums


def try_itself():
    text = '''// static const double commented = 1;
static const double one = 1e-3, two = 1. / 8; /* m */

static bool f(const ob_island_work *w, double x)
{
	const double none = 1 / x;
	for (uint32_t i = 0; w->bodies <= FEW && i < w->bodies; i++)
		if (w->bodies == 1 || w->joints.count)
			return true;
	return w->body[1].among_others;
}
'''
    code = code_of(text)
    return len(code) == 9 and constants_of(code) == ['one', 'two'] and len(branches_of(code)) == 2


def main():
    if len(sys.argv) != 2:
        sys.exit('usage: laws.py ROOT, the folder that holds src/')
    if not try_itself():
        sys.exit('laws.py: counts its own text wrongly')
    root = pathlib.Path(sys.argv[1])
    files = [path for folder in FOLDERS for path in sorted((root / folder).glob('*.[ch]'))]
    if not files:
        sys.exit(f'laws.py: no files in {root}')
    now = count(files)
    failed = False
    for what, then, ceiling, is_now in zip(('lines of code', 'named constants', 'branches on a population'), THEN, CEILING, now):
        print(f'{what:26} {is_now:6,}   {FORMER}: {then:6,}   {is_now / then:.3f}   at most {ceiling:,}')
        if is_now > ceiling:
            print(f'{what}: {is_now - ceiling} more than tests/laws.py allows')
            failed = True
        elif is_now < ceiling:
            print(f'{what}: tests/laws.py may ask for {is_now} at most now')
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
