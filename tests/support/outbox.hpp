// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "flight/kernel/outbox.hpp"

#include <memory>
#include <vector>

namespace aeolis::test {

/// An Explanation as it was recorded.
struct Explained {
    flight::Decision decision{};
    flight::ExplanationVerdict verdict{};
    std::uint16_t subject = 0;
    std::vector<flight::gnc::Condition> conditions;
};

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
    std::vector<Explained> explanations() const {
        std::vector<Explained> found;
        for (const auto& record : sent<flight::Record>()) {
            if (record.apid != flight::packet::Explanation::apid) continue;
            BitReader in{record.data};
            Explained& told = found.emplace_back();
            told.decision = static_cast<flight::Decision>(in.get(16));
            told.verdict = static_cast<flight::ExplanationVerdict>(in.get(8));
            told.subject = static_cast<std::uint16_t>(in.get(16));
            for (auto left = in.get(8); left > 0; --left) {
                flight::gnc::Condition condition;
                condition.quantity = static_cast<flight::Quantity>(in.get(16));
                condition.value = in.get_double();
                condition.bound = in.get_double();
                condition.comparison = static_cast<flight::Comparison>(in.get(8));
                condition.holds = in.get(8) != 0;
                told.conditions.push_back(condition);
            }
        }
        return found;
    }
    template <typename Packet>
    int packets() const {
        int count = 0;
        for (const auto& record : sent<flight::Record>()) count += record.apid == Packet::apid;
        return count;
    }
};

}  // namespace aeolis::test
