// SPDX-License-Identifier: Apache-2.0
// A proxy in front of the server. It answers some routes itself, forwards the others, and gives each page the content
// security policy of a server with accounts. Its answers can be changed while pages use it.
import { once } from 'node:events';
import { createServer, request } from 'node:http';
import { connect } from 'node:net';

const POLICY =
  "default-src 'self'; connect-src 'self'; img-src 'self' data:; style-src 'self'; script-src 'self'; worker-src 'self'; " +
  "object-src 'none'; base-uri 'none'; frame-ancestors 'none'";

/**
 * Starts the proxy. `routes`: { 'GET /session': (body) => [status, answer] }; `gate(path)`: false refuses an API
 * request with 401.
 */
export async function standIn(address, routes, gate = () => true) {
  const { hostname, port, host } = new URL(address);
  const asked = [];
  const sockets = new Set();
  const onward = (headers) => ({ ...headers, host, ...(headers.origin && { origin: address }) });
  const json = (answer, status, value) =>
    answer
      .writeHead(status, { 'content-type': 'application/json' })
      .end(value === undefined ? '' : JSON.stringify(value));
  const server = createServer(async (question, answer) => {
    const path = question.url.replace(/^\/api\/v1/, '');
    if (question.url.startsWith('/api/')) {
      const route = routes[`${question.method} ${path}`] ?? routes[`${question.method} ${path.split('?')[0]}`];
      if (!gate(path)) return json(answer, 401, { error: 'log in first' });
      if (route) {
        let text = '';
        for await (const chunk of question) text += chunk;
        const body = text === '' ? undefined : JSON.parse(text);
        asked.push({ method: question.method, path, body });
        return json(answer, ...route(body));
      }
    }
    const sent = request(
      { hostname, port, path: question.url, method: question.method, headers: onward(question.headers) },
      (theirs) => {
        answer.writeHead(theirs.statusCode, { ...theirs.headers, 'content-security-policy': POLICY });
        theirs.pipe(answer);
      },
    );
    sent.on('error', () => answer.destroy());
    question.pipe(sent);
  });
  server.on('upgrade', (question, near, head) => {
    if (!gate('/stream')) return near.end('HTTP/1.1 401 Unauthorized\r\n\r\n');
    const far = connect(Number(port), hostname, () => {
      far.write(
        `GET ${question.url} HTTP/1.1\r\n${Object.entries(onward(question.headers))
          .map(([name, value]) => `${name}: ${value}\r\n`)
          .join('')}\r\n`,
      );
      far.write(head);
      far.pipe(near).pipe(far);
    });
    sockets.add(near);
    for (const [one, other] of [
      [near, far],
      [far, near],
    ])
      one.on('error', () => other.destroy()).on('close', () => other.destroy());
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  const drop = () => {
    for (const socket of sockets) socket.destroy();
    sockets.clear();
  };
  return {
    address: `http://127.0.0.1:${server.address().port}`,
    asked,
    drop,
    close: () => {
      drop();
      server.closeAllConnections();
      server.close();
    },
  };
}
