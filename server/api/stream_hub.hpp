// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/stream.pb.h"
#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server {

class StreamSession;

enum class StreamFormat : std::uint8_t { protobuf, json };

/// An encoded message, shared by all clients that receive the same.
using Encoded = std::shared_ptr<const std::string>;
Encoded encode(const v1::ServerMessage& message, StreamFormat format);

/// What a subscription selects and how it is encoded. Clients with equal selections receive the same octets.
struct StreamSelection {
    StreamFormat format{};
    bool all_channels = false;
    std::vector<std::uint32_t> channels;  ///< ascending
    double max_rate_hz = 0.0;
    bool packets = true;
    /// Least vehicle time between two samples of a packet that go out; 0: every sample goes out.
    double interval_s() const { return max_rate_hz > 0.0 ? 1.0 / max_rate_hz : 0.0; }
    bool operator==(const StreamSelection&) const = default;
};

/// Facts about an item's samples, computed once for all clients. They make thinning stateless per client: whether an
/// item, and the one before it, goes out at some rate follows from them alone.
struct SampleFacts {
    double time_s = 0.0;                                      ///< by which their rate counts; see SampleSpacing
    std::optional<double> previous_s{}, before_previous_s{};  ///< of the same packet
    float stretch = 1.0F, previous_stretch = 1.0F;            ///< of the interval; see Held
    bool first = true;                                        ///< without a previous one: whether none exists
    bool ascend = false;                                      ///< their channel ids ascend: allows binary search
    std::uint64_t packet = 0;                                 ///< tells packets apart; 0: no samples
};
/// A published item with the facts about its samples.
struct ItemWithFacts {
    const v1::Item* item = nullptr;
    SampleFacts facts;
};

/// An item at some client rate; each client receives those of its samples that it subscribed to.
struct RatedItem {
    const v1::Item* item = nullptr;
    bool left_out = false;  ///< only counted
    bool thinned = false, ascend = false;
    std::uint64_t packet = 0;  ///< as in SampleFacts
};

/// Packets whose newest sample a session left out by an interval of its own, which the hub's facts do not contain. The
/// next sample of each is marked as thinned.
using LeftOutBefore = std::vector<std::uint64_t>;

/// Adds the selected items to a Batch. Commands, events, alarms, tones, firings, explanations, links: all.
/// Samples: the subscribed channels; with `interval_s` > 0 one item a packet in each interval of vehicle time, the
/// others counted in left_out. Packets: those received live, if the selection includes packets; the recording's are at
/// /packets.
void select_items(const StreamSelection& selection, double interval_s, std::span<const ItemWithFacts> items,
                  v1::Batch& batch);

/// The times by which a client's rate is counted.
enum class RateBy : std::uint8_t {
    vehicle,    ///< the vehicle's time: of our mission, whose clock never stands still
    reception,  ///< of another mission's packets, whose clocks may
};

/// Finds the samples before each item's samples. Call in item order.
class SampleSpacing {
  public:
    /// @param from_start  no item of the run, or of the subscription, comes before the first one
    explicit SampleSpacing(bool from_start = true, RateBy by = RateBy::vehicle) : from_start_(from_start), by_(by) {}
    /// @param stretch  factor by which intervals are longer now, >= 1
    SampleFacts next(const v1::Item& item, float stretch = 1.0F);
    /// Updates the packets whose newest sample is left out at a rate.
    void add_left_out(double interval_s, LeftOutBefore& packets) const;

  private:
    struct Last {
        std::uint64_t packet = 0;  ///< its channels, and source
        double time_s = 0.0;
        std::optional<double> previous_s;
        float stretch = 1.0F;
    };
    bool from_start_;
    RateBy by_;
    std::vector<Last> last_;
};

/// The live end of the stream: the current run, its newest items and its clocks.
///
/// In       published batches, run states, clocks             Out   wakes its sessions; encodes for them
/// Thread   the network thread only
/// Memory   the newest `items_max` items. A session reads older ones from the archive: a slow client costs no memory
class StreamHub {
  public:
    static constexpr std::size_t items_max = 16'384;         ///< chosen: about 4 MB, a minute of live data at 1 ×
    static constexpr std::size_t message_items_max = 2'048;  ///< in one Batch: about 300 KiB
    static constexpr std::size_t shared_encodings = 32;

    /// What sessions need from the rest of the server. Callbacks are called on the network thread.
    struct Services {
        std::function<void(archive::RunId, archive::Sequence after, std::size_t limit, archive::Reader::ItemKinds,
                           std::function<void(Result<archive::ItemPage>)>)>
            read_items;
        std::function<void(std::uint64_t run, std::function<void(Result<v1::RunState>)>)> read_run;
        std::function<void(bool wanted)> want_items;
        /// The id of a channel by its name or alias. The Error names the one that is none.
        std::function<Result<std::uint32_t>(const std::string& name)> channel_id =
            [](const std::string& name) -> Result<std::uint32_t> {
            return Error{"channel_names: there is no channel '" + name + "'"};
        };
        /// Whether a channel has this id.
        std::function<bool(std::uint32_t id)> has_channel = [](std::uint32_t) { return true; };
        /// The clock for replays at a pace.
        std::function<std::chrono::steady_clock::time_point()> now = std::chrono::steady_clock::now;
        RateBy rate_by = RateBy::vehicle;
    };
    StreamHub(std::uint16_t dictionary_id, Services services);

    void published(std::shared_ptr<const pipeline::PublishedBatch> batch);
    void run_state(v1::RunState state);
    void clocks(v1::Clocks clocks);
    /// Sets why nothing can be stored now; empty when storing works. Sent with the run state.
    void archive_fault(std::string fault);
    /// How this server stands with others; sent with the run state (docs/scale.md).
    struct Standing {
        std::string follows, unpublished;  ///< as in RunState
        bool origin_lost = false;
        bool operator==(const Standing&) const = default;
    };
    void standing(Standing standing);

    void add(StreamSession& session);
    void remove(StreamSession& session);
    /// Closes clients that may no longer follow.
    void check_clients();
    std::size_t sessions() const { return sessions_.size(); }
    std::size_t sessions_replaying() const;  ///< that receive another run than the current one, or a replay of that
    std::size_t sessions_behind() const;     ///< that have not yet received everything

    // ---- for sessions ------------------------------------------------------------------------------------------
    const Services& services() const { return services_; }
    std::uint16_t dictionary_id() const { return dictionary_id_; }
    std::uint64_t current_run() const { return state_.run(); }  ///< 0: none yet
    const v1::RunState& state() const { return state_; }
    std::uint64_t state_version() const { return state_version_; }
    /// The run before the current one, in its last state; run 0: none since the server started.
    const v1::RunState& previous_run_state() const { return previous_run_state_; }
    /// The state_version() of previous_run_state().
    std::uint64_t previous_run_state_version() const { return previous_run_state_version_; }
    const v1::Clocks& latest_clocks() const { return clocks_; }
    std::optional<Ert> ert_now() const;  ///< by the latest clocks; none: not known
    std::uint64_t clocks_version() const { return clocks_version_; }
    archive::Sequence last_seq() const { return last_seq_; }  ///< last item published of the current run
    bool holds(archive::Sequence after) const;                ///< whether every item after `after` is still in memory

    struct EncodedRange {
        Encoded message;  ///< null: nothing in this range matches the selection, or is due at its rate
        archive::Sequence through = 0;
        std::uint64_t left_out = 0;  ///< after sent_through up to `through`
    };
    /// The items after `after`, at most message_items_max, encoded for `selection`. Requires holds(after).
    /// @param left_out         samples left out after `sent_through` up to `after`
    /// @param left_out_before  of the items up to `after`; those marked in this range are removed
    EncodedRange encoded_range(const StreamSelection& selection, archive::Sequence after,
                               archive::Sequence sent_through, std::uint64_t left_out, LeftOutBefore& left_out_before);
    Encoded encoded_state(StreamFormat format);

    struct Figures {
        std::uint64_t items = 0, encodings = 0, shared = 0, archive_pages = 0, refusals = 0;
        std::uint64_t messages = 0, octets = 0;  ///< handed to clients
    };
    Figures figures;

  private:
    struct Held {
        std::shared_ptr<const pipeline::PublishedBatch> batch;
        std::vector<SampleFacts> facts;  ///< per item, with the stretch of intervals when it was published
    };
    struct Cached {
        StreamSelection selection;
        archive::Sequence after = 0, sent_through = 0, last_seq = 0;
        std::uint64_t left_out = 0, clocks_version = 0;
        EncodedRange encoded;
    };
    /// The items after `after` at one rate. Most clients are equally far, whatever their channels, so that
    /// this is shared.
    struct Range {
        archive::Sequence after = 0, last_seq = 0, through = 0;
        double interval_s = 0.0;
        bool packets = false;
        std::vector<RatedItem> items;
    };
    void wake_all();
    void add_own(v1::RunState& state) const;
    const Range& range_after(archive::Sequence after, double interval_s, bool packets);
    EncodedRange encode_range(const StreamSelection& selection, const Range& range, std::span<const RatedItem> items,
                              archive::Sequence sent_through, std::uint64_t left_out);
    void forget_items();

    std::uint16_t dictionary_id_;
    Services services_;
    std::vector<StreamSession*> sessions_;
    v1::RunState state_, previous_run_state_;
    std::uint64_t previous_run_state_version_ = 0;
    v1::Clocks clocks_;
    std::uint64_t state_version_ = 0, clocks_version_ = 0;
    archive::Sequence last_seq_ = 0;
    std::deque<Held> held_;  ///< without gaps, up to last_seq_
    std::size_t held_items_ = 0;
    SampleSpacing spacing_;
    std::optional<Range> range_;  ///< of the held items; none: not yet computed
    std::deque<Cached> cache_;
    std::string archive_fault_;
    Standing standing_;
    std::array<Encoded, 2> state_encoded_;
    std::uint64_t state_encoded_version_ = 0;
};

}  // namespace aeolis::server
