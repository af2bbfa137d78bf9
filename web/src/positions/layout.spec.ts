// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { expect, it } from 'vitest';
import { isShown } from '../layouts/model';
import { showView } from '../places/model';
import { pictureOf } from '../run/address';
import { dictionary, notices } from '../run/shown';
import { aServer } from '../testing/server';
import { POSITION_VIEWS } from './layout';
import { layoutOf, showLayoutOf } from './own_layout';

const server = aServer();

it.each(Object.entries(POSITION_VIEWS))('the layout of %s shows panels that there are', (_, view) => {
  dictionary.value = undefined; // so that it looks at panels alone
  const { picture, problems } = pictureOf(view);
  expect([...problems, ...showView(picture)]).toEqual([]);
  showView({});
});

it('a person’s own layout of the position’s name stands for the one that ships, in any case', () => {
  const own = { name: 'gnc', view: 'data=notes', saved: '' };
  expect(layoutOf('gnc', [own])).toBe(own);
  expect(layoutOf('gnc', [])).toMatchObject({ name: 'GNC', view: POSITION_VIEWS.gnc });
  expect(layoutOf('nobody', [])).toBeUndefined();
});

it('where a person’s own layouts are not known, the one that ships is shown as that', async () => {
  dictionary.value = undefined;
  server.routes['GET /layouts'] = { status: 503, json: { error: 'busy' } };
  await showLayoutOf('systems');
  expect(isShown({ name: '', view: POSITION_VIEWS.systems, saved: '' })).toBe(true);
  expect(notices.value.map(({ text }) => text)).toEqual(['Systems as it ships, for the layouts are not known: busy']);
  showView({});
});
