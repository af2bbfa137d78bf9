// SPDX-License-Identifier: Apache-2.0
// The least that can be done: the history of the channels named, their live samples over the stream as JSON, a plot each, 20 draws a second.
/* global uPlot */
const names = new URLSearchParams(location.search).get('channels').split(',');
const get = async (path) => (await fetch(`/api/v1${path}`)).json();

const [
  { channels: words },
  {
    runs: [run],
  },
] = await Promise.all([get('/dictionary'), get('/runs')]);
const idOf = new Map(words.map((each) => [each.name, each.id]));
const { channels } = await get(`/runs/${run.run}/channels?names=${names.join()}&points=1000`);
const wide = Math.floor(innerWidth / 2) - 20;
const high = Math.floor(innerHeight / Math.ceil(names.length / 2)) - 20;
document.body.style.cssText = 'display:grid;grid-template-columns:1fr 1fr;margin:4px;gap:8px';
const plots = names.map((name) => {
  const { sclk, value } = channels.find((each) => each.name === name);
  const data = [sclk.map((at) => at - run.entry_sclk), value];
  const element = document.body.appendChild(document.createElement('div'));
  element.className = 'plot';
  const plot = new uPlot(
    {
      width: wide,
      height: high,
      legend: { show: false },
      cursor: { drag: { x: false, y: false } },
      scales: { x: { time: false } },
      series: [{}, { stroke: '#6cb6ff', width: 1, points: { show: false } }],
    },
    data,
    element,
  );
  return { id: idOf.get(name), data, plot, element };
});
let changed = false;
const socket = new WebSocket(`${location.origin.replace(/^http/, 'ws')}/api/v1/stream`, 'aeolis.v1.json');
socket.onopen = () =>
  socket.send(
    JSON.stringify({
      subscribe: { run: run.run, after_seq: run.last_seq ?? '0', channels: plots.map((each) => each.id) },
    }),
  );
socket.onmessage = ({ data }) => {
  for (const { samples } of JSON.parse(data).batch?.items ?? []) {
    if (!samples) continue;
    for (const { id, data } of plots) {
      const at = samples.ids.indexOf(id);
      if (at < 0) continue;
      data[0].push(samples.sclk - run.entry_sclk);
      data[1].push(samples.values[at]);
      changed = true;
    }
  }
};
let last = 0;
requestAnimationFrame(function frame(now) {
  requestAnimationFrame(frame);
  if (!changed || now - last < 46) return;
  last = now;
  changed = false;
  for (const { plot, data, element } of plots) {
    plot.setData(data);
    element.dataset.newest = data[0].at(-1) + run.entry_sclk;
  }
});
