// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef } from 'preact/hooks';

/**
 * The end of a list that scrolls, last in it. While it is out of sight the list has `data-goes-on`, and fades out at
 * its foot: no row ends in the middle of its letters.
 */
export function Foot({ as: Tag = 'div' }: { as?: 'div' | 'li' }) {
  const end = useRef<HTMLElement & HTMLDivElement & HTMLLIElement>(null);
  useEffect(() => {
    const list = end.current?.parentElement;
    if (!end.current || !list) return;
    const seen = new IntersectionObserver(
      (entries) => list.toggleAttribute('data-goes-on', entries.at(-1)?.isIntersecting === false),
      { root: list, rootMargin: '2px' },
    );
    seen.observe(end.current);
    return () => seen.disconnect();
  }, []);
  return <Tag ref={end} class="foot" aria-hidden="true" />;
}
