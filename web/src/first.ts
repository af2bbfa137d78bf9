// SPDX-License-Identifier: Apache-2.0
// The first script of the page. It is short, so that the plotted data are requested while the rest of the page's script
// loads.
import { askFirst } from './run/first_look';

askFirst();
void import('./main');
