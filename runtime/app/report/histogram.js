// Counts over equal bins, as bars of logarithmic height: rare values stay visible.
import {element, number} from "./dom.js";

export function histogram(counts, min, max) {
  const most = Math.log1p(Math.max(...counts, 1));
  const bars = counts.map((n, i) => {
    const h = n > 0 ? Math.max(1.5, 76 * Math.log1p(n) / most) : 0;
    return element("rect", {x: i + 0.06, y: 80 - h, width: 0.88, height: h});
  });
  return element("div", {},
                 element("svg", {class: "histogram", viewBox: `0 0 ${counts.length} 80`, preserveAspectRatio: "none", role: "img",
                                 "aria-label": `Histogram from ${number(min)} to ${number(max)}`}, bars),
                 element("div", {class: "axis"}, element("span", {}, number(min, 4)), element("span", {}, number(max, 4))));
}
