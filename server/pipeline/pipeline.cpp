// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/pipeline.hpp"

#include "server/archive/item_tables.hpp"
#include "server/archive/items.hpp"
#include "server/archive/packet_columns.hpp"
#include "server/base/wall_clock.hpp"
#include "server/pipeline/packet_intake.hpp"
#include "server/pipeline/procedure_feed.hpp"
#include "server/pipeline/situation_feed.hpp"
#include "telemetry/staleness.hpp"
#include "telemetry/station/station_packets.hpp"

#include <algorithm>
#include <map>

namespace aeolis::pipeline {

namespace {

/// How far an act's time may be ahead of the newest item that was there when it was taken: ProcedureFeed::act.
constexpr std::int64_t act_ahead_us = 1'000'000;

std::vector<archive::ProcedureActRecord> acts_before(std::span<const archive::Annotation> annotations, Ert fork) {
    std::vector<archive::ProcedureActRecord> acts;
    for (const auto& annotation : annotations)
        if (const auto* act = std::get_if<archive::ProcedureActRecord>(&annotation);
            act != nullptr && act->ert.microseconds <= fork.microseconds + act_ahead_us)
            acts.push_back(*act);
    return acts;
}

}  // namespace

struct Pipeline::State {
    State(archive::Archive& archive_in, const dictionary::Dictionary& dictionary_in,
          const telemetry::OtherMission* other_in)
        : archive(archive_in), dictionary(dictionary_in), other(other_in), columns(dictionary_in) {}

    /// All state of the current run.
    struct Run {
        Run(RunId id_in, archive::RunStart start_in, const State& state, Numbering numbering_in)
            : id(id_in), start(std::move(start_in)), numbering(std::move(numbering_in)),
              intake(state.dictionary, state.columns, state.other), staleness(state.dictionary),
              situation(state.dictionary, start), procedures(state.dictionary, state.columns, start) {}
        RunId id;
        archive::RunStart start;
        Numbering numbering;
        PacketIntake intake;
        telemetry::StalenessMonitor staleness;
        SituationFeed situation;
        ProcedureFeed procedures;
        archive::Batch pending;
        double progress = 0.0, durable_progress = 0.0;  ///< of the recording
        Sequence last_durable = 0;
        Sequence repeat_until = 0;                      ///< items up to here are already durable
        Compare compare;                                ///< not null while items are repeated
        std::optional<Repeated> origin;                 ///< until the fork
        std::size_t annotated = 0;                      ///< of the origin's annotations
        std::vector<archive::ProcedureActRecord> acts;  ///< to be taken again, in their order
        std::size_t acted = 0;                          ///< of them
        std::optional<Error> differs;
        struct RawLink {
            std::uint64_t received = 0, stored = 0;  ///< octets; the first `stored` are durable
        };
        std::map<std::string, RawLink> raw;
        std::uint16_t station_carriers = 0, station_events = 0, station_spectra = 0;  ///< packets so far

        bool repeats() const { return compare != nullptr; }
        /// Adds the origin's annotations whose numbers have come; in a silence, where no item follows, those that were
        /// made before the fork.
        void annotate(Positions& positions) {
            for (; annotated < origin->annotations.size(); ++annotated) {
                const archive::Annotation& annotation = origin->annotations[annotated];
                const Sequence seq = std::visit([](const auto& record) { return record.seq; }, annotation);
                const Ert made = std::visit([](const auto& record) { return record.ert; }, annotation);
                if (seq > numbering.last() && !(made <= origin->until && numbering.has_come_to(seq))) return;
                numbering.pass(seq);
                if (const auto* act = std::get_if<archive::PositionActRecord>(&annotation); act != nullptr)
                    if (auto taken = positions.repeat({act, 1}); !taken && !differs) differs = taken.error();
                pending.add(annotation);
                pending.first_seq = pending.first_seq == 0 ? seq : std::min(pending.first_seq, seq);
                pending.last_seq = std::max(pending.last_seq, seq);
            }
        }
        /// When something left the vehicle, by light time.
        Sclk sent(Ert ert) const {
            const double after_s =
                static_cast<double>(ert.microseconds - start.correlation.scet.microseconds) * 1e-6 - start.light_time_s;
            return start.correlation.sclk + after_s / start.correlation.rate;
        }
        archive::RecordingTotals totals() const {
            auto totals = intake.totals();
            totals.progress = progress;
            return totals;
        }
    };

    Result<void> room();
    std::string not_going_on(RunId id) const;
    void repeat_acts();
    std::size_t pending_octets() const;
    void take(const telemetry::ReceivedOctets& piece);
    void take(const telemetry::ReceivedPacket& packet);
    /// Notes that the newest packet of the batch was received.
    void heard(bool of_ground);
    void add(std::span<const telemetry::StalenessChange> changes, Ert ert);
    template <typename Received>
    Result<void> accept(const Received& received) {
        if (auto room = this->room(); !room) return room;
        take(received);
        return {};
    }
    void take(const telemetry::ReceivedTone& tone);
    void take(const telemetry::ReceivedCarrier& carrier);
    void take(const telemetry::SeenByDoppler& seen);
    void take(const telemetry::ReceivedSpectrum& spectrum);
    bool has_packet(Apid apid) const;
    void take(const telemetry::LinkState& link);
    void follow();
    void add(std::optional<archive::SituationRecord> situation);
    void add_statuses(std::vector<archive::ProcedureStatusRecord> statuses);
    void compare_with_archive();
    Result<void> go_on_where_it_was_cut_off();
    std::shared_ptr<const PublishedBatch> published(RunId of, const archive::Batch& batch, bool built) const;

    archive::Archive& archive;
    const dictionary::Dictionary& dictionary;
    const telemetry::OtherMission* other;
    archive::PacketColumns columns;
    Publish publish;
    bool items_wanted = true;
    std::uint64_t raw_kept = archive::raw_octets_kept;
    std::optional<Run> run;
    Positions positions;
    std::chrono::steady_clock::time_point last_commit{};
};

Pipeline::Pipeline(archive::Archive& archive, const dictionary::Dictionary& dictionary,
                   const telemetry::OtherMission* other)
    : state_(std::make_unique<State>(archive, dictionary, other)) {}
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

void Pipeline::on_publish(Publish publish) {
    state_->publish = std::move(publish);
}
void Pipeline::want_items(bool wanted) {
    state_->items_wanted = wanted;
}

std::optional<RunId> Pipeline::run() const {
    return state_->run ? std::optional(state_->run->id) : std::nullopt;
}
Sequence Pipeline::last_durable() const {
    return state_->run ? state_->run->last_durable : 0;
}
std::size_t Pipeline::pending_items() const {
    if (!state_->run) return 0;
    const auto& pending = state_->run->pending;
    return pending.requests.size() + pending.raw.size() + pending.link_totals.size() +
           (pending.last_seq == 0 ? 0 : static_cast<std::size_t>(pending.last_seq - pending.first_seq + 1));
}

Result<RunId> Pipeline::begin(const archive::RunStart& start) {
    if (state_->run) return Error{"run " + std::to_string(state_->run->id.value) + " still goes on"};
    auto id = state_->archive.begin_run(start, state_->dictionary);
    if (!id) return id.error();
    state_->run.emplace(*id, start, *state_, Numbering{});
    state_->positions.begin();
    return *id;
}

Result<RunId> Pipeline::begin(const archive::RunStart& start, Repeated repeated) {
    if (state_->run) return Error{"run " + std::to_string(state_->run->id.value) + " still goes on"};
    AEOLIS_CHECK(repeated.compare != nullptr);
    auto id = state_->archive.begin_run(start, state_->dictionary);
    if (!id) return id.error();
    std::vector<Sequence> numbers;
    numbers.reserve(repeated.annotations.size());
    for (const auto& annotation : repeated.annotations)
        numbers.push_back(std::visit([](const auto& record) { return record.seq; }, annotation));
    state_->run.emplace(*id, start, *state_, Numbering{1, std::move(numbers), Numbering::Last::given});
    state_->run->acts = acts_before(repeated.annotations, repeated.until);
    state_->run->origin = std::move(repeated);
    state_->positions.begin();
    return *id;
}

bool Pipeline::differs() const {
    return state_->run && state_->run->differs.has_value();
}

Result<Sequence> Pipeline::forked() {
    AEOLIS_CHECK(state_->run.has_value() && state_->run->origin.has_value());
    state_->repeat_acts();
    if (auto done = commit(); !done) return done.error();
    state_->run->origin.reset();
    state_->run->numbering.forget_taken();
    state_->run->acts.clear();
    if (state_->run->differs) return *state_->run->differs;
    return state_->run->last_durable;
}

Result<void> Pipeline::resume(RunId run, const archive::RunStart& start, Sequence durable, Compare compare,
                              std::vector<Sequence> annotations, std::vector<archive::ProcedureActRecord> acts,
                              std::vector<archive::PositionActRecord> positions) {
    if (state_->run) return Error{"run " + std::to_string(state_->run->id.value) + " still goes on"};
    AEOLIS_CHECK(compare != nullptr);
    state_->run.emplace(run, start, *state_, Numbering{1, std::move(annotations)});
    state_->run->repeat_until = durable;
    state_->run->last_durable = durable;
    state_->run->compare = std::move(compare);
    state_->run->acts = std::move(acts);
    auto stored = state_->archive.raw_ends(run);
    if (!stored) {
        state_->run.reset();
        return stored.error();
    }
    for (const auto& [link, octets] : *stored) state_->run->raw[link].stored = octets;
    state_->positions.begin();
    if (auto taken = state_->positions.repeat(positions); !taken) state_->run->differs = taken.error();
    return {};
}

/// Compares the waiting items, which are already durable, with the archive, and drops them.
void Pipeline::State::compare_with_archive() {
    if (!run->differs && run->pending.last_seq > run->repeat_until)
        run->differs =
            Error{"what came with item " + std::to_string(run->repeat_until) + ", the last that is stored, now has " +
                  std::to_string(run->pending.last_seq - run->repeat_until) + " more items"};
    if (!run->differs && run->pending.last_seq != 0)
        if (auto same = run->compare(*published(run->id, run->pending, true)); !same) run->differs = same.error();
    auto not_stored = std::move(run->pending.raw);  // what came since the last commit before the run was cut off
    run->pending.clear();
    for (const auto& piece : not_stored) run->pending.raw_octets += piece.octets.size();
    run->pending.raw = std::move(not_stored);
}

/// Takes the acts again whose place among the items has come.
void Pipeline::State::repeat_acts() {
    for (auto& next = run->acted; next < run->acts.size(); ++next) {
        const archive::ProcedureActRecord& act = run->acts[next];
        if (!run->numbering.has_come_to(act.seq)) return;
        auto status = run->procedures.repeat(act, run->intake.latest());
        if (!status) {
            if (!run->differs)
                run->differs = Error{"the act on a procedure that is item " + std::to_string(act.seq) +
                                     " is refused now: " + status.error().message};
            continue;
        }
        add_statuses({std::move(*status)});
    }
}

/// Continues the run once its last durable item was repeated; does nothing before that or when not repeating.
Result<void> Pipeline::State::go_on_where_it_was_cut_off() {
    if (!run->repeats() || run->numbering.last() < run->repeat_until) return {};
    compare_with_archive();
    if (run->differs) return {};
    if (auto done = archive.continue_run(run->id); !done) return done;
    run->compare = nullptr;
    return {};
}

Result<bool> Pipeline::caught_up() {
    AEOLIS_CHECK(state_->run.has_value());
    auto& run = *state_->run;
    state_->repeat_acts();
    if (auto done = commit(); !done) return done.error();
    if (auto done = state_->go_on_where_it_was_cut_off(); !done) return done.error();
    if (run.differs) return *run.differs;
    return !run.repeats();
}

void Pipeline::abandon() {
    state_->run.reset();
    state_->positions.end();
}

std::size_t Pipeline::State::pending_octets() const {
    if (!run) return 0;
    return run->pending.octets.size() + run->pending.values.size() * sizeof(double) + run->pending.raw_octets;
}

std::size_t Pipeline::pending_octets() const {
    return state_->pending_octets();
}

Result<void> Pipeline::State::room() {
    AEOLIS_CHECK(run.has_value());
    repeat_acts();
    if (auto done = go_on_where_it_was_cut_off(); !done) return done;
    const std::size_t octets = pending_octets();
    if (octets < pending_octets_max) return {};
    return Error{archive.file().string() + ": " + std::to_string(octets >> 20U) +
                 " MB wait to be stored; the run is held until they are"};
}

Result<void> Pipeline::accept(const telemetry::Received& received) {
    if (received.packets.empty() && received.tones.empty() && received.carrier.empty() && received.seen.empty() &&
        received.spectra.empty() && received.links.empty() && received.octets.empty())
        return {};
    // All or nothing: otherwise a retry would store items twice.
    if (auto room = state_->room(); !room) return room;
    for (const auto& piece : received.octets) state_->take(piece);
    for (const auto& link : received.links) state_->take(link);
    for (const auto& packet : received.packets) state_->take(packet);
    for (const auto& tone : received.tones) state_->take(tone);
    for (const auto& carrier : received.carrier) state_->take(carrier);
    for (const auto& seen : received.seen) state_->take(seen);
    for (const auto& spectrum : received.spectra) state_->take(spectrum);
    return {};
}

Result<void> Pipeline::accept(const telemetry::ReceivedOctets& octets) {
    return state_->accept(octets);
}

Result<void> Pipeline::accept(const telemetry::ReceivedPacket& packet) {
    return state_->accept(packet);
}

Result<void> Pipeline::accept(const telemetry::ReceivedTone& tone) {
    return state_->accept(tone);
}

Result<void> Pipeline::accept(const telemetry::ReceivedCarrier& carrier) {
    return state_->accept(carrier);
}

Result<void> Pipeline::accept(const telemetry::SeenByDoppler& seen) {
    return state_->accept(seen);
}

Result<void> Pipeline::accept(const telemetry::ReceivedSpectrum& spectrum) {
    return state_->accept(spectrum);
}

Result<void> Pipeline::accept(const telemetry::LinkState& link) {
    return state_->accept(link);
}

Result<void> Pipeline::accept(const telemetry::EarthTime& time) {
    if (auto room = state_->room(); !room) return room;
    std::vector<telemetry::StalenessChange> changes;
    state_->run->staleness.pass(time.now, changes);
    state_->add(changes, time.now);
    state_->add(state_->run->situation.changed(time.now));
    state_->add_statuses(state_->run->procedures.pass(time.now));
    return {};
}

Result<archive::Annotation> Pipeline::annotate(RunId run, archive::Annotation annotation) {
    if (!state_->run || state_->run->id != run) {
        auto added = state_->archive.annotate(run, std::move(annotation));
        if (!added || !state_->publish) return added;
        archive::Batch batch;
        batch.first_seq = batch.last_seq = std::visit([](const auto& record) { return record.seq; }, *added);
        batch.add(*added);
        state_->publish(state_->published(run, batch, true));
        return added;
    }
    if (state_->run->repeats() || state_->run->origin)
        return Error{"run " + std::to_string(run.value) + " is flown again up to where it was " +
                     (state_->run->origin ? "forked" : "cut off") + ": try again when it goes on"};
    if (auto room = state_->room(); !room) return room.error();
    auto& current = *state_->run;
    std::visit([&](auto& record) { record.seq = current.numbering.next(current.pending); }, annotation);
    current.pending.add(annotation);
    return annotation;
}

/// Why people cannot act in the run now; empty: it goes on, and they can.
std::string Pipeline::State::not_going_on(RunId id) const {
    const auto of_run = "run " + std::to_string(id.value);
    if (!run || run->id != id)
        return of_run + " does not go on: people act on procedures and positions while a run does";
    if (run->repeats() || run->origin)
        return of_run + " is flown again up to where it was " + (run->origin ? "forked" : "cut off") +
               ": try again when it goes on";
    return "";
}

Result<Pipeline::PositionActed> Pipeline::act(RunId run, archive::PositionActRecord act) {
    if (auto why = state_->not_going_on(run); !why.empty()) return PositionActed{std::move(why), {}};
    if (auto room = state_->room(); !room) return room.error();
    auto& current = *state_->run;
    act.ert = current.procedures.moved(act.ert);
    auto acted = state_->positions.act(std::move(act));
    if (!acted) return PositionActed{acted.error().message, {}};
    acted->seq = current.numbering.next(current.pending);
    current.pending.position_acts.push_back(*acted);
    return PositionActed{{}, std::move(*acted)};
}

const Positions& Pipeline::positions() const {
    return state_->positions;
}

Result<Pipeline::Acted> Pipeline::act(RunId run, archive::ProcedureActRecord act) {
    if (auto why = state_->not_going_on(run); !why.empty()) return Acted{std::move(why)};
    // Whoever sees a danger may hold a procedure.
    if (act.kind != archive::ProcedureActKind::hold)
        if (auto may = state_->positions.may_act(act.position, act.by); !may) return Acted{may.error().message};
    if (auto room = state_->room(); !room) return room.error();
    auto& current = *state_->run;
    auto acted = current.procedures.act(std::move(act), current.intake.latest());
    if (!acted) return Acted{acted.error().message};
    acted->act.seq = current.numbering.next(current.pending);
    current.pending.procedure_acts.push_back(std::move(acted->act));
    state_->add_statuses({std::move(acted->status)});
    return Acted{{}, current.pending.procedure_statuses.back()};
}

Result<void> Pipeline::accept(archive::RequestRecord request) {
    if (auto room = state_->room(); !room) return room;
    state_->run->pending.requests.push_back(std::move(request));
    return {};
}

Result<void> Pipeline::accept(archive::StageRecord stage) {
    if (auto room = state_->room(); !room) return room;
    auto& run = *state_->run;
    stage.seq = run.numbering.next(run.pending);
    run.pending.stages.push_back(std::move(stage));
    state_->follow();
    return {};
}

/// Gives what was added to the batch to those who watch the run.
void Pipeline::State::follow() {
    run->situation.follow(run->pending);
    run->procedures.follow(run->pending, run->intake.latest());
}

void Pipeline::State::take(const telemetry::ReceivedOctets& piece) {
    auto& link = run->raw[piece.link.name];
    const std::uint64_t first = link.received;
    link.received += piece.octets.size();
    const std::uint64_t durable = link.stored > first ? std::min(link.stored, link.received) - first : 0;
    const auto octets = std::span{piece.octets}.subspan(static_cast<std::size_t>(durable));
    if (octets.empty() || raw_kept == 0) return;
    auto& pieces = run->pending.raw;
    run->pending.raw_kept = raw_kept;
    run->pending.raw_octets += octets.size();
    const auto last = std::find_if(pieces.rbegin(), pieces.rend(),
                                   [&](const archive::RawRecord& each) { return each.link == piece.link.name; });
    const bool joins = last != pieces.rend() && !last->datagram && !piece.datagram &&
                       last->octets.size() + octets.size() <= archive::RawRecord::octets_max &&
                       piece.ert.microseconds - last->begun.microseconds <= archive::RawRecord::joined_us_max;
    if (joins) {
        last->octets.insert(last->octets.end(), octets.begin(), octets.end());
        last->ert = piece.ert;
    } else {
        pieces.push_back(
            {piece.link.name, piece.ert, piece.ert, first + durable, {octets.begin(), octets.end()}, piece.datagram});
    }
}

void Pipeline::State::take(const telemetry::ReceivedPacket& packet) {
    run->intake.take(packet, run->numbering, run->pending);
    if (const auto& remark = run->intake.remark(); !remark.empty()) {
        archive::NoteRecord note;
        note.seq = run->numbering.next(run->pending);
        note.ert = packet.ert;
        note.text = remark;
        note.by = "ground";
        note.written = server::wall_clock_text();
        run->pending.notes.push_back(std::move(note));
    }
    if (!packet.link.recorded) heard(packet.link == telemetry::station_link);
    follow();
}

void Pipeline::State::heard(bool of_ground) {
    const auto& record = run->pending.packets.back();
    if (!record.packet) return;
    const Ert ert = record.ert;
    std::vector<telemetry::StalenessChange> changes;
    if (of_ground)
        run->staleness.made_on_ground(*record.packet, ert, changes);
    else
        run->staleness.heard(*record.packet, ert, changes);
    if (!run->intake.phase().empty()) run->staleness.phase(run->intake.phase(), ert, changes);
    add(changes, ert);
}

void Pipeline::State::add(std::span<const telemetry::StalenessChange> changes, Ert ert) {
    for (const auto& change : changes)
        run->pending.staleness.push_back({{run->numbering.next(run->pending), ert},
                                          static_cast<std::uint16_t>(change.packet),
                                          change.is != telemetry::Staleness::current,
                                          change.silent_s,
                                          change.expected_s,
                                          change.reason});
}

void Pipeline::State::take(const telemetry::LinkState& link) {
    run->pending.links.push_back({{run->numbering.next(run->pending), link.ert},
                                  link.link.name,
                                  link.up,
                                  link.words,
                                  link.lost,
                                  link.until,
                                  link.silence});
    follow();
    if (link.link.recorded) return;
    std::vector<telemetry::StalenessChange> changes;
    using telemetry::LinkIs;
    run->staleness.link(link.link.name,
                        link.up     ? LinkIs::up
                        : link.lost ? LinkIs::lost
                                    : LinkIs::down,
                        link.reason(), link.ert, changes);
    add(changes, link.ert);
}

void Pipeline::State::take(const telemetry::ReceivedTone& tone) {
    archive::ToneRecord record;
    record.seq = run->numbering.next(run->pending);
    record.start = tone.start;
    record.ert = tone.end;
    record.tone = tone.tone;
    if (tone.tone && tone.tone->value < dictionary.tones.size()) {
        record.name = dictionary.tones[tone.tone->value].name;
        record.meaning = dictionary.tones[tone.tone->value].meaning;
    }
    record.likelihood = tone.likelihood;
    if (tone.best) {
        record.best.assign(tone.best->begin(), tone.best->end());
        record.runner_up = ToneId{record.best[1].tone};
        record.runner_up_likelihood = record.best[1].likelihood;
    }
    record.spectrum = tone.spectrum;
    record.c_n0_dbhz = tone.c_n0_dbhz;
    record.doppler_hz = tone.doppler_hz;
    record.lock = tone.lock;
    record.model = run->start.tone_model;
    record.sclk = run->sent(tone.start);
    run->pending.tones.push_back(std::move(record));
    follow();
}

/// Whether the run's dictionary has the packet, which the station makes.
bool Pipeline::State::has_packet(Apid apid) const {
    return other == nullptr &&
           std::ranges::find(dictionary.packets, apid, &dictionary::Packet::apid) != dictionary.packets.end();
}

void Pipeline::State::take(const telemetry::ReceivedSpectrum& spectrum) {
    if (!has_packet(station_spectrum_apid)) return;
    take(telemetry::ReceivedPacket{telemetry::station_link, spectrum.ert,
                                   telemetry::station_spectrum_packet(spectrum, run->sent(spectrum.middle),
                                                                      run->station_spectra++, dictionary.id)});
}

void Pipeline::State::take(const telemetry::ReceivedCarrier& carrier) {
    if (!has_packet(station_carrier_apid)) return;
    take(telemetry::ReceivedPacket{
        telemetry::station_link, carrier.ert,
        telemetry::station_carrier_packet(carrier, run->sent(carrier.middle), run->station_carriers++, dictionary.id)});
}

void Pipeline::State::take(const telemetry::SeenByDoppler& seen) {
    const auto* event = other != nullptr ? nullptr : dictionary.event(telemetry::seen_by_doppler_name);
    if (event == nullptr) return;
    take(telemetry::ReceivedPacket{telemetry::station_link, seen.ert,
                                   telemetry::seen_by_doppler_packet(seen, event->id, run->sent(seen.at),
                                                                     run->start.entry, run->station_events++,
                                                                     dictionary.id)});
}

void Pipeline::State::add(std::optional<archive::SituationRecord> situation) {
    if (!situation) return;
    situation->seq = run->numbering.next(run->pending);
    run->pending.situations.push_back(std::move(*situation));
}

void Pipeline::State::add_statuses(std::vector<archive::ProcedureStatusRecord> statuses) {
    for (auto& status : statuses) {
        status.seq = run->numbering.next(run->pending);
        run->pending.procedure_statuses.push_back(std::move(status));
    }
}

void Pipeline::relay_progress(double progress) {
    AEOLIS_CHECK(state_->run.has_value());
    state_->run->progress = progress;
}

void Pipeline::keep_raw(std::uint64_t octets) {
    state_->raw_kept = octets;
}

void Pipeline::link_totals(std::vector<archive::LinkTotals> links) {
    if (!state_->run) return;
    auto& pending = state_->run->pending.link_totals;
    for (auto& told : links) {
        const auto known = std::ranges::find(pending, told.link, &archive::LinkTotals::link);
        if (known == pending.end())
            pending.push_back(std::move(told));
        else
            archive::merge(*known, std::move(told));
    }
}

archive::RecordingTotals Pipeline::totals() const {
    return state_->run ? state_->run->totals() : archive::RecordingTotals{};
}

const std::vector<std::optional<LatestValue>>& Pipeline::latest() const {
    static const std::vector<std::optional<LatestValue>> nothing;
    return state_->run ? state_->run->intake.latest() : nothing;
}

Result<void> Pipeline::commit_if_due(std::chrono::steady_clock::time_point now) {
    if (pending_items() == 0) return {};
    if (pending_items() < commit_items && now - state_->last_commit < commit_interval) return {};
    state_->last_commit = now;
    return commit();
}

Result<void> Pipeline::commit_if_full() {
    return pending_items() < commit_items ? Result<void>{} : commit();
}

Result<void> Pipeline::commit() {
    if (!state_->run) return {};
    auto& run = *state_->run;
    if (run.repeats()) {
        state_->compare_with_archive();
        return {};
    }
    if (!run.pending.packets.empty() || run.progress != run.durable_progress) run.pending.totals = run.totals();
    if (run.origin) run.annotate(state_->positions);
    if (run.pending.empty()) return {};
    if (run.origin && !run.differs && run.pending.last_seq != 0)
        if (auto same = run.origin->compare(*state_->published(run.origin->run, run.pending, true)); !same)
            run.differs = same.error();
    if (auto done = state_->archive.append(run.id, run.pending); !done) return done;
    run.durable_progress = run.progress;
    const auto batch = state_->published(run.id, run.pending, state_->items_wanted);
    run.pending.clear();
    if (!batch) return {};
    run.last_durable = batch->last_seq;
    if (state_->publish && !run.origin) state_->publish(batch);
    return {};
}

Result<void> Pipeline::finish(const archive::RunEnd& end) {
    AEOLIS_CHECK(state_->run.has_value());
    auto& run = *state_->run;
    if (!run.pending.end) {  // once, though a failed commit is tried again
        state_->add(run.situation.changed());
        state_->add_statuses(run.procedures.pass());
    }
    run.intake.seal(run.pending);
    run.pending.end = end;
    if (auto done = commit(); !done) return done;
    state_->run.reset();
    state_->positions.end();
    return {};
}

std::shared_ptr<const PublishedBatch> Pipeline::State::published(RunId of, const archive::Batch& batch,
                                                                 bool built) const {
    if (batch.last_seq == 0) return nullptr;
    auto made = std::make_shared<PublishedBatch>();
    made->run = of;
    made->first_seq = batch.first_seq;
    made->last_seq = batch.last_seq;
    made->built = built;
    if (!built) return made;
    made->items.resize(static_cast<std::size_t>(batch.last_seq - batch.first_seq + 1));
    const auto place = [&](v1::Item item) {
        const auto index = static_cast<std::size_t>(item.seq() - batch.first_seq);
        made->items[index] = std::move(item);
    };
    for (const auto& sample : batch.samples)
        place(to_item(sample, columns.channels(sample.packet),
                      std::span(batch.values).subspan(sample.values.first, sample.values.count)));
    archive::for_item_kinds([&]<typename Record>(archive::ItemKind<Record>) {
        for (const auto& record : batch.*archive::ItemTable<Record>::of_batch)
            place(archive::item_of(record, &dictionary));
    });
    return made;
}

}  // namespace aeolis::pipeline
