// Programs of the graphics processor.

/** Texels in a row of a table: a power of two, so that no integer is divided. */
export const ROW = 2048;

/** Most isolines. */
export const LEVELS = 24;

export const VERTEX = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform sampler2D elements;
uniform sampler2D vertices;
uniform vec3 size;
in vec4 position;
in uint element;
in uint vertex;
flat out vec3 elementColour;
flat out float state;
out vec3 vertexColour;
out float scalar;
out vec3 distances;

vec4 entry(sampler2D table, uint index) {
  return texelFetch(table, ivec2(int(index & ${ROW - 1}u), int(index >> ${Math.log2(ROW)}u)), 0);
}

void main() {
  vec4 own = entry(elements, element);
  vec4 shared_ = entry(vertices, vertex);
  elementColour = own.rgb;
  state = own.a;
  vertexColour = shared_.rgb;
  scalar = shared_.a;
  int code = int(position.w * 65535.0 + 0.5);
  int corner = code & 3;
  int inner = code >> 2;
  // The distance from a side within the element counts as 1 everywhere: no line is drawn along it.
  distances = vec3(corner == 0, corner == 1, corner == 2);
  for (int i = 0; i < 3; i++) if ((inner & (1 << i)) != 0) distances[i] = 1.0;
  vec3 metres = (position.xyz - 0.5) * size;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(metres, 1.0);
  // What is hidden lies outside of what is seen.
  if (state < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

export const FRAGMENT = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
flat in vec3 elementColour;
flat in float state;
in vec3 vertexColour;
in float scalar;
in vec3 distances;
uniform bool appearance;
uniform bool smoothed;
uniform bool bothSides;
uniform bool meshLines;
uniform bool logarithmic;
uniform float exposure;
uniform vec2 range;
uniform float pixel;
uniform int levelCount;
uniform float levels[${LEVELS}];
uniform sampler2D map;
uniform vec3 back;
uniform vec3 accent;
out vec4 result;

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);
const float WHITE = 4.0;

// The tone of the pictures: Reinhard's curve, hue kept, then the curve of sRGB.
vec3 display(vec3 colour) {
  colour = max(colour, 0.0) * exposure;
  float bright = dot(LUMINANCE, colour);
  if (bright <= 0.0) return vec3(0.0);
  float target = bright >= WHITE ? 1.0 : bright * (1.0 + bright / (WHITE * WHITE)) / (1.0 + bright);
  colour *= target / bright;
  float largest = max(colour.r, max(colour.g, colour.b));
  if (largest > 1.0) colour = target + (1.0 - target) / (largest - target + 1e-6) * (colour - target);
  colour = clamp(colour, 0.0, 1.0);
  return mix(12.92 * colour, 1.055 * pow(colour, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, colour));
}

float scaled(float value) {
  return logarithmic ? log(max(value, 1e-37)) : value;
}

float line(float distance, float width) {
  float change = fwidth(distance);
  return change > 0.0 ? 1.0 - smoothstep(0.5 * width - 0.5, 0.5 * width + 0.5, distance / change) : 0.0;
}

void main() {
  float value = smoothed ? scalar : elementColour.r;
  vec3 colour;
  bool front = gl_FrontFacing || bothSides;
  if (!front) {
    colour = back;
  } else if (appearance) {
    colour = display(smoothed ? vertexColour : elementColour);
  } else if (!(value > -1e37 && value < 1e37)) {
    colour = mix(back, vec3(0.5), step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / (8.0 * pixel))));
  } else {
    float t = (scaled(value) - scaled(range.x)) / (scaled(range.y) - scaled(range.x));
    colour = texture(map, vec2((clamp(t, 0.0, 1.0) * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  }
  vec3 ink = dot(LUMINANCE, colour) > 0.4 ? vec3(0.0) : vec3(1.0);
  float steepness = fwidth(scaled(scalar));
  if (front && steepness > 0.0) {
    for (int i = 0; i < levelCount; i++) {
      float away = abs(scaled(scalar) - scaled(levels[i])) / steepness;
      colour = mix(colour, ink, 0.85 * (1.0 - smoothstep(0.4 * pixel, 0.4 * pixel + 1.0, away)));
    }
  }
  float edge = max(line(distances.x, pixel), max(line(distances.y, pixel), line(distances.z, pixel)));
  if (meshLines) colour = mix(colour, ink, 0.28 * edge);
  if (state > 1.5) {
    float wide = 5.0 * pixel;
    float rim = max(line(distances.x, wide), max(line(distances.y, wide), line(distances.z, wide)));
    colour = mix(mix(colour, accent, 0.18), accent, rim);
  }
  result = vec4(colour, 1.0);
}`;
