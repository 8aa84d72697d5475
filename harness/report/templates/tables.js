// A box above every long table that leaves the rows with what is typed into it.
(function () {
  "use strict";
  var LONG = 8;
  document.querySelectorAll("table.sortable").forEach(function (table) {
    var bodies = function () { return Array.from(table.tBodies).flatMap(function (b) { return Array.from(b.rows); }); };
    if (bodies().length < LONG) { return; }
    var label = document.createElement("label"), box = document.createElement("input"), left = document.createElement("span");
    label.className = "filter";
    box.type = "search";
    box.placeholder = "filter";
    box.setAttribute("aria-label", "filter the rows of this table");
    left.setAttribute("role", "status");
    box.addEventListener("input", function () {
      var words = box.value.toLowerCase().split(/\s+/).filter(Boolean), shown = 0, rows = bodies();
      rows.forEach(function (row) {
        var text = row.textContent.toLowerCase();
        row.hidden = !words.every(function (word) { return text.indexOf(word) >= 0; });
        shown += row.hidden ? 0 : 1;
      });
      left.textContent = words.length ? shown + " of " + rows.length + " rows" : "";
    });
    label.append(box, left);
    (table.closest(".scroll") || table).before(label);
  });
})();
