// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/executive.hpp"

#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/interrupts.hpp"

#include <bit>

namespace aeolis::flight {
namespace {

void put(Message& place, const Message& message) {
    copy_content(place, message);
}
/// Constructs an input of the tick as a message directly in the mailbox.
template <typename Content>
void put(Message& place, const Content& content) {
    place.emplace<Content>(content);
}

}  // namespace

template <typename Content>
void Executive::deliver(ModuleId to, const Content& content) {
    if (!is_loaded(state_.load.role, to)) return;
    if (Message* const place = state_.mailboxes[static_cast<std::size_t>(to)].try_grow())
        put(*place, content);
    else
        ++state_.mailbox_overflows;
    if (wakes(to, content)) state_.ready |= bit_of(to);
}

void Executive::cycle(const DeviceInputs& in, DeviceOutputs& out) {
    state_.now = in.now;
    out.begin_cycle();
    for (const Envelope& envelope : state_.next_cycle) deliver(envelope.to, envelope.message);
    state_.next_cycle.clear();
    state_.sync.set_executive_counts(state_.mailbox_overflows, state_.unexpected_messages);
    post_interrupts(in, [&](ModuleId to, const auto& content) { deliver(to, content); });

    // The lowest bit is the module of highest priority; its messages may wake one of still higher priority.
    // What the bound leaves waits in its mailboxes for the next cycle, where sync reports the overrun.
    for (std::size_t runs = 0; state_.ready != 0 && runs < runs_per_cycle_max; ++runs)
        run(static_cast<ModuleId>(std::countr_zero(state_.ready)), out);
}

void Executive::run(ModuleId id, DeviceOutputs& out) {
    state_.ready &= ~bit_of(id);
    auto& mailbox = state_.mailboxes[static_cast<std::size_t>(id)];
    with_module(state_, id, [&](auto& module) {
        for (std::size_t handled = 0; !mailbox.empty(); ++handled) {
            if (handled == mailbox.capacity()) {  // it fills its own mailbox: others get their turn
                state_.ready |= bit_of(id);
                return;
            }
            state_.outbox.begin(id, state_.now, out);
            if (!handle(module, mailbox.front(), state_.outbox)) ++state_.unexpected_messages;
            mailbox.pop();
            distribute(id);
        }
    });
}

void Executive::distribute(ModuleId from) {
    state_.mailbox_overflows += state_.outbox.dropped();
    for (const Envelope& envelope : state_.outbox.sent()) {
        if (tap_ != nullptr) tap_->sent(from, envelope.to, envelope.message);
        if (in_rate_group(from)) {
            deliver(envelope.to, envelope.message);
        } else if (Envelope* const place = state_.next_cycle.try_grow()) {
            place->from = envelope.from;
            place->to = envelope.to;
            copy_content(place->message, envelope.message);
        } else {
            ++state_.mailbox_overflows;
        }
    }
}

}  // namespace aeolis::flight
