#!/usr/bin/env python3
"""Counts sentences of comments and documents that open with a word which makes readers search for the subject, and long
sentences of documents. Prints a line for each folder above its ceiling; exit 1 if there is any.

sentences.py ROOT [-v] [FOLDER...]    checks ROOT, or only the folders named; -v: lists all folders and sentences
First it plants violations in a tree of its own, and fails if it does not see each of them.
"""
import ast
import io
import pathlib
import re
import sys
import tempfile
import tokenize

OPENERS = re.compile(r'(of|what|who|whoever|whose|where|whether|which|how|that|to whom)\b', re.I)
WORDS = 4  # shorter sentences are not counted
CEILING = 2  # percent of sentences that may open so

# Folders not yet rewritten, and the percentage they may have until they are. It only falls.
CEILINGS = {}

# Documents: the number of words that nine of ten sentences do not exceed, and folders not yet there.
LONG = 25
LONG_CEILINGS = {}

# Folders whose subfolders are counted apart, and the depth of these.
SPLIT = {'src': 3, 'tests': 2, 'docs': 2}
ROOTS = ('src', 'include', 'tests', 'bench', 'examples', 'shaders', 'tools', 'scenes', 'docs')

STRING = r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
C = re.compile(rf'({STRING})|//[^\n]*|/\*.*?\*/', re.S)
JS = re.compile(rf'({STRING}|`(?:\\.|[^`\\])*`)|//[^\n]*|/\*.*?\*/', re.S)
LUA = re.compile(rf'({STRING})|--\[\[.*?\]\]|--[^\n]*', re.S)
HASH = re.compile(rf"('''.*?'''|{STRING}|\$#|\$\{{#|\w#)|#[^\n]*", re.S)  # meson, shell
HTML = re.compile(r'((?!))|<!--.*?-->', re.S)
SYNTAX = {'.c': C, '.h': C, '.cpp': C, '.in': C, '.glsl': C, '.vert': C, '.frag': C, '.css': C, '.js': JS, '.lua': LUA,
          '.build': HASH, '.sh': HASH, '.html': HTML}


def marked(text, syntax):
    """(line, text, has code before it) of each comment that a pattern finds."""
    for match in syntax.finditer(text):
        if match.group(1) is None:
            before = text[text.rfind('\n', 0, match.start()) + 1:match.start()]
            yield text.count('\n', 0, match.start()) + 1, match.group(), bool(before.strip())


def python_comments(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string, bool(token.line[:token.start[1]].strip())
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
            constant = node.body[0].value
            yield constant.lineno, '/*' + constant.value + '*/', False


def blocks(comments):
    """Joins line comments that continue the line above. A block: its lines, as (line, text)."""
    block = []
    for line, text, behind_code in sorted(comments):
        if text.startswith('#!'):
            continue
        one_line = re.match(r'//|--(?!\[\[)|#', text)
        if block and (behind_code or not one_line or line != block[-1][0] + 1):
            yield block
            block = []
        plain = re.sub(r'^\s*(//+[!<]?|--\[\[|--|#+|/\*+<?|<!--|\*(?!/))|\*+/$|-->$|\]\]$', '', text, flags=re.M)
        block += list(enumerate(plain.split('\n'), line))
        if not one_line:
            yield block
            block = []
    if block:
        yield block


def paragraphs(text):
    """Blocks of a Markdown document: paragraphs and items, without code, tables and addresses."""
    block, fenced = [], False
    text = re.sub(r'<!--.*?-->', lambda m: '\n' * m.group().count('\n'), text, flags=re.S)
    text = re.sub(r'!?\[([^\]]*)\]\([^)]*\)', lambda m: m.group(1) + '\n' * m.group()[len(m.group(1)):].count('\n'), text)
    for number, line in enumerate(text.split('\n'), 1):
        fenced ^= line.startswith('```')
        item = re.match(r'\s*([-*+]|\d+\.|#+|>)\s+', line)
        code = fenced or line.startswith('```') or line.lstrip().startswith('|') or re.match(r'(    |\t)', line) and not block
        if item or code or not line.strip():
            if block:
                yield block
            block = []
        if line.strip() and not code:
            block.append((number, line[item.end():] if item else line))
            if line.startswith('#'):
                yield block
                block = []
    if block:
        yield block


def sentences(block, ends):
    """(line, words) of each sentence of a block; ends: the marks that end one."""
    words, start = [], None
    for number, line in block:
        for word in line.split():
            if re.search(r'\w', word):
                start = start or number
                words.append(word)
            if re.search(rf'[{ends}][)"\'`*_]*$', word) and words:
                yield start, words
                words, start = [], None
    if words:
        yield start, words


def open_badly(words):
    return OPENERS.match(re.sub(r'^[^\w`]+', '', ' '.join(words[:3])))


def read(path):
    try:
        return path.read_text(encoding='utf-8')
    except (UnicodeDecodeError, OSError):
        return ''


def blocks_of(path):
    text = read(path)
    script = text.startswith('#!') and text.split('\n')[0]
    if path.suffix == '.md':
        return paragraphs(text)
    if path.suffix == '.py' or script and 'python' in script:
        return blocks(python_comments(text))
    syntax = SYNTAX.get(path.suffix) or (script or path.suffix == '') and HASH
    return blocks(marked(text, syntax)) if syntax else ()


def folder_of(name):
    parts = name.split('/')
    depth = SPLIT.get(parts[0], 1)
    return 'README.md' if len(parts) == 1 else '/'.join(parts[:depth]) if len(parts) > depth else parts[0]


class Folder:
    def __init__(self):
        self.count, self.bad, self.lengths, self.long = 0, [], [], []

    def share(self):
        return 100 * len(self.bad) / self.count if self.count else 0

    def p90(self):
        return sorted(self.lengths)[(9 * len(self.lengths) + 9) // 10 - 1] if self.lengths else 0


def measure(root):
    """The sentences of each folder: {folder: Folder}."""
    folders = {}
    paths = [path for top in ROOTS for path in sorted(root.glob(top + '/**/*'))] + [root / 'README.md']
    for path in paths:
        if not path.is_file():
            continue
        name = path.relative_to(root).as_posix()
        folder = folders.setdefault(folder_of(name), Folder())
        for block in blocks_of(path):
            for line, words in sentences(block, '.;:'):
                if len(words) >= WORDS:
                    folder.count += 1
                    if open_badly(words):
                        folder.bad.append(f'{name}:{line}: {" ".join(words[:14])}')
            for line, words in sentences(block, '.!?:') if path.suffix == '.md' else ():
                folder.lengths.append(len(words))
                if len(words) > LONG:
                    folder.long.append(f'{name}:{line}: {len(words)} words: {" ".join(words[:8])}')
    return folders


def above(name, folder):
    """Reasons for which a folder is above its ceilings: a list of texts."""
    found = []
    ceiling = CEILINGS.get(name, CEILING)
    if folder.share() > ceiling:
        found.append(f'{name}: {len(folder.bad)} of {folder.count} sentences open badly: {folder.share():.1f} %, {ceiling} % at most')
    ceiling = LONG_CEILINGS.get(name, LONG)
    if folder.p90() > ceiling:
        found.append(f'{name}: nine of ten sentences have up to {folder.p90()} words, {ceiling} at most')
    return found


# A file, its number of sentences, and the lines of those that open badly.
PLANTED = [
    ('src/a/a.c', '// Whose turn it is to move. Moves it now, at once.\nint a; // of what there is one\n', 3, [1, 2]),
    ('src/b/b.h', '/* Returns the sum of all;\n * That of the next one. */\n', 2, [2]),
    ('src/c/c.cpp', '// Continues on the line\n// where it has begun.\n// Which one it is now\n', 2, [3]),
    ('src/d/d.c', 'char *s = "// what is in a string"; /* To whom it is sent */\n', 1, [1]),
    ('src/e/e.js', 'let a = `// what is no comment`; // how fast it turns\n', 1, [1]),
    ('src/f/f.c', '// one: Whoever comes first takes it\nint a; // takes part\n      // where it can do so\n', 2, [1]),
    ('tests/a/a.py', '"""Who does it, and when."""\nx = "# what is in a string"  # whether it is set\n', 2, [1, 2]),
    ('tests/b/meson.build', "a = '# what is in a string' # where it is built\n", 1, [1]),
    ('tools/a', '#!/bin/sh\n# What is installed here first\necho $# what is no comment\n', 1, [2]),
    ('scenes/a.lua', '-- Which one of them falls\n--[[ That one falls first ]]\n', 2, [1, 2]),
    ('shaders/a.vert', '// (of the light, in metres)\n// Whatever comes is drawn here. Thatched roofs are not drawn.\n', 2, [1]),
    ('docs/a/a.md', '# How to build it all\n\nOf all of them,\nthis is one. `whose` is a word here.\n\n```\nwhat is in code\n```\n'
     '- [Where](x.md) it is written\n- Which of them it is\n\n| That is in tables | a |\n', 5, [1, 3, 9, 10]),
]


def prove():
    """Planted lines that this script judges wrongly."""
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, text, count, lines) in enumerate(PLANTED):
            root = pathlib.Path(folder) / str(number)
            (root / name).parent.mkdir(parents=True)
            (root / name).write_text(text, encoding='utf-8')
            (seen,) = measure(root).values()
            if seen.count != count or [int(line.split(':')[1]) for line in seen.bad] != lines:
                wrong.append(f'{name}: {seen.count} sentences, bad: {seen.bad}')
        root = pathlib.Path(folder) / 'docs'
        (root / 'docs/new').mkdir(parents=True)
        (root / 'docs/new/a.md').write_text(9 * 'One is short. ' + 'word ' * (LONG + 1) + '.\n', encoding='utf-8')
        wrong += above('docs/new', measure(root)['docs/new'])
        (root / 'docs/new/a.md').write_text(8 * 'One is short. ' + 2 * ('word ' * (LONG + 1) + '.\n'), encoding='utf-8')
        if len(above('docs/new', measure(root)['docs/new'])) != 1:
            wrong.append('long sentences are not seen')
    sample = Folder()
    sample.count, sample.bad = 100, ['a'] * (CEILING + 1)
    if not above('src/new', sample):
        wrong.append('a folder above its ceiling is not seen')
    return wrong


def main():
    verbose = '-v' in sys.argv[1:]
    arguments = [a for a in sys.argv[1:] if a != '-v']
    if not arguments or not (pathlib.Path(arguments[0]) / 'src').is_dir():
        sys.exit('usage: sentences.py ROOT [-v] [FOLDER...], ROOT: the folder that holds src/')
    wrong = prove()
    for place in wrong:
        print(f'sentences.py itself judges wrongly: {place}')
    folders, found = measure(pathlib.Path(arguments[0])), []
    for name, folder in sorted(folders.items()):
        if arguments[1:] and name not in arguments[1:]:
            continue
        if verbose:
            print(*folder.bad, *folder.long, sep='\n')
            print(f'{name}: {len(folder.bad)} of {folder.count}, {folder.share():.1f} %' +
                  (f', {folder.p90()} words at p90' if folder.lengths else ''))
        found += above(name, folder)
    print(*found, f'{len(found)} folders above their ceiling', sep='\n')
    sys.exit(1 if wrong or found else 0)


main()
