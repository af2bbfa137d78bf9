// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/column_codec.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "telemetry/decommutator.hpp"

#include <algorithm>
#include <map>
#include <vector>

// State shared by the parts of the reader; not for others.
namespace aeolis::archive {

/// A prepared statement in use. It is reset at the end of the scope, so that it never holds a snapshot open.
class Query {
  public:
    explicit Query(sqlite::Statement& statement) : statement_(&statement) {}
    Query(Query&& other) noexcept : statement_(std::exchange(other.statement_, nullptr)) {}
    Query& operator=(Query&&) = delete;
    ~Query() {
        if (statement_ != nullptr) statement_->reset();
    }
    sqlite::Statement& operator*() const { return *statement_; }
    sqlite::Statement* operator->() const { return statement_; }

  private:
    sqlite::Statement* statement_;
};

struct RunInfo {
    RunId run;
    bool finished = false;  ///< all samples are in segments
    std::uint16_t dictionary = 0;
    Sclk entry;
};

/// A range with both ends closed, for SQL.
struct ClosedRange {
    double from_s = 0.0, to_s = 0.0;
    bool holds(double sclk_s) const { return from_s <= sclk_s && sclk_s <= to_s; }
};
Result<ClosedRange> closed(const SclkRange& range);
/// Checks that a limit is 1 … `most`.
Result<void> check_limit(std::size_t limit, std::size_t most);

/// The numbers that are left for a page, both ends included; none when first > last.
struct Numbers {
    std::uint64_t first = 1, last = 0;
};
/// What is left after `after` of the numbers 1 … `most` in an order; 0: all of them.
inline Numbers numbers_after(std::uint64_t after, Order order, std::uint64_t most) {
    if (after == 0) return {1, most};
    if (order == Order::newest_first) return {1, std::min(after - 1, most)};
    return {std::min(after, most - 1) + 1, after < most ? most : 0};
}

/// The size of a page while it grows.
class PageSize {
  public:
    explicit PageSize(std::size_t limit) : limit_(limit) {}
    void add(std::size_t octets) {
        ++rows_;
        octets_ += octets;
    }
    bool full() const { return rows_ >= limit_ || octets_ >= page_octets_max; }

  private:
    std::size_t limit_, rows_ = 0, octets_ = 0;
};

/// The FTS5 query for words typed by a person: all of them, each as a prefix, punctuation ignored. Empty when there is
/// no word in the text.
std::string search_words(std::string_view text);

struct Sample {
    double sclk_s = 0.0;
    double value = 0.0;
    Source source{};
};

struct Reader::State {
    State(sqlite::Database database_in, const dictionary::Dictionary& dictionary_in,
          const telemetry::OtherMission* other_in)
        : database(std::move(database_in)), dictionary(dictionary_in), columns(dictionary_in), other(other_in) {
        if (other == nullptr) decommutator.emplace(dictionary_in);
    }

    /// Decodes a packet into `decoded`; false when the result is not the packet type that was stored. The id of another
    /// mission's XTCE has 16 bits, and may by chance be that of another file.
    bool decode(std::span<const std::uint8_t> octets, std::size_t packet) {
        const bool done = other != nullptr ? !other->decode(octets, decoded) : !decommutator->decode(octets, decoded);
        return done && decoded.packet == packet;
    }

    /// A statement, prepared once. `sql` must be a constant.
    Result<Query> query(const char* sql);
    Result<RunInfo> info(RunId run);
    /// A run with a read snapshot: all reads during its lifetime are consistent.
    struct Instant {
        sqlite::Transaction snapshot;
        RunInfo run;
    };
    Result<Instant> instant(RunId run);
    Result<Sequence> last_seq(RunId run);
    Result<std::vector<RequestRecord>> requests(RunId run);  ///< in the order taken
    Result<v1::RunState> run_state(const sqlite::Statement& row);
    /// Adds when each anchor was predicted at the start of the run.
    Result<void> add_predicted_anchors(RunId run, v1::TimepointList& list);
    /// Reads the item in the current row, with its parts.
    /// @param words  the dictionary for to_item()
    template <typename Record>
    Result<v1::Item> item(const sqlite::Statement& row, const dictionary::Dictionary* words = nullptr);
    /// The silences of each link and their reported reasons. Call within a read transaction.
    Result<std::vector<v1::Silence>> silences(RunId run);
    /// Whether the whole recording of a run is down.
    Result<bool> recording_complete(RunId run);
    /// A packet's verdict against the other path; with `differs`, the other packet's octets.
    struct Verdict {
        const char* name = "";
        std::vector<std::uint8_t> other_octets{};
    };
    Result<Verdict> verdict_on(RunId run, const PacketRecord& record, bool recording_complete);
    /// The dictionary when the run was recorded with it; else null.
    const dictionary::Dictionary* words_of(const RunInfo& run) const {
        return run.dictionary == dictionary.id ? &dictionary : nullptr;
    }
    Result<void> same_dictionary(const RunInfo& run) const;

    sqlite::Database database;
    const dictionary::Dictionary& dictionary;
    PacketColumns columns;
    const telemetry::OtherMission* other;  ///< null: our own mission
    std::optional<telemetry::Decommutator> decommutator;
    telemetry::Decoded decoded;
    ColumnCodec codec;
    std::vector<Sample> realtime, recorded, both;        ///< samples of the last exact query
    std::vector<double> segment_sclk_s, segment_values;  ///< of the segment being read
    std::map<const char*, sqlite::Statement> statements;
};

template <typename Record>
Result<v1::Item> Reader::State::item(const sqlite::Statement& row, const dictionary::Dictionary* words) {
    auto record = read_row<Record>(row);
    if constexpr (HasParts<Record>) {
        auto parts = query(parts_sql<PartOf<Record>>());
        if (!parts) return parts.error();
        (*parts)->bind(1, row.integer(0));
        for (;;) {
            auto found = (*parts)->step();
            if (!found) return found.error();
            if (!*found) break;
            ItemTable<Record>::parts(record).push_back(read_part<PartOf<Record>>(**parts));
        }
    }
    return item_of(record, words);
}

}  // namespace aeolis::archive
