// SPDX-License-Identifier: Apache-2.0
// Serves Open MCT with the plugin beside a running Aeolis, under one origin and read-only: questions (GET) of its own page go on to /api, and
// live values come by /live, a socket by which this server itself subscribes. Nothing that a page says reaches the stream, which takes commands, too.
//   node serve.mjs [http://127.0.0.1:8080 [PORT]]
import { readFile } from 'node:fs/promises';
import { STATUS_CODES, createServer, request } from 'node:http';
import path from 'node:path';
import { pipeline } from 'node:stream';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const TYPES = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
  '.png': 'image/png',
};
const PASSED_ON = ['accept', 'accept-encoding', 'authorization', 'cookie', 'if-none-match']; // whoever the page is to Aeolis, with or without accounts
const HANDSHAKE = ['upgrade', 'connection', 'sec-websocket-key', 'sec-websocket-version', 'sec-websocket-protocol'];
const ALIVE_MS = 5000; // ours: shorter than a server waits for a sign

/** A client's frame of at most 65535 octets with a mask of zeros, RFC 6455 5.2. */
function frame(opcode, text = '') {
  const octets = Buffer.from(text);
  const length = octets.length < 126 ? [0x80 | octets.length] : [0x80 | 126, octets.length >> 8, octets.length & 255];
  return Buffer.concat([Buffer.from([0x80 | opcode, ...length, 0, 0, 0, 0]), octets]);
}
const [TEXT, CLOSE, PONG] = [1, 8, 10];

/** Answers with the server that listens on loopback, on a free port when `port` is 0. */
export function serve(aeolis, port = 0) {
  const { hostname, port: theirs } = new URL(aeolis);
  const mayAsk = ({ host, origin: asking }) =>
    ['127.0.0.1', 'localhost'].some((name) => host === `${name}:${server.address().port}`) &&
    (asking === undefined || asking === `http://${host}`);
  const passedOn = (headers, names = PASSED_ON) =>
    Object.fromEntries(names.filter((name) => headers[name] !== undefined).map((name) => [name, headers[name]]));
  const say = (answer, status, words) =>
    answer.headersSent
      ? answer.destroy()
      : answer.writeHead(status, { 'content-type': 'text/plain' }).end(`${words}\n`);

  function question(asked, answer) {
    const onward = request({ hostname, port: theirs, path: asked.url, headers: passedOn(asked.headers) }, (told) => {
      answer.writeHead(told.statusCode, told.headers);
      pipeline(told, answer, () => undefined);
    });
    onward.on('error', (error) => say(answer, 502, `${aeolis} does not answer: ${error.message}`));
    answer.on('close', () => onward.destroy());
    onward.end();
  }

  /** What comes live of a run after a place in it: the stream's own messages, and nothing the other way but this one subscription. */
  function live(asked, query, near) {
    const [run, after, channels] = ['run', 'after', 'channels'].map((name) => query.get(name) ?? '');
    if (![run, after].every((number) => /^\d+$/.test(number)) || !/^\d+(,\d+)*$/.test(channels))
      return refuse(near, 400);
    const onward = request({
      hostname,
      port: theirs,
      path: '/api/v1/stream',
      headers: passedOn(asked.headers, [...PASSED_ON, ...HANDSHAKE]),
    });
    onward
      .on('upgrade', (told, far, head) => {
        near.write(
          `HTTP/1.1 101 Switching Protocols\r\n${Object.entries(told.headers)
            .map(([name, value]) => `${name}: ${value}\r\n`)
            .join('')}\r\n`,
        );
        near.write(head);
        far.write(
          frame(
            TEXT,
            JSON.stringify({ subscribe: { run, after_seq: after, channels: channels.split(',').map(Number) } }),
          ),
        );
        const alive = setInterval(() => far.write(frame(PONG)), ALIVE_MS);
        far
          .on('error', () => near.destroy())
          .on('close', () => near.destroy())
          .on('close', () => clearInterval(alive))
          .pipe(near);
        near.on('data', ([first]) => (first & 15) === CLOSE && near.destroy()).on('close', () => far.destroy());
      })
      .on('response', (told) => refuse(near, told.statusCode))
      .on('error', () => refuse(near, 502))
      .end();
    near.on('close', () => onward.destroy());
  }
  const refuse = (near, status) =>
    near.end(`HTTP/1.1 ${status} ${STATUS_CODES[status]}\r\nconnection: close\r\ncontent-length: 0\r\n\r\n`);

  async function page(pathname, answer) {
    const [root, name] = pathname.startsWith('/openmct/')
      ? ['node_modules/openmct/dist', pathname.slice('/openmct/'.length)]
      : ['', pathname === '/' ? 'index.html' : pathname.slice(1)];
    if (root === '' && !['index.html', 'plugin.js'].includes(name)) return say(answer, 404, 'not found');
    const octets = await readFile(path.join(here, root, path.normalize(`/${decodeURIComponent(name)}`))).catch(
      () => undefined,
    );
    if (octets === undefined) return say(answer, 404, 'not found');
    answer.writeHead(200, { 'content-type': TYPES[path.extname(name)] ?? 'application/octet-stream' }).end(octets);
  }

  const server = createServer(async (asked, answer) => {
    try {
      if (!mayAsk(asked.headers)) return say(answer, 403, 'only its own page is answered');
      if (asked.method !== 'GET') return say(answer, 405, 'this page only reads');
      const { pathname } = new URL(`http://${asked.headers.host}${asked.url}`);
      if (pathname.startsWith('/api/')) question(asked, answer);
      else await page(pathname, answer);
    } catch (error) {
      say(answer, 400, error.message); // an address that is none
    }
  });
  server.on('upgrade', (asked, near) => {
    near.on('error', () => near.destroy());
    try {
      const { pathname, searchParams } = new URL(`http://${asked.headers.host}${asked.url}`);
      if (!mayAsk(asked.headers) || pathname !== '/live') return refuse(near, 403);
      live(asked, searchParams, near);
    } catch {
      refuse(near, 400);
    }
  });
  return new Promise((resolve, reject) =>
    server.once('error', reject).listen(port, '127.0.0.1', () => resolve(server)),
  );
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [aeolis = 'http://127.0.0.1:8080', port = '8081'] = process.argv.slice(2);
  await serve(aeolis, Number(port));
  console.log(`Open MCT on http://127.0.0.1:${port}, reading ${aeolis}`);
}
