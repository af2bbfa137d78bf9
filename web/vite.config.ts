// SPDX-License-Identifier: Apache-2.0
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

// `npm run dev` shows the page from its sources; the server behind it is `aeolis serve`, at AEOLIS_SERVER.
const server = process.env.AEOLIS_SERVER ?? 'http://127.0.0.1:8080';

type Output =
  | { type: 'asset'; fileName: string }
  | { type: 'chunk'; fileName: string; isEntry: boolean; name: string; imports: string[] };

/** The script that `first.ts` imports, and what that imports itself. */
function firstLoad(outputs: Output[]): string[] {
  const chunks = outputs.filter((output) => output.type === 'chunk');
  const found = new Set<string>();
  const add = (fileName: string) => {
    const chunk = chunks.find((each) => each.fileName === fileName);
    if (!chunk || found.has(fileName)) return;
    found.add(fileName);
    for (const each of chunk.imports) add(each);
  };
  for (const chunk of chunks) if (chunk.name === 'main') add(chunk.fileName);
  return chunks.filter(({ fileName, isEntry }) => found.has(fileName) && !isEntry).map(({ fileName }) => fileName);
}

/**
 * The page's first line imports the rest of its script, its style names the type: the document asks for all at once.
 * Panels that are loaded when opened stay out.
 */
const preloadFirst: Plugin = {
  name: 'preload-first',
  transformIndexHtml: {
    order: 'post',
    handler: (_html, { bundle = {} }) => [
      ...firstLoad(Object.values(bundle)).map((fileName) => ({
        tag: 'link',
        attrs: { rel: 'modulepreload', crossorigin: true, href: `./${fileName}` },
        injectTo: 'head' as const,
      })),
      ...Object.values(bundle)
        .filter(({ fileName }) => fileName.endsWith('.woff2'))
        .map(({ fileName }) => ({
          tag: 'link',
          attrs: { rel: 'preload', as: 'font', type: 'font/woff2', crossorigin: true, href: `./${fileName}` },
          injectTo: 'head' as const,
        })),
    ],
  },
};

export default defineConfig({
  plugins: [preloadFirst],
  base: './',
  build: {
    target: 'es2023',
    sourcemap: false,
    cssCodeSplit: false,
    modulePreload: false,
    // Two scripts make the first load, what asks first and the rest; split further they compress worse.
    rolldownOptions: {
      output: {
        codeSplitting: {
          groups: [
            { name: 'asks', test: /src\/run\/first_look\.ts$|preload-helper/, priority: 2 },
            { name: 'page', test: /src\/main\.tsx$/, priority: 1 },
          ],
        },
      },
    },
  },
  worker: { format: 'es' },
  oxc: { jsx: { runtime: 'automatic', importSource: 'preact' } },
  server: {
    host: '127.0.0.1',
    fs: { allow: ['.', '../docs'] },
    proxy: { '/api': { target: server, ws: true, changeOrigin: true, headers: { origin: server } } },
  },
  test: { environment: 'node', css: true, include: ['src/**/*.spec.{ts,tsx}'] },
});
