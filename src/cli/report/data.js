/*
 * What the page holds: the description (report-meta) and the arrays (report-data, base64, little endian) that the C code wrote, as
 * frames with positions and values. Numbers and colours as text.
 */
const meta = JSON.parse(document.getElementById("report-meta").textContent);
const bytes = decode(document.getElementById("report-data"));

function decode(element) {
    const text = atob(element.textContent.trim());
    const array = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++)
        array[i] = text.charCodeAt(i);
    element.textContent = ""; // a third of the memory of the page
    return array.buffer;
}

/* ---- Frames ---- */

const ABSENT = 65535; // of a rounded number that is not finite
const LARGEST = 65534;

/* Numbers of the file from an offset, which need not be aligned. */
function numbers(offset, count) {
    const size = meta.exact ? 4 : 2;
    const part = bytes.slice(offset, offset + size * count);
    return meta.exact ? new Float32Array(part) : new Uint16Array(part);
}

/* Positions as x, y, z of each particle; NaN if not finite. Rounded ones leave out those far from the others, which are listed. */
function positions(frame) {
    const { offset, box, far } = frame.position;
    const from = numbers(offset, 3 * frame.particles);
    if (meta.exact)
        return from;
    const to = new Float32Array(from.length);
    for (let i = 0; i < from.length; i++) {
        const axis = i % 3;
        to[i] = from[i] === ABSENT ? NaN : box[axis] + from[i] / LARGEST * (box[axis + 3] - box[axis]);
    }
    for (const [index, ...point] of far ?? [])
        to.set(point, 3 * index);
    return to;
}

/* Coordinates are quantities, too. */
["x", "y", "z"].forEach((name, axis) => {
    meta.quantities.push({ name: `position.${name}`, label: `position.${name}`, unit: "L", meaning: "coordinate",
        min: meta.box[axis], max: meta.box[axis + 3] });
    for (const frame of meta.frames)
        frame.values.push({ axis });
});

/* The values of a quantity, one for each particle; null if the frame does not have them. */
function values(frame, quantity) {
    const known = frame.values[quantity];
    if (!known)
        return null;
    if (known.axis !== undefined)
        return positions(frame).filter((_, i) => i % 3 === known.axis);
    const from = numbers(known.offset, frame.particles);
    if (meta.exact)
        return from;
    const to = new Float32Array(from.length);
    for (let i = 0; i < from.length; i++)
        to[i] = from[i] === ABSENT ? NaN : known.min + from[i] / LARGEST * (known.max - known.min);
    for (const [index, number] of known.far ?? [])
        to[index] = number;
    return to;
}

/* A single value without reading the others. */
function valueAt(frame, quantity, index) {
    const known = frame.values[quantity];
    if (!known)
        return NaN;
    const { offset, min, max, far, place } = known.axis === undefined ? { ...known, place: index } :
        coordinate(frame, known.axis, index);
    const exact = far?.find(([other]) => other === index);
    if (exact)
        return exact[1 + (known.axis ?? 0)];
    const [number] = numbers(offset + (meta.exact ? 4 : 2) * place, 1);
    return meta.exact ? number : number === ABSENT ? NaN : min + number / LARGEST * (max - min);
}

/* Particles have the indices of their ids. Whether one is there: sources add some. */
function hasParticle(frame, id) {
    return id !== null && id >= 0 && id < frame.particles;
}

/* How a coordinate of a particle is stored. */
function coordinate(frame, axis, index) {
    const { offset, box, far } = frame.position;
    return { offset, far, place: 3 * index + axis, min: box?.[axis], max: box?.[axis + 3] };
}

function isFinitePoint(array, index) {
    return Number.isFinite(array[3 * index] + array[3 * index + 1] + array[3 * index + 2]);
}

/* ---- Steps and stages ---- */

const stageOrder = new Map(meta.stages.map((name, i) => [name, i]));
const steps = [...new Set(meta.frames.map(frame => frame.step))]; // those that have frames, ascending

/* The frames of a step, in order of stages, the end last. */
function framesOf(step) {
    return meta.frames.map((frame, index) => ({ frame, index })).filter(({ frame }) => frame.step === step)
        .sort((a, b) => rank(a.frame) - rank(b.frame));
}

function rank(frame) {
    return frame.stage === null ? Infinity : stageOrder.get(frame.stage) ?? 0;
}

/* Index of the frame of a step and stage, or of the nearest earlier one. Without a stage it is the end of the step. */
function findFrame(step, stage) {
    const known = [...steps].reverse().find(other => other <= step) ?? steps[0];
    const choices = framesOf(known);
    const exact = choices.find(({ frame }) => frame.stage === stage);
    const wanted = exact ?? (stage === null ? choices.at(-1) :
        [...choices].reverse().find(({ frame }) => rank(frame) <= rank({ stage })) ?? choices[0]);
    const last = stage === null && wanted === choices.at(-1); // a step that failed has no end
    return { index: wanted.index, exact: known === step && (!!exact || last) };
}

function timeOf(frame) {
    return frame.time ?? frame.step * meta.dt;
}

/* Index of a mark's frame in `steps`. */
function placeOf(step) {
    const place = steps.findLastIndex(other => other <= step);
    return Math.max(place, 0);
}

/* ---- Details ---- */

const details = new Map(meta.details.map(detail => [detail.frame + ":" + detail.particle, detail]));

function detailOf(frameIndex, id) {
    return details.get(frameIndex + ":" + id) ?? null;
}

/* The history ring of a particle. It changes at the end of a step only: before, it is that of the end of the step before. */
function pastOf(frameIndex, id) {
    for (let i = frameIndex; i >= 0 && meta.frames[i].step >= meta.frames[frameIndex].step - 1; i--) {
        const past = detailOf(i, id)?.past;
        if (past)
            return { ...past, step: meta.frames[i].step };
    }
    return null;
}

/* ---- Text ---- */

/* A number with at most so many significant digits, like %g of C. */
function brief(x, digits = 6) {
    if (x === null || x === undefined)
        return "unknown";
    if (!Number.isFinite(x))
        return "not finite";
    if (x === 0)
        return "0";
    const size = Math.abs(x);
    const text = size < 1e-4 || size >= 1e6 ? x.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e") :
        String(Number(x.toPrecision(digits)));
    return text.replaceAll("-", "\u2212");
}

/* A unit such as L/T^2 in the units of the recording, with small digits for powers. */
function unitText(unit) {
    if (!unit || unit === "1")
        return "";
    return unit.replace(/[A-Za-z]+/g, name => meta.units?.[{ L: "length", T: "time", M: "mass", K: "temperature" }[name]] ?? name)
        .replace(/\^(\d)(?!\d)/g, (all, digit) => "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[digit]);
}

function withUnit(x, unit, digits) {
    const text = unitText(unit);
    return brief(x, digits) + (text && Number.isFinite(x) ? " " + text : "");
}

/* ---- Colours ---- */

/* Viridis, at equal distances: it also has its order in grey, and for the colour-blind. */
const VIRIDIS = [[68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140], [34, 168, 132],
    [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37]];

function viridis(t) {
    const place = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1);
    const i = Math.min(Math.floor(place), VIRIDIS.length - 2);
    return VIRIDIS[i].map((from, channel) => from + (place - i) * (VIRIDIS[i + 1][channel] - from));
}

function viridisGradient() {
    return `linear-gradient(to right, ${VIRIDIS.map(rgb => `rgb(${rgb})`).join(", ")})`;
}
