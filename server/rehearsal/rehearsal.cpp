// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal.hpp"

#include "generated/dictionary_flight.hpp"
#include "server/base/wall_clock.hpp"
#include "server/rehearsal/command_messages.hpp"
#include "server/rehearsal/timeline_margins.hpp"
#include "server/scenario/scenario_text.hpp"
#include "telemetry/packet_stream.hpp"
#include "telemetry/text.hpp"

#include <fmt/format.h>
#include <utility>

namespace aeolis::server {
namespace {

constexpr const char* product_packet_name = "DataProduct";

v1::CommandReply refusal(const v1::CommandRequest& request, const std::string& reason) {
    v1::CommandReply reply;
    reply.set_request(request.request());
    reply.set_reason(reason);
    return reply;
}

}  // namespace

Rehearsal::Rehearsal(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                     const dictionary::Dictionary& dictionary, std::shared_ptr<flight::CycleRunner> runner,
                     const std::optional<ClockCorrelation>& clock)
    : scenario_(scenario), dictionary_(dictionary), seed_(seed), case_number_(case_number),
      flight_(scenario, seed, case_number, dictionary, clock), product_packet_(dictionary.packet(product_packet_name)),
      firings_(dictionary) {
    if (runner == nullptr && scenario.test_venue == simulation::TestVenue::performance) {
        ThreadedExecutive::Options options;
        options.measure = true;
        runner = executive_ = std::make_shared<ThreadedExecutive>(options);
    }
    if (runner != nullptr) flight_.run_prime_by(std::move(runner));
    flight_.equip_station(scenario, seed, case_number, dictionary);
}

telemetry::Received& Rehearsal::step() {
    if (!broken_.empty()) return nothing_;
    try {
        auto& received = flight_.step();
        ++cycles_;
        take(received);
        score(landing().report(), received);
        return received;
    } catch (const CheckFailed& bug) {
        broken_ = text_of_bug(bug);
        return nothing_;
    }
}

Result<void> Rehearsal::inject(const v1::FaultInjection& injection) {
    const auto fault = fault_from_message(injection, scenario_);
    if (!fault) return fault.error();
    flight_.inject(*fault);
    return {};
}

Result<void> Rehearsal::redraw(std::uint64_t seed) {
    if (!landing().dispersed())
        return Error{fmt::format("seed: the errors of {} are drawn {} s before entry, by the seed of the run; fork it "
                                 "later, or start another run",
                                 scenario_.name, scenario_.disperse_before_entry_s.value_or(0.0))};
    flight_.redraw(seed, case_number_);
    return {};
}

std::vector<v1::CommandReply> Rehearsal::look(std::span<const v1::CommandRequest> file, const std::string& browser) {
    std::vector<v1::CommandReply> replies;
    std::vector<commands::Request> requests;
    std::vector<std::size_t> places;  // of their replies
    for (const auto& request : file) {
        auto wanted = readable(request, browser, false);
        replies.push_back(wanted ? v1::CommandReply{} : refusal(request, wanted.error().message));
        if (!wanted) continue;
        places.push_back(replies.size() - 1);
        requests.push_back(std::move(*wanted));
    }
    std::size_t next = 0;
    for (const auto& reply : flight_.look(requests)) replies[places[next++]] = message_of(reply);
    return replies;
}

v1::CommandReply Rehearsal::submit(const v1::CommandRequest& request, const std::string& browser, bool director) {
    const auto wanted = readable(request, browser, director);
    return wanted ? message_of(flight_.submit(*wanted)) : refusal(request, wanted.error().message);
}

Result<commands::Request> Rehearsal::readable(const v1::CommandRequest& request, const std::string& browser,
                                              bool director) const {
    const archive::RunClocks clocks{landing().correlation(), scenario_.entry_sclk, landing().light_time_s()};
    if (takes_commands()) return request_of(request, clocks, browser, director);
    return Error{fmt::format("the test venue {} has no computer", name_of(scenario_.test_venue))};
}

std::vector<archive::StageRecord> Rehearsal::take_stages() {
    std::vector<archive::StageRecord> records;
    for (auto& stage : flight_.take_stages()) records.push_back(record_of(std::move(stage)));
    return records;
}

void Rehearsal::take(telemetry::Received& received) {
    flight_.hear(received);
    for (auto& packet : received.packets) {
        register_.add(packet.octets, packet.link.recorded ? telemetry::Path::recorded : telemetry::Path::realtime);
        note_product(packet);
    }
}

void Rehearsal::score(const simulation::CycleReport& truth, const telemetry::Received& received) {
    add_to_digest(truth.recorded);
    firings_.read(truth.recorded);
    for (const auto& symbol : truth.symbols) tones_.sent(symbol);
    for (const auto& tone : received.tones) tones_.heard(tone);
    events_.insert(events_.end(), truth.events.begin(), truth.events.end());
}

void Rehearsal::add_to_digest(std::span<const std::uint8_t> recorded) {
    if (scenario_.test_venue == simulation::TestVenue::gnc_alone) {
        const auto position = landing().truth().p_MoB_M_m;
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

void Rehearsal::note_product(telemetry::ReceivedPacket& packet) {
    const auto header = read_primary_header(packet.octets);
    if (!header || product_packet_ == nullptr || header->apid != product_packet_->apid) return;
    const auto& decoded = flight_.decoded(packet);
    if (!decoded.refusal.empty()) return;
    if (const auto part = telemetry::part_of(dictionary_, decoded.content, packet.octets))
        static_cast<void>(products_.add(*part));  // most parts arrive twice, in real time and recorded
}

archive::Outcome Rehearsal::outcome() const {
    if (!broken_.empty()) return archive::Outcome::lost;
    switch (landing().outcome()) {
    case simulation::Outcome::running: return archive::Outcome::running;
    case simulation::Outcome::touchdown: return archive::Outcome::touchdown;
    case simulation::Outcome::impact: return archive::Outcome::impact;
    case simulation::Outcome::lost: return archive::Outcome::lost;
    case simulation::Outcome::not_commanded: return archive::Outcome::not_commanded;
    case simulation::Outcome::timeout: return archive::Outcome::timeout;
    }
    return archive::Outcome::running;
}

std::string Rehearsal::outcome_reason() const {
    return broken_.empty() ? simulation::reason_of(landing(), judgement()) : broken_;
}

simulation::Judgement Rehearsal::judgement() const {
    if (!broken_.empty()) return {simulation::Verdict::lost, {}};
    const auto least_margin_s = least_timeline_margin_s(firings(), dictionary_);
    return simulation::judge(scenario_.limits, simulation::figures_of(landing(), least_margin_s));
}

std::vector<archive::LinkTotals> Rehearsal::link_totals() const {
    return station().link_totals(landing().ert_now());
}

telemetry::Proof Rehearsal::proof() const {
    if (landing().relaying()) return telemetry::prove(register_);  // by the received part, complete or not
    auto packets = register_;
    telemetry::PacketStream recording{landing().recording()};
    while (const auto packet = recording.next()) packets.add(*packet, telemetry::Path::recorded);
    return telemetry::prove(packets);
}

archive::RunStart Rehearsal::run_start(double pace) const {
    archive::RunStart start;
    start.scenario = scenario_.name;
    start.title = scenario_.title;
    start.seed = seed_;
    start.case_number = case_number_;
    start.pace = pace;
    start.started = wall_clock_text();
    start.start = landing().sclk();
    start.entry = scenario_.entry_sclk;
    start.correlation = landing().correlation();
    start.light_time_s = landing().light_time_s();
    start.tone_model = scenario_.radio.tones_from_samples.value_or(false) ? "signal" : "statistical";
    start.scenario_text = scenario_to_text(scenario_);
    for (const auto& [name, value] : solution_arguments(landing().solution())) start.solution.emplace_back(name, value);
    return start;
}

v1::Clocks Rehearsal::clocks() const {
    v1::Clocks clocks;
    clocks.set_sclk(landing().sclk().seconds);
    clocks.set_scet_us(landing().scet().microseconds);
    clocks.set_e_s(landing().sclk() - scenario_.entry_sclk);
    clocks.set_ert_us(landing().ert_now().microseconds);
    clocks.set_light_time_s(landing().light_time_s());
    clocks.set_seen_sclk(landing().sclk().seconds - landing().light_time_s());
    if (const auto deadline = flight_.gateway().deadlines().next(landing().ert_now())) {
        clocks.set_latest_useful_us(deadline->latest.microseconds);
        clocks.set_useful_before(deadline->timepoint);
    }
    return clocks;
}

}  // namespace aeolis::server
