// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/cycle_runner.hpp"
#include "flight/kernel/executive.hpp"
#include "server/venue/flight_names.hpp"

#include <array>
#include <cstdint>
#include <string>

namespace aeolis::server {

/// Counts the messages between modules while the deterministic executive flies a landing. Writes the document of the
/// flight software from these counts. R9, R40
///
/// Memory   about 200 kB, in the object
class MessageFlow final : public flight::CycleRunner, private flight::MessageTap {
  public:
    void cycle(flight::ComputerState& state, const flight::DeviceInputs& in, flight::DeviceOutputs& out) override;

    std::uint64_t cycles() const { return cycles_; }
    /// The number sent by a module.
    std::uint64_t sent(flight::ModuleId from, flight::ModuleId to, std::size_t message_type) const {
        return counts_[place(static_cast<std::size_t>(from), to, message_type)].messages;
    }
    /// The number delivered with the tick: by the clock and the devices.
    std::uint64_t interrupts(flight::ModuleId to, std::size_t message_type) const {
        return counts_[place(outside, to, message_type)].messages;
    }

    /// The document in Markdown, after at least one cycle: modules with priority, deadline, budget and handled messages
    /// (from the compiler); a diagram of who sends to whom; each message with its number and rate.
    /// @param landing  names the landing flown
    std::string document(const std::string& landing) const;

  private:
    static constexpr std::size_t outside = flight::module_count;
    static constexpr std::size_t place(std::size_t from, flight::ModuleId to, std::size_t type) {
        return (from * flight::module_count + static_cast<std::size_t>(to)) * message_type_count + type;
    }
    struct Counted {
        std::uint64_t messages = 0;
        std::uint32_t seconds = 0;      ///< seconds with at least one message
        std::uint32_t last_second = 0;  ///< the latest of these seconds, counted from 1

        double rate_hz() const { return static_cast<double>(messages) / seconds; }
    };
    void look_at(flight::ComputerState& state);
    void count(std::size_t from, flight::ModuleId to, const flight::Message& message);
    std::string handled_text(std::size_t module) const;
    void sent(flight::ModuleId from, flight::ModuleId to, const flight::Message& message) override;

    std::array<Counted, (flight::module_count + 1) * flight::module_count * message_type_count> counts_{};
    std::array<std::array<bool, message_type_count>, flight::module_count> handled_{};
    std::uint32_t second_ = 0;
    std::uint64_t cycles_ = 0;
};

}  // namespace aeolis::server
