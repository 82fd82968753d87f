// Numbers as people write them.

const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function raised(exponent: number): string {
  const digits = [...String(Math.abs(exponent))]
    .map((digit) => SUPERSCRIPTS[Number(digit)])
    .join("");
  return `10${exponent < 0 ? "⁻" : ""}${digits}`;
}

/** A number with so many significant digits, in the form that is shortest to read. */
export function format(value: number | null | undefined, digits = 4): string {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const sign = value < 0 ? "−" : "";
  const size = Math.abs(value);
  const exponent = Math.floor(Math.log10(Number(size.toPrecision(digits))));
  if (exponent >= -3 && exponent < 6) {
    const text = Number(size.toPrecision(digits));
    const decimals = Math.max(0, digits - 1 - exponent);
    return (
      sign +
      text.toLocaleString("en", { maximumFractionDigits: decimals }).replaceAll(",", "\u202f")
    );
  }
  const mantissa = Number((size / 10 ** exponent).toPrecision(digits));
  return `${sign}${mantissa === 1 ? "" : `${mantissa} × `}${raised(exponent)}`;
}

/** Powers of ten between two limits, about `count` of them at most. */
export function decades(low: number, high: number, count: number): number[] {
  const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
  const stride = Math.max(1, Math.ceil((last - first) / count));
  const found: number[] = [];
  for (let exponent = first; exponent <= last; exponent++) {
    if (exponent % stride === 0) found.push(Number(`1e${exponent}`));
  }
  return found;
}

/** A power of ten, or another number. */
export function decade(value: number): string {
  const exponent = Math.log10(value);
  return Math.abs(exponent - Math.round(exponent)) < 1e-9
    ? raised(Math.round(exponent))
    : format(value, 3);
}

/** Round numbers between two limits: 1, 2 and 5 times powers of ten, about `count` of them. */
export function linearTicks(low: number, high: number, count: number): number[] {
  const rough = (high - low) / Math.max(1, count);
  if (!(rough > 0) || !Number.isFinite(rough)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999) ?? 10);
  const found: number[] = [];
  const first = Math.ceil(low / step - 1e-9);
  for (let i = first; i * step <= high + 1e-9 * step; i++)
    found.push(Number((i * step).toPrecision(12)));
  return found;
}

/** Round numbers on a logarithmic scale: powers of ten, with 2 and 5 times them, or 1 to 9, where these are few. */
export function logarithmicTicks(low: number, high: number, count: number): number[] {
  const decades = Math.log10(high / low);
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const factors = decades < 0.8 ? [] : decades < count / 2.5 ? [1, 2, 5] : [1];
  if (factors.length === 0) return linearTicks(low, high, count).filter((tick) => tick > 0);
  const stride = Math.max(1, Math.ceil(decades / count));
  const found: number[] = [];
  for (let exponent = first; exponent <= last; exponent += 1) {
    if (factors.length === 1 && exponent % stride !== 0) continue;
    for (const factor of factors) {
      const tick = Number((factor * 10 ** exponent).toPrecision(6));
      if (tick >= low * 0.9999 && tick <= high * 1.0001) found.push(tick);
    }
  }
  return found;
}

/** The largest round number not above a positive value, or the smallest not below it. */
export function rounded(value: number, upwards: boolean): number {
  if (!(value > 0) || !Number.isFinite(value)) return value;
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const steps = [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].map((factor) => factor * power);
  const fits = upwards
    ? steps.find((s) => s >= value * 0.999999)
    : steps.findLast((s) => s <= value * 1.000001);
  return Number((fits ?? value).toPrecision(6));
}
