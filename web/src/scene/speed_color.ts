// Speed as colour: the same scale for traces and legend.

export type Rgb = readonly [number, number, number];

/** Slow to fast; distinguished on light and dark ground and with the common colour blindnesses by lightness. */
const kStops: readonly Rgb[] = [
    [0.23, 0.36, 0.8],
    [0.1, 0.6, 0.72],
    [0.25, 0.7, 0.36],
    [0.93, 0.7, 0.16],
    [0.87, 0.24, 0.16],
];

/** \param share of the scale, 0 to 1 */
export function speedColor(share: number): Rgb {
    const at = Math.max(0, Math.min(1, share)) * (kStops.length - 1);
    const i = Math.min(Math.floor(at), kStops.length - 2);
    const low = kStops[i] as Rgb;
    const high = kStops[i + 1] as Rgb;
    const t = at - i;
    return [low[0] + (high[0] - low[0]) * t, low[1] + (high[1] - low[1]) * t, low[2] + (high[2] - low[2]) * t];
}

export function cssGradient(): string {
    const stops = kStops.map((stop) => `rgb(${stop.map((part) => Math.round(part * 255)).join(' ')})`);
    return `linear-gradient(90deg, ${stops.join(', ')})`;
}

/** The end of a scale that holds `speed`: 0.1, 0.25, 0.5, 1 m/s and so on. */
export function niceSpeed(speed: number): number {
    const steps = [0.05, 0.1, 0.25, 0.5, 1, 2, 5];
    return steps.find((step) => speed <= step * 1.0001) ?? 10;
}
