// Plays every animation of the page: lines between joints, measured beside simulated.
(function () {
  "use strict";
  var calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;

  function numbers(packed) {
    return new Float32Array(Uint8Array.from(atob(packed), function (c) { return c.charCodeAt(0); }).buffer);
  }

  function page(name) { return getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(); }

  function made(kind, given, into) { return into.appendChild(Object.assign(document.createElement(kind), given)); }

  document.querySelectorAll("figure.animation").forEach(function (shown) {
    var told = JSON.parse(shown.querySelector("script").textContent), stage = shown.querySelector(".stage");
    var time = numbers(told.time), last = time.length - 1, frame = 0, playing = false, begun = 0, from = 0;
    var motions = told.motions.map(function (m) { return { label: m.label, colour: m.colour, points: numbers(m.points) }; });
    var size = motions[0].points.length / time.length;
    var canvas = made("canvas", {}, stage), legend = made("p", { className: "keys" }, stage), bar = made("div", { className: "zoom player" }, stage);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "the mechanism in motion: " + motions.map(function (m) { return m.label; }).join(", "));
    motions.forEach(function (m) {
      var key = made("span", { textContent: m.label }, legend);
      key.style.borderColor = m.colour === "ink" ? "var(--ink)" : m.colour;
    });
    var button = made("button", { type: "button", textContent: "play" }, bar);
    var slider = made("input", { type: "range", min: 0, max: last, step: 1, value: 0 }, bar);
    slider.setAttribute("aria-label", "time");
    var clock = made("output", {}, bar);

    function draw() {
      var wide = stage.clientWidth, ratio = window.devicePixelRatio || 1, margin = 24;
      var span = [told.high[0] - told.low[0], told.high[1] - told.low[1]];
      var high = Math.round(Math.min(420, Math.max(200, wide * (span[1] + 1e-9) / (span[0] + 1e-9))));
      canvas.width = wide * ratio;
      canvas.height = high * ratio;
      canvas.style.height = high + "px";
      var c = canvas.getContext("2d"), scale = Math.min((wide - 2 * margin) / (span[0] || 1e-9), (high - 2 * margin) / (span[1] || 1e-9));
      c.setTransform(ratio, 0, 0, ratio, 0, 0);
      function x(v) { return wide / 2 + scale * (v - (told.low[0] + told.high[0]) / 2); }
      function y(v) { return high / 2 - scale * (v - (told.low[1] + told.high[1]) / 2); }
      c.lineCap = "round";
      c.fillStyle = page("faint");
      c.fillRect(x(0) - 14, y(0) - 2, 28, 4);
      motions.forEach(function (m, k) {
        c.strokeStyle = c.fillStyle = m.colour === "ink" ? page("ink") : m.colour;
        // What is drawn first is widest, so that equal motions are all seen.
        c.lineWidth = 3 + 4 * (motions.length - 1 - k);
        var base = frame * size;
        told.edges.forEach(function (e) {
          var a = base + 2 * e[0], b = base + 2 * e[1];
          c.beginPath();
          c.moveTo(x(m.points[a]), y(m.points[a + 1]));
          c.lineTo(x(m.points[b]), y(m.points[b + 1]));
          c.stroke();
        });
        for (var p = 0; p < size; p += 2) {
          c.beginPath();
          c.arc(x(m.points[base + p]), y(m.points[base + p + 1]), 3 + 2 * (motions.length - 1 - k), 0, 7);
          c.fill();
        }
      });
      slider.value = frame;
      clock.textContent = time[frame].toFixed(2) + " s";
    }

    function step(now) {
      if (!playing) { return; }
      frame = from + Math.floor((now - begun) / 1000 * last / ((time[last] - time[0]) || 1));
      if (frame >= last) { frame = last; play(false); }
      draw();
      requestAnimationFrame(step);
    }

    function play(on) {
      playing = on;
      button.textContent = on ? "pause" : "play";
      if (on) {
        from = frame >= last ? 0 : frame;
        begun = performance.now();
        requestAnimationFrame(step);
      }
    }

    button.addEventListener("click", function () { play(!playing); });
    slider.addEventListener("input", function () { play(false); frame = Number(slider.value); draw(); });
    new ResizeObserver(draw).observe(stage);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
    draw();
    if (!calm && shown.hasAttribute("data-plays")) { play(true); }
  });
})();
