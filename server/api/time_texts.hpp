// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message.h>

namespace aeolis::server {

/// Writes the texts of all times in an HTTP answer: day-of-year, to the millisecond.
void write_time_texts(google::protobuf::Message& answer);

}  // namespace aeolis::server
