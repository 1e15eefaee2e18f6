/*
 * Programs of the graphics processor. A sphere is drawn as a square in front of it; each of its pixels finds where its ray
 * meets the sphere, so that spheres are round at any size and hide each other correctly.
 */
const HEADER = `#version 300 es
precision highp float;
uniform mat4 view, projection;
`;

/* The square just covers the sphere, which seen from near is wider than its radius. */
const SPHERE_VERTEX = `
in vec2 corner;
out vec3 ray;
flat out vec3 centre;
flat out float size;
void place(vec3 position, float radius) {
    centre = (view * vec4(position, 1)).xyz;
    size = radius;
    float distance = length(centre);
    vec3 away = centre / distance;
    vec3 right = normalize(cross(away, vec3(0, 1, 0)));
    float reach = radius * distance / sqrt(max(distance * distance - radius * radius, radius * radius * 0.01));
    ray = centre + reach * (corner.x * right + corner.y * cross(right, away));
    gl_Position = projection * vec4(ray, 1);
}
`;

const SPHERE_FRAGMENT = `
in vec3 ray;
flat in vec3 centre;
flat in float size;
/* Where the ray of this pixel meets the sphere, in view space. */
vec3 meet() {
    vec3 direction = normalize(ray);
    float middle = dot(direction, centre);
    float rest = middle * middle - dot(centre, centre) + size * size;
    if (rest < 0.0)
        discard;
    vec3 point = direction * (middle - sqrt(rest));
    if (point.z >= 0.0)
        discard;
    vec4 clip = projection * vec4(point, 1);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
    return point;
}
/* Light from above the shoulder, and a dark rim that sets a sphere off from those behind it. */
vec3 lit(vec3 colour, vec3 normal, float facing) {
    float light = 0.62 + 0.38 * max(dot(normal, normalize(vec3(-0.35, 0.6, 0.7))), 0.0);
    return colour * light * mix(0.45, 1.0, smoothstep(0.0, 0.42, facing));
}
`;

const MASK = `
const float HIDDEN = 0.0, PARTNER = 2.0, PICKED = 3.0;
`;

/* A value is 0 to 1 along the scale, or negative: unknown or not finite. */
const PARTICLES = {
    vertex: HEADER + MASK + SPHERE_VERTEX + `
in vec3 position;
in float value;
in float mask;
uniform float radius, cut;
flat out float shade;
flat out float role;
flat out int index;
void main() {
    shade = value;
    role = mask;
    index = gl_InstanceID;
    place(position, mask == PICKED ? 1.25 * radius : radius);
    if (mask == HIDDEN || (-centre.z < cut && mask != PICKED))
        gl_Position = vec4(0, 0, 2, 1);
}`,
    fragment: HEADER + MASK + SPHERE_FRAGMENT + `
flat in float shade;
flat in float role;
flat in int index;
uniform vec3 colours[11];
uniform vec3 unknown, accent;
uniform bool asId;
out vec4 colour;
vec3 scale(float t) {
    float place = clamp(t, 0.0, 1.0) * 10.0;
    int i = min(int(place), 9);
    return mix(colours[i], colours[i + 1], place - float(i));
}
void main() {
    vec3 point = meet();
    if (asId) {
        int id = index + 1;
        colour = vec4(id & 255, id >> 8 & 255, id >> 16 & 255, 255) / 255.0;
        return;
    }
    vec3 normal = (point - centre) / size;
    float facing = dot(normal, -normalize(point));
    vec3 plain = shade < 0.0 ? unknown : scale(shade);
    vec3 shown = lit(plain, normal, facing);
    if (role == PICKED && facing < 0.55)
        shown = accent;
    else if (role == PARTNER && facing < 0.3)
        shown = vec3(1);
    colour = vec4(shown, 1);
}`,
    attributes: ["corner", "position", "value", "mask"],
};

/* Balls have eight panels, so that one sees them turn. */
const BALL = {
    vertex: HEADER + SPHERE_VERTEX + `
uniform vec3 position;
uniform float radius;
void main() { place(position, radius); }`,
    fragment: HEADER + SPHERE_FRAGMENT + `
uniform mat3 turn; // from view to the ball
uniform vec3 panels[2];
uniform float cut;
uniform bool asId;
out vec4 colour;
void main() {
    vec3 point = meet();
    if (-point.z < cut)
        discard;
    if (asId) {
        colour = vec4(0);
        return;
    }
    vec3 normal = (point - centre) / size;
    vec3 side = turn * normal;
    float edge = side.x * side.y * side.z;
    float blend = smoothstep(-0.004, 0.004, edge);
    colour = vec4(lit(mix(panels[0], panels[1], blend), normal, dot(normal, -normalize(point))), 1);
}`,
    attributes: ["corner"],
};

/* Lines of a width in pixels, with soft edges: springs and marks. The first coordinate of a corner is the end of the line. */
const LINES = {
    vertex: HEADER + `
in vec2 corner;
in vec3 from, to;
in vec4 tint;
uniform vec2 pixel; // size of a pixel in clip space
uniform float width;
out vec4 shade;
out float side;
void main() {
    side = corner.y;
    vec4 a = projection * view * vec4(from, 1), b = projection * view * vec4(to, 1);
    vec2 along = normalize((b.xy / b.w - a.xy / a.w) / pixel + vec2(1e-6, 0));
    vec4 end = corner.x < 0.0 ? a : b;
    end.xy += vec2(-along.y, along.x) * corner.y * width * 0.5 * pixel * end.w;
    gl_Position = a.w > 0.0 && b.w > 0.0 ? end : vec4(0, 0, 2, 1);
    shade = tint;
}`,
    fragment: HEADER + `
in vec4 shade;
in float side;
out vec4 colour;
void main() {
    float alpha = shade.a * (1.0 - smoothstep(0.5, 1.0, abs(side)));
    colour = vec4(shade.rgb * alpha, alpha);
}`,
    attributes: ["corner", "from", "to", "tint"],
};

/* A floor or wall: a grid that fades out. */
const FLOOR = {
    vertex: HEADER + `
in vec2 corner;
uniform vec3 origin, across, along;
uniform float reach;
out vec2 place;
void main() {
    place = corner * reach;
    gl_Position = projection * view * vec4(origin + place.x * across + place.y * along, 1);
}`,
    fragment: HEADER + `
in vec2 place;
uniform vec4 tint;
uniform float cell, reach;
out vec4 colour;
void main() {
    vec2 step = fwidth(place / cell);
    vec2 lines = 1.0 - smoothstep(vec2(0), 1.5 * step, abs(fract(place / cell - 0.5) - 0.5));
    lines *= 1.0 - smoothstep(0.15, 0.6, step); // finer than the pixels: no lines
    float alpha = (0.12 + 0.55 * max(lines.x, lines.y)) * tint.a * (1.0 - smoothstep(0.55, 1.0, length(place) / reach));
    colour = vec4(tint.rgb * alpha, alpha);
}`,
    attributes: ["corner"],
};
