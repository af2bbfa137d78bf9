// SPDX-License-Identifier: Apache-2.0
#include "server/api/channel_names.hpp"

#include "common/names.hpp"

#include <fmt/format.h>

namespace aeolis::server {

Result<const dictionary::Channel*> channel_named(const dictionary::Dictionary& dictionary, std::string_view field,
                                                 const std::string& name) {
    if (const auto* channel = dictionary.channel(name)) return channel;
    return Error{fmt::format("{}: there is no channel '{}'; the nearest name is '{}'", field, name,
                             nearest(name, dictionary.channels, &dictionary::Channel::name))};
}

std::map<std::string, std::uint32_t, std::less<>> channel_ids(const dictionary::Dictionary& dictionary) {
    std::map<std::string, std::uint32_t, std::less<>> ids;
    for (const auto& channel : dictionary.channels)
        for (const auto& word : {channel.name, channel.alias}) ids.try_emplace(word, channel.id.value);
    return ids;
}

}  // namespace aeolis::server
