// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/stream.pb.h"
#include "server/api/replay_schedule.hpp"
#include "server/api/stream_hub.hpp"

#include <deque>
#include <functional>
#include <memory>
#include <string_view>

namespace aeolis::server {

/// One client of the stream: its subscription and its progress. Knows no socket.
///
/// In       the client's messages                        Out   next_message(), when the connection can write
/// Rule     items go out in order, each once. Newest items come from the hub, older ones from the archive, page by
///          page: a slow or late client catches up from the archive. Samples are left out only below a rate that the
///          client asked for, and each batch counts them. A client that follows "the current run" gets all of one run,
///          and its end, before the next
/// Pace     a finished run goes out as fast as the archive is read or, with a pace in the subscription, as it reached
///          Earth: each item when it is due, at most one batch per replay_interval. A replay includes nothing else: no
///          run states, no clocks
/// Faults   a failed archive read is reported once and retried with every check() until it succeeds. Meanwhile no
///          clocks go out either: a console that receives nothing must not look live
/// Thread   the network thread only
/// Memory   replies_max short replies and one page of the archive
/// Load     one query at a time, whatever the client asks for meanwhile
class StreamSession : public std::enable_shared_from_this<StreamSession> {
  public:
    static constexpr std::size_t replies_max = 64;    ///< chosen: a client that sends and never reads is closed
    static constexpr std::size_t page_items = 2'048;  ///< read from the archive at once
    static constexpr std::size_t json_items = 128;    ///< chosen: per message; 2 ms of the network thread
    /// Chosen: of a client that takes less than every sample, and falls far behind.
    static constexpr double catching_up_interval_s = 1.0;
    static constexpr std::chrono::milliseconds replay_interval{50};  ///< chosen: 20 Hz, as often as a console draws

    /// What a client may do besides following the stream; the functions check its rights.
    struct Client {
        std::function<void(v1::CommandRequest, std::function<void(v1::CommandReply)>)> command;
        std::function<void(v1::RehearsalControl, std::function<void(Result<void>)>)> control;
        std::function<std::string()> refusal;  ///< why it may no longer follow; empty: it may
    };
    /// A client that only follows and is never refused.
    static Client follower();
    StreamSession(StreamHub& hub, StreamFormat format, std::function<void()> wake, Client client);
    ~StreamSession();
    StreamSession(const StreamSession&) = delete;
    StreamSession& operator=(const StreamSession&) = delete;

    StreamFormat format() const { return selection_.format; }
    /// Handles one message from the client. A request that cannot be served is answered with a Refusal.
    void on_message(std::string_view payload);
    /// The next message to write; null when there is none now: then wake() is called, or due() says when.
    Encoded next_message();
    /// When next_message() will have something without further input; none: never. Only in a replay at a pace.
    std::optional<ReplaySchedule::Clock::time_point> due() const { return due_; }
    /// Whether the client has not yet received everything for it. Items not yet due do not count.
    bool behind() const;
    /// Whether the client is served a finished run or a replay.
    bool replays() const { return subscribed_ && run_ != 0 && !follows_current(); }
    /// Why the connection should close; empty: it should not.
    std::string closing() const;
    /// Checks the client's rights again and retries a failed archive read. The hub calls it periodically.
    void check();
    void wake() { wake_(); }

  private:
    void look_at_rights();
    void subscribe(const v1::Subscribe& subscribe);
    /// Why this run cannot be replayed at that pace; empty: it can.
    std::string refusal_of_pace(double pace, std::uint64_t run) const;
    void read_run(std::uint64_t run, archive::Sequence after);
    void stall(const std::string& why, std::function<void()> retry);
    /// Ends the subscription, because its run no longer exists.
    void lose_run(std::string why);
    void refuse(std::string reason, bool goes_on = false);
    void reply(const v1::ServerMessage& message);
    void follow(std::uint64_t run, archive::Sequence after);
    Encoded next_due();
    Encoded welcome();
    /// A message that says how far the client has come, without items.
    Encoded progress();
    Encoded next_items();
    Encoded from_page();
    /// Takes from the page the items that go out next: all, json_items of them or, with a pace, those due. None:
    /// nothing yet.
    std::optional<archive::ItemPage> take_page();
    void ask_archive();
    void read_page();
    /// Whether the client has received all of its run and the run's final state.
    bool gave_all_of_run() const;
    Encoded last_state_of_run();
    /// Queries the archive now, or after the query in progress. Of waiting queries only the newest is kept.
    void ask(std::function<void()> question);
    void answered();
    bool follows_current() const { return !replay_ && run_ != 0 && run_ == hub_.current_run(); }

    StreamHub& hub_;
    std::function<void()> wake_;
    Client client_;
    std::string refusal_;
    StreamSelection selection_;
    std::deque<Encoded> replies_;

    bool subscribed_ = false, newest_run_ = false;  ///< newest_run_: subscribed to run 0
    bool welcome_due_ = false, waiting_for_run_ = false;
    std::uint64_t run_ = 0;
    std::uint64_t subscription_ = 0;                        ///< answers to an older subscription are dropped
    v1::RunState older_run_;                                ///< state of a run that is not current, or is replayed
    double pace_ = 0.0;                                     ///< of the subscription; 0: none
    std::optional<ReplaySchedule> replay_;                  ///< none: as fast as it is read
    std::optional<ReplaySchedule::Clock::time_point> due_;  ///< when the next item is due; none: nothing waits
    ReplaySchedule::Clock::time_point next_batch_{};        ///< earliest time of the next batch
    archive::Sequence cursor_ = 0;                          ///< served up to here
    archive::Sequence sent_through_ = 0;                    ///< last complete_through sent to the client
    std::uint64_t left_out_ = 0;                            ///< samples left out after it, up to the cursor
    LeftOutBefore left_out_before_;                         ///< by a page, and not marked yet
    bool asking_ = false;                                   ///< an archive query is in progress
    std::function<void()> next_question_;                   ///< null: none waits
    bool reading_ = false, exhausted_ = false, was_live_ = false;
    std::function<void()> retry_;  ///< retries the failed archive read; null: none failed
    bool stall_told_ = false;      ///< reported, and nothing read since
    std::optional<archive::ItemPage> page_;
    std::size_t page_taken_ = 0;  ///< number of its items
    SampleSpacing page_spacing_;
    std::uint64_t state_sent_ = 0, clocks_sent_ = 0;
    bool tell_through_ = false;  ///< send complete_through with a new state, also where no item carries it
};

}  // namespace aeolis::server
