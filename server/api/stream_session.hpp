// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/stream.pb.h"
#include "server/api/replay_pace.hpp"
#include "server/api/stream_hub.hpp"

#include <deque>
#include <functional>
#include <memory>
#include <string_view>

namespace aeolis::server {

/// One client of the stream: what it asked for and how far it has been served. Knows no socket.
///
/// In       the client's messages                        Out   next_message(), when the connection can write
/// Rule     items go out in order, each once. What the hub still holds comes from there; older items from the archive,
///          page by page. So a client that is slow, or came late, reads the archive and catches up. Who follows
///          whichever run goes on gets all of one, and how it ended, before the next
/// Pace     a run that is over goes out as fast as the archive is read, or, where the subscription has a pace, as it
///          reached Earth: an item each when it is due, in a batch each replay_interval at most. Who replays follows
///          nothing else: no run's state, no clocks
/// Faults   what the archive does not give is said once, and asked for again with every check() until it comes;
///          meanwhile no clocks go out either: a console that gets nothing must not look as if it were live
/// Thread   the network thread only
/// Memory   replies_max short replies and one page of the archive
/// Load     one question at a time is with the archive, whatever the client asks for meanwhile
class StreamSession : public std::enable_shared_from_this<StreamSession> {
  public:
    static constexpr std::size_t replies_max = 64;    ///< ours: a client that sends and never reads is closed
    static constexpr std::size_t page_items = 2'048;  ///< read from the archive at once
    static constexpr std::size_t json_items =
        128;  ///< ours: of a page in one message of JSON, some 2 ms of the network thread
    static constexpr double catching_up_interval_s = 1.0;  ///< ours: samples of one who fell behind are thinned to 1 Hz
    static constexpr std::chrono::milliseconds replay_interval{50};  ///< ours: 20 Hz, as often as a console draws

    /// What a client does besides following the stream, with its rights checked.
    struct Client {
        std::function<void(v1::CommandRequest, std::function<void(v1::CommandReply)>)> command;
        std::function<void(v1::RehearsalControl, std::function<void(Result<void>)>)> control;
        std::function<std::string()> refusal;  ///< why it may follow no longer; empty: it may
    };
    /// Follows, may do nothing else, and is never sent away.
    static Client follower();
    StreamSession(StreamHub& hub, StreamFormat format, std::function<void()> wake, Client client);
    ~StreamSession();
    StreamSession(const StreamSession&) = delete;
    StreamSession& operator=(const StreamSession&) = delete;

    StreamFormat format() const { return shape_.format; }
    /// One message from the client. What cannot be done is answered with a Refusal.
    void on_message(std::string_view payload);
    /// What to write next; null when there is nothing now: wake() comes when that changes, or due() says when.
    Encoded next_message();
    /// When next_message() has something without anything else happening; none: it does not. Only of a run sent again
    /// at a pace.
    std::optional<ReplayPace::Clock::time_point> due() const { return due_; }
    /// Whether there is something for it that it has not been given; what is not due yet is not for it.
    bool behind() const;
    /// Why the connection should close; empty: it should not.
    std::string closing() const;
    /// Looks again whether the client may follow, and asks again for what the archive did not give. The hub calls it
    /// now and then.
    void check();
    void wake() { wake_(); }

  private:
    void look_at_rights();
    void subscribe(const v1::Subscribe& subscribe);
    /// Why no run can be sent at that pace, or not this one; empty: it can.
    std::string refusal_of_pace(double pace, std::uint64_t run) const;
    void read_run(std::uint64_t run, archive::Sequence after);
    void stall(const std::string& why, std::function<void()> again);
    void refuse(std::string reason);
    void reply(const v1::ServerMessage& message);
    void follow(std::uint64_t run, archive::Sequence after);
    Encoded next_due();
    Encoded welcome();
    Encoded next_items();
    Encoded from_page();
    /// Of the page what goes out next: all of it, json_items, or with a pace what has its time; none: nothing yet.
    std::optional<archive::ItemPage> take_page();
    void ask_archive();
    void read_page();
    /// Whether all of the run that it follows has been given, how it ended last.
    bool gave_all_of_run() const;
    Encoded last_state_of_run();
    /// Asks now, or when the answer to what was asked before has come; of what waits only the newest is asked.
    void ask(std::function<void()> question);
    void answered();
    bool follows_current() const { return !replay_ && run_ != 0 && run_ == hub_.current_run(); }

    StreamHub& hub_;
    std::function<void()> wake_;
    Client client_;
    std::string refusal_;
    StreamShape shape_;
    std::deque<Encoded> replies_;

    bool subscribed_ = false, newest_run_ = false;  ///< newest_run_: asked for run 0
    bool welcome_due_ = false, waiting_for_run_ = false;
    std::uint64_t run_ = 0;
    std::uint64_t subscription_ = 0;    ///< answers to an older one are dropped
    v1::RunState older_run_;            ///< of a run that is not the current one, or is sent again at a pace
    double pace_ = 0.0;                 ///< of the subscription; 0: none
    std::optional<ReplayPace> replay_;  ///< none: as fast as it is read
    std::optional<ReplayPace::Clock::time_point> due_;  ///< the next of the page; none: nothing waits for its time
    ReplayPace::Clock::time_point next_batch_{};        ///< none goes out before
    archive::Sequence cursor_ = 0;                      ///< served up to here
    archive::Sequence sent_through_ = 0;                ///< what the client was told
    bool asking_ = false;                               ///< a question is with the archive
    std::function<void()> next_question_;               ///< null: none waits
    bool reading_ = false, exhausted_ = false, was_live_ = false;
    std::function<void()> again_;  ///< what the archive did not give; null: nothing
    bool stall_told_ = false;      ///< and nothing came since
    std::optional<archive::ItemPage> page_;
    std::size_t page_taken_ = 0;  ///< of its items
    SampleSpacing page_spacing_;
    std::uint64_t state_sent_ = 0, clocks_sent_ = 0;
    bool tell_through_ = false;  ///< with a new state, also where nothing that comes says how far all is there
};

}  // namespace aeolis::server
