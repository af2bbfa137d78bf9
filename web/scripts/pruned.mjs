// SPDX-License-Identifier: Apache-2.0
// A part of a schema, so that a script carries no descriptors that it never uses.

/**
 * The messages and enums of `set` that `roots` need, with all their fields but those named in `without`. A nested type
 * brings the message around it. Files that are empty then are left out. Names are full: `.package.Message`,
 * `.package.Message.field`. Changes `set`; throws on a name that it lacks.
 */
export function pruned(set, roots, without) {
  const left = new Set(without);
  const types = new Map(); // full name → the file that has it, and the names of the types that it needs
  const enter = (file, name, message, around) => {
    message.field = message.field.filter((field) => !left.delete(`${name}.${field.name}`));
    const inside = [...message.nestedType, ...message.enumType].map((each) => `${name}.${each.name}`);
    const fields = message.field.flatMap(({ typeName }) => (typeName ? [typeName] : []));
    types.set(name, { file, needs: [...fields, ...inside, ...around] });
    for (const each of message.nestedType) enter(file, `${name}.${each.name}`, each, [name]);
    for (const each of message.enumType) types.set(`${name}.${each.name}`, { file, needs: [name] });
  };
  for (const file of set.file) {
    for (const each of file.messageType) enter(file, `.${file.package}.${each.name}`, each, []);
    for (const each of file.enumType) types.set(`.${file.package}.${each.name}`, { file, needs: [] });
  }
  if (left.size > 0) throw new Error(`the schema lacks the field ${[...left].join(', ')}`);

  const needed = new Map();
  const need = (name) => {
    if (needed.has(name)) return;
    const type = types.get(name);
    if (!type) throw new Error(`the schema lacks ${name}`);
    needed.set(name, type);
    type.needs.forEach(need);
  };
  roots.forEach(need);

  const inside = (file, each) => needed.has(`.${file.package}.${each.name}`);
  return {
    ...set,
    file: set.file.flatMap((file) => {
      const its = [...needed.values()].filter((type) => type.file === file);
      if (its.length === 0) return [];
      const imports = new Set(its.flatMap(({ needs }) => needs.map((name) => needed.get(name).file.name)));
      return {
        ...file,
        dependency: file.dependency.filter((name) => imports.has(name)),
        messageType: file.messageType.filter((each) => inside(file, each)),
        enumType: file.enumType.filter((each) => inside(file, each)),
      };
    }),
  };
}
