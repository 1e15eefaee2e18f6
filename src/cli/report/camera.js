/*
 * The camera turns about a point: directions, the two matrices of the view, and moving it. Matrices are in columns, as WebGL has
 * them. Y is up.
 */
const FIELD_OF_VIEW = 35 * Math.PI / 180; // from top to bottom
const STEEPEST = 1.5; // elevation in radians, so that up is never along the view

const add = (a, b) => a.map((x, i) => x + b[i]);
const scaled = (a, factor) => a.map(x => x * factor);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => scaled(a, 1 / Math.hypot(...a));

/* A camera that sees a box [minx, miny, minz, maxx, maxy, maxz]. */
class Camera {
    constructor(box) {
        this.box = box;
        this.reset();
    }

    reset() {
        const { box } = this;
        this.centre = [0, 1, 2].map(axis => (box[axis] + box[axis + 3]) / 2);
        this.radius = Math.hypot(...[0, 1, 2].map(axis => box[axis + 3] - box[axis])) / 2 || 1;
        this.azimuth = 0.6;
        this.elevation = 0.35;
        this.distance = 0.9 * this.radius / Math.sin(FIELD_OF_VIEW / 2);
    }

    /* Unit vectors: towards the eye, to the right and up. */
    directions() {
        const back = [Math.sin(this.azimuth) * Math.cos(this.elevation), Math.sin(this.elevation),
            Math.cos(this.azimuth) * Math.cos(this.elevation)];
        const right = unit(cross([0, 1, 0], back));
        return { back, right, up: cross(back, right) };
    }

    eye() {
        return add(this.centre, scaled(this.directions().back, this.distance));
    }

    /* World to view. */
    view() {
        const { back, right, up } = this.directions();
        const eye = this.eye();
        return new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
            -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
    }

    /* View to clip space. A narrow window sees the whole box, too. */
    projection(aspect) {
        const near = Math.max(this.distance - 6 * this.radius, this.distance / 100);
        const far = this.distance + 6 * this.radius;
        const f = Math.min(1, aspect) / Math.tan(FIELD_OF_VIEW / 2);
        return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0,
            2 * far * near / (near - far), 0]);
    }

    turn(dx, dy) {
        this.azimuth -= dx;
        this.elevation = Math.min(Math.max(this.elevation + dy, -STEEPEST), STEEPEST);
    }

    /* By parts of the height of the window. */
    move(dx, dy) {
        const height = 2 * this.distance * Math.tan(FIELD_OF_VIEW / 2);
        const { right, up } = this.directions();
        this.centre = add(this.centre, add(scaled(right, -dx * height), scaled(up, dy * height)));
    }

    zoom(factor) {
        this.distance = Math.min(Math.max(this.distance * factor, this.radius / 50), this.radius * 20);
    }

    /* Turns about a point from now on, at which it sees a ball of a radius. */
    lookAt(point, radius) {
        this.centre = point;
        this.distance = radius / Math.sin(FIELD_OF_VIEW / 2);
    }

    /* Where the depth of a point is between the nearest and the farthest corner of the box, from 0 to 1. */
    part(point) {
        const [near, far] = this.depths();
        const depth = dot(this.directions().back, add(this.eye(), scaled(point, -1)));
        return (depth - near) / (far - near);
    }

    /* Depths of the nearest and the farthest corner of the box, for the cut. */
    depths() {
        const { box, centre } = this;
        const { back } = this.directions();
        const depths = [0, 1, 2, 3, 4, 5, 6, 7].map(corner =>
            this.distance - dot(back, [0, 1, 2].map(axis => box[axis + (corner >> axis & 1) * 3] - centre[axis])));
        return [Math.min(...depths), Math.max(...depths)];
    }
}

/* A point as x, y of clip space, -1 to 1, and the depth in front of the eye. */
function project(view, projection, point) {
    const seen = [0, 1, 2].map(row => view[row] * point[0] + view[4 + row] * point[1] + view[8 + row] * point[2] + view[12 + row]);
    const depth = -seen[2];
    return { x: projection[0] * seen[0] / depth, y: projection[5] * seen[1] / depth, depth };
}
