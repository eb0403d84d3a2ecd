// What pages do by a script. They are complete without it.
"use strict";

// An address from before a diagnostic had its own page: diagnostics.html#CODE is a row whose first link leads there.
{
  const row = document.getElementById(location.hash.slice(1));
  if (row?.matches(".eu-table tr")) location.replace(row.querySelector("a").href);
}

// What is wider than its place can be scrolled with the arrow keys, so the tab key must reach it.
{
  const wide = new ResizeObserver((entries) => {
    for (const { target } of entries) {
      if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
      else target.removeAttribute("tabindex");
    }
  });
  document.querySelectorAll("pre, .table-wrapper, .eu-equation, .eu-graph").forEach((element) => wide.observe(element));
}
