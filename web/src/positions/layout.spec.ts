// SPDX-License-Identifier: Apache-2.0
// @vitest-environment happy-dom
import { expect, it } from 'vitest';
import { showView } from '../places/model';
import { pictureOf } from '../run/address';
import { dictionary } from '../run/shown';
import { POSITION_VIEWS } from './layout';
import { layoutOf } from './own_layout';

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
