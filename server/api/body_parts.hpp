// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/http_message.hpp"
#include "server/api/query_threads.hpp"

#include <functional>

namespace aeolis::server {

/// Reads the next part of a body. Called on a query thread, once for each part.
using ReadPart = std::function<BodyPart(archive::Reader&)>;

/// Makes HttpResponse::next_part for a body too long to be held in memory. Each part is read in a job of its own, once
/// the client has taken the part before.
decltype(HttpResponse::next_part) in_parts(QueryThreads& queries, const Asker& asker, ReadPart read);

}  // namespace aeolis::server
