// SPDX-License-Identifier: Apache-2.0
// The first line of the page: short, so that what is drawn is asked for while the rest of its script is still on its way.
import { askFirst } from './run/first_look';

askFirst();
void import('./main');
