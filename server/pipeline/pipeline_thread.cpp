// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/pipeline_thread.hpp"

#include "server/archive/reader.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <spdlog/spdlog.h>
#include <utility>

namespace aeolis::server {
namespace {

constexpr std::chrono::milliseconds retry_interval{500};  // chosen: a full disk is not emptied faster
constexpr std::size_t words_of_difference = 200;          // characters of an item in an error: enough to identify it
constexpr std::uint64_t cycles_a_second = 64;
constexpr int retries_when_closing = 4;  // then the waiting items are given up, with an Error

std::string taken_not_stored(const std::string& fault) {
    return fmt::format("this is taken, and stored as soon as the disk takes it; do not send it again. Now: {}", fault);
}

/// Compares a run's repeated items with the archive. The Error names the first that differs.
Result<void> same_items(archive::Reader& stored, const pipeline::PublishedBatch& again) {
    archive::Sequence after = again.first_seq - 1;
    auto item = again.items.begin();
    while (after < again.last_seq) {
        const std::size_t wanted = std::min<std::size_t>(archive::items_page_max, again.last_seq - after);
        const auto page = stored.items(again.run, after, wanted);
        if (!page) return page.error();
        for (const auto& before : page->items) {
            if (item == again.items.end()) break;
            if (item->item_case() == v1::Item::ITEM_NOT_SET) {  // an annotation stored here: it is not repeated
                ++item;
                continue;
            }
            if (before.SerializeAsString() != item->SerializeAsString())
                return Error{fmt::format("run {}: flown again, item {} is not what it was ({})", again.run.value,
                                         before.seq(), item->ShortDebugString().substr(0, words_of_difference))};
            ++item;
        }
        if (page->complete_through <= after)
            return Error{fmt::format("run {}: item {} is not in the archive", again.run.value, after + 1)};
        after = page->complete_through;
    }
    return {};
}

}  // namespace

void Delivery::add(telemetry::Received&& received) {
    const auto move_in = [this](auto& from) {
        entries.insert(entries.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    move_in(received.octets);
    move_in(received.packets);
    move_in(received.tones);
    move_in(received.carrier);
    move_in(received.seen);
    move_in(received.spectra);
    move_in(received.links);
}

void Delivery::pass(std::uint64_t cycles, Ert now) {
    if (cycles % cycles_a_second == 0) entries.emplace_back(telemetry::EarthTime{now});
}

PipelineThread::PipelineThread(archive::Archive archive, const dictionary::Dictionary& dictionary, Faults faults,
                               pipeline::Publish publish, const telemetry::OtherMission* other)
    : archive_(std::move(archive)), dictionary_(dictionary), pipeline_(archive_, dictionary, other), faults_(faults) {
    pipeline_.on_publish([this, publish = std::move(publish)](std::shared_ptr<const pipeline::PublishedBatch> batch) {
        ++batches_;
        items_ += batch->last_seq - batch->first_seq + 1;
        if (publish) publish(std::move(batch));
    });
    thread_ = std::thread{[this] { run(); }};
}

PipelineThread::~PipelineThread() {
    closing();
    jobs_.close();
    thread_.join();
}

Result<archive::RunId> PipelineThread::begin(const archive::RunStart& start) {
    Begin job{start, {}};
    auto done = job.done.get_future();
    if (!jobs_.push(std::move(job))) return Error{"the archive is closing"};
    return done.get();
}

void PipelineThread::perform(Action action) {
    std::promise<void> performed;
    auto done = performed.get_future();
    const bool taken = jobs_.push(Action{[&] {
        action();
        performed.set_value();
    }});
    if (taken) done.wait();
}

Result<archive::RunId> PipelineThread::begin(const archive::RunStart& start, archive::RunId of, Ert until) {
    auto reader = archive::Reader::open(archive_.file(), dictionary_);
    if (!reader) return reader.error();
    auto stored = std::make_shared<archive::Reader>(std::move(*reader));
    auto annotations = stored->annotations(of);
    if (!annotations) return annotations.error();
    const auto compare = [stored](const pipeline::PublishedBatch& again) { return same_items(*stored, again); };
    Result<archive::RunId> run = Error{"the archive is closing"};
    perform([&] { run = pipeline_.begin(start, {of, compare, std::move(*annotations), until}); });
    return run;
}

Result<archive::Sequence> PipelineThread::forked() {
    Result<archive::Sequence> result = Error{"the archive is closing"};
    perform([&] {
        static_cast<void>(retry_until_stored([&] { return pipeline_.commit(); }));
        result = pipeline_.forked();
    });
    return result;
}

Result<void> PipelineThread::resume(archive::FlownRun& cut, const archive::RunStart& start) {
    auto reader = archive::Reader::open(archive_.file(), dictionary_);
    if (!reader) return reader.error();
    auto stored = std::make_shared<archive::Reader>(std::move(*reader));
    const auto compare = [stored](const pipeline::PublishedBatch& again) { return same_items(*stored, again); };
    Result<void> result = Error{"the archive is closing"};
    perform([&] {
        // Annotations may have been added since `cut` was read. From here on this thread assigns the numbers.
        auto now = stored->cut_off(cut.run);
        if (!now) return void(result = now.error());
        cut.last_seq = now->last_seq;
        cut.annotations = std::move(now->annotations);
        auto acts = stored->all_procedure_acts(cut.run);
        if (!acts) return void(result = acts.error());
        auto positions = stored->all_position_acts(cut.run);
        if (!positions) return void(result = positions.error());
        result = pipeline_.resume(cut.run, start, cut.last_seq, compare, cut.annotations, std::move(*acts),
                                  std::move(*positions));
    });
    return result;
}

Result<bool> PipelineThread::caught_up() {
    Result<bool> result = Error{"the archive is closing"};
    perform([&] { result = pipeline_.caught_up(); });
    return result;
}

void PipelineThread::abandon() {
    perform([&] { pipeline_.abandon(); });
}

void PipelineThread::leave() {
    perform([&] {
        static_cast<void>(pipeline_.commit());  // without it the run is continued from an earlier item
        pipeline_.abandon();
    });
}

void PipelineThread::audit(archive::AuditRecord record, std::function<void()> kept) {
    const bool refuses = !fault().empty();
    {
        const std::scoped_lock lock{audit_mutex_};
        if (within_budget(record)) {
            // Records of actions begun while there was room still have room.
            if (audit_.size() < 2 * audit_waiting_max) {
                audit_.push_back(std::move(record));
                audit_kept_.push_back(refuses ? nullptr : std::exchange(kept, nullptr));
            } else {
                spdlog::error("audit: too much waits for the disk, an entry is lost: {} {}", record.who, record.action);
            }
        }
    }
    jobs_.try_push(Action{[] {}});  // wakes the thread; a full queue keeps it awake anyway
    if (kept) kept();
}

bool PipelineThread::within_budget(archive::AuditRecord& record) {
    if (record.who.empty() || !record.outcome.starts_with("refused")) return true;
    const auto left_out = refusals_.take(record.who, std::chrono::steady_clock::now());
    if (left_out.value_or(0) > 0)
        record.outcome += fmt::format(" (and {} refusals before it, not noted one by one)", *left_out);
    return left_out.has_value();
}

void PipelineThread::tell_audit_kept(std::optional<std::size_t> written) {
    std::vector<std::function<void()>> all;
    {
        const std::scoped_lock lock{audit_mutex_};
        const auto end = static_cast<std::ptrdiff_t>(written.value_or(audit_.size()));
        all.assign(std::make_move_iterator(audit_kept_.begin()), std::make_move_iterator(audit_kept_.begin() + end));
        if (written) {
            audit_.erase(audit_.begin(), audit_.begin() + end);
            audit_kept_.erase(audit_kept_.begin(), audit_kept_.begin() + end);
        } else {
            std::ranges::fill(audit_kept_, nullptr);
        }
    }
    for (const auto& kept : all)
        if (kept) kept();
}

bool PipelineThread::audit_has_room() const {
    const std::scoped_lock lock{audit_mutex_};
    return audit_.size() < audit_waiting_max;
}

bool PipelineThread::waits() const {
    if (pipeline_.pending_items() != 0 || !when_durable_.empty() || !answers_.empty()) return true;
    const std::scoped_lock lock{audit_mutex_};
    return !audit_.empty();
}

Result<void> PipelineThread::write_audit() {
    std::vector<archive::AuditRecord> records;
    {
        const std::scoped_lock lock{audit_mutex_};
        records = audit_;
    }
    if (records.empty()) return {};
    if (auto written = archive_.append_audit(records); !written) return written;
    tell_audit_kept(records.size());
    tell_audit_head();
    return {};
}

void PipelineThread::tell_audit_head() {
    if (!on_audited_) return;
    const auto head = archive_.audit_head();
    if (!head || *head == audit_head_) return;
    audit_head_ = *head;
    on_audited_(audit_head_);
}

Result<void> PipelineThread::commit(std::optional<std::chrono::steady_clock::time_point> when_due) {
    const bool waited = pipeline_.pending_items() != 0;
    const auto begun = std::chrono::steady_clock::now();
    auto committed = when_due ? pipeline_.commit_if_due(*when_due) : pipeline_.commit();
    if (waited && pipeline_.pending_items() == 0) note_commit(std::chrono::steady_clock::now() - begun);
    return committed ? write_audit() : committed;
}

void PipelineThread::note_commit(std::chrono::steady_clock::duration took) {
    const double took_s = std::chrono::duration<double>(took).count();
    const std::scoped_lock lock{figures_mutex_};
    ++commits_;
    commit_s_ += took_s;
    longest_commit_s_ = std::max(longest_commit_s_, took_s);
}

void PipelineThread::note_received(const Delivery& delivery) {
    const std::scoped_lock lock{figures_mutex_};
    const auto add = [&](const std::string& link, std::size_t octets) {
        auto& received = links_[link];
        ++received.items;
        received.octets += octets;
    };
    for (const auto& entry : delivery.entries) {
        if (const auto* packet = std::get_if<telemetry::ReceivedPacket>(&entry))
            add(packet->link.name, packet->octets.size());
        if (std::holds_alternative<telemetry::ReceivedTone>(entry)) add("tones", 0);
    }
    for (const auto& told : delivery.links) archive::merge(totals_[told.link], told);
}

bool PipelineThread::deliver(Delivery delivery) {
    return !given_up_ && jobs_.push(std::move(delivery)) && !given_up_;
}

Result<void> PipelineThread::finish(const archive::RunEnd& end) {
    Finish job{end, {}};
    auto done = job.done.get_future();
    if (!jobs_.push(std::move(job))) return Error{"the archive is closing"};
    return done.get();
}

bool PipelineThread::annotate(archive::RunId run, archive::Annotation annotation,
                              std::function<void(Result<Annotated>)> done) {
    return !blocked() && jobs_.try_push(Action{[this, run, annotation = std::move(annotation), done = std::move(done)] {
        auto added = pipeline_.annotate(run, annotation);
        if (!added) return done(added.error());
        tell_audit_head();  // a run that has ended got another fingerprint
        // Answered after the commit, as a command is: a failing disk must not delay what arrives meanwhile.
        answers_.push_back([done, added = std::move(added)](const std::string& fault) {
            if (fault.empty()) return done(Annotated{*added});
            done(Annotated{*added, taken_not_stored(fault)});
        });
    }});
}

template <typename Answer, typename Record>
bool PipelineThread::push_act(archive::RunId run, Record act, std::function<void(Result<Answer>)> done) {
    return !blocked() && jobs_.try_push(Action{[this, run, act = std::move(act), done = std::move(done)] {
        auto acted = pipeline_.act(run, act);
        if (!acted) return done(acted.error());
        if (!acted->refused.empty()) return done(Answer{std::move(*acted)});
        answers_.push_back([done, acted = std::move(acted)](const std::string& fault) {
            done(Answer{*acted, fault.empty() ? "" : taken_not_stored(fault)});
        });
    }});
}

bool PipelineThread::act(archive::RunId run, archive::ProcedureActRecord act, std::function<void(Result<Acted>)> done) {
    return push_act(run, std::move(act), std::move(done));
}

bool PipelineThread::act(archive::RunId run, archive::PositionActRecord act,
                         std::function<void(Result<PositionActed>)> done) {
    return push_act(run, std::move(act), std::move(done));
}

bool PipelineThread::keep_forecast(archive::ForecastRecord forecast, std::function<void(Result<std::uint64_t>)> done) {
    return !blocked() && jobs_.try_push(Action{[this, forecast = std::move(forecast), done = std::move(done)] {
        done(archive_.keep_forecast(forecast));
    }});
}

bool PipelineThread::change_layout(archive::LayoutChange change,
                                   std::function<void(Result<archive::LayoutOutcome>)> done) {
    return !blocked() && jobs_.try_push(Action{[this, change = std::move(change), done = std::move(done)] {
        done(archive_.change_layout(change));
    }});
}

bool PipelineThread::prune(archive::RunId run, archive::AuditRecord by, std::function<void(Result<void>)> done) {
    return !blocked() && jobs_.try_push(Action{[this, run, by = std::move(by), done = std::move(done)] {
        if (pipeline_.run() == run) return done(Error{fmt::format("run {} goes on: it cannot be removed", run.value)});
        auto marked = archive_.prune(run, by);
        pruning_ = pruning_ || marked.ok();
        tell_audit_head();
        done(std::move(marked));
    }});
}

void PipelineThread::remove_pruned() {
    constexpr int share = 10;  // chosen: one part in ten of this thread's time
    const auto begun = std::chrono::steady_clock::now();
    if (!pruning_ || begun < next_piece_) return;
    const auto more = archive_.remove_pruned();
    if (!more) spdlog::error("rows of pruned runs are left until the next is removed: {}", more.error().message);
    pruning_ = more.ok() && *more;
    const auto end = std::chrono::steady_clock::now();
    next_piece_ = end + (share - 1) * (end - begun);
}

std::string PipelineThread::fault() const {
    const std::scoped_lock lock{fault_mutex_};
    return fault_;
}

PipelineThread::Figures PipelineThread::figures() const {
    Figures figures;
    figures.deliveries = deliveries_;
    figures.failed_commits = failed_commits_;
    figures.published_batches = batches_;
    figures.published_items = items_;
    figures.waiting = jobs_.size();
    figures.pending_octets = pending_octets_;
    const auto size_of = [](const std::filesystem::path& file) {
        std::error_code error;
        const auto octets = std::filesystem::file_size(file, error);
        return error ? std::uintmax_t{0} : octets;
    };
    figures.archive_octets = size_of(archive_.file());
    auto log = archive_.file();
    figures.log_octets = size_of(log += "-wal");
    {
        const std::scoped_lock lock{audit_mutex_};
        figures.audit_waiting = audit_.size();
    }
    const std::scoped_lock lock{figures_mutex_};
    figures.commits = commits_;
    figures.commit_s = commit_s_;
    figures.longest_commit_s = longest_commit_s_;
    figures.links = links_;
    figures.totals = totals_;
    return figures;
}

void PipelineThread::run() {
    for (;;) {
        // Nothing waits for a commit: no need to wake for one.
        auto job = waits() || pruning_ ? jobs_.pop_until(std::chrono::steady_clock::now() + pipeline::commit_interval)
                                       : jobs_.pop();
        if (!job && jobs_.closed() && jobs_.size() == 0) {
            if (waits()) retry_until_stored([&] { return commit(std::nullopt); });
            return;
        }
        pipeline_.want_items(items_wanted_);
        if (job) {
            if (auto* begin = std::get_if<Begin>(&*job))
                begin->done.set_value(pipeline_.begin(begin->start));
            else if (auto* delivery = std::get_if<Delivery>(&*job))
                take(*delivery);
            else if (auto* action = std::get_if<Action>(&*job))
                (*action)();
            else
                finish(std::get<Finish>(*job));
        }
        commit_what_is_due();
        differs_ = pipeline_.differs();
        remove_pruned();
        pending_octets_ = pipeline_.pending_octets();
    }
}

void PipelineThread::finish(Finish& finish) {
    not_decoded_ = pipeline_.totals().not_decoded;
    const bool stored = retry_until_stored([&] { return pipeline_.finish(finish.end); });
    tell_audit_head();  // the run's fingerprint
    finish.done.set_value(stored ? Result<void>{} : Error{fault()});
}

void PipelineThread::take(Delivery& delivery) {
    ++deliveries_;
    note_received(delivery);
    // Answers first: what is not taken now is not durable, and an answer must not wait longer than this thread does.
    take_answers(delivery);
    for (auto& entry : delivery.entries) {
        const auto accept = [&] { return std::visit([&](auto& each) { return pipeline_.accept(each); }, entry); };
        // accept() refuses only while too much waits for a failing disk: commit that first.
        if (!accept() && !retry_until_stored(accept)) return;
    }
    pipeline_.relay_progress(delivery.relay_progress);
    if (!delivery.links.empty()) pipeline_.link_totals(std::move(delivery.links));
    for (auto& tell : delivery.when_durable) when_durable_.push_back(std::move(tell));
}

void PipelineThread::take_answers(Delivery& delivery) {
    for (auto& answer : std::exchange(delivery.answers, {})) answers_.push_back(std::move(answer));
}

void PipelineThread::commit_what_is_due() {
    const auto now = std::chrono::steady_clock::now();
    if (given_up_) return tell_answers(fault());
    if (now < next_attempt_) return;
    if (!noted(commit(when_durable_.empty() && answers_.empty() ? std::optional{now} : std::nullopt))) {
        next_attempt_ = now + retry_interval;
        given_up_ = faults_ == Faults::give_up;
        tell_audit_kept({});
        tell_answers(fault());
        return;
    }
    tell_answers("");
    for (const auto& tell : std::exchange(when_durable_, {})) tell();
}

void PipelineThread::tell_answers(const std::string& fault) {
    for (const auto& answer : std::exchange(answers_, {})) answer(fault);
}

bool PipelineThread::noted(const Result<void>& result) {
    if (!result) ++failed_commits_;
    const std::string fault = result ? "" : result.error().message;
    {
        const std::scoped_lock lock{fault_mutex_};
        if (fault == fault_) return result.ok();
        fault_ = fault;
    }
    if (result)
        spdlog::info("archive: writing goes on");
    else
        spdlog::error("archive: {}", fault);
    if (on_fault_) on_fault_(fault);
    return result.ok();
}

bool PipelineThread::retry_until_stored(const std::function<Result<void>()>& attempt) {
    const std::shared_ptr<void> at_the_end{nullptr, [this](void*) { blocked_ = false; }};
    for (int tries_when_closing = 0; !given_up_;) {
        const auto result = attempt();
        if (result) return noted(result);
        if (fault().empty()) noted(result);  // else the disk's own message is already set
        if (faults_ == Faults::give_up || (closing_ && ++tries_when_closing > retries_when_closing)) {
            given_up_ = true;
            break;
        }
        blocked_ = true;
        tell_audit_kept({});
        jobs_.each([this](Job& job) {  // answers of later deliveries must not wait for the disk either
            if (auto* delivery = std::get_if<Delivery>(&job)) take_answers(*delivery);
        });
        tell_answers(fault());
        pending_octets_ = pipeline_.pending_octets();
        std::this_thread::sleep_for(retry_interval);
        const auto committed = pipeline_.commit();  // commits the waiting items, so that accept() can succeed
        (void)committed;
    }
    return false;
}

}  // namespace aeolis::server
