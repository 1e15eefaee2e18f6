"""schema.py PROGRAM FOLDER SCENES...: checks FOLDER/schema.json against FOLDER/parameters and the scenes."""

import json
import subprocess
import sys

program, folder, files = sys.argv[1], sys.argv[2], sys.argv[3:]
schema = json.load(open(folder + "/schema.json"))
parameters = [json.loads(line) for line in open(folder + "/parameters")]
models = {one["properties"]["model"]["const"]: one for one in schema["oneOf"]}


def find(model, path):
    where = models[model]
    for key in path.split("."):
        if key == "0":  # an obstacle: an object with its shape, which has the other parameters
            shapes = [next(iter(known)) for one in where["items"]["oneOf"]
                      for known in [[word for word in one["properties"] if word not in ("$schema", "comment")]]]
            if path.endswith(".shape"):
                return {"enum": shapes, "default": shapes[0]}
            of_shapes = [one["properties"][shape] for one, shape in zip(where["items"]["oneOf"], shapes)]
            where = {"properties": {name: value for one in reversed(of_shapes) for name, value in one["properties"].items()}}
            continue
        where = where["items"] if key == "NAME" else where["properties"].get(key)
        if where is None:
            return None
    return where


def check(parameter):
    """Exactly the models that have the parameter list it, with its range, words and default."""
    for model in models:
        entry = find(model, parameter["path"])
        assert (entry is not None) == (model in parameter["models"]), (model, parameter["path"])
        if entry is None:
            continue
        if parameter["path"] == "emitters.NAME.material":  # a name in the file
            assert entry["type"] == "string"
            continue
        default = parameter["models"][model]
        kind = parameter["type"]
        if entry.get("type") == "boolean":  # words of the program
            assert parameter["choices"] == "false true" and entry["default"] == (default == "true"), parameter["path"]
            continue
        assert entry["default"] == default, parameter["path"]
        if kind == "choice":
            assert entry["enum"] == parameter["choices"].split(), parameter["path"]
            continue
        ranged = entry["items"] if kind == "vector" else entry["oneOf"][0] if kind == "window" else entry
        low = "exclusiveMinimum" if parameter["above_minimum"] else "minimum"
        high = "exclusiveMaximum" if parameter["below_maximum"] else "maximum"
        assert ranged[low] == parameter["minimum"], parameter["path"]
        assert ranged[high] == parameter["maximum"], parameter["path"]


def check_described(entry, path):
    """Every property has a description, or holds only such."""
    for key, value in entry.get("properties", {}).items():
        where = path + "." + key
        if "items" not in value and "properties" not in value:
            assert value.get("description"), where
        check_described(value, where)
    items = entry.get("items", {})
    for one in items.get("oneOf", [items] if items else []):
        check_described(one, path + "[]")


for model in models:
    check_described(models[model], model)
try:
    check_described({"properties": {"a": {"properties": {"b": {"type": "number"}}}}}, "")
    sys.exit("the check does not notice a missing description")
except AssertionError:
    pass
assert len(parameters) > 70 and len(models) >= 2
for parameter in parameters:
    check(parameter)
try:
    check(dict(parameters[0], minimum=-1))
    sys.exit("the check does not notice a wrong range")
except AssertionError:
    pass

try:
    import jsonschema
except ImportError:
    print("every parameter is in the schema; no jsonschema here: scenes are not validated")
    sys.exit(0)
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
names = [json.loads(line)["name"] for line in
         subprocess.run([program, "scenes", "--json"], capture_output=True, check=True).stdout.splitlines()]
for name in names + files:
    written = subprocess.run([program, "run", name, "--write-scene"], capture_output=True).stdout
    if not written:  # built without JSON scenes
        continue
    validator.validate(json.loads(written))
for name in files:
    validator.validate(json.load(open(name)))
bad = ['{"step": 0}', '{"step": "1"}', '{"stp": 1}', '{"springs": {"solver": "magic"}}', '{"history": {"order": 1}}',
       '{"melting": {"viscosity": 1}}', '{"model": "melting", "springs": {"stiffness": 1}}', '{"gravity": [0, 1]}',
       '{"fluid": {"shapes": [{"cube": {}}]}}', '{"fluid": {"shapes": [{"sphere": {"radius": 1}}]}}',
       '{"history": {"window": 1.5}}', '{"history": {"lag": -1}}', '{"history": {"curve": [[0, 1]]}}',
       '{"materials": [{"name": "main"}]}', '{"materials": [{"name": "1"}]}', '{"emitters": [{"name": "a"}]}', '{"emitters": [{"position": [0, 0, 0]}]}',
       '{"emitters": [{"name": "a", "position": [0, 0, 0], "speed": 0}]}', '{"emitters": [{"name": "a", "position": [0, 0, 0], "sped": 1}]}',
       '{"model": "melting", "emitters": [{"name": "a", "position": [0, 0, 0], "material": "main"}]}',
       '{"emitters": [{"name": "a", "position": [0, 0, 0], "flow": true}]}', '{"history": {"curve": []}}', '{"history": {"curve": [[0, 1], [1]]}}', '{"walls": {"planes": [{"point": [0, 0, 0]}]}}', '{"sources": {}}']
commented = ('{"$schema": "s.json", "comment": ["a", 1], "settle": {"comment": 1}, "fluid": {"comment": null, "shapes": [{"comment": "",'
             ' "sphere": {"comment": {}, "centre": [0, 4, 0], "radius": 2}}]}, "walls": {"planes": [{"comment": 1, "point": [0, 0, 0],'
             ' "normal": [0, 1, 0]}], "boxes": [{"$schema": 1, "min": [0, 0, 0], "max": [1, 1, 1]}]},'
             ' "vibrators": {"grid": {"comment": 1, "min": [0, 0], "max": [4, 4], "spacing": 2}}}')
commented_materials = ('{"materials": [{"comment": 1, "$schema": 1, "name": "dough", "springs": {"comment": [], "stiffness": 1}, "history":'
                       ' {"comment": 1, "$schema": ""}}], "history": {"comment": 1, "curve": [[0, 1], [1, 0]]}, "ball": {"comment": 1}}')
commented_melting = '{"comment": 1, "model": "melting", "melting": {"comment": 1}, "walls": {"$schema": 1, "planes": []}}'
emitting = ('{"emitters": [{"name": "a", "comment": 1, "$schema": 1, "position": [0, 9, 0], "shape": "rectangle", "width": 3, "material": "b",'
            ' "end": 3}], "materials": [{"name": "b"}]}')
good = [emitting, '{"model": "melting", "emitters": [{"name": "a", "position": [0, 9, 0], "temperature": 3}]}', commented, commented_materials, commented_melting, '{}', '{"materials": [{"name": "mainly"}]}', '{"history": {"window": "2.5 s", "lag": "0 s"}}', '{"history": {"curve": [[0, 1], [1, 0]]}}',
        '{"model": "melting", "walls": {"boxes": []}}']
for text in bad:
    assert not validator.is_valid(json.loads(text)), text
for text in good:
    assert validator.is_valid(json.loads(text)), text
for text in bad + good:  # the program agrees
    open(folder + "/scene.json", "w").write(text)
    ran = subprocess.run([program, "run", folder + "/scene.json", "--write-scene"], capture_output=True, text=True)
    if "without JSON" not in ran.stderr:
        assert ran.returncode == (0 if text in good else 2), (text, ran.stderr)
print("the schema has", len(parameters), "parameters and accepts", len(names + files), "scenes")
