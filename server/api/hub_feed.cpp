// SPDX-License-Identifier: Apache-2.0
#include "server/api/hub_feed.hpp"

#include <utility>

namespace aeolis::server {

HubFeed::Batch HubFeed::departs(Batch batch) {
    if (waiting_ > 0 && waiting_ + batch->items.size() > items_max_) {
        auto numbers = std::make_shared<pipeline::PublishedBatch>();
        numbers->run = batch->run;
        numbers->first_seq = batch->first_seq;
        numbers->last_seq = batch->last_seq;
        numbers->built = false;
        return numbers;
    }
    waiting_ += batch->items.size();
    return batch;
}

}  // namespace aeolis::server
