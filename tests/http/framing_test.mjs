// SPDX-License-Identifier: Apache-2.0
// Where a request ends: our server against Node's own parser, on the same octets. Two servers that disagree on that can
// be made to take one client's request for another's (request smuggling, RFC 9112, 11.2).
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { connect } from 'node:net';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { serve, temporaryFolder } from '../browser/support.mjs';

const CASES = Number(process.env.AEOLIS_FRAMING_CASES ?? 3000); // chosen: some seconds
const AT_ONCE = 24;

/** A generator of numbers from a seed (mulberry32). */
function random(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

/** Octets of one connection: requests, each with a path of its own, spelt in ways that servers read differently. */
function conversation(seed) {
  const next = random(seed);
  const any = (...choices) => choices[Math.floor(next() * choices.length)];
  const oddity = any(0, 0.02, 0.05, 0.15); // of each spelling
  const mostly = (usual, ...others) => (next() < oddity ? any(...others) : usual);
  let requests = 0;
  const name = () => `/api/v1/case-${seed}-${requests++}`;
  const end = () => mostly('\r\n', '\n', '\r', '\r\r\n', ' \r\n', '\0\r\n');
  const hidden = () => `GET ${name()}-hidden HTTP/1.1\r\nHost: localhost\r\n\r\n`;

  const chunked = (content) => {
    const half = Math.floor(content.length / 2);
    const chunk = (octets) => {
      const size = octets.length.toString(16);
      const spelt = mostly(
        size,
        `0${size}`,
        `+${size}`,
        `0x${size}`,
        ` ${size}`,
        `${size} `,
        `${size};a=b`,
        `${size};`,
        `${size}\t`,
        `${size}g`,
        `${'0'.repeat(20)}${size}`,
        `-${size}`,
        `${size}\0`,
        `ffffffffffffffff${size}`,
      );
      return `${spelt}${end()}${octets}${end()}`;
    };
    const last = mostly(
      '0\r\n\r\n',
      '0\r\nTrailer: x\r\n\r\n',
      '0\n\n',
      '00\r\n\r\n',
      '0\r\n',
      '0;x\r\n\r\n',
      '0\r\nContent-Length: 40\r\n\r\n',
      ' 0\r\n\r\n',
    );
    return chunk(content.slice(0, half)) + chunk(content.slice(half)) + last;
  };
  const lengthOf = (content) => {
    const n = content.length;
    const value = mostly(
      `${n}`,
      `+${n}`,
      `${n} `,
      `0${n}`,
      `${n}, ${n}`,
      `${n},${n + 1}`,
      `0x${n.toString(16)}`,
      `-${n}`,
      `${n}.0`,
      `"${n}"`,
      `${n}\0`,
      `${n}\t`,
      '0',
      `${n - 1}`,
      `${n + 1}`,
      '',
      '99999999999999999999',
      `${n} 0`,
    );
    return mostly(
      `Content-Length: ${value}`,
      `Content-Length:${value}`,
      `content-length:\t${value}`,
      `Content-Length : ${value}`,
      `Content_Length: ${value}`,
      ` Content-Length: ${value}`,
      `Content-Length\0: ${value}`,
      `Content-Length: ${value}\r\nContent-Length: ${value}`,
      `Content-Length: ${value}\r\nContent-Length: 0`,
      `X: y\r\n Content-Length: ${value}`,
      `X: y\nContent-Length: ${value}`,
      `X: y\rContent-Length: ${value}`,
    );
  };
  const encoding = () => {
    const value = mostly(
      'chunked',
      'Chunked',
      'CHUNKED',
      'chunked, identity',
      'identity, chunked',
      'identity',
      'gzip, chunked',
      'xchunked',
      'chunkedx',
      '"chunked"',
      'chunked,',
      ',chunked',
      'chunked;q=1',
      'chunked\t',
      '\x0bchunked',
      'chunked, chunked',
      'cow',
      '',
    );
    return mostly(
      `Transfer-Encoding: ${value}`,
      `Transfer-Encoding:${value}`,
      `transfer-encoding: ${value}`,
      `Transfer-Encoding : ${value}`,
      `Transfer-Encoding:\r\n ${value}`,
      ` Transfer-Encoding: ${value}`,
      `Transfer_Encoding: ${value}`,
      `Transfer-Encoding\t: ${value}`,
      `X: y\nTransfer-Encoding: ${value}`,
      `Transfer-Encoding: ${value}\r\nTransfer-Encoding: ${value}`,
      `Transfer-Encoding: identity\r\nTransfer-Encoding: ${value}`,
    );
  };
  const request = () => {
    const content = any('', 'hello', hidden(), `${hidden()}x=`);
    const kind = any('none', 'length', 'chunked', 'both', 'chunked', 'length');
    const lines = [];
    if (kind === 'length' || kind === 'both') lines.push(lengthOf(content));
    if (kind === 'chunked' || kind === 'both') lines.push(encoding());
    if (next() < 0.5) lines.reverse();
    if (next() < 0.1)
      lines.push(any('Connection: close', 'Connection: keep-alive', 'Expect: 100-continue', 'X: a\x01b', ': x', 'X'));
    lines.unshift(
      mostly('Host: localhost', 'Host: localhost\r\nHost: localhost', 'host:localhost', 'Host : localhost', ''),
    );
    const method = mostly(any('GET', 'POST', 'PUT'), 'DELETE', 'get', 'G\0T', 'OPTIONS');
    const version = mostly('HTTP/1.1', 'HTTP/1.0', 'HTTP/1.1 ', 'HTTP/1.2', 'http/1.1', 'HTTP/01.1', '');
    const blank = mostly(' ', '  ', '\t');
    const head = [`${method}${blank}${name()}${blank}${version}`, ...lines.filter((line) => line !== '')];
    const body =
      kind === 'chunked' || (kind === 'both' && next() < 0.5)
        ? chunked(content)
        : kind === 'none' && next() < 0.8
          ? ''
          : content;
    return head.map((line) => line + end()).join('') + end() + body;
  };
  const before = mostly('', '\r\n', '\n', ' ');
  return before + Array.from({ length: 1 + Math.floor(next() * 3) }, request).join('');
}

/** What a server says to these octets until it closes. */
function said(port, octets) {
  return new Promise((resolve, reject) => {
    const socket = connect({ port, host: '127.0.0.1', allowHalfOpen: true });
    let text = '';
    const late = setTimeout(() => socket.destroy(new Error(`no end after 20 s to ${JSON.stringify(octets)}`)), 20_000);
    socket.setEncoding('latin1');
    socket.on('connect', () => socket.end(octets, 'latin1'));
    socket.on('data', (part) => {
      text += part;
    });
    socket.on('close', () => {
      clearTimeout(late);
      resolve(text);
    });
    socket.on('error', (error) => (error.code === 'ECONNRESET' || error.code === 'EPIPE' ? undefined : reject(error)));
  });
}

/** The paths that a server answered, in order: each reply names its own. */
const pathsIn = (text) => [...text.matchAll(/\/api\/v1\/case-\d+-\d+(?:-hidden)?/g)].map(([found]) => found);
const unique = (paths) => paths.filter((each, i) => each !== paths[i - 1]);

let ours;
let folder;
let other;
const read = new Map(); // by the seed of a conversation: the paths of the requests that Node read whole
before(async () => {
  folder = await temporaryFolder();
  ours = await serve({ archive: path.join(folder.folder, 'framing.db') });
  other = createServer((request, response) => {
    request.resume();
    request.on('end', () => {
      const seed = Number(/case-(\d+)/.exec(request.url)?.[1]);
      read.set(seed, [...(read.get(seed) ?? []), request.url]);
      response.end();
    });
    request.on('error', () => {});
  });
  other.on('clientError', (_error, socket) => socket.destroy());
  await new Promise((done) => other.listen(0, '127.0.0.1', done));
});
after(async () => {
  await ours.stop();
  other.close();
  await folder.remove();
});

test('our server and Node agree on where each request ends, or one of them goes no further', async () => {
  const disagreements = [];
  let answered = 0;
  let seed = 0;
  const worker = async () => {
    while (seed < CASES) {
      const of = seed++;
      const octets = conversation(of);
      const [our] = await Promise.all([said(ours.port, octets), said(other.address().port, octets)]);
      const [a, b] = [unique(pathsIn(our)), read.get(of) ?? []];
      answered += a.length;
      const shorter = Math.min(a.length, b.length);
      if (a.slice(0, shorter).join() !== b.slice(0, shorter).join())
        disagreements.push({ seed: of, octets, ours: a, node: b });
    }
  };
  await Promise.all(Array.from({ length: AT_ONCE }, worker));
  assert.ok(answered > CASES / 2, `only ${answered} requests were answered: these cases try nothing`);
  assert.deepEqual(disagreements, []);
});
