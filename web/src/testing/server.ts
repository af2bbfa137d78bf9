// SPDX-License-Identifier: Apache-2.0
// A server with a few routes for tests: it returns the given answers and keeps the requests.
import { afterEach, beforeEach, vi } from 'vitest';

interface Said {
  status?: number;
  json?: unknown;
  octets?: Uint8Array | ReadableStream;
}
type Answer = Said | (() => Said | Promise<Said>);

export interface FakeServer {
  /** The answers by route, "GET /session". Other routes return 404. */
  routes: Record<string, Answer>;
  asked: { method: string; path: string; body: unknown }[];
}

export function aServer(): FakeServer {
  const server: FakeServer = { routes: {}, asked: [] };
  beforeEach(() => {
    server.routes = {};
    server.asked = [];
    vi.stubGlobal('fetch', async (url: string, options: RequestInit = {}) => {
      const [method, path] = [options.method ?? 'GET', url.replace(/^.*\/api\/v1/, '')];
      server.asked.push({
        method,
        path,
        body: options.body === undefined ? undefined : JSON.parse(String(options.body)),
      });
      const found = server.routes[`${method} ${path}`];
      if (!found) return new Response('{"error":"no such route"}', { status: 404 });
      const { status = 200, json, octets } = typeof found === 'function' ? await found() : found;
      options.signal?.throwIfAborted();
      if (status === 0) throw new TypeError('Failed to fetch');
      return new Response((octets as BodyInit) ?? (json === undefined ? null : JSON.stringify(json)), { status });
    });
  });
  afterEach(() => void vi.unstubAllGlobals());
  return server;
}
