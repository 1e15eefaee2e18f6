/*
 * Plots of a picked particle as SVG, with axes at round numbers and a legend; and elements of the page.
 */

/* ---- Elements ---- */

const SVG = "http://www.w3.org/2000/svg";

/* An element with attributes and children, which are elements or text. Attributes that begin with "on" are listeners. */
function make(name, attributes = {}, ...children) {
    return fill(document.createElement(name), attributes, children);
}

function draw(name, attributes = {}, ...children) {
    return fill(document.createElementNS(SVG, name), attributes, children);
}

function fill(element, attributes, children) {
    for (const [key, value] of Object.entries(attributes))
        if (key.startsWith("on"))
            element.addEventListener(key.slice(2), value);
        else if (value === true)
            element.setAttribute(key, "");
        else if (value !== false && value !== null && value !== undefined)
            element.setAttribute(key, value);
    element.append(...children.flat().filter(child => child !== null && child !== undefined));
    return element;
}

/* ---- Axes ---- */

/* Round numbers in a range, about `count` of them. */
function ticksOf(min, max, count) {
    const rough = (max - min) / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map(factor => factor * power).find(size => size >= rough);
    const ticks = [];
    for (let i = Math.ceil(min / step - 1e-9); i * step <= max + 1e-9 * step; i++)
        ticks.push(i * step);
    return ticks;
}

/* Powers of ten in a range, at most about `count`. */
function powersOf(min, max, count) {
    const first = Math.ceil(Math.log10(min) - 1e-9), last = Math.floor(Math.log10(max) + 1e-9);
    const every = Math.max(Math.ceil((last - first + 1) / count), 1);
    const ticks = [];
    for (let power = first; power <= last; power += every)
        ticks.push(10 ** power);
    return ticks;
}

/* An axis over numbers: its range, ticks, and the place of a number from 0 to 1. */
function axisOf(all, logarithmic, count) {
    let min = Infinity, max = -Infinity;
    for (const x of all)
        if (Number.isFinite(x) && (!logarithmic || x > 0)) {
            min = Math.min(min, x);
            max = Math.max(max, x);
        }
    if (min > max)
        [min, max] = logarithmic ? [0.1, 1] : [0, 1];
    if (logarithmic) {
        min = Math.max(min, max * 1e-12);
        const ticks = powersOf(min, max, count);
        if (min === max || ticks.length < 2)
            [min, max] = [10 ** Math.floor(Math.log10(min)), 10 ** Math.ceil(Math.log10(max * 1.0001))];
        return { ticks: powersOf(min, max, count), place: x => x > 0 ? Math.log(x / min) / Math.log(max / min) : NaN };
    }
    if (max - min <= 1e-7 * Math.max(Math.abs(min), Math.abs(max)) || min === max) {
        const around = Math.abs(min) || 1;
        min -= 0.1 * around;
        max += 0.1 * around;
    }
    return { ticks: ticksOf(min, max, count), place: x => (x - min) / (max - min) };
}

/* ---- Plots ---- */

const WIDTH = 460, HEIGHT = 190, LEFT = 62, RIGHT = 10, TOP = 12, BOTTOM = 36;

/*
 * A plot of curves {name, x, y} over each other. A number that is not finite leaves a gap. `at` is a place on the x axis that is
 * marked, and `onpick` gets the x of a click.
 */
function plot({ label, xLabel, yLabel, curves, logarithmic = false, at = null, onpick = null }) {
    const wide = WIDTH - LEFT - RIGHT, high = HEIGHT - TOP - BOTTOM;
    const xAxis = axisOf(curves.flatMap(curve => curve.x), false, 6);
    const yAxis = axisOf(curves.flatMap(curve => curve.y), logarithmic, 5);
    const toX = x => LEFT + wide * xAxis.place(x), toY = y => TOP + high * (1 - yAxis.place(y));
    const svg = draw("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label, class: "plot" });
    for (const y of yAxis.ticks)
        svg.append(draw("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: toY(y), y2: toY(y) }),
            draw("text", { x: LEFT - 6, y: toY(y) + 4, "text-anchor": "end" }, brief(y, 3)));
    for (const x of xAxis.ticks)
        svg.append(draw("line", { class: "grid", x1: toX(x), x2: toX(x), y1: TOP, y2: TOP + high }),
            draw("text", { x: toX(x), y: TOP + high + 14, "text-anchor": "middle" }, brief(x, 3)));
    svg.append(draw("text", { x: LEFT + wide / 2, y: HEIGHT - 5, "text-anchor": "middle" }, xLabel),
        draw("text", { x: 11, y: TOP + high / 2, "text-anchor": "middle", transform: `rotate(-90 11 ${TOP + high / 2})` }, yLabel));
    if (at !== null && Number.isFinite(toX(at)))
        svg.append(draw("line", { class: "at", x1: toX(at), x2: toX(at), y1: TOP, y2: TOP + high }));
    curves.forEach((curve, look) => {
        svg.append(draw("path", { class: `curve look${look}`, d: pathOf(curve, toX, toY) }));
        if (curve.x.length <= 60)
            curve.x.forEach((x, i) => {
                if (Number.isFinite(toY(curve.y[i])))
                    svg.append(draw("circle", { class: `point look${look}`, cx: toX(x).toFixed(1),
                        cy: toY(curve.y[i]).toFixed(1), r: 1.8 }));
            });
    });
    if (onpick)
        svg.addEventListener("click", event => {
            const box = svg.getBoundingClientRect();
            const place = ((event.clientX - box.left) / box.width * WIDTH - LEFT) / wide;
            const away = x => Math.abs(xAxis.place(x) - place);
            onpick(curves[0].x.reduce((best, x) => away(x) < away(best) ? x : best));
        });
    return svg;
}

function pathOf({ x, y }, toX, toY) {
    let path = "", pen = "M";
    for (let i = 0; i < x.length; i++) {
        const height = toY(y[i]);
        if (Number.isFinite(height)) {
            path += `${pen}${toX(x[i]).toFixed(1)} ${height.toFixed(1)}`;
            pen = "L";
        } else {
            pen = "M";
        }
    }
    return path;
}

/* Names of the curves of a plot, with their lines. */
function legend(curves) {
    return make("figcaption", { class: "legend" }, curves.map((curve, look) => make("span", {},
        draw("svg", { viewBox: "0 0 26 8", width: 26, height: 8, "aria-hidden": "true" },
            draw("path", { class: `curve look${look}`, d: "M0 4H26" })), " " + curve.name)));
}

/* A table of columns of numbers, folded. */
function dataTable(summary, columns) {
    const rows = columns[0].values.map((_, i) => make("tr", {}, columns.map(column => make("td", {}, brief(column.values[i])))));
    return make("details", {}, make("summary", {}, summary),
        make("div", { class: "scroll" }, make("table", {},
            make("thead", {}, make("tr", {}, columns.map(column => make("th", { scope: "col" }, column.name)))),
            make("tbody", {}, rows))));
}
