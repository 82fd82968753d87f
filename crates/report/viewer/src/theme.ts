// Light and dark.

type Listener = () => void;

const listeners: Listener[] = [];
const dark = window.matchMedia("(prefers-color-scheme: dark)");

/** Whether the page is dark now. */
export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : dark.matches;
}

export function onTheme(listener: Listener): void {
  listeners.push(listener);
}

export function toggleTheme(): void {
  document.documentElement.dataset.theme = isDark() ? "light" : "dark";
  tell();
}

export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function tell(): void {
  document.getElementById("theme")?.setAttribute("aria-pressed", String(isDark()));
  listeners.forEach((listener) => listener());
}

export function startTheme(): void {
  dark.addEventListener("change", tell);
  document.getElementById("theme")?.addEventListener("click", toggleTheme);
  tell();
}
