#include "server/rehearsal/rehearsal.hpp"

#include "generated/dictionary_flight.hpp"
#include "server/rehearsal/wall_clock.hpp"
#include "server/scenario/scenario_text.hpp"
#include "telemetry/packet_stream.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server {
namespace {

constexpr const char* firing_packet_name = "TimepointFired";
constexpr const char* product_packet_name = "DataProduct";

const char* name_of(simulation::Outcome outcome) {
    using simulation::Outcome;
    switch (outcome) {
    case Outcome::running:
        return "running";
    case Outcome::touchdown:
        return "touchdown";
    case Outcome::impact:
        return "impact";
    case Outcome::lost:
        return "lost";
    case Outcome::not_commanded:
        return "not_commanded";
    case Outcome::timeout:
        return "timeout";
    }
    return "running";
}

/// Where the recording tells of decisions that the truth cannot see: the event of the same name in capitals.
std::vector<simulation::EventReportName> event_reports(const dictionary::Dictionary& dictionary) {
    std::vector<simulation::EventReportName> reports;
    for (const std::string name : simulation::decided_on_board) {
        std::string capitals = name;
        std::ranges::transform(capitals, capitals.begin(),
                               [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
        if (const dictionary::Event* event = dictionary.event(capitals))
            reports.push_back({dictionary.packets[event->packet].apid, event->id, name});
    }
    return reports;
}

} // namespace

Rehearsal::Rehearsal(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                     const dictionary::Dictionary& dictionary, std::shared_ptr<flight::CycleRunner> runner)
    : scenario_(scenario), dictionary_(dictionary), seed_(seed), case_number_(case_number),
      landing_(scenario, seed, case_number, event_reports(dictionary)),
      gateway_(dictionary, landing_.light_time_s(), solution_arguments(landing_.solution())),
      script_(scenario.commands), firing_packet_(dictionary.packet(firing_packet_name)),
      product_packet_(dictionary.packet(product_packet_name)), decommutator_(dictionary) {
    if (runner == nullptr && scenario.test_venue == simulation::TestVenue::performance) {
        ThreadedExecutive::Options options;
        options.measure = true;
        runner = executive_ = std::make_shared<ThreadedExecutive>(options);
    }
    if (runner != nullptr) landing_.run_prime_by(std::move(runner));
}

const simulation::CycleReport& Rehearsal::step() {
    if (!broken_.empty()) return nothing_;
    try {
        send_script();
        const auto& report = landing_.step();
        ++cycles_;
        take(report);
        return report;
    } catch (const CheckFailed& bug) {
        broken_ = fmt::format("{} ({}:{})", bug.what(), bug.file(), bug.line());
        return nothing_;
    }
}

void Rehearsal::send_script() {
    while (!script_.empty()) {
        // The first one of those that are due first: an order within one instant is the scenario's.
        const auto next = std::ranges::max_element(script_, {}, &simulation::ScriptedCommand::send_before_entry_s);
        if (landing_.sclk() < scenario_.entry_sclk - next->send_before_entry_s) return;
        const auto command = std::move(*next);
        script_.erase(next);
        v1::CommandRequest request;
        request.set_command(command.command);
        request.set_from_solution(command.from_solution);
        for (const auto& [name, value] : command.arguments) {
            auto& argument = *request.add_arguments();
            argument.set_name(name);
            argument.set_value(value);
        }
        // Who wrote the command into the scenario has armed and named it.
        request.set_armed(true);
        request.set_confirmation(command.command);
        const auto reply = submit(request);
        if (!reply.accepted()) script_refusals_.push_back(reply.reason());
    }
}

v1::CommandReply Rehearsal::submit(const v1::CommandRequest& request) {
    if (scenario_.test_venue == simulation::TestVenue::gnc_alone) {
        v1::CommandReply refusal;
        refusal.set_request(request.request());
        refusal.set_reason(fmt::format("the test venue {} has no computer", name_of(scenario_.test_venue)));
        return refusal;
    }
    const auto submitted = gateway_.submit(request, landing_.ert_now(), stages_);
    if (!submitted.packet.empty()) landing_.uplink(submitted.packet);
    return submitted.reply;
}

void Rehearsal::take(const simulation::CycleReport& report) {
    add_to_digest(report.recorded);
    note_firings(report.recorded);
    for (const auto& packet : report.packets) {
        const bool realtime = packet.link == simulation::LinkId::uhf_live;
        units_.add(packet.octets, realtime ? telemetry::Path::realtime : telemetry::Path::recorded);
        gateway_.receive(packet.octets, realtime, packet.ert, stages_);
        note_product(packet.octets);
    }
    // Once a second is enough for windows of many seconds.
    if (cycles_ % 64 == 0) gateway_.pass(landing_.ert_now(), stages_);

    for (const auto& tone : report.tones) {
        if (tone.sent) ++tones_.sent;
        if (tone.tone)
            ++(tone.tone == tone.sent ? tones_.decoded : tones_.wrong);
        else if (tone.sent)
            ++tones_.missed;
    }
    events_.insert(events_.end(), report.events.begin(), report.events.end());
}

void Rehearsal::add_to_digest(std::span<const std::uint8_t> recorded) {
    if (scenario_.test_venue == simulation::TestVenue::gnc_alone) {
        const auto position = landing_.truth().p_MoB_M_m;
        const auto octets = std::as_bytes(std::span{position});
        digest_.add({reinterpret_cast<const std::uint8_t*>(octets.data()), octets.size()});
    }
    if (scenario_.test_venue != simulation::TestVenue::performance) return digest_.add(recorded);
    telemetry::PacketStream packets{recorded};
    while (const auto packet = packets.next()) {
        const auto header = read_primary_header(*packet);
        if (header && header->apid == flight::packet::TaskTimes::apid) continue;
        digest_.add(*packet);
    }
}

void Rehearsal::note_firings(std::span<const std::uint8_t> recorded) {
    if (recorded.empty() || firing_packet_ == nullptr) return;
    telemetry::PacketStream packets{recorded};
    while (const auto packet = packets.next()) {
        const auto header = read_primary_header(*packet);
        if (!header || header->apid != firing_packet_->apid || decommutator_.decode(*packet, decoded_)) continue;
        const auto field = [&](std::string_view name) { return telemetry::field_index(*firing_packet_, name); };
        const auto timepoint = field("timepoint"), fired = field("fired_sclk"), verdict = field("verdict");
        if (!timepoint || !fired || !verdict || !decoded_.value[*timepoint] || !decoded_.value[*fired]) continue;
        const auto row = static_cast<std::size_t>(*decoded_.value[*timepoint]);
        firings_.push_back(
            {row < dictionary_.timeline.size() ? dictionary_.timeline[row].name : fmt::format("timepoint {}", row),
             *decoded_.value[*fired],
             telemetry::number_text(firing_packet_->fields[*verdict].type, decoded_.value[*verdict])});
    }
}

void Rehearsal::note_product(std::span<const std::uint8_t> packet) {
    const auto header = read_primary_header(packet);
    if (!header || product_packet_ == nullptr || header->apid != product_packet_->apid) return;
    if (decommutator_.decode(packet, decoded_)) return;
    if (const auto part = telemetry::part_of(dictionary_, decoded_, packet))
        static_cast<void>(products_.add(*part)); // real time and recording bring most parts twice
}

std::vector<archive::StageRecord> Rehearsal::take_stages() {
    return std::exchange(stages_, {});
}

std::string Rehearsal::outcome() const {
    return broken_.empty() ? name_of(landing_.outcome()) : "lost";
}

std::string Rehearsal::outcome_reason() const {
    return broken_.empty() ? landing_.outcome_reason() : "a check failed in the simulation: " + broken_;
}

telemetry::Proof Rehearsal::proof() const {
    if (landing_.relay_progress() >= 1.0) return telemetry::prove(units_);
    auto units = units_;
    telemetry::PacketStream recording{landing_.recording()};
    while (const auto packet = recording.next())
        units.add(*packet, telemetry::Path::recorded);
    return telemetry::prove(units);
}

archive::RunStart Rehearsal::run_start(double pace) const {
    archive::RunStart start;
    start.scenario = scenario_.name;
    start.title = scenario_.title;
    start.seed = seed_;
    start.case_number = case_number_;
    start.pace = pace;
    start.started = wall_clock_text();
    start.start = landing_.sclk();
    start.entry = scenario_.entry_sclk;
    start.correlation = landing_.correlation();
    start.light_time_s = landing_.light_time_s();
    start.tone_model = "statistical"; // the only one that this landing has
    start.scenario_text = scenario_to_text(scenario_);
    for (const auto& [name, value] : solution_arguments(landing_.solution()))
        start.solution.emplace_back(name, value);
    return start;
}

v1::Clocks Rehearsal::clocks() const {
    v1::Clocks clocks;
    clocks.set_sclk(landing_.sclk().seconds);
    clocks.set_scet(day_of_year_text(landing_.scet()));
    clocks.set_e_s(landing_.sclk() - scenario_.entry_sclk);
    clocks.set_ert(day_of_year_text(landing_.ert_now()));
    clocks.set_light_time_s(landing_.light_time_s());
    clocks.set_seen_sclk(landing_.sclk().seconds - landing_.light_time_s());
    return clocks;
}

} // namespace aeolis::server
