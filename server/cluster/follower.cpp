// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/follower.hpp"

#include "server/base/version.hpp"
#include "server/cluster/run_messages.hpp"

#include <algorithm>
#include <charconv>
#include <condition_variable>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <spdlog/spdlog.h>
#include <thread>

namespace aeolis::server::cluster {
namespace {

using archive::RunId;
using Clock = std::chrono::steady_clock;

constexpr std::size_t messages_at_once = 16;
constexpr double far_behind_s = 2.0;                   // chosen: a person would say so from here on
constexpr std::chrono::milliseconds fetched_wait{20};  // for the engine's steps, while others are fetched
constexpr std::chrono::milliseconds fetched_turn{50};  // chosen: fetched steps are taken so long at a time

double seconds(Clock::duration time) {
    return std::chrono::duration<double>{time}.count();
}

}  // namespace

/// "STREAM PLACE": the stream, and the message after which nothing was taken.
struct Place {
    std::string stream;
    std::uint64_t last = 0;

    static Place of(const std::string& text) {
        const auto space = text.find(' ');
        Place place;
        if (space == std::string::npos) return place;
        place.stream = text.substr(0, space);
        (void)std::from_chars(text.data() + space + 1, text.data() + text.size(), place.last);
        return place;
    }
    std::string text() const { return fmt::format("{} {}", stream, last); }
};

/// Steps of a run that the engine gave and that do not follow what is here.
struct PassedOver {
    v1::RunPosition before;  ///< of the first of them
    v1::RunPosition after;   ///< of all
};

std::string text_of(const Following& following) {
    auto text = fmt::format("follows the archive {}", brief(following.origin));
    if (following.lost)
        text += fmt::format("; the origin has not been heard for {:.0f} s", following.silent_s);
    else if (!following.fault.empty())
        text += "; " + following.fault;
    if (following.behind_items > 0)
        text += following.behind_s < far_behind_s
                    ? fmt::format("; {} items behind", following.behind_items)
                    : fmt::format("; {} items behind, for {:.0f} s", following.behind_items, following.behind_s);
    if (!following.fetching.empty()) text += "; " + following.fetching;
    if (!following.fetch_fault.empty()) text += "; " + following.fetch_fault;
    for (const auto& run : following.left_out) text += "; " + run;
    return text;
}

namespace {

Result<v1::OriginState> find_origin(Engine& engine, const std::string& wanted) {
    const auto subjects = engine.subjects(origin_stream, all_origins);
    if (!subjects) return subjects.error();
    const auto prefix = subject_of_origin("");
    std::vector<std::string> matching, all;
    for (const auto& subject : *subjects) {
        all.push_back(subject.substr(prefix.size()));
        if (all.back().starts_with(wanted)) matching.push_back(subject);
    }
    if (matching.size() != 1) {
        std::string there;
        for (const auto& one : all) there += (there.empty() ? "" : ", ") + one;
        if (all.empty()) return Error{"no archive is published there: start its server with --nats"};
        if (matching.empty()) return Error{fmt::format("no archive {} is published there, but {}", wanted, there)};
        return Error{fmt::format("several archives are published there: name one by --follow-archive: {}", there)};
    }
    const auto newest = engine.newest(origin_stream, matching[0]);
    if (!newest) return newest.error();
    v1::OriginState state;
    if (!*newest || !state.ParseFromString((*newest)->octets) || subject_of_origin(state.archive()) != matching[0])
        return Error{matching[0] + ": not what an origin says"};
    return state;
}

}  // namespace

Result<void> begin_following(archive::SharedArchive& shared, const EngineAddress& address, const std::string& wanted,
                             std::uint16_t dictionary) {
    const auto already = shared.followed();
    if (!already) return already.error();
    if (!already->empty() && already->starts_with(wanted)) return {};
    if (!already->empty())
        return Error{fmt::format("this archive follows the archive {}, not {}: name another file", *already, wanted)};
    auto engine = Engine::connect(address, "aeolis follower");
    if (!engine) return engine.error();
    const auto origin = find_origin(*engine, wanted);
    if (!origin) return Error{fmt::format("{}: {}", cluster::shown(address), origin.error().message)};
    const auto tables = shared.tables();
    if (!tables) return tables.error();
    if (origin->tables() != *tables)
        return Error{
            fmt::format("the origin is aeolis {}, whose tables are not those of this one, {}: both must be of the "
                        "same version",
                        origin->version(), version)};
    if (origin->dictionary() != dictionary)
        return Error{fmt::format("the origin has the dictionary {}, this server {}", origin->dictionary(), dictionary)};
    return shared.follow(origin->archive());
}

class Follower::Thread {
  public:
    /// What the archive knows of itself.
    struct Own {
        archive::SharedArchive shared;
        std::string identity, origin, tables, place;
    };
    Thread(Settings settings, Parts parts, Own own)
        : settings_(std::move(settings)), parts_(std::move(parts)), own_(std::move(own)),
          place_(Place::of(own_.place)) {
        status_.origin = own_.origin;
        if (settings_.snapshots.get) fetcher_ = std::make_unique<SnapshotFetcher>(settings_.snapshots);
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

    Following status() const {
        const std::scoped_lock lock{mutex_};
        return as_of_now();
    }

  private:
    void run() {
        while (!stopped()) {
            const auto done = work();
            const auto fetched = take_fetched();
            told(done ? fetched : done);
            if (!done) steps_.reset();
            if (!done || !fetched) wait(settings_.again_after);
        }
        steps_.reset();
        if (engine_ && engine_->connected()) (void)engine_->remove_consumer(run_stream, reader_name());
    }

    Result<void> work() {
        if (!engine_) {
            auto engine = Engine::connect(settings_.engine, "aeolis follower " + brief(own_.identity));
            if (!engine) return engine.error();
            engine_.emplace(std::move(*engine));
        }
        if (!engine_->connected()) return Error{shown(settings_.engine) + ": the engine is away"};
        if (!steps_)
            if (auto begun = begin(); !begun) return begun;
        auto given = steps_->next(messages_at_once, fetching_.empty() ? settings_.wait : fetched_wait);
        if (!given) return given.error();
        if (fetching_.empty() || !given->empty()) idle_ = given->empty();
        for (const auto& one : *given) {
            if (stopped()) return {};
            if (one.count() != count_ + 1) return Error{"messages of the engine were lost: they are read again"};
            count_ = one.count();
            if (auto taken = take(one); !taken) return taken;
            place_.last = one.place();
        }
        return look();
    }

    /// Reads the stream from where it was left; another stream, or one that is shorter, from its beginning.
    Result<void> begin() {
        const auto facts = engine_->facts(run_stream);
        if (!facts) return facts.error();
        if (facts->made.empty()) return Error{fmt::format("no stream {} yet: the origin makes it", run_stream)};
        if (facts->made != place_.stream || facts->last < place_.last) place_ = {facts->made, 0};
        if (std::exchange(read_again_, false)) place_.last = 0;
        if (place_.last == 0) {
            pieces_.forget();  // else the next piece of a step is still to come
            passed_over_.clear();
        }
        auto steps = engine_->read(run_stream, reader_name(), subject_of_runs(own_.origin), place_.last + 1);
        if (!steps) return steps.error();
        steps_.emplace(std::move(*steps));
        count_ = 0;
        list_due_ = fetcher_ != nullptr;
        return {};
    }

    std::string reader_name() const { return "follower-" + own_.identity; }

    /// Why a message is not of what is followed here; empty: it is.
    std::string refusal_of(const v1::RunRows& message) const {
        if (message.archive() != own_.origin)
            return fmt::format("a message of the archive {}", brief(message.archive()));
        if (message.tables() != own_.tables)
            return "the origin's tables are not those of this program: the same version is needed on both sides";
        return {};
    }
    std::string refusal_of_dictionary(const v1::RunRows& message) const {
        if (message.dictionary() == settings_.dictionary) return {};
        return fmt::format("it has the dictionary {}, this server {}", message.dictionary(), settings_.dictionary);
    }

    /// The Error: the message is to be given again.
    Result<void> take(const Given& given) {
        auto message = run_rows_of(given.octets());
        if (!message) return refuse(message.error().message);
        const RunId run{message->run()};
        if (message->archive() == own_.origin && !settings_.runs.has(run)) return {};
        if (const auto why = refusal_of(*message); !why.empty()) return refuse(why);
        if (const auto why = refusal_of_dictionary(*message); !why.empty()) return refuse(run, why);
        const auto here = position(run);
        if (!here) return here.error();
        if (archive::within(message->after(), **here) && !archive::within(**here, message->after())) {
            ++repeated_;  // older than what is here
            return {};
        }
        auto step = pieces_.join(std::move(*message));
        if (!step) return refuse(step.error().message);
        if (!*step) return {};  // more pieces are to come
        if (!archive::within((*step)->head.before(), **here)) return gap(run, (*step)->head, **here);
        // What was passed over is to be read again, also if this process ends before that.
        const Place place{place_.stream, passed_over_.empty() ? given.place() : 0};
        const auto stored = store(run, **step, **here, place);
        return stored ? Result<void>{} : refuse(run, stored.error().message);
    }

    /// Stores a step, however long the disk refuses it. The Error: the step's own.
    Result<void> store(RunId run, const TravelledStep& travelled, const v1::RunPosition& here, const Place& place) {
        auto rows = archive::unpacked(travelled.octets);
        if (!rows) return rows.error();
        const archive::RunStep step{settings_.dictionary, travelled.head.before(), travelled.head.after(),
                                    std::move(*rows)};
        for (;;) {
            const auto taken = own_.shared.take(run, step, place.text());
            if (taken) {
                if (taken->last > 0) parts_.taken(run, taken->first, taken->last);
                break;
            }
            if (!taken.error().internal) return taken.error();
            told(taken.error());  // the disk's fault: the step waits here
            wait(settings_.again_after);
            if (stopped()) return {};
        }
        ++taken_;
        items_ += step.after.seq() > here.seq() ? step.after.seq() - here.seq() : 0;
        positions_[run.value] = archive::merged(here, step.after);
        left_out_.erase(run.value);
        return {};
    }

    /// Steps are missing: the stream may have them, before the place from which it was read.
    Result<void> gap(RunId run, const v1::RunRows& step, const v1::RunPosition& here) {
        if (wanted_.contains(run.value)) {
            pass_over(run, step);
            return {};
        }
        const auto sought = sought_.find(run.value);
        if (place_.last > 0 && (sought == sought_.end() || here.seq() > sought->second)) {
            sought_[run.value] = here.seq();
            read_again_ = true;
            return Error{fmt::format("run {}: what comes before item {} is missing: the stream is read again from its "
                                     "beginning",
                                     run.value, step.before().seq() + 1)};
        }
        if (fetcher_) {
            pass_over(run, step);
            wanted_.insert(run.value);
            return {};
        }
        return refuse(run, fmt::format("a step begins behind item {}, this archive ends at {}: if the engine no longer "
                                       "has what is between, have it fetched from the origin (--snapshot-from), or "
                                       "begin with a copy of the origin's archive (aeolis archive backup)",
                                       step.before().seq(), here.seq()));
    }

    void pass_over(RunId run, const v1::RunRows& step) {
        const auto [known, first] = passed_over_.try_emplace(run.value, PassedOver{step.before(), step.after()});
        if (!first) known->second.after = archive::merged(known->second.after, step.after());
    }

    /// Takes what another server gave, and asks it for more. The Error: of this archive or the engine.
    Result<void> take_fetched() {
        if (!fetcher_) return {};
        for (const auto until = Clock::now() + fetched_turn; !fetching_.empty() && Clock::now() < until;) {
            auto news = fetcher_->next();
            if (!news) break;
            if (auto* message = std::get_if<v1::RunRows>(&*news)) {
                if (auto taken = take_fetched(std::move(*message)); !taken) return taken;
            } else if (const auto* runs = std::get_if<SnapshotFetcher::Listed>(&*news)) {
                fetching_.clear();
                if (auto taken = want_of(*runs); !taken) return taken;
            } else if (auto ended = fetch_ended(std::get<SnapshotFetcher::Ended>(*news)); !ended) {
                return ended;
            }
        }
        return fetching_.empty() ? fetch_next() : Result<void>{};
    }

    Result<void> fetch_next() {
        const auto now = Clock::now();
        if (list_due_ && now >= list_after_) {
            fetching_ = fmt::format("{} is asked for its runs", fetcher_->source());
            fetched_run_ = 0;
            fetch_refusal_.clear();
            fetcher_->list();
        } else if (!wanted_.empty() && now >= fetch_after_) {
            auto next = wanted_.upper_bound(newest_fetched_);  // in turn, so that none holds up the others
            if (next == wanted_.end()) next = wanted_.begin();
            const RunId run{*next};
            const auto here = position(run);
            if (!here) return here.error();
            fetching_ = fmt::format("run {} is fetched from {}", run.value, fetcher_->source());
            if (!fetch_faults_.contains(run.value))
                spdlog::info("{}, behind item {}: the engine no longer has it", fetching_, (*here)->seq());
            fetched_run_ = newest_fetched_ = run.value;
            fetched_pieces_.forget();
            fetch_refusal_.clear();
            fetched_any_ = false;
            fetcher_->fetch(run, **here);
        }
        return {};
    }

    Result<void> take_fetched(v1::RunRows message) {
        if (!fetch_refusal_.empty()) return {};
        std::string why;
        if (message.archive() != own_.origin)
            why = fmt::format("it has runs of the archive {}, this server follows {}", brief(message.archive()),
                              brief(own_.origin));
        if (why.empty()) why = refusal_of(message);
        if (why.empty() && message.run() != fetched_run_) why = fmt::format("it gives run {}", message.run());
        if (why.empty()) why = refusal_of_dictionary(message);
        if (why.empty()) {
            const RunId run{message.run()};
            const auto here = position(run);
            if (!here) return here.error();
            auto step = fetched_pieces_.join(std::move(message));
            if (!step) {
                why = step.error().message;
            } else if (*step && !archive::within((*step)->head.before(), **here)) {
                why = fmt::format("a step begins behind item {}, this archive ends at {}", (*step)->head.before().seq(),
                                  (*here)->seq());
            } else if (*step) {
                const Place place{place_.stream, passed_over_.empty() ? place_.last : 0};
                if (const auto stored = store(run, **step, **here, place); !stored) why = stored.error().message;
                ++fetched_;
                fetched_any_ = true;
            }
        }
        if (why.empty()) return {};
        ++refused_;
        fetch_refusal_ = std::move(why);
        fetcher_->break_off();
        return {};
    }

    /// Finds runs of another server of which this archive has not all: they are wanted where the engine has nothing of
    /// them. Where it has something that was read earlier, the stream is read again, which finds what is missing. What
    /// lacks now may come in a moment: such runs are looked at twice.
    Result<void> want_of(const SnapshotFetcher::Listed& runs) {
        list_due_ = true;  // until all is known
        list_after_ = Clock::now() + settings_.fetch_again_after;
        if (!engine_ || !engine_->connected()) return {};  // which is told elsewhere
        const auto subjects = engine_->subjects(run_stream, subject_of_runs(own_.origin));
        if (!subjects) return subjects.error();
        const std::set<std::string> there{subjects->begin(), subjects->end()};
        std::set<std::uint32_t> absent;
        std::map<std::uint32_t, archive::Sequence> behind;
        bool again = false;
        for (const auto& listed : runs) {
            const auto number = listed.run.value;
            if (!settings_.runs.has(listed.run) || wanted_.contains(number)) continue;
            const auto settled = own_.shared.is_settled(listed.run, listed.last);
            if (!settled) return settled.error();
            if (*settled) continue;
            const auto here = position(listed.run);
            if (!here) return here.error();
            if (!there.contains(subject_of_run(own_.origin, listed.run))) {
                absent.insert(number);
                if (absent_.contains(number))
                    wanted_.insert(number);
                else
                    again = true;
                continue;
            }
            if (listed.last <= (*here)->seq() || sought_.contains(number)) continue;
            const auto before = behind_.find(number);
            if (idle_ && before != behind_.end() && before->second == (*here)->seq()) {
                sought_[number] = (*here)->seq();
                read_again_ = true;
                steps_.reset();
            } else {
                behind[number] = (*here)->seq();
                again = true;
            }
        }
        absent_ = std::move(absent);
        behind_ = std::move(behind);
        list_due_ = again;
        fetch_faults_.erase(0);
        return {};
    }

    /// The end of what was asked of the other server.
    Result<void> fetch_ended(const SnapshotFetcher::Ended& ended) {
        fetching_.clear();
        const auto number = fetched_run_;
        auto fault = fetch_refusal_.empty() ? ended.fault : fetch_refusal_;
        if (number == 0) {
            list_after_ = Clock::now() + settings_.fetch_again_after;
            tell_fetch_fault(0, fmt::format("{}: {}", fetcher_->source(), fault));
            return {};
        }
        const RunId run{number};
        const auto here = position(run);
        if (!here) return here.error();
        const auto over = passed_over_.find(number);
        const bool joined = over == passed_over_.end() || archive::within(over->second.before, **here);
        if (fault.empty() && !joined)
            fault = fmt::format("it has items up to {}, the engine those behind {}", (*here)->seq(),
                                over->second.before.seq());
        if (!fault.empty()) {
            // Cut off: it goes on from where it was. Else there is nothing new to be had soon.
            fetch_after_ = Clock::now() + (fetched_any_ && fetch_refusal_.empty() ? settings_.again_after
                                                                                  : settings_.fetch_again_after);
            fault = fmt::format("run {} from {}: {}", number, fetcher_->source(), fault);
            if (!ended.gone) {
                tell_fetch_fault(number, fault);
                return {};
            }
            wanted_.erase(number);
            fetch_faults_.erase(number);
            const bool begun = over != passed_over_.end();
            if (begun) passed_over_.erase(over);
            return begun ? refuse(run, fault) : Result<void>{};
        }
        spdlog::info("run {} is fetched, up to item {}", number, (*here)->seq());
        fetch_faults_.erase(number);
        wanted_.erase(number);
        absent_.erase(number);
        if (over == passed_over_.end()) return {};
        if (archive::within(over->second.after, **here)) {
            passed_over_.erase(over);
        } else {  // the stream has what comes next, and it was read already
            read_again_ = true;
            steps_.reset();
        }
        return {};
    }

    void tell_fetch_fault(std::uint32_t run, const std::string& fault) {
        auto& known = fetch_faults_[run];
        if (fault != known) spdlog::warn("{}", fault);
        known = fault;
    }
    std::string text_of_fetch_faults() const {
        if (fetch_faults_.empty()) return {};
        const auto& first = fetch_faults_.begin()->second;
        return fetch_faults_.size() == 1 ? first
                                         : fmt::format("{} (and {} more runs)", first, fetch_faults_.size() - 1);
    }

    Result<const v1::RunPosition*> position(RunId run) {
        auto known = positions_.find(run.value);
        if (known == positions_.end()) {
            auto here = own_.shared.position(run);
            if (!here) return here.error();
            known = positions_.emplace(run.value, std::move(*here)).first;
        }
        return &known->second;
    }

    /// Counted, and told in a line; what comes after it is looked at as if it had not come.
    Result<void> refuse(const std::string& why) {
        ++refused_;
        if (told_.size() < lines_max && told_.insert(why).second) spdlog::warn("refused: {}", why);
        return {};
    }
    Result<void> refuse(RunId run, const std::string& why) {
        left_out_[run.value] = fmt::format("run {} is not taken further: {}", run.value, why);
        return refuse(left_out_[run.value]);
    }

    /// What the origin says of itself.
    Result<void> look() {
        const auto now = Clock::now();
        if (now - looked_ < settings_.look_every) return {};
        looked_ = now;
        const auto facts = engine_->facts(run_stream);
        if (!facts) return facts.error();
        if (facts->made != place_.stream) return Error{"the engine has another stream now"};
        const auto newest = engine_->newest(origin_stream, subject_of_origin(own_.origin));
        if (!newest) return newest.error();
        v1::OriginState state;
        if (!*newest || !state.ParseFromString((*newest)->octets) || state.archive() != own_.origin) return {};
        if (state.publisher() != origin_.publisher() || state.count() != origin_.count()) {
            // The first one that is read may be of an origin that is gone.
            if (!origin_.publisher().empty()) {
                const std::scoped_lock lock{mutex_};
                heard_ = now;
            }
            origin_ = std::move(state);
            {
                const std::scoped_lock lock{mutex_};
                status_.publisher = origin_.publisher();
                status_.heard = origin_.count();
            }
            if (auto given = give_on(); !given) return given;
        }
        return count_behind();
    }

    Result<void> give_on() {
        const RunId run{static_cast<std::uint32_t>(origin_.run().run())};
        if (run.value == 0 || !settings_.runs.has(run)) return {};
        const auto here = position(run);
        if (!here) return here.error();
        if ((*here)->seq() == 0) return {};  // its beginning is not here yet
        auto shown = origin_.run();
        shown.clear_archive_fault();  // the origin's own
        shown.clear_last_seq();
        auto octets = shown.SerializeAsString();
        shown.set_last_seq((*here)->seq());
        if (octets != shown_) parts_.run_state(std::move(shown));
        shown_ = std::move(octets);
        parts_.clocks(origin_.clocks());
        return {};
    }

    Result<void> count_behind() {
        std::map<std::uint32_t, std::uint64_t> last;
        for (const auto& [run, seq] : origin_.last_seq()) last[run] = seq;
        std::uint64_t behind = 0;
        for (const auto& [run, seq] : last) {
            if (left_out_.contains(run) || !settings_.runs.has(RunId{run})) continue;
            const auto here = position(RunId{run});
            if (!here) return here.error();
            if (seq > (*here)->seq()) behind += seq - (*here)->seq();
        }
        const std::scoped_lock lock{mutex_};
        status_.behind_items = behind;
        if (behind == 0) even_ = Clock::now();
        return {};
    }

    Following as_of_now() const {
        auto now = status_;
        now.silent_s = seconds(Clock::now() - heard_);
        now.lost = now.silent_s > seconds(settings_.lost_after);
        now.behind_s = now.behind_items == 0 ? 0.0 : seconds(Clock::now() - even_);
        return now;
    }

    void told(const Result<void>& done) {
        Following now;
        std::string before;
        {
            const std::scoped_lock lock{mutex_};
            before = std::exchange(status_.fault, done ? "" : done.error().message);
            status_.steps = taken_;
            status_.items = items_;
            status_.repeated = repeated_;
            status_.refused = refused_;
            status_.fetching = fetching_;
            status_.fetch_fault = text_of_fetch_faults();
            status_.fetched_steps = fetched_;
            status_.left_out.clear();
            for (const auto& [run, why] : left_out_) status_.left_out.push_back(why);
            now = as_of_now();
        }
        if (done && !before.empty()) spdlog::info("following goes on");
        if (!done && before != done.error().message) spdlog::warn("following: {}", done.error().message);
        if (now.lost != std::exchange(lost_, now.lost)) {
            if (lost_)
                spdlog::warn("the origin {} is silent", brief(own_.origin));
            else
                spdlog::info("the origin {} is heard", brief(own_.origin));
        }
    }

    bool stopped() const {
        const std::scoped_lock lock{mutex_};
        return stop_;
    }
    void wait(std::chrono::milliseconds time) {
        std::unique_lock lock{mutex_};
        wake_.wait_for(lock, time, [this] { return stop_; });
    }

    static constexpr std::size_t lines_max = 100;  // chosen: what is refused is counted anyway
    const Settings settings_;
    const Parts parts_;
    Own own_;
    std::optional<Engine> engine_;
    std::optional<Consumer> steps_;  // before engine_
    std::uint64_t count_ = 0;
    Place place_;
    bool read_again_ = false;
    std::map<std::uint32_t, v1::RunPosition> positions_;
    StepJoiner pieces_;
    std::map<std::uint32_t, std::string> left_out_;  // until a step of the run is taken
    std::map<std::uint32_t, std::uint64_t>
        sought_;  // runs for which the stream was read again, and their last item then
    // What the engine no longer has, from another server.
    std::unique_ptr<SnapshotFetcher> fetcher_;           // none: there is no such server
    std::set<std::uint32_t> wanted_;                     // to be fetched
    std::set<std::uint32_t> absent_;                     // not in the engine when that was looked at
    std::map<std::uint32_t, archive::Sequence> behind_;  // last items then of others that were not here to their end
    std::map<std::uint32_t, PassedOver> passed_over_;    // of those that are wanted
    std::map<std::uint32_t, std::string> fetch_faults_;  // by run; 0: of the list
    std::string fetching_, fetch_refusal_;
    std::uint32_t fetched_run_ = 0, newest_fetched_ = 0;  // 0: the list
    StepJoiner fetched_pieces_;
    bool idle_ = false, list_due_ = false, fetched_any_ = false;  // idle_: the engine had no more
    std::uint64_t fetched_ = 0;
    Clock::time_point fetch_after_{}, list_after_{};
    std::set<std::string> told_;
    std::uint64_t taken_ = 0, items_ = 0, repeated_ = 0, refused_ = 0;
    v1::OriginState origin_;
    std::string shown_;
    bool lost_ = false;
    const Clock::time_point began_ = Clock::now();
    Clock::time_point looked_{};
    mutable std::mutex mutex_;  // of all below
    Clock::time_point heard_ = began_;
    std::condition_variable wake_;
    bool stop_ = false;
    Following status_;
    Clock::time_point even_ = began_;
    std::thread thread_;
};

Follower::Follower(std::unique_ptr<Thread> thread) : thread_(std::move(thread)) {}
Follower::~Follower() = default;

Result<std::unique_ptr<Follower>> Follower::start(Settings settings, Parts parts) {
    auto shared = archive::SharedArchive::open(settings.archive);
    if (!shared) return shared.error();
    auto identity = shared->identity(), origin = shared->followed(), tables = shared->tables(),
         place = shared->fact(archive::fact_taken);
    for (const auto* known : {&identity, &origin, &tables, &place})
        if (!*known) return known->error();
    AEOLIS_CHECK(!origin->empty());
    const auto chosen = shared->fact(archive::fact_chosen);
    if (!chosen) return chosen.error();
    if (*chosen != settings.runs.text()) {
        place->clear();  // what was passed over may be wanted now
        for (const auto& [fact, text] :
             {std::pair{archive::fact_taken, std::string{}}, std::pair{archive::fact_chosen, settings.runs.text()}})
            if (auto kept = shared->keep_fact(fact, text); !kept) return kept.error();
    }
    spdlog::info("following the archive {} by {}", *origin, cluster::shown(settings.engine));
    Thread::Own own{std::move(*shared), std::move(*identity), std::move(*origin), std::move(*tables),
                    std::move(*place)};
    return std::unique_ptr<Follower>{
        new Follower{std::make_unique<Thread>(std::move(settings), std::move(parts), std::move(own))}};
}

Following Follower::status() const {
    return thread_->status();
}

}  // namespace aeolis::server::cluster
