// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/stream_hub.hpp"

#include <atomic>
#include <cstddef>
#include <memory>

namespace aeolis::server {

/// Bounds the items of batches that wait between the pipeline's thread and the hub's.
///
/// In       published batches, in order                       Out   the same, some without their items
/// Memory   at most `items_max` items wait, however late the network thread is. A batch beyond them travels as its
///          numbers alone: it is in the archive, from where the sessions read it
/// Thread   any
class HubFeed {
  public:
    using Batch = std::shared_ptr<const pipeline::PublishedBatch>;

    explicit HubFeed(std::size_t items_max = StreamHub::items_max) : items_max_(items_max) {}

    /// The batch as it is to be posted.
    Batch departs(Batch batch);
    /// Call with each batch that departed once it has reached the hub.
    void arrived(const pipeline::PublishedBatch& batch) { waiting_ -= batch.items.size(); }
    std::size_t items_waiting() const { return waiting_; }

  private:
    std::size_t items_max_;
    std::atomic<std::size_t> waiting_ = 0;
};

}  // namespace aeolis::server
