"use strict";

const byId = (id) => document.getElementById(id);
const images = JSON.parse(byId("images").textContent);
const rows = [...document.querySelectorAll("#table tbody tr")];
const state = { scene: "all", light: "all", kind: "hard", name: "adaptive", size: "" };

/* Pixels of a picture by its name; those of the chosen scene are decoded once. */
const decoded = new Map();
function pixelsOf(name) {
  if (!decoded.has(name)) decoded.set(name, decode(name));
  return decoded.get(name);
}
async function decode(name) {
  if (!images[name]) return null;
  const image = new Image();
  image.src = "data:image/png;base64," + images[name];
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, canvas.width, canvas.height);
}

/* A row of the scene and light whose pictures are shown: means have none of their own. */
const pictured = () => state.scene !== "all" ? rows.find(fits)
  : rows.find((row) => row.dataset.scene === "columns" && row.dataset.kind === state.kind) ||
    rows.find((row) => row.dataset.scene !== "all" && row.dataset.kind === state.kind);

/* What names a scene or light belongs to no other. */
const fits = ({ dataset }) => (dataset.scene ?? state.scene) === state.scene &&
  (dataset.light ?? state.light) === state.light && dataset.kind === state.kind;

function fill(select, values, chosen) {
  select.replaceChildren(...values.map((value) => new Option(value, value)));
  select.value = values.includes(chosen) ? chosen : values[0];
  select.disabled = values.length < 2;
  return select.value;
}
const unique = (list) => [...new Set(list)];

/* Charts, table and lists for the chosen scene, kind and light. */
function choose() {
  const ofScene = rows.filter((row) => row.dataset.scene === state.scene);
  state.kind = fill(byId("kind"), unique(ofScene.map((row) => row.dataset.kind)), state.kind);
  const ofKind = ofScene.filter((row) => row.dataset.kind === state.kind);
  state.light = fill(byId("light"), unique(ofKind.map((row) => row.dataset.light)), state.light);
  for (const part of document.querySelectorAll("[data-kind]")) part.hidden = !fits(part);
  const shown = rows.filter(fits);
  state.size = fill(byId("size"), unique(shown.map((row) => row.dataset.size)), state.size);
  const names = unique(shown.map(nameOf));
  state.name = fill(byId("method"), names, names.includes(state.name) ? state.name : advised());
  drawGallery();
  showMethod();
}
const nameOf = ({ dataset: { filter, method } }) =>
  filter === "hard" ? method : filter + " with " + method;

/* The method that the page recommends for the chosen kind. */
const advised = () => document.querySelector(`#${state.kind}-verdict strong`)?.textContent;

const rowOf = (name) => rows.find((row) => fits(row) && nameOf(row) === name &&
  row.dataset.size === state.size);

const pictureOf = ({ dataset: row }) =>
  [row.scene, row.light, row.size, row.filter, row.method].join("-");

/* The row of a method that has a picture: of the chosen map size, else of another. */
function rowOfPicture(name) {
  const place = pictured().dataset;
  const own = rows.filter((row) => row.dataset.scene === place.scene &&
    row.dataset.light === place.light && nameOf(row) === name && images[pictureOf(row)]);
  return own.find((row) => row.dataset.size === state.size) || own[0];
}

function pictureNames(row) {
  const { scene, light, size, kind } = row.dataset;
  const head = scene + "-" + light.split("-")[0];
  return {
    lit: head + "-lit", dark: head + "-dark", method: pictureOf(row),
    truth: scene + "-" + light + (kind === "soft" ? "" : "-" + size) + "-truth",
  };
}

async function loadPictures(row) {
  const names = pictureNames(row);
  const entries = await Promise.all(Object.entries(names).map(
    async ([key, name]) => [key, await pixelsOf(name)]));
  return { ...Object.fromEntries(entries), soft: row.dataset.kind === "soft" };
}

/* What the truth's greys stand for; 0 does not count. */
const isBoundary = (grey) => grey === 200 || grey === 48;
const truthOf = (pictures, i) => pictures.truth.data[i] === 0 ? 1
  : pictures.soft ? (pictures.truth.data[i] - 1) / 254 : pictures.truth.data[i] > 150 ? 1 : 0;

/* A picture is linear in visibility before the square root of its gamma. */
function drawScene(canvas, pictures, visibilityOf) {
  const { width, height } = pictures.lit;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const lit = pictures.lit.data, dark = pictures.dark.data, out = image.data;
  for (let i = 0; i < out.length; i += 4) {
    const visibility = visibilityOf(i);
    for (let k = i; k < i + 3; k++)
      out[k] = Math.sqrt(dark[k] ** 2 + visibility * (lit[k] ** 2 - dark[k] ** 2));
    out[i + 3] = 255;
  }
  canvas.width = width;
  canvas.height = height;
  context.putImageData(image, 0, 0);
}

function drawErrors(canvas, pictures, withBoundaries) {
  const { width, height } = pictures.lit;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const out = image.data, lit = pictures.lit.data;
  for (let i = 0; i < out.length; i += 4) {
    const grey = 110 + (lit[i] + lit[i + 1] + lit[i + 2]) / 12;
    const truth = pictures.truth.data[i];
    const error = truth > 0 ? pictures.method.data[i] / 255 - truthOf(pictures, i) : 0;
    const pale = !pictures.soft && isBoundary(truth);
    const weight = (pale && !withBoundaries ? 0 : pale ? 0.55 : 1) * Math.min(1, Math.abs(error));
    const color = error < 0 ? [140, 20, 0] : [143, 230, 255];
    for (let k = 0; k < 3; k++) out[i + k] = grey + weight * (color[k] - grey);
    out[i + 3] = 255;
  }
  canvas.width = width;
  canvas.height = height;
  context.putImageData(image, 0, 0);
}

let current = null; /* pictures of the chosen method */
function drawCompare() {
  if (!current) return;
  const canvas = byId("compare"), width = current.lit.width;
  const edge = Math.round(width * (1 - byId("slider").value / 100));
  drawScene(canvas, current, (i) => (i / 4) % width < edge ? truthOf(current, i)
    : current.method.data[i] / 255);
  const context = canvas.getContext("2d");
  context.fillStyle = "#fff";
  context.fillRect(edge - 1, 0, 2, canvas.height);
  context.fillStyle = "#000";
  context.fillRect(edge - 2, 0, 1, canvas.height);
  context.fillRect(edge + 1, 0, 1, canvas.height);
}

async function showMethod() {
  const row = rowOf(state.name);
  for (const point of document.querySelectorAll(".chart:not([hidden]) .point"))
    point.classList.toggle("chosen", Boolean(row) && point.dataset.method === row.dataset.method &&
      point.dataset.filter === row.dataset.filter && point.dataset.size === row.dataset.size);
  for (const button of byId("gallery").children)
    button.setAttribute("aria-pressed", button.dataset.name === state.name);
  const own = rowOfPicture(state.name);
  if (!own) return;
  const pictures = await loadPictures(own);
  if (rowOfPicture(state.name) !== own) return;
  current = pictures;
  drawCompare();
  drawErrors(byId("errors"), pictures, byId("boundaries").checked);
  const { scene, light, size, summary } = own.dataset;
  byId("compare-caption").textContent = `${state.name}: ${scene}, ${light}, map of ${size}`;
  byId("errors-caption").textContent = summary;
}

async function drawGallery() {
  const names = unique(rows.filter(fits).map(nameOf));
  const buttons = names.map((name) => {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.name = name;
    button.innerHTML = "<canvas width=240 height=150 aria-hidden=true></canvas><b></b><span></span>";
    button.querySelector("b").textContent = name;
    button.onclick = () => { byId("method").value = state.name = name; showMethod(); };
    return button;
  });
  byId("gallery").replaceChildren(...buttons);
  for (const button of buttons) {
    const row = rowOfPicture(button.dataset.name);
    button.hidden = !row;
    if (!row) continue;
    const pictures = await loadPictures(row);
    if (!button.isConnected) return; /* another choice was made */
    drawErrors(button.querySelector("canvas"), pictures, byId("boundaries").checked);
    button.querySelector("span").textContent = row.dataset.brief;
  }
}

/* Sorting: numbers by size, missing ones last; a second press turns the order round. */
function sortBy(header) {
  const index = [...header.parentNode.children].indexOf(header);
  const down = header.getAttribute("aria-sort") === "ascending";
  for (const other of header.parentNode.children) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", down ? "descending" : "ascending");
  const value = (row) => row.children[index].dataset.value;
  const isText = header.classList.contains("text");
  rows.sort((a, b) => {
    const x = value(a), y = value(b);
    if (isText) return down ? y.localeCompare(x) : x.localeCompare(y);
    if (x === "" || y === "") return (x === "") - (y === "");
    return down ? y - x : x - y;
  });
  document.querySelector("#table tbody").append(...rows);
}

/* A mark's name beside it, while the pointer or the focus is there. */
const tip = document.createElement("div");
tip.id = "tip";
tip.hidden = true;
document.body.append(tip);
function showTip(point) {
  tip.textContent = point.getAttribute("aria-label");
  tip.hidden = false;
  const mark = point.getBoundingClientRect(), room = document.documentElement.clientWidth;
  const left = Math.max(8, Math.min(mark.right + 8, room - tip.offsetWidth - 8));
  tip.style.left = left + window.scrollX + "px";
  tip.style.top = mark.top - tip.offsetHeight - 6 + window.scrollY + "px";
}

function choosePoint(point) {
  state.name = nameOf(point);
  const newSize = state.size !== point.dataset.size;
  byId("method").value = state.name;
  byId("size").value = state.size = point.dataset.size;
  if (newSize) drawGallery();
  showMethod();
}

for (const chart of document.querySelectorAll(".chart")) {
  const points = [...chart.querySelectorAll(".point")];
  chart.addEventListener("pointerover", (event) => {
    const point = event.target.closest(".point");
    if (point) showTip(point); else tip.hidden = true;
  });
  chart.addEventListener("pointerleave", () => { tip.hidden = true; });
  chart.addEventListener("focusin", (event) => {
    if (event.target.matches(".point")) showTip(event.target);
  });
  chart.addEventListener("focusout", () => { tip.hidden = true; });
  chart.addEventListener("click", (event) => {
    const point = event.target.closest(".point");
    if (point) choosePoint(point);
  });
  chart.addEventListener("keydown", (event) => {
    const index = points.indexOf(event.target);
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (index < 0) return;
    if (event.key === "Enter" || event.key === " ") choosePoint(event.target);
    else if (event.key === "Escape") tip.hidden = true;
    else if (step) {
      const next = points[(index + step + points.length) % points.length];
      event.target.tabIndex = -1;
      next.tabIndex = 0;
      next.focus();
    } else return;
    event.preventDefault();
  });
}

for (const header of document.querySelectorAll("#table thead th"))
  header.querySelector("button").onclick = () => sortBy(header);
byId("scene").onchange = (event) => {
  state.scene = event.target.value;
  decoded.clear();
  choose();
};
byId("kind").onchange = (event) => { state.kind = event.target.value; choose(); };
byId("light").onchange = (event) => { state.light = event.target.value; choose(); };
byId("method").onchange = (event) => { state.name = event.target.value; showMethod(); };
byId("size").onchange = (event) => { state.size = event.target.value; drawGallery(); showMethod(); };
byId("boundaries").onchange = () => { drawGallery(); showMethod(); };
byId("slider").oninput = drawCompare;
state.scene = byId("scene").value;
choose();
