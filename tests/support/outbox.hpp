// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"

#include <memory>
#include <vector>

namespace aeolis::test {

/// An outbox with a bus, recording what was sent, by type.
struct OutboxRecorder {
    std::unique_ptr<flight::DeviceOutputs> bus = std::make_unique<flight::DeviceOutputs>();
    flight::Outbox out;

    explicit OutboxRecorder(flight::ModuleId from = flight::ModuleId::edl, Sclk now = Sclk{1000.0}) {
        begin(from, now);
    }
    void begin(flight::ModuleId from, Sclk now) { out.begin(from, now, *bus); }

    template <typename M>
    std::vector<M> sent() const {
        std::vector<M> found;
        for (const auto& envelope : out.sent())
            if (const auto* message = std::get_if<M>(&envelope.message)) found.push_back(*message);
        return found;
    }
    /// The number of reports of an event.
    template <typename Evr>
    int events() const {
        int count = 0;
        for (const auto& record : sent<flight::Record>())
            if (record.apid == Evr::apid && read_bits(record.data, 0, 16) == Evr::id.value) ++count;
        return count;
    }
    template <typename Packet>
    int packets() const {
        int count = 0;
        for (const auto& record : sent<flight::Record>()) count += record.apid == Packet::apid;
        return count;
    }
};

}  // namespace aeolis::test
