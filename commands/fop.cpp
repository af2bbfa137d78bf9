// SPDX-License-Identifier: Apache-2.0
#include "commands/fop.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::commands {
namespace {

constexpr std::uint8_t control_unlock = 0x00;
constexpr std::uint8_t control_set_expected = 0x82;
constexpr std::uint8_t cop_1 = 1;

}  // namespace

Fop::Fop(const Settings& settings) : settings_(settings) {
    AEOLIS_CHECK(settings.window >= 1 && settings.window <= 127 && settings.transmissions_max >= 1);
}

Result<void> Fop::send(std::uint64_t tag, std::span<const std::uint8_t> data, Service service) {
    if (data.empty() || data.size() > tc_frame_data_octets_max)
        return Error{"a telecommand frame carries 1 ... " + std::to_string(tc_frame_data_octets_max) + " octets, not " +
                     std::to_string(data.size())};
    if (waiting() + outstanding() >= frames_max)
        return Error{std::to_string(frames_max) + " telecommand frames wait already"};
    Item item{tag, ++sent_, {data.begin(), data.end()}};
    (service == Service::expedited ? expedited_ : waiting_).push_back(std::move(item));
    return {};
}

std::vector<std::uint8_t> Fop::frame_of(const TcFrameHeader& header, std::span<const std::uint8_t> data) const {
    std::vector<std::uint8_t> frame(data.size() + tc_frame_overhead_octets);
    write_tc_frame(header, data, frame);
    return frame;
}

Fop::Outgoing Fop::control(std::vector<std::uint8_t> command) const {
    return {frame_of({true, true, settings_.spacecraft, settings_.virtual_channel, 0}, command), std::nullopt, 1};
}

Fop::Outgoing Fop::radiate(Item& item, bool bypass) {
    item.due = false;
    ++item.transmissions;
    const TcFrameHeader header{bypass, false, settings_.spacecraft, settings_.virtual_channel, item.sequence};
    return {frame_of(header, item.data), item.tag, item.transmissions};
}

std::optional<Fop::Outgoing> Fop::next() {
    if (!controls_.empty()) {
        auto command = std::move(controls_.front());
        controls_.pop_front();
        return control(std::move(command));
    }
    Item* const sequenced = next_sequenced();
    const auto passes = [&](const Item& expedited) {
        return sequenced == nullptr || sequenced->transmissions > 0 || expedited.order < sequenced->order;
    };
    if (!expedited_.empty() && passes(expedited_.front())) {
        Item item = std::move(expedited_.front());
        expedited_.pop_front();
        reports_.push_back({item.tag, Fate::radiated, 1});
        return radiate(item, true);
    }
    if (sequenced == nullptr) return std::nullopt;
    if (waiting_.empty() || sequenced != &waiting_.front()) return radiate(*sequenced, false);
    Item& item = outstanding_.emplace_back(std::move(waiting_.front()));
    waiting_.pop_front();
    item.sequence = next_sequence_++;
    return radiate(item, false);
}

Fop::Item* Fop::next_sequenced() {
    if (state_ != State::active && state_ != State::retransmitting) return nullptr;
    const auto due = std::ranges::find_if(outstanding_, &Item::due);
    if (due != outstanding_.end()) return &*due;
    return waiting_.empty() || outstanding_.size() >= settings_.window ? nullptr : &waiting_.front();
}

std::uint8_t Fop::first_outstanding() const {
    return static_cast<std::uint8_t>(next_sequence_ - outstanding_.size());
}

void Fop::acknowledge(std::size_t frames) {
    for (; frames > 0; --frames) {
        reports_.push_back({outstanding_.front().tag, Fate::acknowledged, outstanding_.front().transmissions});
        outstanding_.pop_front();
    }
}

void Fop::on(const Clcw& clcw) {
    if (clcw.virtual_channel != settings_.virtual_channel || clcw.cop != cop_1 || state_ == State::halted) return;
    if (state_ == State::restarting) {
        const bool done = !clcw.lockout && !clcw.retransmit && clcw.expected == next_sequence_ && controls_.empty();
        if (done) state_ = State::active;
        return;
    }
    // A locked receiver may have forgotten what it took, so its count means nothing.
    if (clcw.lockout) return halt(Halt::lockout);
    const auto acknowledged = static_cast<std::uint8_t>(clcw.expected - first_outstanding());
    if (acknowledged > outstanding_.size()) return halt(Halt::contradiction);
    acknowledge(acknowledged);
    const bool asked_already = state_ == State::retransmitting && acknowledged == 0;
    if (clcw.wait)
        state_ = State::waiting;
    else if (!clcw.retransmit)
        state_ = State::active;
    else if (!asked_already && !outstanding_.empty())
        send_again();
}

void Fop::send_again() {
    const auto tired = [&](const Item& item) { return item.transmissions >= settings_.transmissions_max; };
    if (std::ranges::any_of(outstanding_, tired)) return halt(Halt::too_many_transmissions);
    // Frames not radiated since the last request are due anyway.
    for (Item& item : outstanding_) item.due = true;
    state_ = State::retransmitting;
}

void Fop::repeat() {
    if (state_ == State::restarting) return restart();
    if (state_ == State::halted || outstanding_.empty()) return;
    send_again();
}

void Fop::halt(Halt why) {
    for (const Item& item : outstanding_) reports_.push_back({item.tag, Fate::never_acknowledged, item.transmissions});
    outstanding_.clear();
    state_ = State::halted;
    why_halted_ = why;
}

void Fop::restart() {
    if (state_ != State::restarting) halt(Halt::none);
    controls_.clear();
    controls_.push_back({control_unlock});
    controls_.push_back({control_set_expected, 0x00, next_sequence_});
    state_ = State::restarting;
    why_halted_ = Halt::none;
}

std::vector<std::uint64_t> Fop::take_back() {
    std::vector<std::uint64_t> tags;
    for (auto* items : {&expedited_, &waiting_}) {
        for (const Item& item : *items) tags.push_back(item.tag);
        items->clear();
    }
    return tags;
}

std::vector<std::uint64_t> Fop::unacknowledged() const {
    std::vector<std::uint64_t> tags;
    tags.reserve(outstanding_.size());
    for (const Item& item : outstanding_) tags.push_back(item.tag);
    return tags;
}

std::vector<Fop::Report> Fop::take_reports() {
    return std::exchange(reports_, {});
}

}  // namespace aeolis::commands
