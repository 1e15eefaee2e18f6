/*
 * The view of a frame in WebGL2: particles as spheres, springs of the picked one, balls, floors, and which particle is at a point.
 * Nothing is drawn before draw() is called; the page calls it when something has changed.
 */
const FAR = 1e30;
const HIDDEN = 0, SHOWN = 1, PARTNER = 2, PICKED = 3; // of the mask

class View {
    constructor(canvas, box) {
        this.canvas = canvas;
        this.camera = new Camera(box);
        this.cut = 0; // part of the depth that is cut away
        this.alone = false; // nothing is shown but the picked particle and its partners, so they are not cut away
        this.gl = canvas.getContext("webgl2", { alpha: true, antialias: false, depth: true, premultipliedAlpha: true });
        this.works = !!this.gl;
        if (!this.works)
            return;
        this.begin();
        canvas.addEventListener("webglcontextlost", event => event.preventDefault());
        canvas.addEventListener("webglcontextrestored", () => {
            this.begin();
            this.onrestored?.();
        });
    }

    begin() {
        const { gl } = this;
        this.programs = { particles: this.link(PARTICLES), ball: this.link(BALL), lines: this.link(LINES),
            floor: this.link(FLOOR) };
        const corners = this.buffer(new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]));
        this.arrays = {};
        this.buffers = {};
        const layouts = {
            particles: { position: [3, gl.FLOAT], value: [1, gl.FLOAT], mask: [1, gl.UNSIGNED_BYTE] },
            lines: { from: [3, gl.FLOAT], to: [3, gl.FLOAT], tint: [4, gl.FLOAT] },
            square: {},
        };
        for (const [name, layout] of Object.entries(layouts)) {
            const program = this.programs[name] ?? this.programs.floor;
            gl.bindVertexArray(this.arrays[name] = gl.createVertexArray());
            this.attribute(program.attribute.corner, corners, 2, gl.FLOAT, 0);
            this.buffers[name] = {};
            for (const [attribute, [count, type]] of Object.entries(layout)) {
                const buffer = this.buffers[name][attribute] = gl.createBuffer();
                this.attribute(program.attribute[attribute], buffer, count, type, 1);
            }
        }
        gl.bindVertexArray(null);
        this.ids = { frame: gl.createFramebuffer(), colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer(), width: 0,
            height: 0 };
        this.lineCount = 0;
        this.count = 0;
    }

    link({ vertex, fragment, attributes }) {
        const { gl } = this;
        const program = gl.createProgram();
        for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost())
                throw new Error(gl.getShaderInfoLog(shader));
            gl.attachShader(program, shader);
        }
        attributes.forEach((name, place) => gl.bindAttribLocation(program, place, name));
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
            throw new Error(gl.getProgramInfoLog(program));
        const uniforms = {};
        return {
            program,
            attribute: Object.fromEntries(attributes.map((name, place) => [name, place])),
            uniform: name => uniforms[name] ??= gl.getUniformLocation(program, name),
        };
    }

    buffer(array) {
        const { gl } = this;
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
        return buffer;
    }

    attribute(place, buffer, count, type, divisor) {
        const { gl } = this;
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, count, type, false, 0, 0);
        gl.vertexAttribDivisor(place, divisor);
    }

    upload(name, arrays) {
        const { gl } = this;
        for (const [attribute, array] of Object.entries(arrays)) {
            gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name][attribute]);
            gl.bufferData(gl.ARRAY_BUFFER, array, gl.DYNAMIC_DRAW);
        }
    }

    /* ---- What is drawn ---- */

    /* Positions, values along the scale (negative: not finite) and masks of all particles, and the balls. */
    setFrame({ positions, shades, masks, balls }) {
        this.balls = balls;
        this.positions = positions;
        this.count = shades.length;
        const finite = new Float32Array(positions);
        const shown = new Uint8Array(masks);
        for (let i = 0; i < this.count; i++)
            if (!isFinitePoint(positions, i)) {
                finite.fill(0, 3 * i, 3 * i + 3);
                shown[i] = HIDDEN;
            }
        if (this.works)
            this.upload("particles", { position: finite, value: shades, mask: shown });
    }

    /* Lines with ends and a colour with opacity. */
    setLines(lines) {
        this.lineCount = lines.length;
        if (this.works)
            this.upload("lines", {
                from: new Float32Array(lines.flatMap(line => line.from)),
                to: new Float32Array(lines.flatMap(line => line.to)),
                tint: new Float32Array(lines.flatMap(line => line.tint)),
            });
    }

    setColours({ unknown, accent, floor, panels }) {
        this.colours = { unknown, accent, floor, panels };
    }

    /* ---- Drawing ---- */

    resize() {
        const ratio = Math.min(window.devicePixelRatio || 1, 2);
        const width = Math.max(Math.round(this.canvas.clientWidth * ratio), 1);
        const height = Math.max(Math.round(this.canvas.clientHeight * ratio), 1);
        if (this.canvas.width !== width || this.canvas.height !== height) {
            this.canvas.width = width;
            this.canvas.height = height;
        }
        this.ratio = ratio;
    }

    matrices() {
        const { camera, canvas } = this;
        return { view: camera.view(), projection: camera.projection(canvas.clientWidth / Math.max(canvas.clientHeight, 1)) };
    }

    draw() {
        if (!this.works || this.gl.isContextLost())
            return;
        const { gl, canvas } = this;
        this.resize();
        this.at = this.matrices();
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        this.drawSpheres(false);
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        this.drawFloors();
        this.drawLines();
        gl.disable(gl.BLEND);
    }

    use(name) {
        const { gl } = this;
        const { program, uniform } = this.programs[name];
        gl.useProgram(program);
        gl.uniformMatrix4fv(uniform("view"), false, this.at.view);
        gl.uniformMatrix4fv(uniform("projection"), false, this.at.projection);
        return uniform;
    }

    /* The depth up to which all is cut away. */
    cutDepth() {
        const [near, far] = this.camera.depths();
        return this.cut > 0 ? near + this.cut * (far - near) : -FAR;
    }

    drawSpheres(asId) {
        const { gl } = this;
        gl.enable(gl.DEPTH_TEST);
        gl.depthMask(true);
        let uniform = this.use("particles");
        gl.uniform1f(uniform("radius"), meta.radius);
        gl.uniform1f(uniform("cut"), this.alone ? -FAR : this.cutDepth());
        gl.uniform1i(uniform("asId"), asId ? 1 : 0);
        gl.uniform3fv(uniform("colours"), VIRIDIS.flat().map(x => x / 255));
        gl.uniform3fv(uniform("unknown"), this.colours.unknown);
        gl.uniform3fv(uniform("accent"), this.colours.accent);
        gl.bindVertexArray(this.arrays.particles);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.count);
        uniform = this.use("ball");
        gl.uniform3fv(uniform("panels"), this.colours.panels.flat());
        gl.uniform1f(uniform("cut"), this.cutDepth());
        gl.uniform1i(uniform("asId"), asId ? 1 : 0);
        gl.bindVertexArray(this.arrays.square);
        for (const ball of this.balls) {
            gl.uniform3fv(uniform("position"), ball.position);
            gl.uniform1f(uniform("radius"), ball.radius);
            gl.uniformMatrix3fv(uniform("turn"), false, this.turnOf(ball.rotation));
            gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
        }
        gl.bindVertexArray(null);
    }

    /* From directions of the view to those of a ball: its rotation and the view's, both turned back. */
    turnOf([w, x, y, z]) {
        const { view } = this.at;
        const columns = [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]]; // of the rotation, ball to world
        const turn = new Float32Array(9);
        for (let row = 0; row < 3; row++)
            for (let column = 0; column < 3; column++)
                turn[3 * column + row] = dot(columns[row], [view[column], view[4 + column], view[8 + column]]);
        return turn;
    }

    /* Walls that one sees from the side of the fluid. */
    drawFloors() {
        const { gl, camera } = this;
        const { box, spacing } = meta;
        const uniform = this.use("floor");
        const size = Math.max(box[3] - box[0], box[4] - box[1], box[5] - box[2]);
        const cell = spacing * 2 ** Math.max(Math.round(Math.log2(size / 12 / spacing)), 0);
        gl.depthMask(false);
        gl.bindVertexArray(this.arrays.square);
        for (const wall of meta.walls) {
            const normal = unit(wall.normal);
            const height = dot(normal, add(camera.eye(), scaled(wall.point, -1)));
            if (height <= 0)
                continue;
            const middle = [0, 1, 2].map(axis => (box[axis] + box[axis + 3]) / 2);
            const over = dot(normal, add(middle, scaled(wall.point, -1)));
            const across = unit(cross(normal, Math.abs(normal[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1]));
            gl.uniform3fv(uniform("origin"), add(middle, scaled(normal, -over - 0.5 * meta.radius)));
            gl.uniform3fv(uniform("across"), across);
            gl.uniform3fv(uniform("along"), cross(normal, across));
            gl.uniform1f(uniform("reach"), 0.9 * size);
            gl.uniform1f(uniform("cell"), cell);
            gl.uniform4fv(uniform("tint"), [...this.colours.floor, Math.abs(normal[1]) > 0.5 ? 1 : 0.35]);
            gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
        }
        gl.bindVertexArray(null);
        gl.depthMask(true);
    }

    /* Springs lie between particles, so they are drawn over them. */
    drawLines() {
        const { gl, canvas } = this;
        if (!this.lineCount)
            return;
        const uniform = this.use("lines");
        gl.disable(gl.DEPTH_TEST);
        gl.uniform2fv(uniform("pixel"), [2 / canvas.width, 2 / canvas.height]);
        gl.uniform1f(uniform("width"), 4 * this.ratio);
        gl.bindVertexArray(this.arrays.lines);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.lineCount);
        gl.bindVertexArray(null);
        gl.enable(gl.DEPTH_TEST);
    }

    /* ---- Points of the canvas ---- */

    /* Index of the particle at a point in CSS pixels of the canvas; -1: none. All are drawn once more with numbers for colours. */
    pick(x, y) {
        if (!this.works || this.gl.isContextLost())
            return -1;
        const { gl, canvas, ids } = this;
        this.resize();
        this.at = this.matrices();
        gl.bindFramebuffer(gl.FRAMEBUFFER, ids.frame);
        if (ids.width !== canvas.width || ids.height !== canvas.height) {
            ids.width = canvas.width;
            ids.height = canvas.height;
            for (const [buffer, format, place] of [[ids.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0],
                [ids.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
                gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
                gl.renderbufferStorage(gl.RENDERBUFFER, format, canvas.width, canvas.height);
                gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
            }
        }
        const left = Math.floor(x * this.ratio), bottom = canvas.height - 1 - Math.floor(y * this.ratio);
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.enable(gl.SCISSOR_TEST);
        gl.scissor(left, bottom, 1, 1);
        gl.clearColor(0, 0, 0, 0);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        this.drawSpheres(true);
        const pixel = new Uint8Array(4);
        gl.readPixels(left, bottom, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        gl.disable(gl.SCISSOR_TEST);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        return (pixel[0] | pixel[1] << 8 | pixel[2] << 16) - 1;
    }

    /* The line of sight through a point of the canvas in CSS pixels, from the eye. */
    ray(x, y) {
        const { camera, canvas } = this;
        const { back, right, up } = camera.directions();
        const high = Math.tan(FIELD_OF_VIEW / 2) * Math.max(1, canvas.clientHeight / canvas.clientWidth);
        const wide = high * canvas.clientWidth / canvas.clientHeight;
        const across = (2 * x / canvas.clientWidth - 1) * wide, over = (1 - 2 * y / canvas.clientHeight) * high;
        return { eye: camera.eye(), direction: unit(add(add(scaled(right, across), scaled(up, over)), scaled(back, -1))) };
    }

    /* Where a point of the world is on the canvas, in CSS pixels; null if it is behind the eye. */
    place(point) {
        const { view, projection } = this.matrices();
        const { x, y, depth } = project(view, projection, point);
        if (!(depth > 0))
            return null;
        return { x: (1 + x) / 2 * this.canvas.clientWidth, y: (1 - y) / 2 * this.canvas.clientHeight, depth };
    }
}
