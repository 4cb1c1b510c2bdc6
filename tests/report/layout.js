// The faults of the layout of the page at hand, as sentences; none: every text stands by itself and can be read, nothing is wider
// than the page, every picture is there, and the texts of its figures lie inside them.
(async () => {
  const faults = new Set();
  const short = text => '"' + text.trim().replace(/\s+/g, " ").slice(0, 60) + '"';
  const overlap = (a, b) => Math.min(
    Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
  // Boxes of text hold the room above and below the letters.
  const letters = r => ({left: r.left, right: r.right, top: r.top + 0.2 * r.height, bottom: r.bottom - 0.2 * r.height});
  const overlapping = (texts, where) => {
    texts.sort((a, b) => a.box.top - b.box.top);
    texts.forEach((one, i) => {
      for (let k = i + 1; k < texts.length && texts[k].box.top < one.box.bottom; ++k)
        if (texts[k].owner !== one.owner && overlap(one.box, texts[k].box) > 1)
          faults.add(where + short(one.text) + " overlaps " + short(texts[k].text));
    });
  };
  const clip = (box, by) => ({left: Math.max(box.left, by.left), right: Math.min(box.right, by.right),
                              top: Math.max(box.top, by.top), bottom: Math.min(box.bottom, by.bottom)});

  const page_width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > page_width + 1)
    faults.add("the page is " + document.documentElement.scrollWidth + " wide in a window of " + page_width);

  const texts = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = walker.currentNode, owner = node.parentElement;
    if (!node.data.trim() || owner.closest("script,style,svg") || !owner.checkVisibility({visibilityProperty: true})) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const rect of range.getClientRects()) {
      if (rect.width < 1) continue;
      let box = letters(rect), scrolls = false;
      for (let e = owner; e !== document.body; e = e.parentElement) {
        const style = getComputedStyle(e), around = e.getBoundingClientRect();
        if (style.overflowX === "visible" || style.display === "inline") continue;
        if (style.overflowX === "auto" || style.overflowX === "scroll") scrolls = true;
        else if (rect.right > around.right + 1 || rect.left < around.left - 1) faults.add(short(node.data) + " is cut");
        box = clip(box, around);
      }
      if (!scrolls && (rect.right > page_width + 1 || rect.left < -1)) faults.add(short(node.data) + " is beyond the page");
      if (box.right > box.left && box.bottom > box.top) texts.push({text: node.data, owner: node, box});
    }
  }
  overlapping(texts, "");

  for (const img of document.images) {
    if (!img.complete || img.naturalWidth === 0) faults.add("the picture " + short(img.alt || img.src) + " is not there");
    if (!img.alt) faults.add("a picture has no words: " + img.src.slice(0, 40));
    const type = "data:image/svg+xml;base64,";
    if (!img.src.startsWith(type)) continue;
    const bytes = Uint8Array.from(atob(img.src.slice(type.length)), c => c.charCodeAt(0));
    const svg = document.importNode(
      new DOMParser().parseFromString(new TextDecoder().decode(bytes), "image/svg+xml").documentElement, true);
    const host = document.createElement("div");
    host.style.cssText = "position:absolute;left:0;top:0;width:" + img.naturalWidth + "px;line-height:normal";
    host.append(svg);
    document.body.append(host);
    const whole = svg.getBoundingClientRect(), figure = "figure " + short(img.alt) + ": ", labels = [];
    for (const text of svg.querySelectorAll("text")) {
      const rect = text.getBoundingClientRect();
      if (!text.textContent.trim() || rect.width === 0) continue;
      if (rect.left < whole.left || rect.right > whole.right || rect.top < whole.top || rect.bottom > whole.bottom)
        faults.add(figure + short(text.textContent) + " is cut");
      labels.push({text: text.textContent, owner: text, box: letters(rect)});
    }
    if (labels.length === 0) faults.add(figure + "has no text");
    overlapping(labels, figure);
    host.remove();
  }
  return [...faults];
})()
