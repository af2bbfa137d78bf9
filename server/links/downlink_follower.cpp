// SPDX-License-Identifier: Apache-2.0
#include "server/links/downlink_follower.hpp"

#include "server/base/wall_clock.hpp"
#include "telemetry/station/silence_classifier.hpp"

#include <algorithm>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::chrono::milliseconds connect_limit{10'000};  // chosen
constexpr std::chrono::milliseconds receive_limit{1'000};
constexpr std::int64_t pass_interval_us = 1'000'000;
constexpr std::int64_t fault_log_interval_us = 10'000'000;  // chosen: a link that is bad throughout fills no disk

}  // namespace

DownlinkFollower::DownlinkFollower(Settings settings, PipelineThread& pipeline, OnState on_state, OnClock on_clock)
    : settings_(std::move(settings)), pipeline_(pipeline), on_state_(std::move(on_state)),
      on_clock_(std::move(on_clock)), clock_(settings_.clocks), station_(recognise_by(settings_.format)),
      wait_(settings_.retry_first) {}

Result<std::unique_ptr<DownlinkFollower>> DownlinkFollower::start(Settings settings, PipelineThread& pipeline,
                                                                  OnState on_state, OnClock on_clock) {
    std::unique_ptr<DownlinkFollower> follower{
        new DownlinkFollower{std::move(settings), pipeline, std::move(on_state), std::move(on_clock)}};
    auto& self = *follower;
    if (!needs_beginning(self.settings_.format))
        if (const auto source = packet_source(self.settings_.format, {}, true); !source) return source.error();
    if (self.settings_.address.udp) {
        if (auto bound = self.socket_.open(self.settings_.address, connect_limit); !bound) return bound.error();
        self.port_ = self.settings_.address.port = self.socket_.local_port();
    }
    self.start_.scenario = "downlink";
    self.start_.title =
        self.settings_.address.text() + ", " + self.settings_.format.name + " by " + self.settings_.xtce;
    self.start_.venue = "downlink";
    self.start_.pace = 1.0;
    self.start_.started = wall_clock_text();
    const auto run = pipeline.begin(self.start_);
    if (!run) return run.error();
    self.run_ = *run;
    spdlog::info("run {} begins: {}", self.run_.value, self.start_.title);
    self.thread_ = std::thread{[&self] { self.follow(); }};
    return follower;
}

DownlinkFollower::~DownlinkFollower() {
    socket_.wake();
    if (thread_.joinable()) thread_.join();
}

void DownlinkFollower::follow() {
    on_state_(state(v1::RunState::running));
    while (!stop_) {
        if (settings_.address.udp)
            waits("listening");
        else if (!connect_again())
            break;
        receive_until_end();
        end_of_stream();
    }
    tell_totals(clock_.now(), true);
    const auto finished = pipeline_.finish({archive::Outcome::stopped, "stopped", "", wall_clock_text()});
    if (!finished) spdlog::error("run {}: its end could not be stored: {}", run_.value, finished.error().message);
    spdlog::info("run {} ends: {} packets", run_.value, packets_);
    on_state_(state(v1::RunState::finished));
}

/// Connects, with retries. False when stopped.
bool DownlinkFollower::connect_again() {
    while (!stop_) {
        // Waits also after a stream without packets, so that a faulty sender is not reconnected continuously.
        if (!said_.empty() && socket_.sleep(wait_)) break;
        wait_ = std::min(2 * wait_, settings_.retry_max);
        const auto opened = socket_.open(settings_.address, connect_limit);
        if (opened) {
            waits("connected");
            return true;
        }
        lost(telemetry::SilenceClass::ground_fault, opened.error().message + "; trying again, at most every " +
                                                        fmt::format("{:.3g} s", settings_.retry_max.count() * 1e-3));
    }
    stop_ = true;
    return false;
}

void DownlinkFollower::receive_until_end() {
    std::vector<std::uint8_t> piece(piece_octets);
    out_of_step_ = false;
    for (;;) {
        const auto received = socket_.receive(piece, receive_limit);
        if (received.got == DownlinkSocket::Got::woken) {
            stop_ = true;
            return;
        }
        pass();
        if (received.got == DownlinkSocket::Got::end)
            return lost(telemetry::SilenceClass::ground_fault, received.reason);
        if (received.got == DownlinkSocket::Got::nothing) continue;
        take(std::span{piece}.first(received.octets));
        if (stop_) return;
        if (out_of_step_ && !settings_.address.udp) {
            socket_.close();
            return lost(telemetry::SilenceClass::ground_fault,
                        "no packet begins where the last one ended: the connection is made anew");
        }
    }
}

void DownlinkFollower::take(std::span<const std::uint8_t> octets) {
    const Ert now = clock_.now();
    telemetry::Downlink downlink;
    downlink.now = now;
    downlink.octets.push_back({telemetry::downlink_link, now, {octets.begin(), octets.end()}, settings_.address.udp});
    auto& received = station_.receive(std::move(downlink));
    tell_layout();
    if (const auto unread = station_.take_unread()) lost(telemetry::SilenceClass::ground_fault, unread->why);
    deliver(received, now);
    out_of_step_ = station_.lost();
}

void DownlinkFollower::end_of_stream() {
    const Ert now = clock_.now();
    auto& received = station_.end(now);
    tell_layout();
    if (const auto unread = station_.take_unread())
        spdlog::warn("downlink {}: {} octets are not read: {}", settings_.address.text(), unread->octets, unread->why);
    deliver(received, now);
    tell_totals(now, false);
}

void DownlinkFollower::tell_layout() {
    if (const auto layout = station_.take_layout(); !layout.empty())
        spdlog::info("downlink {}: taken for {}", settings_.address.text(), layout);
}

void DownlinkFollower::deliver(telemetry::Received& received, Ert ert) {
    packets_ += received.packets.size();
    if (!received.packets.empty()) {
        wait_ = settings_.retry_first;
        rhythm_.heard(ert);
        // Before the packets: what comes with them is then known to come over a link that is up.
        if (!up_) say({telemetry::downlink_link, received.packets.front().ert, true, "packets come"});
    }
    Delivery delivery;
    delivery.add(std::move(received));
    if (!delivery.entries.empty() && !pipeline_.deliver(std::move(delivery))) stop_ = true;
}

/// Reports the time on Earth, also while nothing is received, and a silence.
void DownlinkFollower::pass() {
    const Ert now = clock_.now();
    if (const auto silence = rhythm_.silent(now); silence && up_)
        lost(telemetry::SilenceClass::unexplained,
             fmt::format("no packet since {}; before, they came at least every {:.3g} s",
                         day_of_year_text(silence->since), silence->interval_s));
    if (now.microseconds - passed_.microseconds < pass_interval_us) return;
    passed_ = now;
    v1::Clocks clocks;
    clocks.set_ert_us(now.microseconds);
    on_clock_(std::move(clocks));
    Delivery delivery;
    delivery.entries.emplace_back(telemetry::EarthTime{now});
    if (!pipeline_.deliver(std::move(delivery))) stop_ = true;
    tell_totals(now, false);
}

/// Hands on the link's totals, and logs what went wrong. @param last  the run ends: however short ago the last line was
void DownlinkFollower::tell_totals(Ert now, bool last) {
    auto totals = station_.totals(now);
    const bool due =
        !faults_logged_ || now.microseconds - faults_logged_->microseconds >= fault_log_interval_us || last;
    if (const auto faults = due ? station_.ledger().faults_since(totals) : std::string{}; !faults.empty()) {
        faults_logged_ = now;
        spdlog::warn("downlink {}: {}", settings_.address.text(), faults);
        if (const auto words = pointers_contradict(settings_.format, totals.pointers); !words.empty())
            spdlog::warn("downlink {}: {}", settings_.address.text(), words);
    }
    if (!station_.ledger().changed(totals)) return;
    Delivery delivery;
    delivery.links.push_back(std::move(totals));
    if (!pipeline_.deliver(std::move(delivery))) stop_ = true;
}

/// The line is there, and nothing has come over it yet.
void DownlinkFollower::waits(const std::string& how) {
    if (!up_) say({telemetry::downlink_link, clock_.now(), false, how + ", no packet has come yet"});
}

void DownlinkFollower::lost(telemetry::SilenceClass silence, const std::string& why) {
    say({telemetry::downlink_link, clock_.now(), false, why, true, {}, silence});
}

void DownlinkFollower::say(telemetry::LinkState state) {
    const auto reason = state.reason();
    if (reason == said_) return;
    said_ = reason;
    up_ = state.up;
    spdlog::log(state.lost ? spdlog::level::warn : spdlog::level::info, "downlink {}: {}", settings_.address.text(),
                reason);
    Delivery delivery;
    const Ert at = state.ert;
    delivery.entries.emplace_back(std::move(state));
    delivery.entries.emplace_back(telemetry::EarthTime{at});  // the situation is judged with the link's change
    if (!pipeline_.deliver(std::move(delivery))) stop_ = true;
    on_state_(this->state(v1::RunState::running));
}

v1::RunState DownlinkFollower::state(v1::RunState::State phase) const {
    v1::RunState state;
    state.set_run(run_.value);
    state.set_scenario(start_.scenario);
    state.set_title(start_.title);
    state.set_venue(start_.venue);
    state.set_state(phase);
    state.set_outcome(phase == v1::RunState::finished ? v1::Landing::stopped : v1::Landing::running);
    state.set_pace(start_.pace);
    state.set_started(start_.started);
    return state;
}

}  // namespace aeolis::server
