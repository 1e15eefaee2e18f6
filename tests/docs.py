#!/usr/bin/env python3
"""
docs.py SOURCE RHEOLOG [NAME=PROGRAM...] [PAGE...] [--write]

Gives every command in README.md and docs/*.md, in order and in a folder of its own for each page, and compares exit codes
and outputs with what the page says. PAGE is a page to test, as docs/faults.md; all without it. PROGRAM is the build with the
fault NAME of docs/faults.md (plant.sh); there `./rheolog` is the build with the fault of the section. With --write, outputs on
the pages that are no longer right are replaced by whole ones, to shorten by hand.

A block ```sh holds commands. In a block ```console a command stands behind "$ ", and its output follows it: its words must be
the same, where "..." stands for any words. Lines behind a prompt like "(ball 12) " are given to `rheolog debug`. A block of
another language becomes the file that the line before it names, if that line ends like "`scene.json`:". `replays` and `tests`
of the checkout are in the folder.

These comments say what is special about the block that follows them. One that has no effect is an error.

    <!-- not run: REASON -->              the block is not run; if REASON names a script in tests/ or docs/, that must name the page
    <!-- needs: PROGRAM -->               the block is run only if there is such a program
    <!-- exit code 1: COMMAND -->         commands that begin like this have this exit code; all of the block without ": COMMAND"
    <!-- in the test, OLD is NEW -->      a shorter run; at the head of a page, before any block, for the whole page
    <!-- first: COMMAND -->               given before the block
    <!-- file: NAME -->                   the block is not run, but becomes a file

    <!-- run by tests/NAME.sh: LANGUAGE -->   anywhere: this script gives all commands of the page in blocks of this language
"""
import concurrent.futures
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

MARKER = re.compile(r'<!-- (not run: |needs: |exit code |in the test, |first: |file: |run by )(.*) -->$')
PROMPT = re.compile(r'\(\w+ \d+.*?\) (.*)')
# Builds are named only if they differ, progress is shown only on a slow machine, and the compiler is anyone's.
VARYING = re.compile(r'; builds: .*\(this build\)$|^.*\bstep \d+ of \d+(, .* left)?\n', re.M)
BUILD = re.compile(r'rheolog [\d.]+, .*, (float|double), \w+')
COMMAND = re.compile(r'(\$ |build/)?(rheolog|meson|ninja|bench/\S+|tests/\S+|sh) \w')
FEWEST_FAULTS, MOST_COMMANDS = 12, 3 # of docs/faults.md; commands in the median


def slug(title):
    return re.sub(r'[^\w-]', '', title.strip().lower().replace(' ', '-'))


def same_words(expected, actual):
    """Whether the words of two texts are the same; "..." stands for any words."""
    want, have = (BUILD.sub('build', text).split() for text in (expected, actual))
    w, h, star, again = 0, 0, None, 0
    while h < len(have):
        if w < len(want) and want[w] == '...':
            star, w, again = w, w + 1, h
        elif w < len(want) and want[w] == have[h]:
            w, h = w + 1, h + 1
        elif star is not None:
            w, again = star + 1, again + 1
            h = again
        else:
            return False
    return all(word == '...' for word in want[w:])


def is_whole(text):
    """Whether a shell can run the text, or needs further lines."""
    if text.endswith('\\'):
        return False
    return subprocess.run(['sh', '-n', '-c', text], stderr=subprocess.DEVNULL, check=False).returncode == 0


class Page:
    """A page, its folder, and what is wrong with it."""

    def __init__(self, source, name, rheolog, faulty, write):
        self.source, self.name, self.faulty, self.write = source, name, faulty, write
        self.wrong, self.commands, self.not_run, self.seconds = [], 0, [], 0
        self.folder = tempfile.mkdtemp()
        self.work = os.path.join(self.folder, 'work')
        os.makedirs(os.path.join(self.folder, 'bin'))
        os.mkdir(self.work)
        os.symlink(rheolog, os.path.join(self.folder, 'bin/rheolog'))
        for name in 'replays', 'tests':
            os.symlink(os.path.join(source, name), os.path.join(self.work, name))
        self.environment = dict(os.environ, PATH=os.path.join(self.folder, 'bin') + ':' + os.environ['PATH'],
                                HOME=self.folder, XDG_CACHE_HOME=self.folder) # where engines of sweeps keep files

    def complain(self, line, text):
        self.wrong.append(f'{self.name}:{line}: {text}')

    def test(self):
        start = time.time()
        path = os.path.join(self.source, self.name)
        with open(path, encoding='utf-8') as f:
            self.lines = f.read().split('\n')
        self.elsewhere, self.everywhere = self.run_by(), []
        self.out = []
        self.give()
        for old, _, used, line in self.everywhere:
            if not used:
                self.complain(line, f'no command has "{old}"')
        if self.write and self.out != self.lines:
            with open(path, 'w', encoding='utf-8') as f:
                f.write('\n'.join(self.out))
        shutil.rmtree(self.folder)
        self.seconds = time.time() - start
        return self

    def script(self, line, name):
        """Whether a script of the checkout names this page."""
        path = os.path.join(self.source, name)
        if not os.path.exists(path):
            self.complain(line, f'there is no {name}')
            return
        with open(path, encoding='utf-8') as f:
            if os.path.basename(self.name) not in f.read():
                self.complain(line, f'{name} does not name this page')

    def run_by(self):
        languages = {}
        for number, line in enumerate(self.lines, 1):
            marker = MARKER.match(line)
            if marker and marker[1] == 'run by ':
                script, _, language = marker[2].partition(': ')
                self.script(number, script)
                languages[language] = script
                if '```' + language not in self.lines:
                    self.complain(number, f'the page has no block {language}')
        return languages

    def give(self):
        before, markers, section, at, blocks = '', [], '', 0, 0
        while at < len(self.lines):
            line = self.lines[at]
            at += 1
            self.out.append(line)
            if line.startswith('```'):
                end = self.lines.index('```', at)
                blocks += 1
                self.block(line[3:], at + 1, self.lines[at:end], markers, before)
                self.out.append('```')
                at, markers = end + 1, []
                continue
            marker = MARKER.match(line)
            if marker and marker[1] == 'in the test, ' and blocks == 0 and self.is_alone(at):
                self.everywhere.append(self.replacement(at, marker[2]))
            elif marker and marker[1] != 'run by ':
                markers.append((marker[1].rstrip(': ,'), marker[2], at))
            elif line:
                if line.startswith('    ') and COMMAND.match(line.strip()):
                    self.complain(at, 'a command in a block that is neither sh nor console')
                before = line
                for kind, text, number in markers:
                    self.complain(number, f'no block follows "{kind}: {text}"')
                markers = []
            if line.startswith('### '):
                section = slug(line[4:])
                link = os.path.join(self.work, 'rheolog')
                if os.path.lexists(link):
                    os.remove(link)
                if section in self.faulty:
                    os.symlink(self.faulty[section], link)
        for kind, text, number in markers:
            self.complain(number, f'no block follows "{kind}: {text}"')

    def is_alone(self, at):
        """Whether an empty line follows these comments."""
        while MARKER.match(self.lines[at]):
            at += 1
        return self.lines[at] == ''

    @staticmethod
    def replacement(line, text):
        old, _, new = text.partition(' is ')
        return [old, new, False, line]

    def block(self, language, line, lines, markers, before):
        named = [text for kind, text, _ in markers if kind == 'file'] or re.findall(r'`([\w./-]+)`:$', before)
        if markers and markers[0][0] == 'file':
            language, markers = 'file', markers[1:]
        if language not in ('sh', 'console'):
            self.out += lines
            for number, text in enumerate(lines, line):
                if not language and COMMAND.match(text):
                    self.complain(number, 'a command in a block that is neither sh nor console')
            for kind, text, number in markers:
                self.complain(number, f'"{kind}: {text}" before a block without commands')
            if named:
                path = os.path.join(self.work, named[0])
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, 'w', encoding='utf-8') as f:
                    f.write('\n'.join(lines) + '\n')
            return
        codes, here = [], []
        for kind, text, number in markers:
            if kind == 'not run':
                for script in re.findall(r'(?:tests|docs)/\w+\.(?:sh|py)', text):
                    self.script(number, script)
                self.not_run.append(f'{self.name}:{line}: {text}')
                self.out += lines
                if len(markers) > 1:
                    self.complain(number, 'a block that is not run has other markers')
                return
            if kind == 'needs' and not shutil.which(text):
                self.not_run.append(f'{self.name}:{line}: there is no {text}')
                self.out += lines
                return
            if kind == 'exit code':
                code, _, command = text.partition(': ')
                codes.append([int(code), command, False, number])
            if kind == 'in the test':
                here.append(self.replacement(number, text))
            if kind == 'first' and self.run(text)[0] != 0:
                self.complain(number, f'fails: {text}\n{self.said}')
        if language in self.elsewhere:
            self.out += lines
            return
        for number, command, expected in self.split(language, line, lines):
            self.one(number, command, expected, codes, self.everywhere + here)
        for code, command, used, number in codes:
            if not used:
                self.complain(number, f'no command of the block is "{command}", with exit code {code}')
        for old, _, used, number in here:
            if not used:
                self.complain(number, f'no command of the block has "{old}"')

    @staticmethod
    def split(language, line, lines):
        """The commands of a block: line, text, expected output or None."""
        found, whole = [], True
        for number, text in enumerate(lines, line):
            is_command = language == 'sh' or text.startswith('$ ') or not whole
            if is_command and whole:
                if text:
                    found.append([number, text[2:] if language == 'console' else text, None if language == 'sh' else []])
            elif is_command:
                found[-1][1] += '\n' + text
            elif found:
                found[-1][2].append(text)
            if is_command and found:
                whole = is_whole(found[-1][1])
        return found

    def run(self, command):
        done = subprocess.run(['sh', '-c', command], cwd=self.work, env=self.environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=900, check=False)
        self.said = VARYING.sub('', done.stdout.decode('utf-8', 'replace'))
        return done.returncode, self.said

    def one(self, line, command, expected, codes, replacements):
        self.commands += 1
        wanted = 0
        for item in codes:
            if command.startswith(item[1]):
                wanted, item[2] = item[0], True
        given = command
        for item in replacements:
            if item[0] in given:
                given, item[2] = given.replace(item[0], item[1]), True
        if expected is not None and command.startswith('rheolog debug'):
            prompts = [match[1] for match in map(PROMPT.match, expected) if match]
            if prompts:
                with open(os.path.join(self.work, 'prompts.txt'), 'w', encoding='utf-8') as f:
                    f.write('\n'.join(prompts) + '\n')
                given += ' -x prompts.txt'
        code, said = self.run(given)
        if code != wanted:
            self.complain(line, f'exit code {code} instead of {wanted}: {given}\n{said}')
        if expected is None:
            self.out += command.split('\n')
            return
        self.out += ('$ ' + command).split('\n')
        right = same_words('\n'.join(expected), said)
        self.out += expected if right or not self.write else said.rstrip('\n').split('\n')
        if not right:
            self.complain(line, f'another output of: {command}\n{said}')


def check_faults(text):
    """The table of docs/faults.md: the number of commands of each fault, and its cause in the output of the last one."""
    rows = re.findall(r'^\| \[.*?\]\(#(.*?)\) \| .*? \| (\d+) \| `(.*)` \|$', text, re.M)
    sections = {slug(part.split('\n')[0]): part for part in text.split('\n### ')[1:]}
    wrong, counts = [], sorted(int(row[1]) for row in rows)
    for name, count, cause in rows:
        commands = re.findall(r'^\$ (?:(?!^\$ |^```).*\n)*', sections.get(name, ''), re.M)
        if len(commands) != int(count):
            wrong.append(f'{name}: {len(commands)} commands, not {count} as in the table')
        if not commands or cause not in ' '.join(commands[-1].split()):
            wrong.append(f'{name}: the last command does not print "{cause}"')
    if len(rows) < FEWEST_FAULTS or {row[0] for row in rows} != set(sections):
        wrong.append(f'there are {len(rows)} faults in the table, and {len(sections)} sections')
    if rows and counts[(len(counts) - 1) // 2] > MOST_COMMANDS:
        wrong.append(f'the median number of commands is more than {MOST_COMMANDS}')
    return ['docs/faults.md: ' + text for text in wrong]


def test_pages(source, names, rheolog, faulty=None, write=False):
    """Two pages at a time."""
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda name: Page(source, name, rheolog, faulty or {}, write).test(), names))


def self_check(rheolog, faults):
    """Proves that everything is noticed that can be wrong with a page, and in the table of docs/faults.md."""
    block = '```{}\n{}\n```\n'
    pages = {
        'exit code 1 instead of 0': block.format('sh', 'true\nfalse'),
        'exit code 0 instead of 1': '<!-- exit code 1 -->\n' + block.format('sh', 'true'),
        'no command of the block is "falsely"': '<!-- exit code 1: falsely -->\n' + block.format('sh', 'true'),
        'another output of: echo a b': block.format('console', '$ echo a b\na c'),
        'another output of: echo a "\n" b': block.format('console', '$ echo a "\n" b\na ... b c'),
        'another output of: echo rheolog': block.format('console', '$ echo rheolog 1.2, gcc, x86\nrheolog 2.3, gcc, x86'),
        'another output of: echo two': block.format('console', '$ echo one\none\n$ echo two\n'),
        'no block follows "not run: because"': '<!-- not run: because -->\ntext\n' + block.format('sh', 'true'),
        'no block follows "needs: sh"': '<!-- needs: sh -->\n',
        'before a block without commands': '<!-- not run: because -->\n' + block.format('json', '{}'),
        'a.sh does not name this page': '<!-- not run: tests/a.sh runs it -->\n' + block.format('sh', 'false'),
        'there is no tests/b.sh': '<!-- run by tests/b.sh: sh -->\n' + block.format('sh', 'false'),
        'has other markers': '<!-- needs: sh -->\n<!-- not run: because -->\n' + block.format('sh', 'false'),
        'the page has no block console': '<!-- run by tests/a.sh: console -->\n' + block.format('sh', 'true'),
        'no command of the block has "x"': '<!-- in the test, x is y -->\n' + block.format('sh', 'true'),
        'no command has "x"': '<!-- in the test, x is y -->\n\n' + block.format('sh', 'true'),
        'fails: false': '<!-- first: false -->\n' + block.format('sh', 'true'),
        'neither sh nor console': block.format('', '$ rheolog scenes'),
        'md:3: a command in a block': 'text\n\n    rheolog scenes\n',
        'bad.json': '`bad.json`:\n' + block.format('json', '{') + block.format('sh', 'rheolog check bad.json'),
    }
    right = [block.format('console', '$ echo rheolog 1.2, gcc, float, x86\nrheolog 2.3, clang 9, optimised, float, arm') +
             '<!-- file: a.txt -->\n' + block.format('sh', 'a b') + '<!-- in the test, z.txt is a.txt -->\n'
             '<!-- exit code 1: false -->\n<!-- first: touch b -->\n' +
             block.format('console', '$ cat z.txt\na\nb\n$ ls b\n...\n$ false'),
             '`b.txt`:\n' + block.format('text', 'b') + block.format('console', '$ cat b.txt\nb') +
             '<!-- needs: no-such-program -->\n' + block.format('sh', 'false') +
             block.format('sh', "echo 'a\nb' |\n  grep -c . >c"),
             '<!-- run by tests/a.sh: sh -->\n' + block.format('sh', 'false')]
    source = tempfile.mkdtemp()
    for folder in 'docs', 'replays', 'tests':
        os.mkdir(os.path.join(source, folder))
    with open(os.path.join(source, 'tests/a.sh'), 'w', encoding='utf-8') as f:
        f.write('right2.md\n')
    names = {}
    for number, text in enumerate(list(pages.values()) + right):
        name = f'docs/wrong{number}.md' if number < len(pages) else f'docs/right{number - len(pages)}.md'
        names[name] = list(pages)[number] if number < len(pages) else None
        with open(os.path.join(source, name), 'w', encoding='utf-8') as f:
            f.write(text)
    failures = []
    for page in test_pages(source, names, rheolog):
        expected = names[page.name]
        if expected is None and page.wrong or expected and not any(expected in text for text in page.wrong):
            failures.append(f'docs.py does not notice "{expected}", but {page.wrong}')
    shutil.rmtree(source)
    for pattern, replacement in (r'(\(#turned-normal\) .*\|) 1 \|', r'\1 2 |'), (r'(\(#turned-normal\) .*)wall 2', r'\1wall 3'), \
            (r'\| \[Stale list.*\n', ''), (r'\| 1 \|', '| 9 |'):
        if not check_faults(re.sub(pattern, replacement, faults)):
            failures.append(f'docs.py does not notice a wrong table of faults: {pattern}')
    return failures


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != '--write']
    source, rheolog = map(os.path.abspath, arguments[:2])
    faulty = dict(argument.split('=', 1) for argument in arguments[2:] if '=' in argument)
    faulty = {name: os.path.abspath(program) for name, program in faulty.items()}
    names = [argument for argument in arguments[2:] if '=' not in argument]
    whole = not names
    if whole:
        names = ['README.md'] + sorted(os.path.relpath(path, source) for path in glob.glob(os.path.join(source, 'docs/*.md')))
    pages = test_pages(source, names, rheolog, faulty, '--write' in sys.argv)
    with open(os.path.join(source, 'docs/faults.md'), encoding='utf-8') as f:
        faults = f.read()
    wrong = [text for page in pages for text in page.wrong] + check_faults(faults)
    if whole and not wrong:
        wrong = self_check(rheolog, faults)
    for page in pages:
        for language, script in page.elsewhere.items():
            print(f'{page.name}: blocks {language} are run by {script}')
        if page.commands or page.not_run:
            print(f'{page.name}: {page.commands} commands, {page.seconds:.1f} s')
        for text in page.not_run:
            print('  not run: ' + text)
    for text in wrong:
        print(text)
    if wrong:
        sys.exit(f'{len(wrong)} wrong; after an intended change of outputs: python3 tests/docs.py SOURCE RHEOLOG ... --write')
    print(f'{sum(page.commands for page in pages)} commands do what the pages say')


if __name__ == '__main__':
    main()
