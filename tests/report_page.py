"""
report_page.py RHEOLOG [PROPERTY...]: the pages bad.html (of bad.rlog, exact numbers) and both.html (of base.rlog and other.rlog,
rounded numbers) in Chromium, against the program. See report.sh.
"""
import json
import math
import os
import re
import subprocess
import sys
import time

from browser import Browser

RHEOLOG = sys.argv[1]
REPORT = "window.rheologReport"
proofs = []


def proves(function):
    proofs.append(function)
    return function


def address(file, place=""):
    return f"file://{os.path.abspath(file)}" + (f"#{place}" if place else "")


def meta_of(file):
    with open(file, encoding="utf-8") as page:
        return json.loads(re.search(r'id="report-meta">(.*?)</script>', page.read(), re.S)[1])


def inspect(file, step, stage=None, particle=None):
    arguments = ["--step", str(step), *(["--stage", stage] if stage else []),
                 *(["--particle", str(particle)] if particle is not None else [])]
    answer = subprocess.run([RHEOLOG, "inspect", file, *arguments, "--json", "--quiet"], check=True, capture_output=True)
    return json.loads(answer.stdout)


def state(browser):
    return browser.run(f"[{REPORT}.step(), {REPORT}.stage(), {REPORT}.particle()]")


def same(what, seen, wanted):
    if seen != wanted:
        raise AssertionError(f"{what}: {seen} instead of {wanted}")


def near(what, seen, wanted, tolerance):
    for a, b in zip(seen, wanted, strict=True):
        if not (math.isfinite(a) and abs(a - b) <= tolerance):
            raise AssertionError(f"{what}: {seen} instead of {wanted}, not within {tolerance}")


def clean(browser, file):
    """The page has asked for itself only, and has nothing to complain about."""
    same("messages on the console", browser.errors, [])
    same("addresses asked for", {url.split("#")[0] for url in browser.requests}, {address(file)})


# ---- What the page shows, and what inspect says ----

def frame_shown(browser, meta):
    return meta["frames"][browser.run(REPORT + ".frame()")]


def compare(browser, meta, file):
    """Position and all values of the picked particle with inspect. Returns what inspect says."""
    step, stage, particle = state(browser)
    frame = frame_shown(browser, meta)
    same("step of the frame", [frame["step"], frame["stage"]], [step, stage])
    said = inspect(file, step, stage, particle)["particle"]
    values = browser.run(REPORT + ".values()")
    exact = meta["exact"] or any(detail["frame"] == meta["frames"].index(frame) and detail["particle"] == particle
                                 for detail in meta["details"])
    box = frame["position"]["box"] if not meta["exact"] else [0] * 6
    rounding = max(box[axis + 3] - box[axis] for axis in range(3)) / 65534
    for seen in (values["position"], [values["position." + axis] for axis in "xyz"]):
        near(f"position of {particle} in step {step}", seen, said["position"], rounding + 1e-5)
    compared = 0
    for i, quantity in enumerate(meta["quantities"]):
        name = quantity["name"]
        base, _, axis = name.partition(".")
        if name not in values or base not in said or isinstance(said[base], list) and not axis and base != "derivative":
            continue
        number = said[base]
        if isinstance(number, list) and base in ("neighbours", "springs"):
            number = len(number)
        elif axis:
            number = number["xyz".index(axis)]
        elif isinstance(number, list):
            number = math.hypot(*number)
        known = frame["values"][i]
        rounding = 0 if exact or not known else (known["max"] - known["min"]) / 65534
        near(f"{name} of {particle} in step {step}", [values[name]], [number], rounding + 1e-6 * abs(number))
        compared += 1
    if compared < 5:
        raise AssertionError(f"only {compared} values were compared: {list(values)}")
    return said


def nearest(browser, positions, radius, balls, x, y):
    """The particle that a line of sight meets first: calculated here, from all positions. None if a ball or nothing is there."""
    ray = browser.run(f"{REPORT}.ray({x}, {y})")
    first, found = math.inf, None
    for particle, (point, size) in enumerate([(point, radius) for point in positions] + balls):
        to = [a - b for a, b in zip(point, ray["eye"])]
        along = sum(a * b for a, b in zip(to, ray["direction"]))
        rest = along * along - sum(a * a for a in to) + size * size
        if rest > 0 and 0 < along - math.sqrt(rest) < first:
            first, found = along - math.sqrt(rest), particle if particle < len(positions) else None
    return found


def positions_of(file, step):
    subprocess.run([RHEOLOG, "export", file, "-o", "csv", "--format", "csv", "--step", str(step), "--quiet", "--force"],
                   check=True, capture_output=True)
    with open(f"csv/{file[:-5]}_{step:06}.csv", encoding="ascii") as table:
        return [[float(x) for x in line.split(",")[1:4]] for line in list(table)[1:]]


# ---- The properties ----

@proves
def the_page_begins_at_the_first_sign(browser):
    meta = meta_of("bad.html")
    browser.open(address("bad.html"))
    same("WebGL2", browser.run(REPORT + ".works()"), True)
    sign = next(mark for mark in meta["marks"] if mark["kind"] == "sign")
    same("beginning", state(browser)[0::2], [meta.get("begin", sign)["step"], meta.get("begin", sign)["particle"]])
    same("exact numbers", meta["exact"], True)
    said = compare(browser, meta, "bad.rlog")
    rows = browser.run('[...document.querySelectorAll(".springs tbody tr")].map(row => row.cells[0].textContent)')
    most = sorted(said["springs"], key=lambda spring: -abs(spring["stretch"]))
    same("springs, the most stretched first", rows[:3], [str(spring["partner"]) for spring in most[:3]])
    same("number of springs", len(rows), len(most))
    past = [row["velocity"] for row in said["history"]]
    rows = browser.run('''[...[...document.querySelectorAll("#panel details")].find(part => part.textContent.includes("history"))
        .querySelectorAll("tbody tr")].map(row =>
            [2, 3, 4].map(i => Number(row.cells[i].textContent.replaceAll("\u2212", "-"))))''')
    for seen, wanted in zip(rows, past, strict=True):
        near("velocity in the history ring", seen, wanted, 1e-5 * math.hypot(*wanted) + 1e-12)
    clean(browser, "bad.html")


@proves
def sliders_move_through_steps_and_stages(browser):
    meta = meta_of("both.html")
    ends = sorted({frame["step"] for frame in meta["frames"]})
    staged = next(frame["step"] for frame in meta["frames"] if frame["stage"])
    names = [frame["stage"] for frame in meta["frames"] if frame["step"] == staged]
    browser.open(address("both.html", "step=0&particle=5"))
    browser.run('document.getElementById("step").focus()')
    browser.key("End")
    same("End on the step slider", state(browser), [ends[-1], None, 5])
    compare(browser, meta, "base.rlog")
    browser.key("Home")
    for _ in range(ends.index(staged)):
        browser.key("ArrowRight")
    same("arrows on the step slider", state(browser), [staged, None, 5])
    browser.run('document.getElementById("stage").focus()')
    browser.key("Home")
    same("Home on the stage slider", state(browser), [staged, names[0], 5])
    for name in names[1:4]:
        browser.key("ArrowRight")
        same("arrows on the stage slider", state(browser), [staged, name, 5])
    compare(browser, meta, "base.rlog")
    same("address", browser.run("location.hash")[1:].split("&")[:3], [f"step={staged}", f"stage={names[3]}", "particle=5"])
    plain = next(step for step in ends if sum(frame["step"] == step for frame in meta["frames"]) == 1)
    browser.run(f'location.hash = "step={plain}"')
    browser.settle()
    same("stage slider of a step without stages", browser.run('document.getElementById("stage").disabled'), True)
    browser.click_on("#stage-text a")
    stages = [frame["stage"] for frame in meta["frames"] if frame["step"] == state(browser)[0]]
    same("a link to a step with stages", len(stages) > 1, True)
    browser.run('location.hash = "step=999"')
    browser.settle()
    same("the frame before a step that is not there", state(browser)[0], ends[-1])
    same("words for it", f"This is step {ends[-1]}" in browser.run('document.getElementById("note").textContent'), True)


@proves
def links_of_the_story_lead_to_their_frames(browser):
    meta = meta_of("bad.html")
    browser.open(address("bad.html", "step=15"))
    same("address", state(browser)[0], 15)
    links = browser.run('[...document.querySelectorAll("#story a")].map(link => link.getAttribute("href"))')
    if len(links) < 2:
        raise AssertionError(f"the story has only these links: {links}")
    for i, link in enumerate(links):
        browser.run(f'document.querySelectorAll("#story a")[{i}].setAttribute("id", "link{i}")')
        browser.click_on(f"#link{i}")
        wanted = dict(part.split("=") for part in link[1:].split("&"))
        step, stage, particle = state(browser)
        same(f"particle of {link}", str(particle), wanted.get("particle", str(particle)))
        stages = [frame["stage"] for frame in meta["frames"] if frame["step"] == int(wanted["step"])]
        if stages:
            same(f"step and stage of {link}", [step, stage], [int(wanted["step"]), wanted.get("stage", stages[-1])])
        else:
            same(f"words for {link}", "This is step" in browser.run('document.getElementById("note").textContent'), True)
        if step <= meta["steps"]:
            compare(browser, meta, "bad.rlog")
    clean(browser, "bad.html")


@proves
def a_click_picks_the_particle_that_one_sees(browser):
    meta = meta_of("both.html")
    browser.open(address("both.html", "step=20"))
    positions = positions_of("base.rlog", 20)
    balls = [(body["position"], body["radius"]) for body in inspect("base.rlog", 20)["bodies"]]
    left, top, wide, high = browser.run('''(() => {
        const box = document.getElementById("canvas").getBoundingClientRect();
        return [box.x, box.y, box.width, box.height];
    })()''')
    picked = set()
    browser.key("+")
    for _ in range(2):
        for particle in range(0, len(positions), 40):
            place = browser.run(f"{REPORT}.place({particle})")  # others may hide it
            x, y = round(place["x"]), round(place["y"])
            wanted = nearest(browser, positions, meta["radius"], balls, x + 0.5, y + 0.5)
            got = browser.run(f"{REPORT}.pick({x}, {y})")
            if got != wanted:  # a pixel beside the edge of a sphere
                around = {nearest(browser, positions, meta["radius"], balls, x + 0.5 + dx, y + 0.5 + dy)
                          for dx in (-1, 1) for dy in (-1, 1)}
                if got not in around:
                    raise AssertionError(f"at {x}, {y} is particle {got}, and should be {wanted}")
            picked.add(got)
        browser.drag(left + wide / 2, top + high / 2, left + wide / 2 + 170, top + high / 2 + 60)
    if len(picked - {None}) < 8:
        raise AssertionError(f"only these particles were met: {picked}")
    for particle in sorted(picked - {None})[::4]:
        browser.run(f'location.hash = "step=20&particle={particle}"')
        browser.settle()
        place = browser.run(f"{REPORT}.place({particle})")
        if nearest(browser, positions, meta["radius"], balls, place["x"], place["y"]) == particle:
            browser.key("Escape")
            same("Escape", state(browser)[2], None)
            browser.click(place["x"], place["y"])
            same("a click of the mouse", state(browser)[2], particle)
        compare(browser, meta, "base.rlog")
    clean(browser, "both.html")


@proves
def what_hides_a_particle_can_be_cut_away(browser):
    browser.media(prefers_reduced_motion="reduce")
    browser.open(address("bad.html", "step=15"))
    hidden = [particle for particle in range(0, 600, 60)
              if browser.run(f"{REPORT}.pick({REPORT}.place({particle}).x, {REPORT}.place({particle}).y)") != particle]
    if len(hidden) < 3:
        raise AssertionError(f"only these particles are hidden: {hidden}")
    for particle in hidden[:3]:
        browser.run(f'location.hash = "step=15&particle={particle}"')
        browser.settle()
        browser.click_on("button[data-name=near]")
        same("look closer", browser.run(f"{REPORT}.pick({REPORT}.place({particle}).x, {REPORT}.place({particle}).y)"), particle)
        browser.key("r")
    browser.media()


@proves
def the_divergence_is_the_distance_in_both_recordings(browser):
    meta = meta_of("both.html")
    browser.open(address("both.html", "step=25"))
    colour = browser.run('document.getElementById("colour").selectedOptions[0].textContent')
    same("colour of two recordings", colour, "divergence")
    for _ in range(2):
        browser.key("m")
        particle = state(browser)[2]
        here, there = (inspect(file, 25, None, particle)["particle"]["position"] for file in ("base.rlog", "other.rlog"))
        known = frame_shown(browser, meta)["values"][[q["name"] for q in meta["quantities"]].index("divergence")]
        near("divergence", [browser.run(REPORT + ".values()")["divergence"]], [math.dist(here, there)],
             1e-5 * math.dist(here, there) + (known["max"] - known["min"]) / 65534)
        browser.run('location.hash = "step=25&particle=17"')
        browser.settle()
    mark = next(mark for mark in meta["marks"] if mark["kind"] == "difference")
    browser.open(address("both.html"))
    same("beginning", state(browser)[0], mark["step"])


@proves
def all_can_be_done_with_the_keyboard(browser):
    meta = meta_of("both.html")
    ends = sorted({frame["step"] for frame in meta["frames"]})
    browser.open(address("both.html", "step=0&particle=3"))
    browser.key("ArrowRight")
    same("right", state(browser)[0], ends[1])
    browser.key("ArrowLeft")
    same("left", state(browser)[0], ends[0])
    browser.key("End")
    same("End", state(browser)[0], ends[-1])
    browser.key("p")
    mark = next(mark for mark in meta["marks"] if mark["kind"] == "difference")
    same("previous mark", state(browser)[0], mark["step"])
    browser.run(f'location.hash = "step={mark["step"]}"')
    browser.settle()
    names = [frame["stage"] for frame in meta["frames"] if frame["step"] == mark["step"]]
    browser.key("[")
    same("previous stage", state(browser)[1], names[-2])
    browser.key("]")
    same("next stage", state(browser)[1], None)
    place = browser.run(REPORT + ".place(3)")
    browser.key("ArrowUp", shift=True)
    browser.key("+")
    if browser.run(REPORT + ".place(3)") == place:
        raise AssertionError("shift and up does not turn the view")
    browser.key("r")
    browser.run("new Promise(done => setTimeout(done, 500))")
    near("reset", list(browser.run(REPORT + ".place(3)").values()), list(place.values()), 0.01)
    browser.key("?")
    same("help", browser.run('document.getElementById("keys").open'), True)
    browser.key("Escape")
    same("Escape closes the help", browser.run('document.getElementById("keys").open'), False)
    browser.key("Home")
    browser.key(" ")
    until = time.monotonic() + 30
    while state(browser)[0] < ends[3]:
        if time.monotonic() > until:
            raise AssertionError("space does not play")
    browser.key(" ")
    step = state(browser)[0]
    browser.run("new Promise(done => setTimeout(done, 500))")
    same("space pauses", state(browser)[0], step)
    reached = set()
    for _ in range(60):
        browser.key("Tab")
        reached.add(browser.run("document.activeElement.id"))
    missing = {"step", "stage", "play", "colour", "particle", "canvas", "help"} - reached
    if "stage" in missing and browser.run('document.getElementById("stage").disabled'):
        missing.remove("stage")
    same("controls that the tab key does not reach", missing, set())
    clean(browser, "both.html")


@proves
def the_wheel_zooms_a_view_that_has_the_focus(browser):
    browser.open(address("bad.html", "step=15&particle=3"))
    left, top, wide, high = browser.run('Object.values(document.getElementById("canvas").getBoundingClientRect().toJSON())')[:4]
    place = browser.run(REPORT + ".place(3)")
    browser.mouse("mouseWheel", left + 20, top + 20, deltaX=0, deltaY=-200)
    browser.settle()
    same("a page that is scrolled", browser.run(REPORT + ".place(3)"), place)
    browser.run('document.getElementById("canvas").focus()')
    browser.mouse("mouseWheel", left + 20, top + 20, deltaX=0, deltaY=-200)
    browser.settle()
    nearer = browser.run(REPORT + ".place(3)")
    middle = [left + wide / 2, top + high / 2]
    if math.dist(nearer.values(), middle) <= 1.2 * math.dist(place.values(), middle):
        raise AssertionError(f"the wheel does not zoom: {place}, then {nearer}")


@proves
def motion_is_reduced_for_those_who_want_it(browser):
    browser.media(prefers_reduced_motion="reduce")
    browser.open(address("both.html", "step=5&particle=3"))
    step = state(browser)[0]
    place = browser.run(REPORT + ".place(3)")
    for _ in range(3):
        browser.key("-")
    browser.key("r")
    near("reset without easing", list(browser.run(REPORT + ".place(3)").values()), list(place.values()), 0.01)
    same("nothing plays by itself", state(browser)[0], step)
    browser.media()


CONTRASTS = r"""
(() => {
    const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    const rgba = colour => {
        canvas.clearRect(0, 0, 1, 1);
        canvas.fillStyle = colour;
        canvas.fillRect(0, 0, 1, 1);
        return [...canvas.getImageData(0, 0, 1, 1).data];
    };
    const ground = element => {
        const over = [];
        for (; element; element = element.parentElement)
            over.push(rgba(getComputedStyle(element).backgroundColor));
        return over.reverse().reduce((below, [r, g, b, a]) =>
            [r, g, b].map((x, i) => (x * a + below[i] * (255 - a)) / 255), [255, 255, 255]);
    };
    const light = rgb => rgb.map(x => x / 255).map(x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4)
        .reduce((sum, x, i) => sum + x * [0.2126, 0.7152, 0.0722][i], 0);
    const found = [];
    let texts = 0;
    for (const element of document.querySelectorAll("body *")) {
        const text = [...element.childNodes].filter(node => node.nodeType === 3).map(node => node.data.trim()).join("");
        if (!text || element.closest("script, noscript, option, [hidden], section:not(.panel) svg") ||
            element.matches(":disabled") || !element.getClientRects().length)
            continue;
        const style = getComputedStyle(element);
        const front = light(rgba(element instanceof SVGElement ? style.fill : style.color).slice(0, 3));
        const back = light(ground(element));
        const contrast = (Math.max(front, back) + 0.05) / (Math.min(front, back) + 0.05);
        texts++;
        if (contrast < 4.5)
            found.push(`${text.slice(0, 40)}: ${contrast.toFixed(2)}`);
    }
    return { texts, found };
})()
"""


@proves
def texts_stand_out_from_their_ground(browser):
    for theme in ("light", "dark"):
        browser.media(prefers_color_scheme=theme)
        browser.open(address("bad.html"))
        seen = browser.run(CONTRASTS)
        same(f"contrasts below 4.5 in the {theme} theme", seen["found"], [])
        if seen["texts"] < 60:
            raise AssertionError(f"only {seen['texts']} texts were seen")
    browser.run('document.querySelector("#story p").style.color = "#777"')
    same("a grey text is noticed", len(browser.run(CONTRASTS)["found"]), 1)
    browser.media()


@proves
def the_page_fits_narrow_screens(browser):
    for width, height in ((1280, 720), (820, 1100), (360, 740)):
        browser.resize(width, height)
        browser.open(address("bad.html"))
        same(f"width at {width}", browser.run("document.documentElement.scrollWidth"), width)
        wide, high = browser.run('[document.getElementById("canvas").clientWidth, document.getElementById("canvas").clientHeight]')
        if wide < 0.5 * min(width, 1280) or high < 200:
            raise AssertionError(f"the view has {wide} times {high} pixels at {width}")
    browser.resize(1024, 640)


@proves
def without_webgl_the_rest_works(browser):
    script = browser.call("Page.addScriptToEvaluateOnNewDocument", source="HTMLCanvasElement.prototype.getContext = () => null")
    browser.open(address("bad.html", "step=15&particle=3"))
    same("WebGL2", browser.run(REPORT + ".works()"), False)
    same("the words instead", browser.run('document.getElementById("fallback").checkVisibility()'), True)
    compare(browser, meta_of("bad.html"), "bad.rlog")
    browser.key("ArrowRight")
    same("right", state(browser), [16, None, 3])
    clean(browser, "bad.html")
    browser.call("Page.removeScriptToEvaluateOnNewDocument", **script)


@proves
def prints_leave_the_view_out(browser):
    browser.open(address("bad.html"))
    browser.media("print")
    visible = 'id => document.getElementById(id).checkVisibility()'
    same("visible in print", browser.run(f'["view", "panel", "story", "metrics", "commands", "budget"].map({visible})'),
         [False, False, True, True, True, True])
    browser.media()


@proves
def another_value_is_noticed(browser):
    """The comparison itself: a page whose positions are those of the next particle."""
    with open("bad.html", encoding="utf-8") as page:
        text = page.read()
    meta = meta_of("bad.html")
    place = next(i for i, frame in enumerate(meta["frames"]) if frame["step"] == 15)
    meta["frames"][place]["position"]["offset"] += 12
    with open("wrong.html", "w", encoding="utf-8") as page:
        page.write(re.sub(r'(id="report-meta">).*?(</script>)',
                          lambda found: found[1] + json.dumps(meta).replace("<", "\\u003c") + found[2], text, flags=re.S))
    browser.open(address("wrong.html", "step=15&particle=3"))
    try:
        compare(browser, meta, "bad.rlog")
    except AssertionError:
        return
    raise AssertionError("a wrong position is not noticed")


@proves
def without_scripts_the_story_is_there(browser):
    browser.without_scripts()
    browser.open(address("bad.html"))
    text = browser.run("document.body.innerText")
    doctor = subprocess.run([RHEOLOG, "doctor", "bad.rlog", "--json"], capture_output=True, check=False)
    verdict = json.loads(doctor.stdout)
    for words in ("What happened", "Metrics", "Commands", "history.stiffness", str(verdict["step"]), "no view of the particles"):
        if words not in text:
            raise AssertionError(f"the page without scripts does not say {words}")
    same("controls without scripts", browser.run('document.getElementById("view").checkVisibility()'), False)


with Browser(1024, 640) as chromium:
    for proof in (proof for proof in proofs if not sys.argv[2:] or proof.__name__ in sys.argv[2:]):
        begin = time.monotonic()
        chromium.requests.clear()
        chromium.errors.clear()
        proof(chromium)
        print(f"{proof.__name__}: {time.monotonic() - begin:.1f} s")
