// SPDX-License-Identifier: Apache-2.0
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

// `npm run dev` shows the page from its sources; the server behind it is `aeolis serve`, at AEOLIS_SERVER.
const server = process.env.AEOLIS_SERVER ?? 'http://127.0.0.1:8080';

/** The page's first line imports the rest of its script: the document asks for all of it at once. */
const preloadScript: Plugin = {
  name: 'preload-script',
  transformIndexHtml: {
    order: 'post',
    handler: (_html, { bundle = {} }) =>
      Object.values(bundle)
        .filter((chunk) => chunk.type === 'chunk' && !chunk.isEntry)
        .map(({ fileName }) => ({
          tag: 'link',
          attrs: { rel: 'modulepreload', crossorigin: true, href: `./${fileName}` },
          injectTo: 'head' as const,
        })),
  },
};

export default defineConfig({
  plugins: [preloadScript],
  base: './',
  build: { target: 'es2023', sourcemap: false, cssCodeSplit: false, modulePreload: false },
  worker: { format: 'es' },
  oxc: { jsx: { runtime: 'automatic', importSource: 'preact' } },
  server: {
    host: '127.0.0.1',
    fs: { allow: ['.', '../docs'] },
    proxy: { '/api': { target: server, ws: true, changeOrigin: true, headers: { origin: server } } },
  },
  test: { environment: 'node', css: true, include: ['src/**/*.spec.{ts,tsx}'] },
});
