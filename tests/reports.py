"""reports.py PROGRAM: checks JUnit XML, TAP and annotations of `rheolog verify` and `rheolog diff`."""

import atexit
import contextlib
import fcntl
import json
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import xml.etree.ElementTree

program = os.path.abspath(sys.argv[1])
folder = tempfile.mkdtemp()
atexit.register(shutil.rmtree, folder)
os.chdir(folder)
strange = 'a<&"\u00e9,%: #\\\n\x01.rlog'  # every character that one of the formats escapes


def run(code, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True)
    assert done.returncode == code, (arguments, done)
    return done.stdout.decode(), done.stderr.decode()


def junit(path):
    """(name, kind, message) of each case; the totals must agree with the cases."""
    root = xml.etree.ElementTree.parse(path).getroot()
    suite = root.find("testsuite")
    cases = [(case.get("name"), case[0].tag if len(case) else None, case[0].get("message") if len(case) else None)
             for case in suite.findall("testcase")]
    for total in root, suite:
        assert int(total.get("tests")) == len(cases), total.attrib
        for kind in "failure", "error":
            assert int(total.get(kind + "s")) == sum(case[1] == kind for case in cases), total.attrib
    assert all(case.get("file") and float(case.get("time")) >= 0 for case in suite)
    return cases


def tap(text):
    """(passed, description, diagnostics) of each test line of TAP 13."""
    lines = text.splitlines()
    assert lines[0] == "TAP version 13", lines
    plan = int(re.fullmatch(r"1\.\.(\d+)", lines[1]).group(1))
    tests, at = [], 2
    while at < len(lines):
        found = re.fullmatch(r"(not )?ok (\d+) - ((?:[^#\\]|\\[#\\])*)", lines[at])
        assert found and int(found.group(2)) == len(tests) + 1, lines[at]
        assert lines[at + 1] == "  ---", lines[at + 1]
        end = lines.index("  ...", at)
        values = dict(re.fullmatch(r"  (\w+): (.*)", line).groups() for line in lines[at + 2:end])
        tests.append((found.group(1) is None, re.sub(r"\\(.)", r"\1", found.group(3)),
                      {key: json.loads(value) for key, value in values.items()}))
        at = end + 1
    assert plan == len(tests), (plan, len(tests))
    return tests


# Small recordings: of two that begin with the same state, the second differs from step 1 on.
os.mkdir("golden")
os.mkdir("new")
box = ["run", "melting-box", "--set", "fluid.spacing=0.2", "--steps", "3", "--json"]
run(0, *box, "-o", "golden/one.rlog")
run(0, "run", "--from", "golden/one.rlog@0", "--set", "gravity=[0, -5, 0]", "--steps", "3", "-o", "new/one.rlog", "--json")
one = open("golden/one.rlog", "rb").read()
for name in "golden/two.rlog", "new/two.rlog", "golden/gone.rlog", "new/more.rlog", "new/" + strange:
    open(name, "wb").write(one)
open("new/cut.rlog", "wb").write(one[:-9])

# verify: same, unreadable and missing files, in this order.
files = ["golden/one.rlog", "new/" + strange, "new/cut.rlog", "none.rlog"]
text, errors = run(2, "verify", *files, "--junit", "verify.xml", "--github")
assert text.splitlines()[-1] == "4 recordings: 2 same, 0 differ, 2 unreadable", text
cases = junit("verify.xml")
assert [case[0] for case in cases] == [name.replace("\x01", "?") for name in files], cases
assert [case[1] for case in cases] == [None, None, "error", "error"], cases
assert cases[2][2].startswith("unreadable"), cases
annotations = [line for line in errors.splitlines() if line.startswith("::")]
assert [re.fullmatch(r"::error file=([^,:]*),title=([^,:]*)::.*", line).groups() for line in annotations] == [
    ("new/cut.rlog", "rheolog verify"), ("none.rlog", "rheolog verify")], annotations
open("new/cut" + strange, "wb").write(one[:-9])
errors = run(2, "verify", "new/cut" + strange, "--github")[1]
file, message = re.search(r"^::error file=([^,:]*),title=rheolog verify::(.*)$", errors, re.M).groups()
escaped = re.sub("[%\n\x01]", lambda found: "%%%02X" % ord(found[0]), "new/cut" + strange)
assert file == escaped.replace(",", "%2C").replace(":", "%3A"), errors  # in messages these two may stand
assert message.startswith(escaped + ": unreadable"), errors
os.remove("new/cut" + strange)
tests = tap(run(2, "verify", "--tap", *files)[0])
assert [test[0] for test in tests] == [True, True, False, False], tests
assert tests[1][1] == "new/" + strange.replace("\n", "?").replace("\x01", "?"), tests[1]
assert tests[0][2]["steps"] == 3 and tests[3][2]["verdict"] == "unreadable", tests
assert run(2, "verify", *files, "--tap", "--json")[0] == ""

# A folder that is called like a recording does not end the report.
os.mkdir("folder.rlog")
text, errors = run(2, "verify", "folder.rlog", "golden/one.rlog")
assert text.splitlines()[1:] == ["golden/one.rlog: same: 3 steps from step 0 on",
                                 "2 recordings: 1 same, 0 differ, 1 unreadable"], text

# diff of folders: a name that one side lacks is an error.
run(2, "diff", "golden", "new/", "--junit", "diff.xml", "--github")
kinds = {case[0].split("/")[-1]: case[1] for case in junit("diff.xml")}
assert kinds == {"one.rlog": "failure", "two.rlog": None, "gone.rlog": "error", "more.rlog": "error", "cut.rlog": "error",
                 strange.replace("\x01", "?"): "error"}, kinds
text, errors = run(1, "diff", "golden/", "new/one.rlog", "new/two.rlog", "--github")
assert text.splitlines()[-1] == "2 pairs: 1 same, 1 differs, 0 unreadable", text
assert errors.startswith("::error file=golden/one.rlog,title=rheolog diff::golden/one.rlog, new/one.rlog: differs"), errors
passed, name, values = tap(run(1, "diff", "--tap", "golden/one.rlog", "new")[0])[0]
assert not passed and name == "golden/one.rlog, new/one.rlog", name
assert values["verdict"] == "differs" and values["step"] == 1 and float(values["wanted"]) != float(values["found"]), values
os.mkdir("empty")
assert "nothing was compared" in run(2, "diff", "empty", "empty")[1]
assert "is no folder" in run(2, "diff", "new/one.rlog", "new/two.rlog", "golden")[1]

# A file that is not a report is not replaced; an older report is.
assert "not XML" in run(2, "verify", "--junit", *files)[1]
assert open("golden/one.rlog", "rb").read() == one
run(0, "verify", "golden/one.rlog", "--junit", "verify.xml")
assert junit("verify.xml") == [("golden/one.rlog", None, None)]
assert not [name for name in os.listdir(".") if name.endswith(".new")]

# Progress appears on a terminal, and Ctrl-C leaves a partial verdict and a report with every file.
def verify_many(*options, interrupt):
    """Verifies for more than a second with a terminal as standard error; returns exit code, results and terminal."""
    terminal, child = pty.openpty()
    done = subprocess.Popen([program, "verify", *["golden/one.rlog"] * 20000, *options], stdout=open("out", "w"), stderr=child)
    os.close(child)
    shown = b""
    if interrupt:
        while b"verifying, step" not in shown:
            shown += os.read(terminal, 1000)
        done.send_signal(signal.SIGINT)
    else:
        time.sleep(1.5)
        done.kill()
        done.wait()
        with contextlib.suppress(OSError):  # the terminal has no other end any more
            shown += os.read(terminal, 1000)
    code = done.wait()
    return code, open("out").read(), shown


code, text, shown = verify_many("--junit", "verify.xml", interrupt=True)
assert code == 4 and re.search(rb"golden/one\.rlog: verifying, step [12] of 3", shown), (code, shown)
assert re.search(r"^golden/one\.rlog: interrupted after [123] steps?: same so far$", text, re.M), text[-500:]
assert re.fullmatch(r"20000 recordings: \d+ same, 0 differ, 0 unreadable, \d+ interrupted", text.splitlines()[-1]), text[-100:]
kinds = [case[1] for case in junit("verify.xml")]
assert len(kinds) == 20000 and kinds[0] is None and kinds[-1] == "error", kinds[-3:]
os.remove("verify.xml")
# Regression: the JSON had no lines of the files whose turn had not come.
code, text, shown = verify_many("--json", interrupt=True)
lines = [json.loads(line) for line in text.splitlines()]
assert code == 4 and len(lines) == 20000 and {line["verdict"] for line in lines} == {"same", "not compared"}, (code, len(lines))
assert lines[0]["verdict"] == "same" and lines[-1]["message"] == "not compared: interrupted before", lines[-1]
open("verify.xml", "w").write("<an/>")
assert verify_many("--quiet", "--junit", "verify.xml", interrupt=False)[2] == b""
assert not os.path.exists("verify.xml")  # a command that is killed leaves no older report

# The progress of `run` tells the steps and what they cost.
terminal, child = pty.openpty()
done = subprocess.Popen([program, *box[:4], "--steps", "100000000"], stdout=subprocess.DEVNULL, stderr=child)
os.close(child)
shown = b""
while b" left" not in shown:
    shown += os.read(terminal, 1000)
done.send_signal(signal.SIGINT)
assert done.wait() == 4
step, cost = re.search(rb"step (\d+) of 100000000, ([\d.]+) ns per particle and step, .* left", shown).groups()
assert int(step) > 0 and float(cost) > 0, shown
os.close(terminal)

# Lines are wrapped on a terminal, at its width or at COLUMNS, and nowhere else.
def on_terminal(width, columns, *arguments):
    terminal, child = pty.openpty()
    fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("4H", 24, width, 0, 0))
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    if columns:
        environment["COLUMNS"] = columns
    done = subprocess.Popen([program, *arguments], stdout=child, stderr=child, env=environment)
    shown = b""
    ended = False
    while not ended:  # with its other end open, the terminal gives all that was written
        ended = done.poll() is not None
        while select.select([terminal], [], [], 0.05)[0]:
            shown += os.read(terminal, 1000)
    os.close(child)
    os.close(terminal)
    return re.sub("\r(\033\\[K)?", "", shown.decode())


pair = "diff", "--quiet", "golden/one.rlog", "new/one.rlog"  # on a slow machine there would be progress too
plain, _ = run(1, *pair)
assert max(len(line) for line in plain.splitlines()) > 130
for width, columns, most in ((60, None, 60), (130, None, 130), (60, "100", 100), (0, None, 80), (60, "x", 60)):
    text = on_terminal(width, columns, *pair)
    assert text.split() == plain.split(), text  # the same words
    lines = [line for line in text.splitlines() if "rheolog " not in line]  # commands are there to be copied
    assert max(map(len, lines)) <= most and len(lines) > len(plain.splitlines()), (most, text)
text = on_terminal(40, None, "verify")
assert max(len(line) for line in text.splitlines()) <= 40 and text.count("\n") > 1, text
assert "\n" not in run(2, "verify")[1][:-1]

# The checks notice totals that are wrong, a missing case and a missing plan.
for wrong in ("""tests="2" failures="0" errors="0" """, """tests="1" failures="1" errors="0" """):
    open("wrong.xml", "w").write("<a %s><testsuite %s><testcase name='x' file='x' time='0'/></testsuite></a>" % (wrong, wrong))
    try:
        junit("wrong.xml")
    except AssertionError:
        continue
    sys.exit("wrong totals went unnoticed")
try:
    tap("TAP version 13\n1..2\nok 1 - a\n  ---\n  ...\n")
except AssertionError:
    sys.exit(0)
sys.exit("a missing test went unnoticed")
