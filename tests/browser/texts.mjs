// SPDX-License-Identifier: Apache-2.0
// Measures every text of the console against its box, in the page and in its pictures, and what must always be whole.

/** Runs before the page: keeps the words that each canvas has drawn since it was cleared, in screen pixels. */
export function keepWhatIsWritten() {
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  const kept = new WeakMap();
  window.writtenOn = (canvas) => kept.get(canvas) ?? [];
  CanvasRenderingContext2D.prototype.clearRect = function (...box) {
    kept.set(this.canvas, []);
    return clearRect.apply(this, box);
  };
  CanvasRenderingContext2D.prototype.fillText = function (words, x, y, ...more) {
    const size = this.measureText(words);
    const at = this.getTransform();
    const one = at.transformPoint({ x: x - size.actualBoundingBoxLeft, y: y - size.actualBoundingBoxAscent });
    const other = at.transformPoint({ x: x + size.actualBoundingBoxRight, y: y + size.actualBoundingBoxDescent });
    const all = kept.get(this.canvas) ?? [];
    all.push({ words: String(words), left: one.x, top: one.y, right: other.x, bottom: other.y });
    kept.set(this.canvas, all);
    return fillText.call(this, words, x, y, ...more);
  };
}

/** In the page: each text that is cut off, over another, beyond the window, or broken inside a number; and what must be whole and is not. */
export function notWhole() {
  const found = [];
  const name = (element) => element.closest('[data-testid]')?.dataset.testid ?? element.closest('[class]')?.className;
  const hiddenBy = (element) => {
    for (let e = element; e; e = e.parentElement) if (getComputedStyle(e).clipPath === 'inset(50%)') return true;
    return false;
  };
  const all = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const node = walk.currentNode;
    const parent = node.parentElement;
    const words = node.data.trim();
    if (
      words === '' ||
      /^(SCRIPT|STYLE|OPTION)$/.test(parent.tagName) ||
      !parent.checkVisibility({ visibilityProperty: true, opacityProperty: true })
    )
      continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const boxes = [...range.getClientRects()].filter((box) => box.width > 0.5 && box.height > 0.5);
    if (boxes.length === 0) continue;
    // a number must not be broken
    for (const match of node.data.matchAll(/[^\s]*\d[^\s]*(?:\u2009\d+)*/g)) {
      range.setStart(node, match.index);
      range.setEnd(node, match.index + match[0].length);
      const tops = [...range.getClientRects()].filter((b) => b.width > 0.5).map((b) => Math.round(b.top));
      if (match[0].length < 24 && new Set(tops).size > 1) found.push(`${name(parent)}: “${match[0]}” is broken`);
    }
    // what cuts it off, and whether that can be scrolled
    if (hiddenBy(parent)) continue;
    let shown = boxes.map(({ left, right, top, bottom }) => ({ left, right, top, bottom }));
    let hidden = false;
    for (let box = parent; box && box !== document.documentElement; box = box.parentElement) {
      const style = getComputedStyle(box);
      if (style.position === 'fixed') break;
      if (style.display === 'contents') continue;
      const around = box.getBoundingClientRect();
      if (style.clipPath === 'inset(50%)') {
        hidden = true;
        break;
      }
      if (style.overflowX === 'visible' && style.overflowY === 'visible') continue;
      const scrolls = { x: /auto|scroll/.test(style.overflowX), y: /auto|scroll/.test(style.overflowY) };
      for (const one of shown) {
        if (one.right <= one.left || one.bottom <= one.top) continue;
        const wide = Math.max(around.left - one.left, one.right - around.right);
        const high = Math.max(around.top - one.top, one.bottom - around.bottom);
        if (!scrolls.x && wide > 1.5) {
          const clamped = style.textOverflow === 'ellipsis' && box.title;
          if (!clamped)
            found.push(
              `${name(parent)}: “${words.slice(0, 40)}” is cut off by ${wide.toFixed(0)} px across (${box.className || box.tagName})`,
            );
        }
        const lines = style.webkitLineClamp !== 'none';
        if (!scrolls.y && high > 3 && !lines)
          found.push(
            `${name(parent)}: “${words.slice(0, 40)}” is cut off by ${high.toFixed(0)} px in height (${box.className || box.tagName})`,
          );
      }
      shown = shown
        .map((one) => ({
          left: Math.max(one.left, around.left),
          right: Math.min(one.right, around.right),
          top: Math.max(one.top, around.top),
          bottom: Math.min(one.bottom, around.bottom),
        }))
        .filter((one) => one.right - one.left > 1 && one.bottom - one.top > 1);
    }
    if (hidden) continue;
    for (const one of shown) {
      if (one.right > innerWidth + 1 || one.left < -1)
        found.push(`${name(parent)}: “${words.slice(0, 40)}” is beyond the window`);
      // inline boxes are as high as their line's type: the letters take about two thirds of it
      const trim = (one.bottom - one.top) * 0.18;
      all.push({
        words,
        of: name(parent),
        parent,
        node,
        left: one.left,
        right: one.right,
        top: one.top + trim,
        bottom: one.bottom - trim,
      });
    }
  }
  for (const canvas of document.querySelectorAll('canvas')) {
    const box = canvas.getBoundingClientRect();
    const sight = canvas.closest('.grid')?.getBoundingClientRect() ?? box; // what is scrolled away lies over nothing
    if (box.width === 0 || hiddenBy(canvas) || !canvas.checkVisibility({ visibilityProperty: true })) continue;
    const [sx, sy] = [box.width / canvas.width, box.height / canvas.height];
    const of = canvas.dataset.testid ?? canvas.closest('[data-testid]')?.dataset.testid ?? 'canvas';
    for (const text of window.writtenOn?.(canvas) ?? []) {
      const one = {
        words: text.words,
        of,
        parent: canvas,
        left: box.left + text.left * sx,
        right: box.left + text.right * sx,
        top: box.top + text.top * sy,
        bottom: box.top + text.bottom * sy,
      };
      if (one.right < box.left || one.left > box.right || one.bottom < box.top || one.top > box.bottom) continue;
      if (one.bottom < sight.top || one.top > sight.bottom) continue;
      if (
        one.left < box.left - 1.5 ||
        one.right > box.right + 1.5 ||
        one.top < box.top - 1.5 ||
        one.bottom > box.bottom + 1.5
      )
        found.push(`${of}: “${text.words}” is cut off by its picture`);
      all.push(one);
    }
  }
  // sticky and fixed things lie over what scrolls below them
  const layer = (element) => {
    for (let e = element; e; e = e.parentElement) if (/sticky|fixed/.test(getComputedStyle(e).position)) return e;
    return null;
  };
  for (const each of all) each.layer = layer(each.parent);
  for (let i = 0; i < all.length; ++i)
    for (let k = i + 1; k < all.length; ++k) {
      const [one, other] = [all[i], all[k]];
      if (one.layer !== other.layer || (one.node && one.node === other.node)) continue;
      if (
        Math.min(one.right, other.right) - Math.max(one.left, other.left) > 1 &&
        Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top) > 1
      )
        found.push(`“${one.words.slice(0, 30)}” (${one.of}) lies over “${other.words.slice(0, 30)}” (${other.of})`);
    }
  // what must always be whole
  for (const selector of ['.header', '.situation', '.armed-here', '.command-line input', '.armed', '.tape']) {
    const element = document.querySelector(selector);
    if (!element) continue;
    const box = element.getBoundingClientRect();
    if (box.top < -1 || box.bottom > innerHeight + 1 || box.left < -1 || box.right > innerWidth + 1 || box.height < 4)
      found.push(`${selector} is not whole: ${[box.left, box.top, box.right, box.bottom].map(Math.round)}`);
    else {
      for (let around = element.parentElement; around; around = around.parentElement) {
        const clip = around.getBoundingClientRect();
        if (
          getComputedStyle(around).display !== 'contents' &&
          getComputedStyle(around).overflowY !== 'visible' &&
          (box.top < clip.top - 1 || box.bottom > clip.bottom + 1)
        ) {
          found.push(`${selector} is cut off by ${around.className}`);
          break;
        }
      }
    }
  }
  // each control is whole in every box around it; only rows of a list, what stands behind the command line or under
  // what is waited for, and the panels of a telephone are scrolled to
  const rows =
    '.table-scroll, .under-way, .packets, .plots-named, .fields, .offers, .panel-commands .panel-body, .waiting';
  const scrolled = innerWidth > 1100 ? rows : `${rows}, .grid, .choices`;
  for (const control of document.querySelectorAll('button, input, select, textarea, summary, a[href], kbd')) {
    if (hiddenBy(control) || !control.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
    const box = control.getBoundingClientRect();
    if (box.width < 1 || box.height < 1) continue;
    const says = (control.innerText || control.ariaLabel || control.placeholder || control.tagName).slice(0, 40);
    for (let around = control.parentElement; around; around = around.parentElement) {
      const style = getComputedStyle(around);
      if (style.display === 'contents' || (style.overflowX === 'visible' && style.overflowY === 'visible')) continue;
      if (around.matches(scrolled)) break;
      const edge = around === document.body || around === document.documentElement;
      const clip = edge ? { left: 0, top: 0, right: innerWidth, bottom: innerHeight } : around.getBoundingClientRect();
      const [wide, high] = [
        Math.max(clip.left - box.left, box.right - clip.right),
        Math.max(clip.top - box.top, box.bottom - clip.bottom),
      ];
      if (wide > 1.5 || high > 1.5) {
        found.push(
          `${name(control)}: “${says}” is cut off by ${Math.max(wide, high).toFixed(0)} px (${around.className || around.tagName})`,
        );
        break;
      }
    }
  }
  const page = document.documentElement;
  if (page.scrollWidth > innerWidth) found.push(`the page is ${page.scrollWidth} px wide`);
  if (innerWidth > 1100 && page.scrollHeight > innerHeight) found.push(`the page scrolls: ${page.scrollHeight} px`);
  return [...new Set(found)];
}
