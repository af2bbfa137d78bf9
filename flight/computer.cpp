#include "flight/computer.hpp"

#include "flight/kernel/executive.hpp"

namespace aeolis::flight {

Computer::Computer(const Load& load, Sclk start) : state_(std::make_unique<ComputerState>(load, start)) {}
Computer::Computer(const Computer& other) : state_(std::make_unique<ComputerState>(*other.state_)) {}
Computer& Computer::operator=(const Computer& other) {
    *state_ = *other.state_;
    return *this;
}
Computer::Computer(Computer&&) noexcept = default;
Computer& Computer::operator=(Computer&&) noexcept = default;
Computer::~Computer() = default;

void Computer::step(const DeviceInputs& in, DeviceOutputs& out) {
    try {
        Executive{*state_}.cycle(in, out);
    } catch (const CheckFailed& bug) {
        // A bug on board stays on board: the computer starts anew, and says so in its first cycle.
        const std::uint32_t resets = state_->resets + 1;
        const Load load = state_->load;
        std::destroy_at(state_.get());
        std::construct_at(state_.get(), load, in.now);
        state_->resets = resets;
        state_->outbox.begin(ModuleId::sync, in.now, out);
        state_->outbox.event(evr::FATAL_CHECK_FAILED{.source_line = bug.line(), .resets = resets});
        for (const Envelope& envelope : state_->outbox.sent()) state_->next_cycle.push_back(envelope);
    }
}

Computer::Counters Computer::counters() const {
    return {state_->sync.cycles(), state_->sync.overruns(), state_->mailbox_overflows, state_->unexpected_messages,
            state_->resets};
}

}  // namespace aeolis::flight
