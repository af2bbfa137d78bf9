// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace aeolis::server {

/// The channel of that name or alias. The Error names the field that has the name, the name, and the nearest one.
Result<const dictionary::Channel*> channel_named(const dictionary::Dictionary& dictionary, std::string_view field,
                                                 const std::string& name);

/// Ids by name and alias, for whoever looks up many; of equal words the first channel has it, as in channel_named().
std::map<std::string, std::uint32_t, std::less<>> channel_ids(const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
