/** Charts of drive and error over the last half minute, and of the tick times. */

import uPlot from "uplot";

import type { Frame, Histogram, Past, State } from "../feed/messages";
import { doubles, floats } from "../feed/numbers";
import type { Store } from "../feed/store";
import { drawnBySoftware } from "../space/software-rendering";
import { element, say } from "./dom";
import { ChartSeries, SPAN } from "./chart-series";
import { digits, percent } from "./format";

const SOFTWARE_DRAW_INTERVAL = 1000; // time between two drawings with software rendering [ms]
const ERRORS = [1e-4, 0.01, 1, 100] as const; // tick marks [%]; smaller errors are drawn at the first one
const COUNTS = [0, 10, 100, 1000, 10_000];
const MIN_TICK_TIME = 0.01; // lower end of the axis of tick times, which has no 0 [ms]
const INITIAL_MAX_TICK_TIME = 100; // upper end before the first histogram [ms]
const INK = "#8b96a6";
const LINE = "#8fc7ff";
const FAINT = "#4b6d93";
const AMBER = "#f3c66b";
const DIM = "#8a7443";
const RED = "#ff7a70";
const GRID = { stroke: "#232b36", width: 1 };
const FONT = "11px system-ui, sans-serif";

export class Charts {
  private readonly drive = new ChartSeries(["mean", "max"]);
  private readonly error = new ChartSeries(["mean", "max"]);
  private readonly plots: { drive: uPlot; error: uPlot; ticks: uPlot };
  private histogram: Histogram | undefined;
  private readonly apart = drawnBySoftware() ? SOFTWARE_DRAW_INTERVAL : 0;
  private due = 0;

  /** driven: returns the present mean and maximum of the amplitudes, 0..1. */
  constructor(store: Store, driven: () => { mean: number; most: number }) {
    this.plots = {
      drive: plot("chart-drive", over([LINE, FAINT], { range: [0, 100] })),
      error: plot("chart-error", over([AMBER, DIM], { distr: 3, range: [ERRORS[0], ERRORS[3]] })),
      ticks: plot("chart-ticks", this.bars()),
    };
    store.on("frame", (frame: Frame) => {
      const { mean, most } = driven();
      this.drive.add(frame.time, 100 * mean, 100 * most);
    });
    store.on("state", (state: State) => {
      const asked = state.asked.length > 0;
      const error = asked ? Math.min(Math.max(100 * state.error, ERRORS[0]), ERRORS[3]) : NaN;
      this.error.add(state.time, error, error);
    });
    store.on("history", (history) => this.fill(history));
    store.onBeat("state", (state: State) => this.draw(state));
    store.on("histogram", (histogram: Histogram) => {
      this.histogram = histogram;
    });
  }

  /** Replace the data by those of a recording up to the time that is shown. */
  private fill({ times, drive_mean, drive_max, error }: Past): void {
    const [at, mean, max, wrong] = [doubles(times), floats(drive_mean), floats(drive_max), floats(error)];
    this.drive.clear();
    this.error.clear();
    at.forEach((time, k) => {
      const each = Math.min(Math.max(100 * (wrong[k] ?? NaN), ERRORS[0]), ERRORS[3]);
      this.drive.add(time, 100 * (mean[k] ?? NaN), 100 * (max[k] ?? NaN));
      this.error.add(time, each, each);
    });
    this.due = 0;
  }

  private draw(state: State): void {
    const now = performance.now();
    if (now < this.due) return;
    this.due = now + this.apart;
    this.say(state);
    this.plots.drive.setData(this.drive.data);
    this.plots.error.setData(this.error.data);
    if (this.histogram) this.plots.ticks.setData(columns(this.histogram));
  }

  private say(state: State): void {
    const [mean, max] = this.drive.latest.map((percents) => `${digits(percents)} %`);
    const [p50, p99, worst] = state.tick_ms.map((ms) => digits(ms, 2));
    output("chart-drive", `mean ${mean}, max ${max}`);
    output("chart-error", state.asked.length ? `${percent(state.error)}, ${state.status}` : "no samples");
    output("chart-ticks", `p50 ${p50}, p99 ${p99}, max ${worst} ms`);
  }

  private bars(): Omit<uPlot.Options, "width" | "height"> {
    const bars = uPlot.paths.bars?.({ size: [1, Infinity, 1], align: 1, gap: 1 });
    return {
      ...common(),
      scales: {
        x: { time: false, distr: 3, range: () => this.edges() },
        y: { distr: 4, asinh: 5, range: (_plot, _low, high) => [0, Math.max(high, 10)] },
      },
      axes: [
        axis({ splits: () => this.powers(), values: (_plot, ticks) => ticks.map((ms, k) => (k < ticks.length - 1 ? `${ms}` : `${ms} ms`)) }),
        axis({ splits: (shown) => COUNTS.filter((each) => each <= (shown.scales["y"]?.max ?? 0)) }),
      ],
      series: [{}, { stroke: LINE, fill: "#8fc7ff99", width: 0, points: { show: false }, ...(bars && { paths: bars }) }],
      hooks: { draw: [(shown) => this.deadline(shown)] },
    };
  }

  private edges(): [number, number] {
    const edges = this.histogram?.edges_ms ?? [];
    return [edges[0] || MIN_TICK_TIME, edges.at(-1) ?? INITIAL_MAX_TICK_TIME];
  }

  private powers(): number[] {
    const [low, high] = this.edges().map((edge) => Math.round(Math.log10(edge)));
    const first = low ?? 0;
    return Array.from({ length: (high ?? 0) - first + 1 }, (_, k) => Number(`1e${first + k}`));
  }

  private deadline(shown: uPlot): void {
    if (!this.histogram) return;
    const { ctx, bbox } = shown;
    const x = Math.round(shown.valToPos(this.histogram.deadline_ms, "x", true));
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = RED;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.fillText(" deadline", x, bbox.top + 12 * devicePixelRatio);
    ctx.restore();
  }
}

function columns({ edges_ms, counts }: Histogram): uPlot.AlignedData {
  return [edges_ms.slice(0, counts.length), [...counts]];
}

function common(): Pick<uPlot.Options, "legend" | "cursor" | "padding"> {
  return { legend: { show: false }, cursor: { show: false }, padding: [8, 24, 0, 0] };
}

function over(colours: string[], y: uPlot.Scale): Omit<uPlot.Options, "width" | "height"> {
  return {
    ...common(),
    scales: { x: { time: false, range: [-SPAN, 0] }, y },
    axes: [
      axis({ values: (_plot, ticks) => ticks.map((t) => (t ? `−${-t} s` : "now")) }),
      axis(y.distr === 3 ? { size: 54, splits: () => [...ERRORS], values: (_plot, ticks) => ticks.map(String) } : {}),
    ],
    series: [{}, ...colours.map((stroke) => ({ stroke, width: 1.5, points: { show: false } }))],
  };
}

function axis(more: Partial<uPlot.Axis> = {}): uPlot.Axis {
  return { filter: (_plot, ticks) => ticks, stroke: INK, grid: GRID, ticks: { ...GRID, size: 4 }, font: FONT, gap: 4, size: 44, ...more };
}

/** Make a chart that fills its figure below the caption. */
function plot(id: string, options: Omit<uPlot.Options, "width" | "height">): uPlot {
  const figure = element(id);
  const caption = figure.querySelector("figcaption");
  const size = (): { width: number; height: number } => ({
    width: figure.clientWidth,
    height: Math.max(figure.clientHeight - (caption?.offsetHeight ?? 0), 40),
  });
  const made = new uPlot({ ...options, ...size() }, [[], []], figure);
  const observer = new ResizeObserver(() => made.setSize(size()));
  for (const each of [figure, caption]) if (each) observer.observe(each);
  return made;
}

function output(id: string, text: string): void {
  const figure = element(id);
  const told = figure.querySelector("output");
  if (told) say(told, text);
  const what = figure.querySelector("figcaption")?.firstChild?.textContent?.trim() ?? "";
  figure.setAttribute("aria-label", `${what}: ${text}`);
}
