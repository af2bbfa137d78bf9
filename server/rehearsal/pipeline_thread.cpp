#include "server/rehearsal/pipeline_thread.hpp"

#include "server/archive/reader.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::chrono::milliseconds retry_interval{500}; // ours: a full disk does not empty faster
constexpr std::size_t words_of_difference = 200;         // of an item: enough to see which it is
constexpr std::uint64_t cycles_a_second = 64;
constexpr int retries_when_closing = 4;                  // then the last commit is given up, and said so

/// Whether a run's items that came again are those that the archive has; an Error names the first that is not.
Result<void> same_items(archive::Reader& stored, const pipeline::PublishedBatch& again) {
    archive::Sequence after = again.first_seq - 1;
    auto item = again.items.begin();
    while (after < again.last_seq) {
        const std::size_t wanted = std::min<std::size_t>(archive::items_page_max, again.last_seq - after);
        const auto page = stored.items(again.run, after, wanted);
        if (!page) return page.error();
        for (const auto& before : page->items) {
            if (item == again.items.end()) break;
            if (item->item_case() == v1::Item::ITEM_NOT_SET) { // someone added what is stored here: it does not come again
                ++item;
                continue;
            }
            if (before.SerializeAsString() != item->SerializeAsString())
                return Error{fmt::format("run {}: flown again, item {} is not what it was ({})", again.run.value, before.seq(),
                                         item->ShortDebugString().substr(0, words_of_difference))};
            ++item;
        }
        if (page->complete_through <= after) return Error{fmt::format("run {}: item {} is not in the archive", again.run.value, after + 1)};
        after = page->complete_through;
    }
    return {};
}

} // namespace

void Delivery::add(const simulation::CycleReport& report) {
    entries.insert(entries.end(), report.packets.begin(), report.packets.end());
    entries.insert(entries.end(), report.tones.begin(), report.tones.end());
    entries.insert(entries.end(), report.links.begin(), report.links.end());
}

void Delivery::pass(std::uint64_t cycles, Ert now) {
    if (cycles % cycles_a_second == 0) entries.emplace_back(pipeline::EarthTime{now});
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

Result<void> PipelineThread::resume(const archive::CutOffRun& cut, const archive::RunStart& start) {
    auto reader = archive::Reader::open(archive_.file(), dictionary_);
    if (!reader) return reader.error();
    auto stored = std::make_shared<archive::Reader>(std::move(*reader));
    const auto compare = [stored](const pipeline::PublishedBatch& again) { return same_items(*stored, again); };
    Result<void> result = Error{"the archive is closing"};
    perform([&] { result = pipeline_.resume(cut.run, start, cut.last_seq, compare, cut.annotations); });
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

void PipelineThread::audit(archive::AuditRecord record) {
    {
        const std::scoped_lock lock{audit_mutex_};
        audit_.push_back(std::move(record));
    }
    jobs_.try_push(Action{[] {}}); // wakes it; a full queue keeps it awake
}

bool PipelineThread::audit_has_room() const {
    const std::scoped_lock lock{audit_mutex_};
    return audit_.size() < audit_waiting_max;
}

void PipelineThread::write_audit() {
    std::vector<archive::AuditRecord> records;
    {
        const std::scoped_lock lock{audit_mutex_};
        records.swap(audit_);
    }
    if (records.empty() || insist([&] { return archive_.append_audit(records); })) return;
    spdlog::error("audit: {} entries could not be written", records.size());
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

bool PipelineThread::annotate(archive::RunId run, archive::Annotation annotation, std::function<void(Result<archive::Annotation>)> done) {
    return jobs_.try_push(Action{[this, run, annotation = std::move(annotation), done = std::move(done)] {
        auto added = pipeline_.annotate(run, annotation);
        if (added && !insist([this] { return pipeline_.commit(); })) added = Error{fault()};
        done(std::move(added));
    }});
}

std::string PipelineThread::fault() const {
    const std::scoped_lock lock{fault_mutex_};
    return fault_;
}

PipelineThread::Figures PipelineThread::figures() const {
    return {deliveries_, failed_commits_, batches_, items_, jobs_.size()};
}

void PipelineThread::run() {
    for (;;) {
        // Nothing waits for a commit: neither does this thread need to wake for one.
        auto job = pipeline_.pending_items() == 0
                       ? jobs_.pop()
                       : jobs_.pop_until(std::chrono::steady_clock::now() + pipeline::commit_interval);
        if (!job && pipeline_.pending_items() == 0) return write_audit();
        pipeline_.want_items(items_wanted_);
        if (job) {
            if (auto* begin = std::get_if<Begin>(&*job)) {
                begin->done.set_value(pipeline_.begin(begin->start));
            } else if (auto* delivery = std::get_if<Delivery>(&*job)) {
                take(*delivery);
            } else if (auto* action = std::get_if<Action>(&*job)) {
                (*action)();
            } else {
                auto& finish = std::get<Finish>(*job);
                if (insist([&] { return pipeline_.finish(finish.end); }))
                    finish.done.set_value({});
                else
                    finish.done.set_value(Error{fault()});
            }
        }
        insist([&] { return pipeline_.commit_if_due(std::chrono::steady_clock::now()); });
        write_audit();
        if (!job && jobs_.closed() && (given_up_ || !pipeline_.commit().ok())) return;
    }
}

void PipelineThread::take(Delivery& delivery) {
    ++deliveries_;
    for (auto& entry : delivery.entries) {
        // Refused only while too much waits for a failing disk: then that must be committed first.
        const auto accepted = insist([&]() -> Result<void> {
            auto result = std::visit([&](auto& each) { return pipeline_.accept(each); }, entry);
            return result;
        });
        if (!accepted) return;
    }
    pipeline_.relay_progress(delivery.relay_progress);
    if (!delivery.links.empty()) pipeline_.link_totals(std::move(delivery.links));
    if (delivery.when_durable.empty()) return;
    if (!insist([&] { return pipeline_.commit(); })) return;
    for (const auto& tell : delivery.when_durable)
        tell();
}

bool PipelineThread::insist(const std::function<Result<void>()>& attempt) {
    for (int tries = 0; !given_up_; ++tries) {
        auto result = attempt();
        if (result) {
            if (tries > 0) {
                spdlog::info("archive: writing goes on");
                const std::scoped_lock lock{fault_mutex_};
                fault_.clear();
            }
            return true;
        }
        ++failed_commits_;
        if (tries == 0) {
            spdlog::error("archive: {}", result.error().message);
            const std::scoped_lock lock{fault_mutex_};
            fault_ = result.error().message;
        }
        if (faults_ == Faults::give_up || (jobs_.closed() && tries >= retries_when_closing)) {
            given_up_ = true;
            break;
        }
        std::this_thread::sleep_for(retry_interval);
        const auto committed = pipeline_.commit(); // what waits goes first: accept() can then succeed
        (void)committed;
    }
    return false;
}

} // namespace aeolis::server
