/*
 * What the reader does: sliders, buttons, keys, mouse and touch. At the end the page begins.
 */

/* ---- Playing ---- */

function play() {
    if (playing !== null)
        return pause();
    if (frameShown().step === steps.at(-1))
        goToPlace(0);
    playing = setInterval(() => {
        goToPlace(placeOf(frameShown().step) + 1);
        if (frameShown().step === steps.at(-1))
            pause();
    }, 1000 / FRAMES_PER_SECOND);
    element("play").textContent = "\u275a\u275a pause";
    element("play").setAttribute("aria-label", "Pause");
}

function pause() {
    clearInterval(playing);
    playing = null;
    element("play").textContent = "\u25b6 play";
    element("play").setAttribute("aria-label", "Play");
}

const moveStep = by => goToPlace(placeOf(frameShown().step) + by);

/* ---- The camera ---- */

function resetView() {
    cutAt(0);
    easeTo(() => view.camera.reset());
}

/* Shows the picked particle and a few spacings around it, and cuts away all that is in front of it. */
function lookCloser() {
    if (!isSeen())
        return;
    const point = pointAt(shown.particle);
    easeTo(() => view.camera.lookAt(point, 6 * meta.spacing), () => cutAt(view.camera.part(point)));
}

/* A part of the depth from 0 to 1. */
function cutAt(part) {
    view.cut = Math.min(Math.max(part, 0), 0.99);
    element("cut").value = 100 * view.cut;
    redraw();
}

/* Moves the camera to where `change` puts it: in a quarter of a second, or at once if the reader wants no motion. Calls `then`. */
function easeTo(change, then = redraw) {
    const { camera } = view;
    const state = () => [...camera.centre, camera.azimuth, camera.elevation, camera.distance];
    const from = state();
    change();
    const to = state();
    if (quiet.matches)
        return then();
    const begin = performance.now();
    const move = now => {
        const part = Math.min((now - begin) / 250, 1);
        const eased = part * part * (3 - 2 * part);
        const [x, y, z, azimuth, elevation, distance] = from.map((a, i) => a + Math.max(eased, 0) * (to[i] - a));
        Object.assign(camera, { centre: [x, y, z], azimuth, elevation, distance });
        redraw();
        if (part < 1)
            requestAnimationFrame(move);
        else
            then();
    };
    requestAnimationFrame(move);
}

function change(action) {
    action();
    redraw();
}

/* One pointer turns or moves the view, two zoom and move it; one that hardly moved picks. */
const pointers = new Map();
let moved = 0;

function listenToPointers(canvas) {
    canvas.addEventListener("pointerdown", event => {
        if (pointers.size === 0)
            moved = 0;
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", event => {
        const before = pointers.get(event.pointerId);
        if (!before)
            return;
        const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
        const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        moved += Math.abs(dx) + Math.abs(dy);
        const { camera } = view;
        if (others.length) {
            const distance = ([x, y]) => Math.hypot(x - others[0][0], y - others[0][1]) || 1;
            camera.zoom(distance(before) / distance([event.clientX, event.clientY]));
            camera.move(dx / 2 / canvas.clientHeight, dy / 2 / canvas.clientHeight);
        } else if (event.shiftKey || event.buttons & 6) {
            camera.move(dx / canvas.clientHeight, dy / canvas.clientHeight);
        } else {
            camera.turn(dx / 150, dy / 150);
        }
        redraw();
    });
    for (const name of ["pointerup", "pointercancel"])
        canvas.addEventListener(name, event => {
            pointers.delete(event.pointerId);
            if (name === "pointerup" && event.button === 0 && moved < 5)
                pickAt(event.clientX, event.clientY);
        });
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("dblclick", lookCloser);
    canvas.addEventListener("wheel", event => { // a page that is scrolled past the view does not zoom it
        if (document.activeElement !== canvas && !event.ctrlKey)
            return;
        event.preventDefault();
        change(() => view.camera.zoom(Math.exp(Math.min(Math.max(event.deltaY, -200), 200) / 500)));
    }, { passive: false });
}

/* ---- Keys ---- */

const TURN = 0.1; // radians
const KEYS = {
    ArrowLeft: () => moveStep(-1),
    ArrowRight: () => moveStep(1),
    Home: () => goToPlace(0),
    End: () => goToPlace(steps.length - 1),
    "[": () => moveStage(-1),
    "]": () => moveStage(1),
    " ": play,
    n: () => moveMark(1),
    p: () => moveMark(-1),
    m: pickLargest,
    Escape: () => pickParticle(null),
    "+": () => change(() => view.camera.zoom(1 / 1.2)),
    "=": () => change(() => view.camera.zoom(1 / 1.2)),
    "-": () => change(() => view.camera.zoom(1.2)),
    c: lookCloser,
    r: resetView,
    "?": () => element("keys").showModal(),
    "/": () => element("keys").showModal(),
};
const TURNS = {
    ArrowLeft: [TURN, 0],
    ArrowRight: [-TURN, 0],
    ArrowUp: [0, TURN],
    ArrowDown: [0, -TURN],
};

/* Keys that the focused control needs itself are its own. */
function isOwn(target, key) {
    if (!(target instanceof Element))
        return false;
    if (target.matches("input[type=number], select, textarea"))
        return key !== "Escape";
    if (target.matches("input[type=range]"))
        return /^(Arrow|Home|End|Page)/.test(key);
    return key === " " && target.matches("button, a, summary, input");
}

function listenToKeys() {
    document.addEventListener("keydown", event => {
        if (event.ctrlKey || event.altKey || event.metaKey || element("keys").open)
            return;
        if (event.shiftKey && TURNS[event.key] && !isOwn(event.target, event.key)) {
            event.preventDefault();
            return change(() => view.camera.turn(...TURNS[event.key]));
        }
        const action = KEYS[event.key];
        if (!action || isOwn(event.target, event.key) || event.shiftKey && /^(Arrow|Home|End)/.test(event.key))
            return;
        event.preventDefault();
        action();
    });
}

/* ---- Controls ---- */

/* Marks under the step slider. Several at a place are one. The text says the same, so they are no stops of the tab key. */
function addTicks() {
    const kinds = ["failure", "sign", "difference", "command", "event"]; // the first of them gives a place its look
    for (const [place, marks] of groupMarks()) {
        const kind = kinds.find(name => marks.some(mark => mark.kind === name)) ?? "event";
        element("ticks").append(make("button", { type: "button", tabindex: -1, "aria-hidden": "true", class: `tick ${kind}`,
            title: marks.map(mark => `step ${mark.step}: ${mark.text}`).join("\n"),
            onclick: () => showMark(marks.find(mark => mark.kind === kind) ?? marks[0]),
            style: `left: ${steps.length > 1 ? 100 * place / (steps.length - 1) : 0}%` }));
    }
}

function groupMarks() {
    const places = new Map();
    for (const mark of meta.marks)
        places.set(placeOf(mark.step), [...places.get(placeOf(mark.step)) ?? [], mark]);
    return places;
}

function listenToControls() {
    const on = (id, name, action) => element(id).addEventListener(name, action);
    on("step", "input", () => goToPlace(Number(element("step").value)));
    on("stage", "input", () => {
        shown.frame = framesOf(frameShown().step)[Number(element("stage").value)].index;
        update();
    });
    on("first", "click", KEYS.Home);
    on("previous", "click", KEYS.ArrowLeft);
    on("next", "click", KEYS.ArrowRight);
    on("last", "click", KEYS.End);
    on("play", "click", play);
    on("mark", "click", KEYS.n);
    on("largest", "click", pickLargest);
    on("reset", "click", resetView);
    on("help", "click", KEYS["?"]);
    on("particle", "change", () => {
        const id = numberOf(element("particle").value);
        pickParticle(id);
        if (id !== null && !isThere())
            say(`There is no particle ${id} in this frame; it has ${frameShown().particles}.`);
    });
    on("colour", "change", () => {
        choose(Number(element("colour").value));
        update();
    });
    for (const id of ["range", "logarithmic", "alone"])
        on(id, "change", update);
    on("cut", "input", () => cutAt(Number(element("cut").value) / 100));
    dark.addEventListener("change", () => {
        takeColours();
        update();
    });
    window.addEventListener("hashchange", obeyAddress);
    new ResizeObserver(redraw).observe(element("canvas"));
    view.onrestored = update;
    // On a narrow screen the view is above the text, so a link scrolls back to it, also if it leads to the frame that is shown.
    document.querySelector(".document").addEventListener("click", event => {
        if (event.target.closest('a[href^="#step="]') && element("view").getBoundingClientRect().bottom < 100)
            element("view").scrollIntoView({ behavior: quiet.matches ? "auto" : "smooth" });
    });
}

/* ---- Begin ---- */

/* Without an address: where the story says that it begins, or at the first sign of something wrong, or at the first step. */
function beginning() {
    if (meta.begin)
        return meta.begin;
    const found = ["difference", "sign", "failure"].map(kind => meta.marks.find(mark => mark.kind === kind)).filter(mark => mark);
    return found.sort((a, b) => a.step - b.step)[0] ?? { step: steps[0], stage: null, particle: null };
}

element("step").max = steps.length - 1;
element("alone").closest("label").hidden = !meta.details.some(detail => detail.springs?.length);
element("mark").disabled = !meta.marks.length;
element("colour").append(...meta.quantities.map(({ label, meaning }, i) => make("option", { value: i, title: meaning }, label)));
choose(Math.max(meta.quantities.findIndex(({ name }) => name === (meta.other ? "divergence" : "speed")), 0));
element("fallback").hidden = view.works;
takeColours();
addTicks();
listenToControls();
listenToKeys();
listenToPointers(element("canvas"));
if (!obeyAddress())
    showMark(beginning());

/* For tests and the console. */
window.rheologReport = {
    frame: () => shown.frame,
    step: () => frameShown().step,
    stage: () => frameShown().stage,
    particle: () => shown.particle,
    works: () => view.works,
    pick: pickAt, // at a point of the window; picks nothing beside the particles
    /* The particle picked: its position and values, as the panel has them. */
    values: () => isThere() ? { position: pointAt(shown.particle), ...valuesOf(shown.frame, shown.particle) } : null,
    /* The line of sight through a point of the window. */
    ray: (x, y) => {
        const box = element("canvas").getBoundingClientRect();
        return view.ray(x - box.left, y - box.top);
    },
    /* Where a particle is in the window. */
    place: id => {
        const box = element("canvas").getBoundingClientRect();
        const place = view.place(pointAt(id));
        return { x: box.left + place.x, y: box.top + place.y };
    },
};
