"""Parameters: their defaults and words, from the tables of docs/parameters.md."""
import re


class Parameters:
    def __init__(self, page):
        """page: the text of docs/parameters.md."""
        self.words, self.defaults = {}, {}
        for path, default, allowed in re.findall(r'^\| `([\w.]+)` \|[^|]*\| ([^|]*?) \| ([^|]*?) \|', page, re.M):
            if allowed.startswith('one of: '):
                self.words[path] = allowed[len('one of: '):].split()
            default = default.split(';')[0]
            self.defaults[path] = self.parse(path, default)

    def parse(self, path, text):
        """The values of a parameter that is written as text."""
        if path in self.words:
            return [float(self.words[path].index(text))]
        return [float(v) for v in text.strip('[] ').split(',')]

    def word(self, path, values):
        return self.words[path][int(values[0])]


class Definition:
    """The parameters in force."""

    def __init__(self, parameters, recorded):
        self.parameters = parameters
        self.values = dict(parameters.defaults)
        self.values.update(recorded)
        self.ball = 0  # whose parameters "ball." are (balls.one)
        self.materials = list(dict.fromkeys(path.split('.')[1] for path in recorded if path.startswith('materials.')))

    def of_materials(self, path):
        """A parameter of all materials by number; that of material 0 is the main one."""
        own = [self[f'materials.{name}.{path}'] for name in self.materials]
        return [self[path]] + [self[path] if value < 0 else value for value in own]

    def __getitem__(self, path):
        """A number, or the word of a choice."""
        if path in self.parameters.words:
            return self.parameters.word(path, self.values[path])
        return self.values[self.own(path)][0]

    def vector(self, path):
        return self.values[self.own(path)]

    def own(self, path):
        return f'ball{self.ball + 1}.{path[5:]}' if self.ball and path.startswith('ball.') else path

    def set(self, path, text):
        group, _, rest = path.partition('.')
        if group == 'materials':
            name, _, member = rest.partition('.')
            path = f'materials.{self.materials[int(name) - 1] if name.isdigit() else name}.{member}'
        self.values[path] = self.parameters.parse(path, text)
