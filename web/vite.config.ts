import { defineConfig } from 'vitest/config';

// `npm run dev` shows the page from its sources; the server behind it is `aeolis serve`, at AEOLIS_SERVER.
const server = process.env['AEOLIS_SERVER'] ?? 'http://127.0.0.1:8080';

export default defineConfig({
  base: './',
  build: { target: 'es2023', sourcemap: false, modulePreload: { polyfill: false } },
  worker: { format: 'es' },
  oxc: { jsx: { runtime: 'automatic', importSource: 'preact' } },
  server: { host: '127.0.0.1', fs: { allow: ['.', '../docs'] }, proxy: { '/api': { target: server, ws: true, changeOrigin: true, headers: { origin: server } } } },
  test: { environment: 'node', css: true, include: ['src/**/*.spec.{ts,tsx}'] },
});
