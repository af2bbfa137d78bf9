// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

namespace aeolis::test {

/// A pipeline over an archive in a folder of its own, which can be opened again as after a crash.
struct ReopenedGround {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary;
    std::filesystem::path file = folder / "a.db";
    std::optional<archive::Archive> archive;
    std::optional<pipeline::Pipeline> pipeline;
    std::vector<v1::Item> published;

    explicit ReopenedGround(dictionary::Dictionary of) : dictionary(std::move(of)) { open(); }
    void open() {
        pipeline.reset();
        archive.reset();
        archive.emplace(std::move(archive::Archive::open(file)).value());
        pipeline.emplace(*archive, dictionary);
        pipeline->on_publish(
            [this](const auto& batch) { published.insert(published.end(), batch->items.begin(), batch->items.end()); });
    }
    archive::Reader reader() const { return std::move(archive::Reader::open(file, dictionary)).value(); }
    /// Compares items that are produced again with those of the archive.
    pipeline::Compare compare() const {
        return [this](const pipeline::PublishedBatch& again) -> Result<void> {
            const auto items = reader().items(again.run, again.first_seq - 1, 10'000)->items;
            for (const auto& item : again.items) {
                if (item.item_case() == v1::Item::ITEM_NOT_SET) continue;
                const auto before = std::ranges::find(items, item.seq(), &v1::Item::seq);
                if (before == items.end() || before->SerializeAsString() != item.SerializeAsString())
                    return Error{"item " + item.ShortDebugString()};
            }
            return {};
        };
    }
};

}  // namespace aeolis::test
