// Draws every plot of the page from the data beside it; without this script the still pictures stay.
(function () {
  "use strict";
  var dark = window.matchMedia("(prefers-color-scheme: dark)");
  var drawn = [];

  function numbers(packed) {
    var bytes = Uint8Array.from(atob(packed), function (c) { return c.charCodeAt(0); });
    // A gap is a null, not a number that is none.
    return Array.from(new Float32Array(bytes.buffer), function (v) { return isFinite(v) ? v : null; });
  }

  function page(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); }

  function colour(name) { return name === "ink" || name === "faint" ? page(name) : name; }

  function figure(value) { return value == null ? "–" : String(Number(value.toPrecision(5))); }

  function extent(values) {
    return values.reduce(function (found, v) { return [Math.min(found[0], v), Math.max(found[1], v)]; }, [Infinity, -Infinity]);
  }

  function seriesOf(line, known) {
    var shape = line.style === "dots" || line.style === "marks";
    return {
      label: line.label,
      stroke: function () { return colour(line.colour); },
      width: line.width,
      dash: line.style === "dashed" ? [6, 4] : undefined,
      paths: shape ? function () { return null; } : undefined,
      points: { show: shape, size: line.style === "dots" ? 3 : 7, width: line.style === "dots" ? 0 : 1.4,
                fill: line.style === "dots" ? function () { return colour(line.colour); } : page("panel") },
      spanGaps: known,
      value: function (u, v) { return figure(v); }
    };
  }

  function draw(place, told) {
    var data = [numbers(told.x)], series = [{ label: told.xLabel, value: function (u, v) { return figure(v); } }], bands = [];
    told.lines.forEach(function (line) {
      data.push(numbers(line.y));
      series.push(seriesOf(line, Boolean(line.ends)));
      if (line.ends) {
        line.ends.forEach(function (end, k) {
          data.push(numbers(end));
          series.push({ label: (k ? "upper" : "lower") + " end", stroke: "transparent", points: { show: false }, spanGaps: true,
                        value: function (u, v) { return figure(v); } });
        });
        bands.push({ series: [data.length - 1, data.length - 2], fill: line.colour + "38" });
      }
    });
    // A band is told by the line it is around.
    var hidden = series.reduce(function (found, each, k) { return each.stroke === "transparent" ? found.concat(k) : found; }, []);
    var whole = extent(data[0]), narrow = place.clientWidth < 520;
    var labels = { stroke: function () { return page("ink"); }, font: "12px " + page("sans"), labelFont: "12px " + page("sans"),
                   grid: { stroke: function () { return page("grid"); }, width: 1 }, ticks: { stroke: function () { return page("grid"); }, width: 1 } };
    var y = told.log.indexOf("y") >= 0 ? { distr: 3 } : told.linear ? { distr: 4, asinh: told.linear } : {};
    if (told.limits) { y.range = function (u, low, high) { return low == null ? told.limits : [Math.max(low, told.limits[0]), Math.min(high, told.limits[1])]; }; }
    var options = {
      width: place.clientWidth, height: told.height, series: series, bands: bands,
      scales: { x: { time: false, distr: told.log.indexOf("x") >= 0 ? 3 : 1 }, y: y },
      axes: [Object.assign({ label: told.xLabel, labelSize: 18 }, labels),
             Object.assign({ label: told.yLabel, labelSize: 18, size: narrow ? 54 : 66, values: ticks }, decades(told), labels)],
      cursor: { drag: { x: true, y: false, setScale: true }, sync: told.together ? { key: told.together, scales: ["x", null] } : undefined,
                focus: { prox: 24 } },
      legend: { live: true, markers: { width: 2 } },
      hooks: { drawClear: [function (u) { shade(u, told.band); }], setScale: [function (u, key) { follow(u, key, told.together); }] }
    };
    var plot = new uPlot(options, data, place);
    var rows = place.querySelectorAll(".u-legend .u-series");
    // For who hears the page: what the canvas is a picture of, and that the legend's words head its rows.
    var canvas = place.querySelector("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", place.getAttribute("aria-label"));
    place.querySelectorAll(".u-legend th").forEach(function (head) { head.scope = "row"; });
    hidden.forEach(function (k) { rows[k].hidden = true; rows[k].style.display = "none"; });
    drawn.push({ plot: plot, together: told.together, place: place });
    buttons(place, plot, whole, told);
    new ResizeObserver(function () {
      if (place.clientWidth && place.clientWidth !== plot.width) { plot.setSize({ width: place.clientWidth, height: told.height }); }
    }).observe(place);
  }

  function ticks(u, splits) {
    return splits.map(function (v) {
      if (v == null) { return ""; }
      var far = Math.abs(v) >= 1e5 || (v && Math.abs(v) < 1e-3);
      return far ? v.toExponential(0).replace("e+", "e") : String(Number(v.toPrecision(6)));
    });
  }

  // Of an axis that is not linear: whole decades, few enough to be read, and parts of them where there is no more than one or two.
  function decades(told) {
    if (told.log.indexOf("y") < 0 && !told.linear) { return {}; }
    return { splits: function (u, axis, low, high) {
      var least = told.linear || low, most = Math.max(Math.abs(low), Math.abs(high)), found = [];
      var first = Math.floor(Math.log10(least)), last = Math.ceil(Math.log10(most)), stride = Math.max(1, Math.ceil((last - first) / (told.linear ? 3 : 6)));
      var parts = last - first < 3 && !told.linear ? [1, 2, 5] : [1];
      for (var k = last; k >= first; k -= stride) { parts.forEach(function (part) { found.push(part * Math.pow(10, k)); }); }
      if (told.linear) { found = found.filter(function (v) { return v >= told.linear; }); found = found.concat(0, found.map(function (v) { return -v; })); }
      return found.filter(function (v) { return v >= low && v <= high; }).sort(function (a, b) { return a - b; });
    } };
  }

  function shade(u, half) {
    if (!half) { return; }
    var top = u.valToPos(half, "y", true), bottom = u.valToPos(-half, "y", true);
    u.ctx.save();
    u.ctx.globalAlpha = 0.18;
    u.ctx.fillStyle = page("faint");
    u.ctx.beginPath();
    u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    u.ctx.clip();
    u.ctx.fillRect(u.bbox.left, top, u.bbox.width, bottom - top);
    u.ctx.restore();
  }

  // What shows the same recording goes to the same stretch of it.
  var following = false;
  function follow(u, key, together) {
    if (key !== "x" || !together || following) { return; }
    following = true;
    drawn.forEach(function (other) {
      var x = other.plot.scales.x;
      if (other.plot !== u && other.together === together && (x.min !== u.scales.x.min || x.max !== u.scales.x.max)) { other.plot.setScale("x", { min: u.scales.x.min, max: u.scales.x.max }); }
    });
    following = false;
  }

  // The mouse drags and double-clicks; fingers and keys have these.
  function buttons(place, plot, whole, told) {
    var log = told.log.indexOf("x") >= 0;
    function on(v) { return log ? Math.log(v) : v; }
    function back(v) { return log ? Math.exp(v) : v; }
    function to(middle, span) {
      var low = on(whole[0]), high = on(whole[1]);
      span = Math.min(span, high - low);
      middle = Math.min(Math.max(middle, low + span / 2), high - span / 2);
      plot.setScale("x", { min: back(middle - span / 2), max: back(middle + span / 2) });
    }
    var bar = document.createElement("div");
    bar.className = "zoom";
    [["−", "zoom out", 0, 2], ["+", "zoom in", 0, 0.5], ["‹", "earlier", -0.5, 1], ["›", "later", 0.5, 1], ["whole", "the whole", 0, Infinity]].forEach(function (b) {
      var button = document.createElement("button");
      button.type = "button";
      button.textContent = b[0];
      button.title = b[1];
      button.setAttribute("aria-label", b[1]);
      button.addEventListener("click", function () {
        var low = on(plot.scales.x.min), high = on(plot.scales.x.max), span = high - low;
        to((low + high) / 2 + b[2] * span, b[3] === Infinity ? on(whole[1]) - on(whole[0]) : span * b[3]);
      });
      bar.appendChild(button);
    });
    place.appendChild(bar);
  }

  document.querySelectorAll("figure.plot").forEach(function (shown) {
    var place = shown.querySelector(".live");
    shown.classList.add("drawn");
    draw(place, JSON.parse(shown.querySelector("script").textContent));
  });
  dark.addEventListener("change", function () { drawn.forEach(function (each) { each.plot.redraw(false, true); }); });
})();
