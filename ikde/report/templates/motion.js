// Motions that play, in mm: from the side, right of it from the front, below it from above, and in space, to be turned.
// All players and the cursors in the page's charts over time show the same moment.
const PAD = 14, LABEL = 20, TALLEST = 620, LINK_MM = 22, GRID_MM = 500, SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const VIEWS = [
  {name: "side: x, z", flat: (p) => [p[0], p[2]], depth: (p) => -p[1], column: 0, row: 0},
  {name: "front: y, z", flat: (p) => [p[1], p[2]], depth: (p) => p[0], column: 1, row: 0},
  {name: "top: x, y", flat: (p) => [p[0], p[1]], depth: (p) => p[2], column: 0, row: 1},
];
const sum = (a, b) => a.map((x, k) => x + b[k]), minus = (a, b) => a.map((x, k) => x - b[k]);
// Where an obstacle is in a frame: its points, if it moves in a frame of its own.
function placer(obstacle, frame) {
  if (!obstacle.poses) return (p) => p;
  const T = obstacle.poses[frame];
  return (p) => [0, 1, 2].map((k) => T[3 * k] * p[0] + T[3 * k + 1] * p[1] + T[3 * k + 2] * p[2] + T[9 + k]);
}
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
  motion.obstacles.forEach((obstacle) => (obstacle.poses ?? [0]).forEach((_, frame) => {
    const place = placer(obstacle, frame);
    obstacle.solids.forEach((solid) => solid.corners.forEach((p) => add(place(p), 0)));
  }));
  return box;
}
// One scale for the flat views; those of a column share x, those of a row share z. The view in space has what is left.
function layOut(motion, width) {
  const boxes = VIEWS.map((view) => boxOf(motion, view.flat));
  const [x, y, z] = [boxes[0][2] - boxes[0][0], boxes[1][2] - boxes[1][0], boxes[0][3] - boxes[0][1]];
  const scale = Math.min((width - 3 * PAD) / (x + y), (TALLEST - 2 * PAD - 2 * LABEL) / (z + y), .6 * (width - 3 * PAD) / x);
  const room = width - 3 * PAD - x * scale, lower = Math.max(y * scale, Math.min(room, 320));
  const left = [PAD, 2 * PAD + x * scale + .5 * (room - y * scale)];
  const bottom = [LABEL + z * scale, PAD + 2 * LABEL + z * scale + .5 * (lower + y * scale)];
  const views = VIEWS.map((view, k) => ({...view, scale, left: left[view.column], bottom: bottom[view.row], box: boxes[k],
    top: bottom[view.row] - (view.row ? y : z) * scale, head: view.row ? PAD + 2 * LABEL + z * scale : LABEL,
    at(p) { const [u, v] = view.flat(p); return [this.left + (u - this.box[0]) * scale, this.bottom - (v - this.box[1]) * scale]; }}));
  const low = [boxes[0][0], boxes[1][0], Math.min(0, boxes[0][1])], high = [boxes[0][2], boxes[1][2], boxes[0][3]];
  const space = {name: "in space: drag it, or use the arrow keys", brief: "in space: drag it", left: 2 * PAD + x * scale, top: PAD + 2 * LABEL + z * scale, head: PAD + 2 * LABEL + z * scale, width: room, tall: lower, low, high};
  return {height: space.top + lower + PAD, views, space};
}
// The view in space as it is turned: like a flat view, with the same scale whatever the turn about z.
function turned(space, [turn, lift]) {
  const [s, c, up, flat] = [Math.sin(turn), Math.cos(turn), Math.sin(lift), Math.cos(lift)];
  const middle = sum(space.low, space.high).map((x) => x / 2), size = minus(space.high, space.low);
  const across = Math.hypot(size[0], size[1]), rise = across * Math.abs(up) + size[2] * flat;
  const scale = Math.min(space.width / across, space.tall / rise);
  return {...space, scale,
    depth(p) { const [x, y, z] = minus(p, middle); return flat * (c * x + s * y) + up * z; },
    at(p) {
      const [x, y, z] = minus(p, middle), u = c * y - s * x, v = flat * z - up * (c * x + s * y);
      return [this.left + this.width / 2 + u * scale, this.top + this.tall / 2 - v * scale];
    }};
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
function drawGround(c, view, soft) {
  const {low, high} = view, first = (k) => GRID_MM * Math.ceil(low[k] / GRID_MM);
  c.globalAlpha = .35;
  for (let x = first(0); x <= high[0]; x += GRID_MM) stroke(c, [[x, low[1], 0], [x, high[1], 0]].map((p) => view.at(p)), soft, .6);
  for (let y = first(1); y <= high[1]; y += GRID_MM) stroke(c, [[low[0], y, 0], [high[0], y, 0]].map((p) => view.at(p)), soft, .6);
}
// Corners of the convex hull of points in a plane.
function outline(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const walk = (way) => {
    const hull = [];
    for (const p of way) {
      while (hull.length > 1) {
        const [a, b] = hull.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        hull.pop();
      }
      hull.push(p);
    }
    return hull.slice(0, -1);
  };
  return [...walk(sorted), ...walk(sorted.reverse())];
}
const meanOf = (points) => points.reduce(sum).map((x) => x / points.length);
// A convex solid: its outline, and the edges of the faces that are seen.
function drawSolid(c, view, solid, color) {
  const middle = meanOf(solid.corners), depth = view.depth(middle);
  c.fillStyle = c.strokeStyle = color; c.lineWidth = .8;
  const trace = (points, fill, edge) => {
    c.beginPath(); points.forEach(([x, y], k) => (k ? c.lineTo(x, y) : c.moveTo(x, y))); c.closePath();
    c.globalAlpha = fill; c.fill(); c.globalAlpha = edge; c.stroke();
  };
  trace(outline(solid.corners.map((p) => view.at(p))), solid.endless ? .08 : .2, solid.endless ? .15 : .6);
  solid.faces.filter((face) => view.depth(meanOf(face)) > depth).forEach((face) => trace(face.map((p) => view.at(p)), .06, .45));
}
// Spheres, obstacles, and the links as capsules, far ones first.
function drawBody(c, motion, view, frame, ink) {
  const links = motion.links_mm[frame], touched = new Set(motion.touched[frame]);
  const things = motion.centres_mm[frame].map((p, s) => ({depth: view.depth(p), draw() {
    const role = roleOf(motion, frame, motion.parts[s]);
    c.globalAlpha = role === "base" ? .3 : .55; dot(c, view.at(p), motion.radii_mm[s] * view.scale, role === "colliding" ? ink : motion.colors[role]);
    c.globalAlpha = .35; c.strokeStyle = role === "colliding" ? ink : "#fff"; c.lineWidth = .7; c.stroke();
  }}));
  links.slice(1).forEach((p, k) => things.push({depth: (view.depth(p) + view.depth(links[k])) / 2, draw() {
    c.globalAlpha = .9; stroke(c, [links[k], p].map((end) => view.at(end)), "#8b919b", Math.max(2, 2 * LINK_MM * view.scale));
  }}));
  motion.obstacles.forEach((obstacle, k) => {
    const color = motion.colors[touched.has(k) ? "obstacle that is too near" : "obstacle"];
    const place = placer(obstacle, frame);
    obstacle.solids.forEach((own) => {
      const solid = {...own, corners: own.corners.map(place), faces: own.faces.map((face) => face.map(place))};
      things.push({depth: solid.endless ? -Infinity : view.depth(meanOf(solid.corners)), draw() { drawSolid(c, view, solid, color); }});
    });
    obstacle.points.map(place).forEach((p) => things.push({depth: view.depth(p), draw() {
      const [x, y] = view.at(p); c.globalAlpha = .7; c.fillStyle = color; c.fillRect(x - .8, y - .8, 1.6, 1.6);
    }}));
  });
  things.sort((a, b) => a.depth - b.depth).forEach((thing) => thing.draw());
}
// Where there is the least room of a world: a ring, which is filled at that moment.
function drawNearest(c, view, nearest, frame, color) {
  const [from, to] = nearest.points.map((p) => view.at(p)), now = frame === nearest.frame;
  c.globalAlpha = now ? 1 : .55;
  if (now) stroke(c, [from, to], color, 2.5);
  c.beginPath(); c.arc(...to, now ? 6 : 4, 0, 7); c.strokeStyle = color; c.lineWidth = now ? 2.5 : 1.5; c.stroke();
}
function drawView(c, motion, view, frame, ink, soft) {
  c.globalAlpha = 1; c.fillStyle = soft;
  const fits = !view.brief || c.measureText(view.name).width <= view.width;
  c.fillText(fits ? view.name : view.brief, view.left, view.head - 6);
  if (view.low) drawGround(c, view, soft);
  const path = motion.path_mm.map((p) => view.at(p));
  c.globalAlpha = .6; stroke(c, path, soft, 1.2);
  drawBody(c, motion, view, frame, ink);
  c.globalAlpha = 1; stroke(c, path.slice(0, motion.done[frame]), motion.colors.target, 2.2);
  dot(c, view.at(motion.links_mm[frame].at(-1)), 3.5, motion.colors.target);
  if (motion.nearest) drawNearest(c, view, motion.nearest, frame, motion.colors["closest pair"]);
  if (path.length === 1) { c.beginPath(); c.arc(...path[0], 7, 0, 7); c.strokeStyle = motion.colors.target; c.lineWidth = 2.5; c.stroke(); }
}
// Lines that mark the moment in charts over time; a drag in such a chart moves all to another.
const players = [], cursors = [];
function showMoment(time) {
  players.forEach((player) => player.show(time));
  cursors.forEach(({line, box: [left, right, , , first, last]}) => {
    const x = left + (right - left) * (time - first) / (last - first);
    line.setAttribute("x1", x); line.setAttribute("x2", x);
    line.setAttribute("visibility", x < left - 1 || x > right + 1 ? "hidden" : "visible");
  });
}
function setUpChart(svg) {
  const boxes = JSON.parse(svg.dataset.times);
  for (const box of boxes) {
    const line = svg.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "line"));
    line.setAttribute("class", "cursor"); line.setAttribute("y1", box[2]); line.setAttribute("y2", box[3]);
    cursors.push({line, box});
  }
  const seek = (event) => {
    const {x, y} = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const box = boxes.find((b) => x >= b[0] - 4 && x <= b[1] + 4 && y >= b[2] && y <= b[3]);
    if (!box) return false;
    players.forEach((player) => player.stop());
    showMoment(box[4] + (box[5] - box[4]) * Math.min(1, Math.max(0, (x - box[0]) / (box[1] - box[0]))));
    return true;
  };
  svg.onpointerdown = (event) => { if (seek(event)) { svg.setPointerCapture(event.pointerId); event.preventDefault(); } };
  svg.onpointermove = (event) => { if (svg.hasPointerCapture(event.pointerId)) seek(event); };
}
function setUp(figure) {
  const motion = JSON.parse(figure.dataset.motion);
  const [canvas, button, slider, speed, clock] = ["canvas", "button.play", "input", "select", "output"].map((name) => figure.querySelector(name));
  const last = motion.times_s.length - 1, home = [-.9, .4];
  let layout, playing = 0, fitted = 0, eye = [...home];
  const least = figure.querySelector("button.least"), nearest = motion.nearest;
  least.hidden = !nearest || nearest.frame < 0 || !last;
  slider.max = last; figure.querySelector(".player").hidden = !last;
  SPEEDS.forEach((times) => speed.add(new Option(`${times}×`, times, times === 1, times === 1)));
  const draw = () => {
    if (!layout) return;
    const c = canvas.getContext("2d"), ratio = canvas.width / canvas.clientWidth, style = getComputedStyle(figure);
    const [ink, soft] = ["--ink", "--soft"].map((name) => style.getPropertyValue(name));
    const frame = Number(slider.value), names = motion.components.filter((_, part) => roleOf(motion, frame, part) === "colliding").sort();
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    c.font = "12px system-ui, sans-serif"; c.lineJoin = c.lineCap = "round";
    [...layout.views, turned(layout.space, eye)].forEach((view) => drawView(c, motion, view, frame, ink, soft));
    clock.textContent = `${motion.times_s[frame].toFixed(2)} of ${motion.duration_s.toFixed(2)} s${names.length ? ": " + names.join(", ") + " collide" : ""}${nearest && frame === nearest.frame ? "\n" + nearest.text : ""}`;
    slider.ariaValueText = clock.textContent;
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
  const show = (time) => {
    const next = motion.times_s.findIndex((t) => t > time + 1e-6);
    slider.value = next < 0 ? last : Math.max(0, next - 1);
    draw();
  };
  const step = (time, before) => (now) => {
    if (!playing) return;
    const next = time + Number(speed.value) * Math.max(0, now - before) / 1000;
    showMoment(Math.min(next, motion.times_s[last]));
    if (next > motion.times_s[last]) return stop();
    playing = requestAnimationFrame(step(next, now));
  };
  const stop = () => { cancelAnimationFrame(playing); playing = 0; button.textContent = "▶"; button.ariaLabel = "play"; };
  const play = () => {
    players.forEach((player) => player.stop());
    if (Number(slider.value) === last) showMoment(motion.times_s[0]);
    button.textContent = "❚❚"; button.ariaLabel = "pause";
    playing = requestAnimationFrame(step(motion.times_s[Number(slider.value)], performance.now()));
  };
  const orbit = (across, up) => { eye = [eye[0] - across, Math.min(1.57, Math.max(-.2, eye[1] + up))]; draw(); };
  button.onclick = () => (playing ? stop() : play());
  least.onclick = () => { stop(); showMoment(motion.times_s[nearest.frame]); };
  slider.oninput = () => { stop(); showMoment(motion.times_s[Number(slider.value)]); };
  canvas.onpointerdown = (event) => {
    if (event.offsetX > layout.space.left && event.offsetY > layout.space.top - LABEL) canvas.setPointerCapture(event.pointerId);
  };
  canvas.onpointermove = (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) orbit(event.movementX / 120, event.movementY / 120);
  };
  canvas.ondblclick = () => { eye = [...home]; draw(); };
  canvas.onkeydown = (event) => {
    const by = {ArrowLeft: [-.1, 0], ArrowRight: [.1, 0], ArrowUp: [0, .1], ArrowDown: [0, -.1]}[event.key];
    if (by) { orbit(...by); event.preventDefault(); } else if (event.key === "Home") canvas.ondblclick();
  };
  new ResizeObserver(fit).observe(figure);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  players.push({show, stop});
  fit();
}
document.querySelectorAll("figure.animation").forEach(setUp);
document.querySelectorAll("svg[data-times]").forEach(setUpChart);
showMoment(0);
