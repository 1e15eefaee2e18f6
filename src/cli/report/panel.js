/*
 * The panel of the picked particle: its values, its colour over the frames, its history ring, its springs, and the command that
 * prints the rest.
 */

/* The springs of a detail, the most stretched first. */
function springsOf(detail) {
    return (detail?.springs ?? []).map(spring => ({ ...spring, stretch: spring.stretch ?? spring.length / spring.rest_length - 1 }))
        .sort((a, b) => size(b.stretch) - size(a.stretch));
}

function size(x) {
    return Number.isFinite(x) ? Math.abs(x) : Infinity; // what is not finite comes first
}

/* Rounding to 16 bits makes 23.0002 of a number of neighbours. */
function wholeIfCount(quantity, number) {
    return quantity.count ? Math.round(number) : number;
}

/* Names that stand for the length of a vector. */
const lengths = new Set(Object.keys(meta.details[0]?.values ?? {}).filter(name => name.endsWith(".x"))
    .map(name => name.slice(0, -2)));

/* The values of a particle in a frame by name, exact if the page has its details. */
function valuesOf(frameIndex, id) {
    const frame = meta.frames[frameIndex];
    const detail = detailOf(frameIndex, id);
    const found = {};
    meta.quantities.forEach((quantity, i) => {
        if (frame.values[i])
            found[quantity.name] = wholeIfCount(quantity, valueAt(frame, i, id));
    });
    return { ...found, ...detail?.values };
}

function unitOf(name) {
    return meta.quantities.find(quantity => quantity.name === name)?.unit ?? meta.detail_units?.[name] ??
        meta.detail_units?.[name.replace(/\.[xyz]$/, "")] ?? "";
}

function meaningOf(name) {
    return meta.quantities.find(quantity => quantity.name === name || quantity.name === name + ".x")?.meaning ?? null;
}

function labelOf(name) {
    return meta.quantities.find(quantity => quantity.name === name)?.label ?? name.replaceAll("_", " ");
}

class Panel {
    constructor(element, { pick, show, near, close }) {
        this.element = element;
        this.actions = { pick, show, near, close };
        this.open = new Set(); // folded parts that the reader has opened
    }

    hide() {
        this.element.hidden = true;
        this.element.replaceChildren();
    }

    /* Shows a particle; the page calls it again for every frame. */
    show({ frameIndex, id, there, quantity, logarithmic }) {
        const { element, actions } = this;
        const frame = meta.frames[frameIndex];
        const focused = element.contains(document.activeElement) ? document.activeElement.dataset.name ?? "title" : null;
        const { scrollTop } = element;
        element.hidden = false;
        element.replaceChildren(
            make("div", { class: "panel-head" },
                make("h2", { tabindex: -1, "data-name": "title" }, `Particle ${id}`),
                make("span", {}, `step ${frame.step}, ${frame.stage ? "after stage " + frame.stage : "end"}`),
                there && view.works ? make("button", { type: "button", "data-name": "near", title: "Look at it from near (c)",
                    onclick: actions.near }, "look closer") : "",
                make("button", { type: "button", class: "close", "data-name": "close", "aria-label": "Close: pick nothing",
                    onclick: actions.close }, "\u00d7")),
            ...(there ? this.parts({ frameIndex, frame, id, quantity, logarithmic }) :
                [make("p", {}, "This particle is not there in this frame.")]));
        element.scrollTop = scrollTop;
        for (const details of element.querySelectorAll("details")) {
            const name = details.firstChild.textContent;
            details.open = this.open.has(name);
            details.addEventListener("toggle", () => details.open ? this.open.add(name) : this.open.delete(name));
        }
        if (focused)
            element.querySelector(`[data-name="${CSS.escape(focused)}"]`)?.focus({ preventScroll: true });
    }

    parts({ frameIndex, frame, id, quantity, logarithmic }) {
        const detail = detailOf(frameIndex, id);
        return [
            this.valueTable(frameIndex, id, detail),
            this.overTime(frame, id, quantity, logarithmic),
            this.past(frameIndex, id),
            detail ? this.springTable(detail) : null,
            this.command(frame, id, detail),
        ].filter(part => part);
    }

    /* Rows of a name, a number or vector, and its unit. */
    valueTable(frameIndex, id, detail) {
        const all = valuesOf(frameIndex, id);
        const rows = new Map();
        rows.set("position", { numbers: ["x", "y", "z"].map(axis => all["position." + axis]), unit: "L" });
        for (const [name, number] of Object.entries(all)) {
            const [, base, axis] = name.match(/^(.*)\.([xyz])$/) ?? [null, lengths.has(name) ? `|${name}|` : name, null];
            if (base === "position")
                continue;
            if (!rows.has(base))
                rows.set(base, { numbers: [], unit: unitOf(name) });
            rows.get(base).numbers.push(number);
        }
        const rounded = !meta.exact && !detail;
        return make("div", { class: "scroll" },
            make("table", { class: "values" }, make("tbody", {}, [...rows].map(([name, { numbers, unit }]) => make("tr", {},
                make("th", { scope: "row", title: meaningOf(name) }, labelOf(name)),
                make("td", { class: numbers.every(Number.isFinite) ? null : "bad" },
                    name === "material" && meta.materials?.[numbers[0]] || numbers.map(x => brief(x)).join(", ")),
                make("td", {}, unitText(unit)))))),
            rounded ? make("p", { class: "small" }, "Rounded to 1/65534 of the range of the frame.") : null);
    }

    /* The quantity that is coloured, at the ends of all steps that have frames; a click goes there. */
    overTime(frame, id, quantity, logarithmic) {
        const x = [], y = [];
        for (const other of meta.frames)
            if (other.stage === null && other.values[quantity]) {
                x.push(other.step);
                y.push(hasParticle(other, id) ? valueAt(other, quantity, id) : NaN);
            }
        if (x.length < 2)
            return null;
        const { label, unit } = meta.quantities[quantity];
        const unitPart = unitText(unit) ? ", " + unitText(unit) : "";
        return make("figure", {},
            plot({ label: `${label} of particle ${id} over the steps`, xLabel: "step", yLabel: label + unitPart, curves: [{ x, y }],
                logarithmic: logarithmic && y.some(value => value > 0), at: frame.step, onpick: step => this.actions.show(step) }),
            dataTable(`${label} over the steps`, [{ name: "step", values: x }, { name: label + unitPart, values: y }]));
    }

    /* The velocities that the particle remembers, the newest at age 0. */
    past(frameIndex, id) {
        const past = pastOf(frameIndex, id);
        if (!past)
            return null;
        const { age, velocity, rows, step } = past;
        const curves = [
            { name: "|v|", x: age, y: velocity.map(v => Math.hypot(...v)) },
            ...["x", "y", "z"].map((axis, i) => ({ name: `v.${axis}`, x: age, y: velocity.map(v => v[i]) })),
        ];
        const unitPart = unitText("L/T") ? ", " + unitText("L/T") : "";
        const agePart = unitText("T") ? ", " + unitText("T") : "";
        return make("figure", {},
            make("h3", {}, `History ring at the end of step ${step}`,
                rows > age.length ? `, ${age.length} of ${rows} rows` : ""),
            plot({ label: `Velocities that particle ${id} remembers`, xLabel: "age" + agePart, yLabel: "velocity" + unitPart,
                curves }),
            legend(curves),
            dataTable("Velocities in the history ring",
                [{ name: "age", values: age }, ...curves.map(({ name, y }) => ({ name, values: y }))]));
    }

    springTable(detail) {
        const springs = springsOf(detail);
        if (!springs.length)
            return make("p", {}, "It has no springs.");
        const columns = ["length", "rest_length", "stretch", ...Object.keys(springs[0]).filter(name =>
            !["other", "length", "rest_length", "stretch"].includes(name))];
        return make("div", {},
            make("h3", {}, `${springs.length} springs, the most stretched first`),
            make("p", { class: "legend" }, make("span", {}, make("i", { class: "swatch long" }), "longer than at rest"),
                make("span", {}, make("i", { class: "swatch short" }), "shorter")),
            make("div", { class: "scroll" }, make("table", { class: "springs" },
                make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "to"),
                    columns.map(name => make("th", { scope: "col" }, name.replaceAll("_", " "))))),
                make("tbody", {}, springs.map(spring => make("tr", {},
                    make("td", {}, make("button", { type: "button", class: "link", "data-name": `spring-${spring.other}`,
                        onclick: () => this.actions.pick(spring.other) }, String(spring.other))),
                    columns.map(name => make("td", {}, brief(spring[name], 5)))))))));
    }

    command(frame, id, detail) {
        const stage = frame.stage ? ` --stage ${frame.stage}` : "";
        return make("p", { class: "small" },
            detail ? "The same, with its neighbours: " : "Springs and history of this particle are not on this page: ",
            make("code", {}, `rheolog inspect ${meta.name} --step ${frame.step}${stage} --particle ${id}`));
    }
}
