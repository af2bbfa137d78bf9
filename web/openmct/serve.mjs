// Serves Open MCT with the plugin beside a running Aeolis, under one origin: /api goes on to it, as the server asks for.
//   node serve.mjs [http://127.0.0.1:8080 [PORT]]
import { createReadStream } from 'node:fs';
import { createServer, request } from 'node:http';
import { connect } from 'node:net';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const here = path.dirname(fileURLToPath(import.meta.url));
const TYPES = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml', '.png': 'image/png' };

/** Answers with the server that listens on loopback, on a free port when `port` is 0. */
export function serve(aeolis, port = 0) {
  const { hostname, port: theirs, host } = new URL(aeolis);
  const forwarded = (headers) => ({ ...headers, host, ...(headers.origin && { origin: aeolis }) });
  const server = createServer((asked, answer) => {
    const { pathname } = new URL(asked.url, aeolis);
    if (pathname.startsWith('/api/')) {
      if (asked.method !== 'GET') return answer.writeHead(405).end('this page only reads\n');
      const onward = request({ hostname, port: theirs, path: asked.url, headers: forwarded(asked.headers) }, (theirs) => {
        answer.writeHead(theirs.statusCode, theirs.headers);
        theirs.pipe(answer);
      });
      onward.on('error', (error) => answer.writeHead(502).end(JSON.stringify({ error: `${aeolis} does not answer: ${error.message}` })));
      return onward.end();
    }
    const [root, name] = pathname.startsWith('/openmct/') ? ['node_modules/openmct/dist', pathname.slice('/openmct/'.length)] : ['', pathname === '/' ? 'index.html' : pathname.slice(1)];
    if (root === '' && !['index.html', 'plugin.js'].includes(name)) return answer.writeHead(404).end();
    const base = path.join(here, root);
    const file = path.join(base, path.normalize(`/${decodeURIComponent(name)}`));
    createReadStream(file).on('error', () => answer.writeHead(404).end())
      .on('open', () => answer.writeHead(200, { 'content-type': TYPES[path.extname(file)] ?? 'application/octet-stream' })).pipe(answer);
  });
  server.on('upgrade', (asked, socket, head) => {
    const onward = connect(Number(theirs), hostname, () => {
      const headers = Object.entries(forwarded(asked.headers)).map(([name, value]) => `${name}: ${value}\r\n`).join('');
      onward.write(`GET ${asked.url} HTTP/1.1\r\n${headers}\r\n`);
      onward.write(head);
      onward.pipe(socket).pipe(onward);
    });
    for (const [one, other] of [[onward, socket], [socket, onward]]) one.on('error', () => other.destroy()).on('close', () => other.destroy());
  });
  return new Promise((resolve, reject) => server.once('error', reject).listen(port, '127.0.0.1', () => resolve(server)));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [aeolis = 'http://127.0.0.1:8080', port = '8081'] = process.argv.slice(2);
  await serve(aeolis, Number(port));
  console.log(`Open MCT on http://127.0.0.1:${port}, reading ${aeolis}`);
}
