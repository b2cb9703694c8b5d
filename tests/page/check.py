#!/usr/bin/env python3
"""Checks the page of make report in a headless Chromium: check.py PAGE [DIRECTORY OF SCREENSHOTS]"""
import os
import re
import sys

sys.dont_write_bytecode = True
import browser  # beside this file

NARROW = 400

# True once a condition holds, false after ten seconds.
WAIT = """return new Promise((resolve) => {
  const end = performance.now() + 10000;
  const look = () => CONDITION ? resolve(true)
    : performance.now() > end ? resolve(false) : requestAnimationFrame(look);
  look();
});"""

DRAWN = """document.querySelector("#gallery button:not([hidden])") !== null &&
  [...document.querySelectorAll("#gallery button:not([hidden]) span")].every((e) => e.textContent)"""

# The column of the compared picture that is white from top to bottom.
BORDER = """const canvas = document.querySelector("#compare"), { width, height } = canvas;
const context = new OffscreenCanvas(width, height).getContext("2d");
context.drawImage(canvas, 0, 0);
const data = context.getImageData(0, 0, width, height).data;
const isWhite = (x) => {
  for (let i = 4 * x; i < data.length; i += 4 * width)
    if (data[i] + data[i + 1] + data[i + 2] < 765) return false;
  return true;
};
return [...Array(width).keys()].find(isWhite) ?? -1;"""

VISIBLE_ROWS = """return [...document.querySelectorAll("#table tbody tr:not([hidden])")]
  .map((row) => [row.dataset.scene, row.dataset.kind, row.dataset.light,
    row.children[arguments[0]].dataset.value]);"""

# Every text that is seen, with its contrast (WCAG 2, relative luminance) if that is below 4.5.
PALE_TEXTS = """
const context = new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
const rgba = (color) => {
  context.clearRect(0, 0, 1, 1);
  context.fillStyle = color;
  context.fillRect(0, 0, 1, 1);
  return [...context.getImageData(0, 0, 1, 1).data];
};
const luminance = (color) => rgba(color).slice(0, 3).map((v) => v / 255)
  .map((v) => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
  .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
const ground = (element) => {
  const color = getComputedStyle(element).backgroundColor;
  return rgba(color)[3] === 255 ? color : ground(element.parentElement);
};
const hasText = (element) => [...element.childNodes].some((node) =>
  node.nodeType === Node.TEXT_NODE && node.data.trim());
return [...document.querySelectorAll("body *")].filter((e) => hasText(e) && e.checkVisibility())
  .map((element) => {
    const style = getComputedStyle(element);
    const ink = luminance(element instanceof SVGElement ? style.fill : style.color);
    const paper = luminance(ground(element));
    const contrast = (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
    return contrast < 4.5 ? element.textContent.trim() + ": " + contrast.toFixed(2) : "";
  }).filter(Boolean);"""


def require(condition, message):
    if not condition:
        raise AssertionError(message)


def wait(page, condition):
    return page.run(WAIT.replace("CONDITION", condition))


def is_silent(page):
    messages = page.console()
    require(messages == [], f"the console says {messages}")


def loads(page):
    require(wait(page, DRAWN), "the gallery stays empty")
    is_silent(page)


def needs_no_network(page):
    outside = page.run("""return performance.getEntriesByType("resource").map((e) => e.name)
      .filter((name) => !name.startsWith("data:"));""")
    require(outside == [], f"loads {outside}")


def loads_all_images(page):
    sizes = page.run("""const images = JSON.parse(document.querySelector("#images").textContent);
    const entries = Object.entries(images);
    const states = entries.map(async ([name, data]) => {
      const image = new Image();
      image.src = "data:image/png;base64," + data;
      return image.decode().then(() => image.naturalWidth + "x" + image.naturalHeight, () => name);
    });
    return Promise.all(states).then((sizes) => [...new Set(sizes)]);""")
    require(len(sizes) == 1 and re.fullmatch(r"[1-9]\d*x[1-9]\d*", sizes[0]),
            f"images are broken or differ in size: {sizes[:9]}")
    rest = page.run("return [...document.images].filter((i) => !i.naturalWidth).map((i) => i.src);")
    require(rest == [], f"images: {rest}")


def is_sorted(page, column, down):
    values = [float(row[3]) for row in page.run(VISIBLE_ROWS, column) if row[3]]
    require(len(set(values)) > 2, "too few values to sort")
    return values == sorted(values, reverse=down)


def sort_state(page, column):
    return page.run("""return document.querySelectorAll("#table th[scope=col]")[arguments[0]]
      .getAttribute("aria-sort");""", column)


def sorts_by_click(page):
    for column, down in ((2, False), (2, True), (7, False)):
        page.click(f"#table th:nth-child({column + 1}) button")
        require(is_sorted(page, column, down), f"column {column} is not in order")
        require(sort_state(page, column) == ("descending" if down else "ascending"), "aria-sort")


def sorts_by_keyboard(page):
    page.run("document.querySelectorAll('#table th button')[3].focus();")
    for key, down in (("Enter", False), ("Space", True)):
        page.press(key)
        require(is_sorted(page, 3, down), f"{key} does not sort")
    page.press("Tab")
    page.press("Enter")
    require(is_sorted(page, 4, False), "Tab does not lead to the next column")


def slider_moves_the_border(page):
    page.run("document.querySelector('#slider').focus();")
    borders = [page.run(BORDER)]
    for key in ("ArrowRight", "ArrowRight", "ArrowLeft"):
        page.press(key)
        borders.append(page.run(BORDER))
    require(min(borders) >= 0, "there is no border")
    steps = borders[0] - borders[1], borders[1] - borders[2]
    # Equal but for the rounding to whole columns.
    require(min(steps) > 0 and abs(steps[0] - steps[1]) <= 1 and borders[3] == borders[1],
            f"the border stands at {borders}")


def choose(page, control, value):
    page.run("""const control = document.getElementById(arguments[0]);
    control.value = arguments[1];
    control.dispatchEvent(new Event("change"));""", control, value)


def options(page, control):
    return page.run("return [...document.getElementById(arguments[0]).options].map((o) => o.value);",
                    control)


def filters_by_scene_and_light(page):
    seen = 0
    for scene in reversed(options(page, "scene")):
        choose(page, "scene", scene)
        for kind in reversed(options(page, "kind")):
            choose(page, "kind", kind)
            for light in options(page, "light"):
                choose(page, "light", light)
                rows = page.run(VISIBLE_ROWS, 0)
                seen += len(rows)
                require(rows and all(row[:3] == [scene, kind, light] for row in rows),
                        f"{scene}, {kind}, {light}: {rows[:3]}")
                require(page.run("return document.querySelector('.chart:not([hidden]) .point');"),
                        f"{scene}, {kind}, {light}: no figure")
    require(seen == page.run("return document.querySelectorAll('#table tbody tr').length;"),
            "some rows are never shown")
    require(wait(page, DRAWN), "the gallery stays empty")


def tip(page):
    return page.run("const tip = document.querySelector('#tip'); return tip.hidden ? '' : tip.textContent")


def marks_tell_their_method(page):
    point = ".chart:not([hidden]) .point"
    name = page.run(f"return document.querySelector('{point}').dataset.method;")
    page.point_at(point)
    require(name in tip(page), "hover shows no method")
    page.point_at("h1")
    require(tip(page) == "", "the tip stays")
    page.run(f"document.querySelector('{point}').focus();")
    require(name in tip(page), "focus shows no method")
    page.press("ArrowRight")
    chosen = page.run("return document.activeElement.dataset.method;")
    require(chosen and chosen in tip(page), "arrows do not move the focus")
    page.press("Enter")
    require(page.run("return document.querySelector('#method').value;").startswith(chosen),
            "Enter does not choose")


def focus_is_visible(page):
    page.run("document.querySelector('.skip').focus();")
    kinds, kind = set(), ""
    while kind != "body":  # behind the last one
        kind, outline, stroke = page.run("""const e = document.activeElement;
        const style = getComputedStyle(e);
        return [e.closest(".point") ? "point" : e.localName, style.outlineStyle,
          parseFloat(style.strokeWidth)];""")
        require(outline != "none" or kind == "body" or (kind == "point" and stroke >= 2),
                f"{kind} hides its focus")
        kinds.add(kind)
        page.press("Tab")
    page.run("document.activeElement.blur();")
    require({"a", "select", "point", "input", "button"} <= kinds, f"Tab reaches only {kinds}")


def tables_have_captions(page):
    bare = page.run("""return [...document.querySelectorAll("table")]
      .filter((table) => !table.caption || !table.caption.textContent.trim()).length;""")
    require(bare == 0, f"{bare} tables have no caption")


def fits(page, width):
    page.resize(width, 900)
    over = page.run("""const room = document.documentElement.clientWidth;
    return document.documentElement.scrollWidth > room
      ? [...document.querySelectorAll("body *")].filter((e) => e.getBoundingClientRect().right > room)
          .map((e) => e.localName + "." + e.className) : [];""")
    require(over == [], f"wider than {width}: {over[:9]}")


def looks(page, scheme, width, directory):
    page.prefer(scheme)
    fits(page, width)
    pale = page.run(PALE_TEXTS)
    require(pale == [], f"too little contrast, {scheme}: {pale[:9]}")
    if directory:
        page.screenshot(os.path.join(directory, f"{scheme}-{width}.png"))


CHECKS = (loads, needs_no_network, loads_all_images, marks_tell_their_method, sorts_by_click,
          sorts_by_keyboard, slider_moves_the_border, focus_is_visible, tables_have_captions,
          filters_by_scene_and_light)


def check(path, directory):
    with browser.Browser() as page:
        page.prefer("light")
        page.resize(1280, 900)
        page.open("file://" + os.path.abspath(path))
        for one in CHECKS:
            one(page)
            print("ok  ", one.__name__.replace("_", " "))
        for scheme in ("light", "dark"):
            for width in (1280, NARROW):
                looks(page, scheme, width, directory)
                print(f"ok   {scheme}, {width} pixels wide")
        is_silent(page)


def main():
    if len(sys.argv) not in (2, 3):
        print(__doc__)
        return 2
    missing = browser.missing()
    if missing:
        print(f"left out: no {missing}")
        return 0
    try:
        check(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else None)
    except AssertionError as error:
        print(f"FAILED {error}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
