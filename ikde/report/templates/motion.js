// Motions that play, drawn as on a plan, in mm: from the side, right of it from the front, and below it from above.
const PAD = 14, LABEL = 20, TALLEST = 620;
const VIEWS = [
  {name: "side: x, z", flat: (p) => [p[0], p[2]], depth: (p) => -p[1], column: 0, row: 0},
  {name: "front: y, z", flat: (p) => [p[1], p[2]], depth: (p) => p[0], column: 1, row: 0},
  {name: "top: x, y", flat: (p) => [p[0], p[1]], depth: (p) => p[2], column: 0, row: 1},
];
function boxOf(motion, flat) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  const add = (p, r) => {
    const [u, v] = flat(p);
    box[0] = Math.min(box[0], u - r); box[1] = Math.min(box[1], v - r);
    box[2] = Math.max(box[2], u + r); box[3] = Math.max(box[3], v + r);
  };
  motion.path_mm.forEach((p) => add(p, 20));
  motion.links_mm.flat().forEach((p) => add(p, 20));
  motion.centres_mm.forEach((row) => row.forEach((p, s) => add(p, motion.radii_mm[s])));
  return box;
}
// One scale for all views; those of a column share x, those of a row share z.
function layOut(motion, width) {
  const boxes = VIEWS.map((view) => boxOf(motion, view.flat));
  const [x, y, z] = [boxes[0][2] - boxes[0][0], boxes[1][2] - boxes[1][0], boxes[0][3] - boxes[0][1]];
  const scale = Math.min((width - 3 * PAD) / (x + y), (TALLEST - 2 * PAD - 2 * LABEL) / (z + y));
  const spare = (width - 3 * PAD - (x + y) * scale) / 2;
  const left = [PAD + spare, 2 * PAD + spare + x * scale];
  const bottom = [LABEL + z * scale, PAD + 2 * LABEL + (z + y) * scale];
  const views = VIEWS.map((view, k) => ({...view, scale, left: left[view.column], bottom: bottom[view.row], box: boxes[k],
    top: bottom[view.row] - (view.row ? y : z) * scale,
    at(p) { const [u, v] = view.flat(p); return [this.left + (u - this.box[0]) * scale, this.bottom - (v - this.box[1]) * scale]; }}));
  return {height: bottom[1] + PAD, views};
}
function stroke(c, points, color, width) {
  c.beginPath();
  points.forEach(([x, y], k) => (k ? c.lineTo(x, y) : c.moveTo(x, y)));
  c.strokeStyle = color; c.lineWidth = width; c.stroke();
}
function dot(c, [x, y], radius, color) {
  c.beginPath(); c.arc(x, y, radius, 0, 7); c.fillStyle = color; c.fill();
}
const roleOf = (motion, frame, part) => Object.keys(motion.colors)[motion.roles[frame][part]];
function drawView(c, motion, view, frame, ink, soft) {
  c.globalAlpha = 1; c.fillStyle = soft;
  c.fillText(view.name, view.left, view.top - 6);
  const path = motion.path_mm.map((p) => view.at(p));
  c.globalAlpha = .5; stroke(c, path, soft, 1.2);
  const order = motion.centres_mm[frame].map((p, s) => [view.depth(p), s]).sort((a, b) => a[0] - b[0]);
  for (const [, s] of order) {
    const role = roleOf(motion, frame, motion.parts[s]), point = view.at(motion.centres_mm[frame][s]), radius = motion.radii_mm[s] * view.scale;
    c.globalAlpha = .55; dot(c, point, radius, motion.colors[role]);
    c.globalAlpha = .35; c.strokeStyle = role === "colliding" ? ink : "#fff"; c.lineWidth = .7; c.stroke();
  }
  c.globalAlpha = 1; stroke(c, path.slice(0, motion.done[frame]), motion.colors.target, 2.2);
  const links = motion.links_mm[frame].map((p) => view.at(p));
  stroke(c, links, ink, 1.6);
  links.forEach((p) => dot(c, p, 2, ink));
  dot(c, links[links.length - 1], 3.5, motion.colors.target);
}
function setUp(figure) {
  const motion = JSON.parse(figure.dataset.motion);
  const [canvas, button, slider, clock] = ["canvas", "button", "input", "output"].map((name) => figure.querySelector(name));
  const last = motion.times_s.length - 1;
  let layout, playing = 0, fitted = 0;
  slider.max = last;
  const draw = () => {
    const c = canvas.getContext("2d"), ratio = canvas.width / canvas.clientWidth, style = getComputedStyle(figure);
    const [ink, soft] = ["--ink", "--soft"].map((name) => style.getPropertyValue(name));
    const frame = Number(slider.value), names = motion.components.filter((_, part) => roleOf(motion, frame, part) === "colliding").sort();
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    c.font = "12px system-ui, sans-serif"; c.lineJoin = c.lineCap = "round";
    layout.views.forEach((view) => drawView(c, motion, view, frame, ink, soft));
    clock.textContent = `${motion.times_s[frame].toFixed(2)} of ${motion.duration_s.toFixed(2)} s${names.length ? ": " + names.join(", ") + " collide" : ""}`;
  };
  const fit = () => {
    const width = canvas.clientWidth, ratio = window.devicePixelRatio || 1;
    if (!width || width === fitted) return;
    fitted = width;
    layout = layOut(motion, width);
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(layout.height * ratio);
    canvas.style.aspectRatio = `${width} / ${layout.height}`;
    draw();
  };
  const step = (from, begun) => (now) => {
    if (!playing) return;
    const time = from + (now - begun) / 1000;
    let frame = motion.times_s.findIndex((t) => t > time);
    if (frame < 0) frame = last + 1;
    slider.value = frame - 1; draw();
    if (frame > last) return stop();
    playing = requestAnimationFrame(step(from, begun));
  };
  const stop = () => { cancelAnimationFrame(playing); playing = 0; button.textContent = "▶"; button.ariaLabel = "play"; };
  const play = () => {
    if (Number(slider.value) === last) slider.value = 0;
    button.textContent = "❚❚"; button.ariaLabel = "pause";
    const from = motion.times_s[Number(slider.value)], begun = performance.now();
    playing = requestAnimationFrame(step(from, begun));
  };
  button.onclick = () => (playing ? stop() : play());
  slider.oninput = () => { stop(); draw(); };
  new ResizeObserver(fit).observe(figure);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  fit();
}
document.querySelectorAll("figure.animation").forEach(setUp);
