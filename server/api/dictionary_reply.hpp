// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "dictionaries/dictionary.hpp"

namespace aeolis::server {

/// The dictionary as the console receives it.
v1::DictionaryReply dictionary_reply(const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
