// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/enumerations.hpp"

#include <algorithm>

namespace aeolis::dictionary {

std::vector<const Type*> enumerations_of(const std::vector<Packet>& packets, const std::vector<Command>& commands) {
    std::vector<const Type*> found;
    const auto add = [&](const Type& type) {
        const auto same_name = [&](const Type* each) { return each->name == type.name; };
        if (type.kind == ValueKind::enumerated && std::ranges::none_of(found, same_name)) found.push_back(&type);
    };
    for (const Packet& packet : packets)
        for (const Field& field : packet.fields) add(field.type);
    for (const Command& command : commands)
        for (const Argument& argument : command.arguments) add(argument.type);
    return found;
}

}  // namespace aeolis::dictionary
