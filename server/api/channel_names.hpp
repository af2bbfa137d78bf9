// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <string>
#include <string_view>

namespace aeolis::server {

/// The channel of that name or alias. The Error names the field that has the name, the name, and the nearest one.
Result<const dictionary::Channel*> channel_named(const dictionary::Dictionary& dictionary, std::string_view field,
                                                 const std::string& name);

}  // namespace aeolis::server
