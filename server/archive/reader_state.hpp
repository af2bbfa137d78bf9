// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/column_codec.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/sqlite.hpp"
#include "telemetry/decommutator.hpp"

#include <map>
#include <vector>

// What the parts of the reader share; not for others.
namespace aeolis::archive {

/// A prepared statement in use; reset at the end of the scope, so that it never holds a snapshot open.
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
    bool finished = false;  ///< every sample is in a segment
    std::uint16_t dictionary = 0;
    Sclk entry;
};

/// A range with both ends, for SQL.
struct ClosedRange {
    double from_s = 0.0, to_s = 0.0;
    bool holds(double sclk_s) const { return from_s <= sclk_s && sclk_s <= to_s; }
};
Result<ClosedRange> closed(const SclkRange& range);
/// 1 … `most`, or an Error that says so.
Result<void> check_limit(std::size_t limit, std::size_t most);

/// What FTS5 looks for when people type words: each as it begins, all of them, whatever signs stand between. Empty when
/// there is no word in it.
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

    /// Into `decoded`.
    bool decode(std::span<const std::uint8_t> packet) {
        return other != nullptr ? !other->decode(packet, decoded) : !decommutator->decode(packet, decoded);
    }

    /// Prepared once; `sql` is a constant.
    Result<Query> query(const char* sql);
    Result<RunInfo> info(RunId run);
    /// A run as it is now: what is read while this lives belongs together.
    struct Instant {
        sqlite::Transaction snapshot;
        RunInfo run;
    };
    Result<Instant> instant(RunId run);
    Result<Sequence> last_seq(RunId run);
    Result<std::vector<RequestRecord>> requests(RunId run);  ///< as they were taken
    Result<v1::RunState> run_state(const sqlite::Statement& row);
    /// When the design had each anchor when the run began.
    Result<void> add_predicted_anchors(RunId run, v1::TimepointList& list);
    /// The item whose row stands ready, with its parts.
    /// @param words  as to_item() takes them
    template <typename Record>
    Result<v1::Item> item(const sqlite::Statement& row, const dictionary::Dictionary* words = nullptr);
    /// When each link brought nothing, and why, as was told. Call within a read transaction.
    Result<std::vector<v1::Silence>> silences(RunId run);
    /// Whether the whole recording of a run is down.
    Result<bool> recording_complete(RunId run);
    /// A unit against the other path; of one that differs, that one's octets.
    struct Verdict {
        const char* name = "";
        std::vector<std::uint8_t> other_octets{};
    };
    Result<Verdict> verdict_on(RunId run, const UnitRecord& unit, bool recording_complete);
    /// Null when the run was recorded with another dictionary.
    const dictionary::Dictionary* words_of(const RunInfo& run) const {
        return run.dictionary == dictionary.id ? &dictionary : nullptr;
    }
    Result<void> same_dictionary(const RunInfo& run) const;

    sqlite::Database database;
    const dictionary::Dictionary& dictionary;
    PacketColumns columns;
    const telemetry::OtherMission* other;  ///< none: our own
    std::optional<telemetry::Decommutator> decommutator;
    telemetry::Decoded decoded;
    ColumnCodec codec;
    std::vector<Sample> realtime, recorded, both;        ///< samples of the last exact question
    std::vector<double> segment_sclk_s, segment_values;  ///< of the segment that is being read
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
