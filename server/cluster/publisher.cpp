// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/publisher.hpp"

#include "aeolis/v1/cluster.pb.h"
#include "server/archive/run_rows.hpp"
#include "server/archive/shared_archive.hpp"
#include "server/base/version.hpp"
#include "server/cluster/run_messages.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <fmt/format.h>
#include <iterator>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::server::cluster {
namespace {

using archive::RunId;
using Clock = std::chrono::steady_clock;

constexpr auto counters_every = std::chrono::seconds{1};  // of a run that goes on: counters of its links
constexpr auto all_runs_every = std::chrono::seconds{1};  // notes on runs that are over are seen so late at most
constexpr auto keep_every = std::chrono::seconds{1};      // what is kept later is asked of the engine again
constexpr auto tell_at_most_every = std::chrono::milliseconds{200};  // chosen: clocks of a console

std::string drawn() {
    std::random_device random;
    return fmt::format("{:08x}{:08x}", random(), random());
}

}  // namespace

/// A run that something is published of.
struct OpenRun {
    archive::RunHead stored;
    std::optional<v1::RunPosition> position;  ///< none: the engine is to be asked
    std::uint64_t place = 0;                  ///< of the newest message of its subject
    Clock::time_point counted{};
};

std::string text_of(const Publishing& publishing) {
    auto text = publishing.waiting_items == 0 ? std::string{"all is published"}
                                              : fmt::format("{} items wait to be published", publishing.waiting_items);
    if (!publishing.fault.empty()) text += "; nothing is published now: " + publishing.fault;
    for (const auto& run : publishing.left_out) text += "; not published: " + run;
    return text;
}

class Publisher::Thread {
  public:
    explicit Thread(Settings settings) : settings_(std::move(settings)), name_(drawn()) {
        thread_ = std::thread{[this] { run(); }};
    }
    ~Thread() {
        {
            const std::scoped_lock lock{mutex_};
            stop_ = true;
        }
        wake_.notify_all();
        thread_.join();
    }

    void run_state(const v1::RunState& state) {
        const std::scoped_lock lock{mutex_};
        state_ = state;
        told_anew_ = true;
    }
    void clocks(const v1::Clocks& clocks) {
        const std::scoped_lock lock{mutex_};
        clocks_ = clocks;
        told_anew_ = true;
    }
    Publishing status() const {
        const std::scoped_lock lock{mutex_};
        auto now = status_;
        now.waiting_s = now.waiting_items == 0 ? 0.0 : std::chrono::duration<double>{Clock::now() - even_}.count();
        return now;
    }

    std::optional<std::chrono::milliseconds> age_of(const std::string& publisher, std::uint64_t count) const {
        const std::scoped_lock lock{mutex_};
        if (publisher != name_ || count > count_told_ || count_told_ - count >= told_at_.size()) return std::nullopt;
        const auto told = told_at_[told_at_.size() - 1 - (count_told_ - count)];
        const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - told);
        return age > told_kept ? std::nullopt : std::optional{age};
    }

  private:
    void run() {
        while (!stopped()) {
            auto more = work();
            told(more ? Result<void>{} : more.error());
            if (!more) {
                forget_positions();  // what was under way may have arrived
                wait(settings_.again_after);
            } else if (!*more) {
                wait(settings_.look_every);
            }
        }
        if (const auto kept = keep_positions(); !kept) spdlog::warn("publishing: {}", kept.error().message);
    }

    /// True: more waits to be published.
    Result<bool> work() {
        if (auto ready = begin(); !ready) return ready.error();
        if (auto looked = look(); !looked) return looked.error();
        const auto moved = reader_->changed();
        if (!moved) return moved.error();
        const auto now = Clock::now();
        bool more = false;
        if (*moved || pending_ || now - swept_ >= counters_every) {
            if (!pending_) swept_ = now;
            pending_ = true;                                                // until all is published, whatever fails
            for (auto run = open_.begin(); run != open_.end() && !more;) {  // the newest run first
                const auto came = publish_step(run->second);
                if (!came) return came.error();
                more = *came == Step::sent;
                run = *came == Step::over ? open_.erase(run) : std::next(run);
            }
            pending_ = more;
        }
        count_waiting();
        if (auto alive = tell(); !alive) return alive.error();
        if (Clock::now() - kept_ >= keep_every) (void)keep_positions();  // else later: the engine knows it too
        return more;
    }

    /// Reader, connection and streams, each once.
    Result<void> begin() {
        if (!shared_) {
            auto shared = archive::SharedArchive::open(settings_.archive);
            if (!shared) return shared.error();
            auto identity = shared->identity();
            auto published = shared->published();
            auto stream = shared->fact(archive::fact_published);
            if (!identity) return identity.error();
            if (!published) return published.error();
            if (!stream) return stream.error();
            identity_ = std::move(*identity);
            known_ = std::move(*published);
            stream_ = std::move(*stream);
            shared_.emplace(std::move(*shared));
            spdlog::info("publishing the archive {} to {}", identity_, shown(settings_.engine));
        }
        if (!reader_) {
            auto reader = archive::RunRowsReader::open(settings_.archive);
            if (!reader) return reader.error();
            reader_.emplace(std::move(*reader));
        }
        if (!engine_) {
            auto engine = Engine::connect(settings_.engine, "aeolis origin " + brief(identity_));
            if (!engine) return engine.error();
            engine_.emplace(std::move(*engine));
        }
        if (!engine_->connected()) return Error{shown(settings_.engine) + ": the engine is away"};
        if (ready_) return {};
        if (auto made = engine_->make_stream(run_stream, all_runs, Retention::all); !made) return made;
        if (auto made = engine_->make_stream(origin_stream, all_origins, Retention::newest); !made) return made;
        auto facts = engine_->facts(run_stream);
        if (!facts) return facts.error();
        if (facts->made != stream_) {
            // Another stream than the one in which runs were acknowledged: it is given them all.
            known_.clear();
            open_.clear();
            unkept_.clear();
            mine_.clear();
            left_out_.clear();
            stream_ = facts->made;
        }
        looked_ = {};
        ready_ = true;
        return {};
    }

    /// Which runs there is something to publish of.
    Result<void> look() {
        auto newest = reader_->newest_run();
        if (!newest) return newest.error();
        const auto now = Clock::now();
        if (*newest == newest_ && now - looked_ < all_runs_every) return {};
        const auto runs = reader_->runs();
        if (!runs) return runs.error();
        newest_ = *newest;
        looked_ = now;
        for (const auto& run : *runs) {
            const auto known = known_.find(run.run.value);
            const bool done = run.state != "running" && known != known_.end() && known->second.state == run.state &&
                              known->second.position.seq() >= run.last_seq;
            if (!done && !left_out_.contains(run.run.value)) open_[-std::int64_t{run.run.value}].stored.run = run.run;
        }
        for (auto run = open_.begin(); run != open_.end();) {
            const bool there =
                std::ranges::any_of(*runs, [&](const auto& one) { return one.run == run->second.stored.run; });
            if (there) {
                ++run;
                continue;
            }
            // Pruned: whoever follows from now on need not have it.
            (void)engine_->clear(run_stream, subject_of_run(identity_, run->second.stored.run));
            run = open_.erase(run);
        }
        return {};
    }

    /// Where the engine has this run, by the newest message of its subject.
    Result<void> find(OpenRun& run) {
        const auto number = run.stored.run.value;
        const auto newest = engine_->newest(run_stream, subject_of_run(identity_, run.stored.run));
        if (!newest) return newest.error();
        reader_->forget(run.stored.run);  // rows that change: an engine may have lost the newest of them
        const std::scoped_lock lock{mutex_};
        ++status_.again;
        const auto known = known_.find(number);
        const auto acknowledged = known != known_.end() ? known->second.position : v1::RunPosition{};
        run.place = *newest ? (*newest)->place : 0;
        v1::RunRows message;
        if (!*newest || !message.ParseFromString((*newest)->octets) || message.archive() != identity_ ||
            message.run() != number) {
            run.position = acknowledged;  // older messages were removed, or the newest is of somebody else
            return {};
        }
        const bool mine = mine_.contains(number);
        if (mine && message.publisher() != name_)
            return Error{fmt::format("another server publishes the archive {} too: one of the two files is a copy; "
                                     "serve it without --nats, or let it follow",
                                     brief(identity_))};
        const auto& there = message.piece() + 1 == message.pieces() ? message.after() : message.before();
        // In a subject that this process publishes to, any other step than its own is somebody's forgery.
        const auto sent = sent_.find(number);
        const bool own = !mine || archive::equal(there, acknowledged) ||
                         (sent != sent_.end() && archive::equal(there, sent->second));
        run.position = own ? there : acknowledged;
        return {};
    }

    enum class Step : std::uint8_t { sent, none, over };
    /// `over`: nothing is to be published of it, until it gets another item.
    Result<Step> publish_step(OpenRun& run) {
        if (!run.position)
            if (auto found = find(run); !found) return found.error();
        const auto now = Clock::now();
        const bool counters = now - run.counted >= counters_every;
        const auto stored = reader_->run(run.stored.run);
        if (!stored) return stored.error();
        if (!*stored) return Step::none;  // pruned: look() finds that
        run.stored = **stored;
        auto step = reader_->next(run.stored.run, *run.position, counters);
        if (!step && step.error().internal) return step.error();
        if (!step) {
            leave_out(run, step.error().message);
            return Step::over;
        }
        if (counters) run.counted = now;
        if (!*step) {
            acknowledged(run, run.stored.state);
            return run.stored.state == "running" ? Step::none : Step::over;
        }
        if (auto sent = send(run, **step); !sent) {
            reader_->forget(run.stored.run);
            return sent.error();
        }
        return Step::sent;
    }

    Result<void> send(OpenRun& run, const archive::RunStep& step) {
        v1::RunRows head;
        head.set_archive(identity_);
        head.set_publisher(name_);
        head.set_run(run.stored.run.value);
        head.set_tables(reader_->tables());
        const auto subject = subject_of_run(identity_, run.stored.run);
        sent_[run.stored.run.value] = step.after;
        std::size_t octets = 0;
        for (const auto& message : messages_of(step, std::move(head))) {
            const auto place = engine_->publish_after(subject, message, run.place);
            if (!place) return place.error();
            run.place = *place;
            octets += message.size();
            mine_.insert(run.stored.run.value);
        }
        run.position = step.after;
        acknowledged(run, "running");  // it is over once nothing more is found
        const std::scoped_lock lock{mutex_};
        ++status_.steps;
        status_.octets += octets;
        status_.items += step.after.seq() - step.before.seq();
        return {};
    }

    void acknowledged(const OpenRun& run, const std::string& state) {
        auto& known = known_[run.stored.run.value];
        const bool as_kept = known.state == state && known.position.seq() == run.position->seq();
        known = {run.stored.run, *run.position, state};
        if (!as_kept) unkept_.insert(run.stored.run.value);
    }

    void leave_out(const OpenRun& run, const std::string& why) {
        spdlog::error("not published: {}", why);
        left_out_.insert(run.stored.run.value);
        const std::scoped_lock lock{mutex_};
        status_.left_out.push_back(why);
    }

    void count_waiting() {
        std::uint64_t waiting = 0;
        for (const auto& [number, run] : open_) {
            const auto has = run.position ? run.position->seq() : 0;
            if (run.stored.last_seq > has) waiting += run.stored.last_seq - has;
        }
        const std::scoped_lock lock{mutex_};
        status_.waiting_items = waiting;
        if (waiting == 0) even_ = Clock::now();
    }

    /// What waits while nothing is published, by the archive alone.
    void count_without_engine() {
        if (!reader_) return;
        if (const auto newest = reader_->newest_run(); newest && *newest > 0) {
            auto stored = reader_->run(RunId{*newest});
            if (!stored || !*stored) return;
            const auto known = known_.find(*newest);
            const auto has = known == known_.end() ? 0 : known->second.position.seq();
            const std::scoped_lock lock{mutex_};
            status_.waiting_items = (*stored)->last_seq > has ? (*stored)->last_seq - has : 0;
        }
    }

    /// That this origin lives, and how its run stands.
    Result<void> tell() {
        const auto now = Clock::now();
        v1::OriginState state;
        {
            const std::scoped_lock lock{mutex_};
            const bool due = now - told_ >= settings_.tell_every || (told_anew_ && now - told_ >= tell_at_most_every);
            if (!due) return {};
            told_anew_ = false;
            *state.mutable_run() = state_;
            *state.mutable_clocks() = clocks_;
        }
        told_ = now;
        state.set_archive(identity_);
        state.set_publisher(name_);
        state.set_dictionary(settings_.dictionary);
        state.set_tables(reader_->tables());
        state.set_version(version);
        state.set_count(++count_);
        {
            const std::scoped_lock lock{mutex_};
            told_at_.push_back(now);
            count_told_ = count_;
            while (now - told_at_.front() > told_kept) told_at_.pop_front();
        }
        for (const auto& [number, run] : open_) (*state.mutable_last_seq())[run.stored.run.value] = run.stored.last_seq;
        if (const auto newest = known_.find(newest_); newest != known_.end() && !open_.contains(-std::int64_t{newest_}))
            (*state.mutable_last_seq())[newest_] = newest->second.position.seq();
        return engine_->publish(subject_of_origin(identity_), state.SerializeAsString());
    }

    Result<void> keep_positions() {
        kept_ = Clock::now();
        if (unkept_.empty() || !shared_) return {};
        std::vector<archive::PublishedRun> runs;
        runs.reserve(unkept_.size());
        for (const auto number : unkept_) runs.push_back(known_.at(number));
        auto kept = shared_->keep_published(runs, stream_);
        if (kept) unkept_.clear();
        return kept;
    }

    void forget_positions() {
        for (auto& [number, run] : open_) run.position.reset();
        ready_ = false;
        count_without_engine();
    }

    void told(const Result<void>& done) {
        std::string before;
        {
            const std::scoped_lock lock{mutex_};
            before = std::exchange(status_.fault, done ? "" : done.error().message);
        }
        if (done && !before.empty()) spdlog::info("publishing goes on");
        if (!done && before.empty()) spdlog::warn("nothing is published: {}", done.error().message);
    }

    bool stopped() const {
        const std::scoped_lock lock{mutex_};
        return stop_;
    }
    void wait(std::chrono::milliseconds time) {
        std::unique_lock lock{mutex_};
        wake_.wait_for(lock, time, [this] { return stop_; });
    }

    Settings settings_;
    const std::string name_;
    std::optional<archive::SharedArchive> shared_;
    std::string identity_, stream_;  // of the archive, and of the engine's stream in which known_ is
    std::optional<archive::RunRowsReader> reader_;
    std::optional<Engine> engine_;
    bool ready_ = false, pending_ = true;
    std::map<std::int64_t, OpenRun> open_;                  // by number, the largest first
    std::map<std::uint32_t, archive::PublishedRun> known_;  // what the engine has acknowledged
    std::set<std::uint32_t> unkept_, left_out_;
    std::set<std::uint32_t> mine_;                   // runs of which this process has published
    std::map<std::uint32_t, v1::RunPosition> sent_;  // what its last step, arrived or not, brings each to
    std::uint32_t newest_ = 0;
    std::uint64_t count_ = 0;
    Clock::time_point looked_{}, swept_{}, told_{}, kept_{};
    mutable std::mutex mutex_;  // of all below
    std::condition_variable wake_;
    bool stop_ = false, told_anew_ = false;
    v1::RunState state_;
    v1::Clocks clocks_;
    std::deque<Clock::time_point> told_at_;  // of the newest counts
    std::uint64_t count_told_ = 0;
    Publishing status_;
    Clock::time_point even_ = Clock::now();
    std::thread thread_;
};

Publisher::Publisher(Settings settings) : thread_(std::make_unique<Thread>(std::move(settings))) {}
Publisher::~Publisher() = default;

void Publisher::run_state(const v1::RunState& state) {
    thread_->run_state(state);
}
void Publisher::clocks(const v1::Clocks& clocks) {
    thread_->clocks(clocks);
}
std::optional<std::chrono::milliseconds> Publisher::age_of(const std::string& publisher, std::uint64_t count) const {
    return thread_->age_of(publisher, count);
}
Publishing Publisher::status() const {
    return thread_->status();
}

}  // namespace aeolis::server::cluster
