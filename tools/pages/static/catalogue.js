// SPDX-License-Identifier: GPL-3.0-or-later
// Rows whose text holds every word that was typed; families without one disappear. #WORDS in the address is a search.
(() => {
  const find = document.getElementById("find"), count = document.getElementById("found");
  const rows = [...document.querySelectorAll("#presets tr[data-words]")];
  const families = [...document.querySelectorAll("#presets tr.family")];
  const show = () => {
    const words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
    const seen = new Set();
    let found = 0;
    for (const row of rows) {
      row.hidden = !words.every((word) => row.dataset.words.includes(word));
      if (!row.hidden) { found += 1; seen.add(row.dataset.family); }
    }
    for (const row of families) row.hidden = !seen.has(row.dataset.family);
    count.textContent = found ? `${found} of ${rows.length}` : "No match. Clear the search.";
  };
  const follow = () => { find.value = decodeURIComponent(location.hash.slice(1)); show(); };
  find.addEventListener("input", show);
  addEventListener("hashchange", follow);
  follow();
})();
