#!/usr/bin/env python3
"""
links.py SOURCE: every relative link and #anchor in the pages of a checkout leads somewhere, and README.md leads to every page
in docs. Every file that a page names in backquotes exists, every function that it names is in a source, and every page that a
help text or a comment names as docs/NAME.md exists. The changelog may name files and functions of its time. At the end the
script proves that it notices each of these errors.
"""
import glob
import os
import re
import sys
import tempfile
import urllib.parse

FOLDERS = 'bench', 'docs', 'include', 'replays', 'src', 'tests'
LINK = re.compile(r'\]\(<?([^)\s>]+)>?(?: "[^"]*")?\)|(?:src|href)="([^"]+)"|^\[[^\]]+\]: (\S+)', re.M)
NAMED = re.compile(r'`((?:%s)/[\w./-]+)`' % '|'.join(FOLDERS))
FUNCTION = re.compile(r'`[^`\n]*?\b(rheo_\w+)\(')
PAGE = re.compile(r'\b(docs/[\w-]+\.md)\b')
TEXTS = '.c', '.h', '.def', '.txt', '.sh', '.py', '.build'


def read(root, name):
    with open(os.path.join(root, name), encoding='utf-8', errors='replace') as f:
        return f.read()


def files(root, *endings):
    names = []
    for folder in ('.',) + FOLDERS:
        pattern = '*' if folder == '.' else '**/*'
        for path in glob.glob(os.path.join(root, folder, pattern), recursive=True):
            if path.endswith(endings) and os.path.isfile(path):
                names.append(os.path.relpath(path, root))
    return sorted(names)


def without_code(text):
    return re.sub(r'`[^`\n]*`', '', re.sub(r'^```.*?^```$', '', text, flags=re.M | re.S))


def anchors(text):
    """Of a page, as GitHub makes them from titles."""
    found = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    for title in re.findall(r'^#+ (.*)$', re.sub(r'^```.*?^```$', '', text, flags=re.M | re.S), re.M):
        name = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', title).strip().lower()
        name = re.sub(r'[^\w\- ]', '', name).replace(' ', '-')
        number = 0
        while name + (f'-{number}' if number else '') in found:
            number += 1
        found.add(name + (f'-{number}' if number else ''))
    return found


def wrong_links(root):
    pages = {name: read(root, name) for name in files(root, '.md')}
    words = set(re.findall(r'\brheo_\w+', ' '.join(read(root, name) for name in files(root, '.h', '.c', '.py'))))
    wrong, leads_to = [], {}
    for name, text in pages.items():
        leads_to[name] = set()
        for match in LINK.finditer(without_code(text)):
            link = next(group for group in match.groups() if group)
            if re.match(r'[a-z]+:', link):
                continue
            path, _, anchor = link.partition('#')
            target = os.path.normpath(os.path.join(os.path.dirname(name), urllib.parse.unquote(path))) if path else name
            if not os.path.exists(os.path.join(root, target)):
                wrong.append(f'{name}: there is no {target} ({link})')
            elif anchor and target in pages and anchor not in anchors(pages[target]):
                wrong.append(f'{name}: {target} has no title for #{anchor}')
            leads_to[name].add(target)
        if name != 'CHANGELOG.md':
            named = (file for file in NAMED.findall(text) if not re.search('[A-Z]{4}', file)) # but `src/NAME.c`
            wrong += [f'{name}: there is no {file}' for file in named if not os.path.exists(os.path.join(root, file))]
            wrong += [f'{name}: there is no function {function}' for function in FUNCTION.findall(text) if function not in words]
    for name in files(root, *TEXTS):
        if name != 'tests/links.py':
            wrong += [f'{name}: there is no {page}' for page in PAGE.findall(read(root, name)) if page not in pages]
    reached, new = set(), {'README.md'}
    while new:
        reached |= new
        new = {target for name in new for target in leads_to.get(name, ()) if target in pages} - reached
    return wrong + [f'README.md does not lead to {name}' for name in pages if name.startswith('docs/') and name not in reached]


def check(texts):
    with tempfile.TemporaryDirectory() as root:
        for name, text in texts.items():
            os.makedirs(os.path.dirname(os.path.join(root, name)), exist_ok=True)
            with open(os.path.join(root, name), 'w', encoding='utf-8') as f:
                f.write(text)
        return wrong_links(root)


def main():
    wrong = wrong_links(sys.argv[1])
    for text in wrong:
        print(text)
    if wrong:
        sys.exit(f'{len(wrong)} links or names lead nowhere')
    right = {'README.md': 'A [page](docs/a.md#a-title-of-a), `docs/a.md` and\n```\n[no](link)\n```\n![x](<docs/x.png>)\n',
             'docs/a.md': '# A\n## A title, of `a`\n## A\n[b](b.md#b-1), [here](#a-1), [out](https://example.org/#x), `rheo_a()`\n',
             'docs/b.md': '# B\n# B\n', 'docs/x.png': '', 'src/a.c': 'rheo_a(); /* docs/a.md says why. */\n'}
    faults = {'there is no docs/c.md (c.md)': ('docs/b.md', '[c](c.md)'),
              'docs/b.md has no title for #b-2': ('docs/a.md', '[b](b.md#b-2)'),
              'docs/a.md has no title for #x': ('docs/a.md', '[here](#x)'), 'README.md does not lead to docs/d.md': ('docs/d.md', '# D'),
              'docs/a.md: there is no src/b.c': ('docs/a.md', '`src/b.c` `src/NAME.c`'), 'src/a.c: there is no docs/e.md': ('src/a.c', '// docs/e.md'),
              'there is no function rheo_b': ('docs/a.md', '`rheo_b(1)`'),
              'there is no docs/y.png': ('docs/a.md', '<img src="y.png">')}
    if check(right):
        sys.exit(f'links.py is wrong about right links: {check(right)}')
    for expected, (name, addition) in faults.items():
        found = check({**right, name: right.get(name, '') + addition})
        if len(found) != 1 or expected not in found[0]:
            sys.exit(f'links.py does not notice "{expected}", but {found}')
    print('every link leads somewhere')


if __name__ == '__main__':
    main()
