// SPDX-License-Identifier: Apache-2.0
#include "server/api/body_parts.hpp"

#include <fmt/format.h>
#include <memory>

namespace aeolis::server {

decltype(HttpResponse::next_part) in_parts(QueryThreads& queries, const Asker& asker, ReadPart read) {
    const auto shared = std::make_shared<ReadPart>(std::move(read));
    return [&queries, asker, shared](const std::function<void(BodyPart)>& tell) {
        const auto job = [shared, tell](archive::Reader& reader) {
            try {
                tell((*shared)(reader));
            } catch (const std::exception& bug) {
                tell(Error{fmt::format("this is a fault of the server: {}", bug.what())});
            }
        };
        // A part takes milliseconds, and a started answer must not be cut off because many queries wait: so it queues
        // with the stream's pages.
        if (!queries.ask(job, asker, JobPriority::soon)) tell(Error{"too many questions wait"});
    };
}

}  // namespace aeolis::server
