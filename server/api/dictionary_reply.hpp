// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "dictionaries/dictionary.hpp"
#include "server/procedures/call_list.hpp"

#include <string>

namespace aeolis::server {

/// Adds the limits of one context, named in words; empty: those without a context.
void add_limits(const dictionary::Alarms& alarms, const std::string& context,
                google::protobuf::RepeatedPtrField<v1::AlarmLimit>& limits);

/// The dictionary as the console receives it, with the mission's standard calls.
v1::DictionaryReply dictionary_reply(const dictionary::Dictionary& dictionary, const procedures::CallList& calls);

}  // namespace aeolis::server
