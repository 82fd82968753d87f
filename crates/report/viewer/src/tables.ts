// Tables whose rows can be put in order. A cell carries its full number in `data-value`.

import type { Page } from "./data";
import { format } from "./numbers";

/** Shows the means of a band in the columns that have one for each band. */
export function showBand(page: Page, band: number): void {
  for (const head of document.querySelectorAll<HTMLTableCellElement>("th[data-of]")) {
    const of = head.dataset.of as "irradiance" | "radiosity";
    const table = head.closest("table");
    for (const row of table?.tBodies[0].rows ?? []) {
      const value = page.model?.surfaces[Number(row.dataset.row)][of][band];
      const cell = row.cells[head.cellIndex];
      cell.textContent = format(value, 3);
      cell.dataset.value = String(value ?? "");
    }
    const name = head.querySelector("small") ?? document.createElement("small");
    name.textContent = page.bands.length > 1 ? ` ${page.bands[band]}` : "";
    (head.querySelector("button") ?? head).append(name);
  }
}

export function startTables(): void {
  document.querySelectorAll<HTMLTableElement>("table.sortable").forEach(makeSortable);
}

function makeSortable(table: HTMLTableElement): void {
  const heads = [...(table.tHead?.rows[0]?.cells ?? [])];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const upwards = head.ariaSort !== "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.ariaSort = upwards ? "ascending" : "descending";
      sort(table, column, upwards);
    });
  });
}

function sort(table: HTMLTableElement, column: number, upwards: boolean): void {
  const body = table.tBodies[0];
  const key = (row: HTMLTableRowElement): string =>
    row.cells[column].dataset.value ?? row.cells[column].innerText;
  const order = (a: string, b: string): number => {
    // What has no value stands last either way.
    if (a === "" || b === "") return Number(a === "") - Number(b === "");
    const [x, y] = [Number(a), Number(b)];
    const words = Number.isNaN(x) || Number.isNaN(y);
    return (upwards ? 1 : -1) * (words ? a.localeCompare(b, undefined, { numeric: true }) : x - y);
  };
  body.append(...[...body.rows].sort((p, q) => order(key(p), key(q))));
}
