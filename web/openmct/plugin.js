// SPDX-License-Identifier: Apache-2.0
// Aeolis in Open MCT, read-only: runs as folders, their channels as telemetry, history from the query routes, live values by serve.mjs.
// Time is milliseconds from a run's predicted entry, at the vehicle: so runs lie over one another.
//
//     openmct.install(AeolisPlugin('http://127.0.0.1:8081'))     the origin of serve.mjs: /api/v1 and /live; this page's own by default
const NAMESPACE = 'aeolis';
const AGAIN_MS = 1000; // after a lost connection
const TOGETHER_MS = 20; // a view's channels come one after the other, and are asked for at once
const POINTS = 2000; // of a request that does not say how many: thinned by the server to least and largest

/** "E+04:28.3", "E-1:02:00.0". */
const fromEntry = {
  key: 'aeolis.from-entry',
  format(ms) {
    const tenths = Math.round(Math.abs(ms) / 100);
    const [hours, minutes, seconds] = [Math.floor(tenths / 36000), Math.floor(tenths / 600) % 60, (tenths % 600) / 10];
    return `E${ms < 0 ? '-' : '+'}${hours > 0 ? `${hours}:` : ''}${String(minutes).padStart(2, '0')}:${seconds.toFixed(1).padStart(4, '0')}`;
  },
  parse(text) {
    if (typeof text === 'number') return text;
    const [, sign, hours, minutes, seconds] = /^E?([+-]?)(?:(\d+):)?(\d+):(\d+(?:\.\d+)?)$/.exec(text) ?? [];
    return seconds === undefined
      ? NaN
      : (sign === '-' ? -1000 : 1000) * (Number(hours ?? 0) * 3600 + Number(minutes) * 60 + Number(seconds));
  },
  validate: (text) => Number.isFinite(fromEntry.parse(text)),
};

export function AeolisPlugin(origin = location.origin) {
  const api = `${origin}/api/v1`;
  const get = async (path) => {
    const response = await fetch(api + path);
    const answer = await response.json();
    if (!response.ok) throw new Error(`Aeolis: ${answer.error}`);
    return answer;
  };
  const once = (ask) => {
    let answer;
    return () =>
      (answer ??= ask().catch((error) => {
        answer = undefined;
        throw error;
      }));
  };
  const words = once(() => get('/dictionary'));
  const runs = new Map(); // by number: what does not change of a run
  const runOf = async (number) => {
    if (!runs.has(number)) runs.set(number, await get(`/runs/${number}`));
    return runs.get(number);
  };
  const idOf = (key) => ({ namespace: NAMESPACE, key });
  const partsOf = ({ key }) => {
    // "runs", "3", "3~altitude_m": a stroke would end it in an address
    const [run, channel] = key.split('~');
    return { run, channel };
  };

  const object = async (identifier) => {
    if (identifier.key === 'runs') return { identifier, name: 'Aeolis', type: 'folder', location: 'ROOT' };
    const { run, channel: name } = partsOf(identifier);
    if (name === undefined)
      return {
        identifier,
        name: `Run ${run}: ${(await runOf(run)).scenario}`,
        type: 'folder',
        location: 'aeolis:runs',
      };
    const channel = (await words()).channels.find((each) => each.name === name);
    if (!channel) throw new Error(`Aeolis: the dictionary has no channel ${name}`);
    const labels = (channel.labels ?? []).map(({ value, label }) => ({ value: Number(value), string: label }));
    return {
      identifier,
      name,
      type: 'aeolis.channel',
      location: `aeolis:${run}`,
      notes: channel.text,
      telemetry: {
        values: [
          { key: 'e', source: 'e', name: 'From entry', format: fromEntry.key, hints: { domain: 1 } },
          {
            key: 'value',
            name: channel.alias || name,
            unit: channel.unit,
            format: labels.length > 0 ? 'enum' : 'float',
            enumerations: labels,
            hints: { range: 1 },
          },
        ],
      },
    };
  };

  const composition = async ({ identifier }) =>
    identifier.key === 'runs'
      ? ((await get('/runs')).runs ?? []).map(({ run }) => idOf(run))
      : (await words()).channels.map(({ name }) => idOf(`${identifier.key}~${name}`));

  const request = async ({ identifier }, { start, end, size, strategy }) => {
    const { run, channel } = partsOf(identifier);
    const { entry_sclk: entry } = await runOf(run);
    const query =
      strategy === 'latest'
        ? `/runs/${run}/state?at=${entry + end / 1000}`
        : `/runs/${run}/channels?names=${encodeURIComponent(channel)}&from=${entry + start / 1000}&to=${entry + end / 1000}&points=${Math.max(2, Math.min(20000, size ?? POINTS))}`;
    const series = (await get(query)).channels?.find(({ name }) => name === channel);
    return (series?.sclk ?? []).map((sclk, i) => ({ e: (sclk - entry) * 1000, value: series.value[i] }));
  };

  const streams = new Map(); // by run: one socket for all of its channels that are shown
  const subscribe = ({ identifier }, take) => {
    const { run, channel } = partsOf(identifier);
    if (!streams.has(run))
      streams.set(
        run,
        followRun(run, () => streams.delete(run)),
      );
    return streams.get(run).add(channel, take);
  };

  function followRun(run, ended) {
    const takers = new Set();
    let [socket, after, again] = [undefined, undefined, undefined];
    const ready = Promise.all([words(), get(`/runs/${run}`)]).then(
      ([{ channels }, { entry_sclk: entry, last_seq: last }]) => {
        after = last ?? '0'; // what was before comes by request
        return { idOfName: new Map(channels.map((each) => [each.name, each.id ?? 0])), entry };
      },
    );
    const connectIn = (ms) => {
      clearTimeout(again);
      again = setTimeout(() => connect().catch((error) => console.error(error)), ms);
    };
    /** Anew whenever what is shown changes: from where the last one was. */
    const connect = async () => {
      const { idOfName, entry } = await ready;
      const before = socket;
      socket = undefined;
      before?.close();
      const channels = [...new Set([...takers].map((taker) => idOfName.get(taker.channel)))];
      if (channels.length === 0) return;
      const mine = new WebSocket(
        `${origin.replace(/^http/, 'ws')}/live?run=${run}&after=${after}&channels=${channels}`,
        'aeolis.v1.json',
      );
      socket = mine;
      mine.onclose = () => {
        if (socket === mine) connectIn(AGAIN_MS);
      };
      mine.onmessage = ({ data }) => {
        if (socket !== mine) return;
        const { batch } = JSON.parse(data);
        if (batch?.complete_through) after = batch.complete_through;
        for (const { samples } of batch?.items ?? [])
          for (const taker of samples ? takers : []) {
            const at = samples.ids?.indexOf(idOfName.get(taker.channel)) ?? -1;
            if (at >= 0) taker.take({ e: ((samples.sclk ?? 0) - entry) * 1000, value: samples.values[at] ?? 0 });
          }
      };
    };
    return {
      add(channel, take) {
        const taker = { channel, take };
        takers.add(taker);
        connectIn(TOGETHER_MS);
        return () => {
          takers.delete(taker);
          connectIn(TOGETHER_MS);
          if (takers.size === 0) ended();
        };
      },
    };
  }

  return function install(openmct) {
    openmct.telemetry.addFormat(fromEntry);
    openmct.time.addTimeSystem({
      key: 'e',
      name: 'From entry',
      cssClass: 'icon-clock',
      timeFormat: fromEntry.key,
      durationFormat: 'duration',
      isUTCBased: false,
    });
    openmct.types.addType('aeolis.channel', {
      name: 'Aeolis channel',
      description: 'a channel of a run, read-only',
      cssClass: 'icon-telemetry',
    });
    openmct.objects.addRoot(idOf('runs'));
    openmct.objects.addProvider(NAMESPACE, { get: object });
    openmct.composition.addProvider({
      appliesTo: ({ identifier, type }) => identifier.namespace === NAMESPACE && type === 'folder',
      load: composition,
    });
    const supports = ({ type }) => type === 'aeolis.channel';
    openmct.telemetry.addProvider({ supportsRequest: supports, request, supportsSubscribe: supports, subscribe });
  };
}
