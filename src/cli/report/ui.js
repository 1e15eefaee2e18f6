/*
 * What is shown: frame, particle and colour. They follow from the controls and the address (#step=...), and all parts of the
 * page follow from them.
 */
const element = id => document.getElementById(id);
const quiet = window.matchMedia("(prefers-reduced-motion: reduce)");
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const FRAMES_PER_SECOND = 8;

document.documentElement.classList.add("scripted");
const view = new View(element("canvas"), meta.box);
const panel = new Panel(element("panel"), { pick: pickParticle, show: step => goTo(step, null), near: lookCloser,
    close: () => pickParticle(null) });

/* What is shown. */
const shown = { frame: 0, particle: null, quantity: 0 };
let points = null; // positions of the frame
let numbersShown = null; // values of the quantity in the frame
let playing = null;

const frameShown = () => meta.frames[shown.frame];
const quantityShown = () => meta.quantities[shown.quantity];
const isThere = () => hasParticle(frameShown(), shown.particle); // the particle picked
const isSeen = () => isThere() && isFinitePoint(points, shown.particle);

/* ---- Address ---- */

/* Reads #step=81&stage=forces@2&particle=17&colour=speed. What is left out stays; without a stage it is the end of the step. */
function obeyAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const quantity = meta.quantities.findIndex(({ name }) => name === wanted.get("colour"));
    if (quantity >= 0 && quantity !== shown.quantity)
        choose(quantity);
    if (wanted.has("particle"))
        shown.particle = numberOf(wanted.get("particle"));
    const step = numberOf(wanted.get("step"));
    if (step !== null)
        goTo(step, wanted.get("stage"));
    else
        update();
    return step !== null;
}

function numberOf(text) {
    return /^\d+$/.test(text ?? "") ? Number(text) : null;
}

function writeAddress() {
    const { step, stage } = frameShown();
    const parts = [`step=${step}`];
    if (stage !== null)
        parts.push(`stage=${stage}`);
    if (shown.particle !== null)
        parts.push(`particle=${shown.particle}`);
    parts.push(`colour=${quantityShown().name}`);
    try {
        history.replaceState(null, "", "#" + parts.join("&"));
    } catch {
        // some places that show pages allow no addresses
    }
}

/* ---- Going to a frame, picking ---- */

function goTo(step, stage) {
    const { index, exact } = findFrame(step, stage);
    shown.frame = index;
    update();
    if (!exact)
        sayOther(step, stage);
}

/* What is shown instead of the frame wanted. */
function sayOther(step, stage) {
    const { step: found, stage: after } = frameShown();
    const here = `This is step ${found}${after ? " after " + after : ""}`;
    if (meta.marks.some(mark => mark.kind === "failure" && mark.step === step))
        say(`Step ${step} failed${stage ? " in " + stage : ""}, which left no state. ${here}.`);
    else
        say(`The page holds no frame of step ${step}${stage ? " after " + stage : ""}. ${here}; for the other: ` +
            `rheolog inspect ${meta.name} --step ${step}${stage ? " --stage " + stage : ""}`);
}

function goToPlace(place) {
    goTo(steps[Math.min(Math.max(place, 0), steps.length - 1)], null);
}

/* By stages of the step. */
function moveStage(by) {
    const choices = framesOf(frameShown().step);
    const place = choices.findIndex(({ index }) => index === shown.frame) + by;
    if (choices[place]) {
        shown.frame = choices[place].index;
        update();
    }
}

function moveMark(by) {
    const places = [...new Set(meta.marks.map(mark => placeOf(mark.step)))].sort((a, b) => a - b);
    const here = placeOf(frameShown().step);
    const next = by > 0 ? places.find(place => place > here) : places.findLast(place => place < here);
    if (next === undefined)
        return say(by > 0 ? "There is no later mark." : "There is no earlier mark.");
    showMark(meta.marks.find(mark => placeOf(mark.step) === next));
}

function showMark(mark) {
    if (mark.particle !== null && mark.particle !== undefined)
        shown.particle = mark.particle;
    goTo(mark.step, mark.stage);
}

function pickParticle(id) {
    shown.particle = id;
    update();
}

function pickLargest() {
    let best = -1;
    for (let i = 0; numbersShown && i < numbersShown.length; i++)
        if (!Number.isFinite(numbersShown[i]) ? best < 0 || Number.isFinite(numbersShown[best]) :
            best < 0 || numbersShown[i] > numbersShown[best])
            best = i; // a number that is not finite is the largest
    if (best >= 0)
        pickParticle(best);
}

function pickAt(clientX, clientY) {
    const box = element("canvas").getBoundingClientRect();
    const index = view.pick(clientX - box.left, clientY - box.top);
    pickParticle(index < 0 ? null : index);
    return shown.particle;
}

/* ---- Colours ---- */

/* The largest values of a quantity in the frames, ascending. */
function maxima(quantity) {
    return meta.frames.map(frame => frame.values[quantity]?.max).filter(Number.isFinite).sort((a, b) => a - b);
}

function leastMaximum(quantity) {
    return maxima(quantity).find(max => max > 0) ?? 0;
}

/* Whether a few frames have so large values that all others would have one colour. */
function isSpread(quantity) {
    const all = maxima(quantity), { min, max } = meta.quantities[quantity];
    return min >= 0 && all.length > 0 && max > 10 * all[all.length >> 1];
}

function choose(quantity) {
    shown.quantity = quantity;
    element("logarithmic").checked = meta.quantities[quantity].name === "divergence" || isSpread(quantity);
}

/* The range of the scale, and the function from numbers to 0..1 along it; -1: not finite. */
function scaleOf() {
    let { min, max } = quantityShown();
    if (element("range").value === "frame" && numbersShown) {
        const finite = numbersShown.filter(Number.isFinite);
        if (finite.length)
            [min, max] = [finite.reduce((a, b) => Math.min(a, b)), finite.reduce((a, b) => Math.max(a, b))];
    }
    const logarithmic = element("logarithmic").checked && max > 0;
    if (logarithmic)
        min = Math.max(min, Math.min(leastMaximum(shown.quantity) / 10, max / 10), max * 1e-9);
    const width = logarithmic ? Math.log(max / min) : max - min;
    const place = x => !Number.isFinite(x) ? -1 : width > 0 ?
        Math.min(Math.max(logarithmic ? Math.log(Math.max(x, min) / min) / width : (x - min) / width, 0), 1) : 0.5;
    return { min, max, logarithmic, place };
}

function showScale({ min, max, logarithmic, place }) {
    const { label, unit } = quantityShown();
    const middle = logarithmic ? Math.sqrt(min * max) : (min + max) / 2;
    element("scale-title").textContent = label + (unitText(unit) ? ", " + unitText(unit) : "");
    element("scale-bar").style.background = viridisGradient();
    element("scale-numbers").replaceChildren(...[min, middle, max].map(x => make("span", {}, brief(x, 3))));
    const t = isThere() && numbersShown ? place(numbersShown[shown.particle]) : -1;
    element("scale-mark").hidden = t < 0;
    element("scale-mark").style.left = `${100 * t}%`;
}

/* A colour of the style sheet as red, green and blue from 0 to 1. */
function styleColour(name) {
    const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    return [1, 3, 5].map(place => parseInt(text.slice(place, place + 2), 16) / 255);
}

function takeColours() {
    view.setColours({ unknown: styleColour("--unknown"), accent: styleColour("--accent"), floor: styleColour("--floor"),
        panels: [styleColour("--ball"), styleColour("--ball-other")] });
}

/* ---- Showing ---- */

let loaded = { frame: -1, quantity: -1 };

function update() {
    const frame = frameShown();
    if (loaded.frame !== shown.frame)
        points = positions(frame);
    if (loaded.frame !== shown.frame || loaded.quantity !== shown.quantity)
        numbersShown = values(frame, shown.quantity);
    loaded = { ...shown };
    say(marksHere().map(mark => mark.text).join(" \u00b7 "));
    showFrame();
    showTime();
    showPanel();
    writeAddress();
    showLinks();
}

function showFrame() {
    const frame = frameShown();
    const scale = scaleOf();
    const springs = isThere() ? springsOf(detailOf(shown.frame, shown.particle)) : [];
    const alone = element("alone").checked && springs.length > 0;
    element("alone").disabled = springs.length === 0;
    view.alone = alone;
    const masks = new Uint8Array(frame.particles).fill(alone ? HIDDEN : SHOWN);
    for (const spring of springs)
        masks[spring.other] = PARTNER;
    if (isThere())
        masks[shown.particle] = PICKED;
    const shades = numbersShown ? Float32Array.from(numbersShown, scale.place) : new Float32Array(frame.particles).fill(-1);
    view.setFrame({ positions: points, shades, masks, balls: frame.balls ?? [] });
    view.setLines([...vibratorLines(), ...springLines(springs)]);
    showScale(scale);
    element("canvas").setAttribute("aria-label",
        `Particles in step ${frame.step}${frame.stage ? " after " + frame.stage : ""}, by ${quantityShown().label}`);
    const lost = countLost();
    element("absent").hidden = !lost && !!numbersShown;
    element("absent").textContent = !numbersShown ? `${quantityShown().label} is not known in this frame` :
        `${lost} ${lost === 1 ? "particle has" : "particles have"} no finite position`;
    redraw();
}

function countLost() {
    let lost = 0;
    for (let i = 0; i < frameShown().particles; i++)
        lost += isFinitePoint(points, i) ? 0 : 1;
    return lost;
}

const pointAt = index => Array.from(points.subarray(3 * index, 3 * index + 3));

/* Longer springs than at rest in one colour, shorter ones in another; the most stretched are the least transparent. */
function springLines(springs) {
    const most = size(springs[0]?.stretch) || 1;
    const colours = { long: styleColour("--stretched"), short: styleColour("--pressed") };
    return springs.map(spring => ({ spring, from: pointAt(shown.particle), to: pointAt(spring.other) }))
        .filter(({ spring, from, to }) => Math.hypot(...add(from, scaled(to, -1))) < 2 * spring.length) // else it crosses a border
        .map(({ spring, from, to }) => ({ from, to, tint: [...(spring.stretch > 0 ? colours.long : colours.short),
            0.35 + 0.65 * Math.min(size(spring.stretch) / most, 1)] }));
}

function vibratorLines() {
    const floor = meta.walls.find(wall => wall.normal[1] > 0.9)?.point[1] ?? meta.box[1];
    const tint = [...styleColour("--floor"), 0.8];
    const arm = meta.spacing;
    return (meta.vibrators ?? []).flatMap(([x, z]) => [
        { from: [x - arm, floor, z], to: [x + arm, floor, z], tint },
        { from: [x, floor, z - arm], to: [x, floor, z + arm], tint }]);
}

/* Draws once before the next picture of the screen. */
let waiting = false;

function redraw() {
    if (waiting)
        return;
    waiting = true;
    requestAnimationFrame(() => {
        waiting = false;
        view.draw();
        showMarker();
    });
}

/* A ring around the picked particle, also if others hide it. */
function showMarker() {
    const place = view.works && isSeen() ? view.place(pointAt(shown.particle)) : null;
    element("marker").hidden = !place;
    if (place) {
        element("marker").style.transform = `translate(${place.x}px, ${place.y}px)`;
        element("marker").firstElementChild.textContent = shown.particle;
    }
}

function showTime() {
    const frame = frameShown();
    const place = steps.indexOf(frame.step);
    const choices = framesOf(frame.step);
    const text = frame.step > meta.steps ? `${frame.step}, which failed` : `${frame.step} of ${meta.steps}`;
    element("step").value = place;
    element("step").setAttribute("aria-valuetext", `step ${text}`);
    element("step-text").textContent = `${text}, ${withUnit(timeOf(frame), "T", 4)}`;
    const stage = element("stage");
    stage.max = choices.length - 1;
    stage.value = choices.findIndex(({ index }) => index === shown.frame);
    stage.disabled = choices.length < 2;
    const name = frame.stage ? `after ${frame.stage}` : "end of the step";
    stage.setAttribute("aria-valuetext", name);
    element("stage-text").replaceChildren(name);
    if (choices.length < 2)
        element("stage-text").append(...stagedSteps());
    element("previous").disabled = element("first").disabled = place === 0;
    element("next").disabled = element("last").disabled = place === steps.length - 1;
}

/* Which steps have frames of stages, where this one has not. */
function stagedSteps() {
    const staged = [...new Set(meta.frames.filter(frame => frame.stage !== null).map(frame => frame.step))];
    if (!staged.length)
        return [make("span", { class: "small" }, " (no step has stages here)")];
    const away = step => Math.abs(step - frameShown().step);
    const near = staged.sort((a, b) => away(a) - away(b)).slice(0, 3).sort((a, b) => a - b);
    return [make("span", { class: "small" }, " (stages: ",
        near.flatMap((step, i) => [i ? ", " : "", make("a", { href: `#step=${step}` }, String(step))]), ")")];
}

function showPanel() {
    if (shown.particle === null) {
        panel.hide();
    } else {
        panel.show({ frameIndex: shown.frame, id: shown.particle, there: isThere(),
            quantity: shown.quantity, logarithmic: element("logarithmic").checked });
    }
    if (document.activeElement !== element("particle"))
        element("particle").value = shown.particle ?? "";
    element("colour").value = shown.quantity;
}

function marksHere() {
    const { step } = frameShown();
    return meta.marks.filter(mark => mark.step === step);
}

/* Marks the links of the text that lead to what is shown. */
function showLinks() {
    const { step, stage } = frameShown();
    for (const link of document.querySelectorAll('.document a[href^="#step="]')) {
        const wanted = new URLSearchParams(link.hash.slice(1));
        const here = Number(wanted.get("step")) === step && (wanted.get("stage") ?? null) === stage &&
            (!wanted.has("particle") || Number(wanted.get("particle")) === shown.particle);
        if (here)
            link.setAttribute("aria-current", "true");
        else
            link.removeAttribute("aria-current");
    }
}

function say(text) {
    element("note").textContent = text;
}
